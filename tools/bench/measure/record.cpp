#include "bench/measure/record.hpp"

#include <algorithm>
#include <fstream>
#include <span>

#include "clearway/error.hpp"
#include "io/files/pending_file.hpp"

namespace clearway::bench {
namespace {

Json read(const std::filesystem::path& path) {
  std::ifstream in(path);
  Json all = Json::parse(in, nullptr, false);
  const auto is_case = [](const Json& one) {
    return one.is_object() && one.contains("key") && one["key"].is_string();
  };
  if (!in || !all.is_object() || !all.contains("cases") || !all["cases"].is_array() ||
      !std::all_of(all["cases"].begin(), all["cases"].end(), is_case)) {
    throw InputError(path.string() + ": is not a file of clearway-bench");
  }
  return all;
}

/// The parameter that may differ between the runs of an experiment; each case that a limit stopped
/// keeps that limit.
constexpr const char* kLimit = "limit";
/// The parameter that grows: a file may be continued with other scenes.
constexpr const char* kScenes = "scenes";

std::string plain_text(const Json& value) {
  if (value.is_null()) return "nothing";
  if (!value.is_array()) return value.is_string() ? value.get<std::string>() : value.dump();
  std::string text;
  for (const Json& one : value) text += (text.empty() ? "" : ",") + plain_text(one);
  return text;
}

/// The option that sets a parameter.
std::string option_of(std::string parameter) {
  std::replace(parameter.begin(), parameter.end(), '_', '-');
  return "--" + parameter;
}

/// Throws UsageError with the first value, of that name or within it, that differs.
void check_same(const std::filesystem::path& path, const std::string& name, const Json& earlier,
                const Json& now) {
  if (earlier == now) return;
  if (!now.is_object() || !earlier.is_object()) {
    throw UsageError(path.string() + ": differs in " + name + ": " + plain_text(earlier) +
                     " in the file, " + plain_text(now) + " now; --force replaces it");
  }
  Json both = now;
  both.update(earlier);
  for (const auto& [inner, either] : both.items()) {
    const std::string full = name == "parameters" ? option_of(inner) : name + " " + inner;
    if (full == option_of(kLimit) || full == option_of(kScenes)) continue;
    check_same(path, full, earlier.value(inner, Json()), now.value(inner, Json()));
  }
}

/// Whether a smaller limit has stopped the case, or the conversion that it describes. Where the
/// limit was not recorded, it is taken to be the time after which the case was stopped.
bool stopped_earlier(const Json& one, double limit_seconds) {
  for (const char* place : {"/failed", "/findings/failed"}) {
    const Json::json_pointer failed(place);
    const double after = one.value(failed / "after_seconds", limit_seconds);
    if (one.value(failed / kLimit, after) < limit_seconds) return true;
  }
  return false;
}

}  // namespace

Record::Record(std::filesystem::path path, const Json& header, bool resume, bool force)
    : path_(std::move(path)), all_(header) {
  all_["cases"] = Json::array();
  if (std::filesystem::exists(path_) && !force) {
    if (!resume) {
      throw UsageError(path_.string() + ": exists; --resume goes on with it, --force replaces it");
    }
    Json earlier = read(path_);
    for (const auto& [name, value] : header.items()) {
      check_same(path_, name, earlier.value(name, Json()), value);
    }
    Json& scenes = all_["parameters"][kScenes];
    Json both = earlier.value("parameters", Json()).value(kScenes, Json::array());
    for (const Json& scene : scenes) {
      if (std::find(both.begin(), both.end(), scene) == both.end()) both.push_back(scene);
    }
    scenes = std::move(both);
    all_["cases"] = std::move(earlier["cases"]);
  }
  write();
}

const Json* Record::find(const std::string& key) const {
  for (const Json& one : all_["cases"]) {
    if (one["key"] != key) continue;
    return stopped_earlier(one, all_["parameters"][kLimit]) ? nullptr : &one;
  }
  return nullptr;
}

Json Record::add(Json of_case) {
  Json& cases = all_["cases"];
  const auto known = std::find_if(cases.begin(), cases.end(),
                                  [&](const Json& one) { return one["key"] == of_case["key"]; });
  const auto at = known == cases.end() ? cases.insert(known, Json()) : known;
  *at = std::move(of_case);
  write();
  return *at;
}

void Record::write() const {
  PendingFile pending(path_, true);
  {
    const File file = File::create(pending.partial());
    const std::string text = all_.dump(1) + "\n";
    file.write(std::as_bytes(std::span(text)));
  }
  pending.publish();
}

}  // namespace clearway::bench
