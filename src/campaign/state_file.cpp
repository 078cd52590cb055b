#include "campaign/state_file.hpp"

#include <array>
#include <system_error>

#include "clearway/error.hpp"
#include "io/json/parse_json.hpp"
#include "io/system/file_text.hpp"

namespace clearway::campaign {
namespace {

using nlohmann::ordered_json;

constexpr const char* kStateName = "state.json";
constexpr std::array kEndings{"begun", "done", "interrupted", "failed"};

Ending ending_of(const std::string& name) {
  for (std::size_t i = 0; i < kEndings.size(); ++i) {
    if (name == kEndings[i]) return static_cast<Ending>(i);
  }
  return Ending::kBegun;
}

ordered_json place_of(const ordered_json& place) {
  if (place.is_null()) return nullptr;
  ordered_json out{{"pose", place.at("pose")}, {"chainage", place.at("chainage")}};
  if (place.contains("distance")) out["distance"] = place.at("distance");
  return out;
}

/// The counts of ignored points; null where the query ignores nothing.
ordered_json ignored_of(const ordered_json& ignored) {
  if (ignored.at("classes").empty() && ignored.at("boxes").empty()) return nullptr;
  return {{"points", ignored.at("points")},
          {"colliding", ignored.value("colliding", ordered_json())}};
}

ordered_json json_of(const std::vector<InputStamp>& stamps) {
  ordered_json out = ordered_json::array();
  for (const InputStamp& stamp : stamps) {
    out.push_back({{"what", stamp.what},
                   {"file", stamp.file},
                   {"bytes", stamp.bytes},
                   {"modified", stamp.modified}});
  }
  return out;
}

std::vector<InputStamp> stamps_in(const ordered_json& list) {
  std::vector<InputStamp> stamps;
  for (const ordered_json& one : list) {
    InputStamp& stamp = stamps.emplace_back();
    one.at("what").get_to(stamp.what);
    one.at("file").get_to(stamp.file);
    one.at("bytes").get_to(stamp.bytes);
    one.at("modified").get_to(stamp.modified);
  }
  return stamps;
}

}  // namespace

std::optional<TaskState> read_state(const std::filesystem::path& folder) {
  std::error_code unknown;
  if (!std::filesystem::exists(folder / kStateName, unknown)) return std::nullopt;
  try {
    const ordered_json json = parse_json(text_of_file(folder / kStateName));
    TaskState state;
    state.ending = ending_of(json.at("state").get<std::string>());
    json.at("question_id").get_to(state.question_id);
    json.at("outputs_id").get_to(state.outputs_id);
    json.at("exit_code").get_to(state.exit_code);
    json.at("message").get_to(state.message);
    json.at("tries").get_to(state.tries);
    json.at("seconds").get_to(state.seconds);
    json.at("host").get_to(state.host);
    json.at("time").get_to(state.time);
    state.inputs_changed = json.value("inputs_changed", false);
    state.inputs = stamps_in(json.value("inputs", ordered_json::array()));
    state.facts = json.at("facts");
    return state;
  } catch (const JsonError&) {
    return std::nullopt;
  } catch (const ordered_json::exception&) {
    return std::nullopt;
  } catch (const ResourceError&) {
    return std::nullopt;
  }
}

void write_state(const std::filesystem::path& folder, const TaskState& state) {
  const ordered_json json{{"state", kEndings.at(static_cast<std::size_t>(state.ending))},
                          {"exit_code", state.exit_code},
                          {"message", state.message},
                          {"tries", state.tries},
                          {"seconds", state.seconds},
                          {"host", state.host},
                          {"time", state.time},
                          {"question_id", state.question_id},
                          {"outputs_id", state.outputs_id},
                          {"inputs_changed", state.inputs_changed},
                          {"inputs", json_of(state.inputs)},
                          {"facts", state.facts}};
  replace_file(folder / kStateName,
               json.dump(1, ' ', false, ordered_json::error_handler_t::replace) + "\n");
}

ordered_json task_facts(const std::filesystem::path& run_json, const ordered_json& question) {
  try {
    const ordered_json run = parse_json(text_of_file(run_json));
    ordered_json warnings = ordered_json::array(), texts = ordered_json::array();
    for (const auto& warning : run.at("warnings")) {
      warnings.push_back(warning.at("code"));
      texts.push_back(warning.at("message"));
    }
    const ordered_json& profile = run.at("least_profile");
    return {{"verdict", run.at("verdict")},
            {"reasons", run.value("reasons", ordered_json::array())},
            {"exact", question.at("tolerance") == 0 && question.at("single_precision") == false},
            {"colliding_points", run.at("colliding_points")},
            {"ignored", ignored_of(run.at("ignored"))},
            {"least", place_of(profile.is_null() ? run.at("least_clearance") : profile)},
            {"first", place_of(run.at("first_place"))},
            {"warnings", std::move(warnings)},
            {"warning_texts", std::move(texts)}};
  } catch (const JsonError& error) {
    throw ResourceError(run_json.string() + ": is not what the run printed: " + error.what());
  } catch (const ordered_json::exception& error) {
    throw ResourceError(run_json.string() + ": is not what the run printed: " + error.what());
  }
}

}  // namespace clearway::campaign
