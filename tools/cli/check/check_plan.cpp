#include "cli/check/check_plan.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <functional>
#include <system_error>
#include <utility>

#include "clearway/error.hpp"
#include "cli/check/step_options.hpp"
#include "cli/steps.hpp"
#include "cli/support/options.hpp"
#include "cli/vehicle/vehicle_inputs.hpp"
#include "core/messages/messages.hpp"
#include "core/util/format.hpp"
#include "io/files/text_number.hpp"
#include "io/models/model_input.hpp"
#include "io/scans/point_reader.hpp"
#include "io/store/file_kind.hpp"

namespace clearway::tool {
namespace {

using Words = CheckPlan::Words;

/// Clearances and profile are asked for up to so many times the radius, unless the user says
/// otherwise.
constexpr double kClearanceRadii = 3, kProfileRadii = 5;

// How check deals with the options of its steps.
const StepOptions kConvertOptions{
    {"--output", "--force", "--resume", "--near", "--within", "--json", "--help"},
    {{"--lever-arm", "--origins-lever-arm"},
     {"--trajectory-format", "--origins-format"},
     {"--angles", "--origins-angles"},
     {"--trajectory-crs", "--origins-crs"},
     {"--trajectory-datum", "--origins-datum"},
     {"--trajectory-unit", "--origins-unit"}}};
// --gap is that of conflicts, and only a run with an error budget takes it.
const StepOptions kRunOptions{{"--env", "--output", "--first-pose", "--gap", "--shard", "--force",
                               "--resume", "--fail-on-collision", "--json", "--help"}};
const StepOptions kResampleOptions{
    {"--output", "--env", "--max-motion", "--force", "--json", "--help"}};
// The run turns the model, and what reads its result knows that.
const StepOptions kConflictsOptions{{"--output", "--env", "--forward", "--up", "--date",
                                     "--fail-on-collision", "--force", "--json", "--help"}};
// --show is about conflicts, which check prints.
const StepOptions kStationsOptions{
    {"--output", "--forward", "--up", "--show", "--force", "--json", "--help"}};
// A section of a store that check is about to make cannot be there.
const StepOptions kReportOptions{{"--env", "--output", "--section", "--forward", "--up", "--shifts",
                                  "--force", "--json", "--help"}};

/// The options that say how the path of the question is read.
constexpr std::array kReading{"--trajectory-format", "--lever-arm",        "--angles",
                              "--trajectory-crs",    "--trajectory-datum", "--trajectory-unit"};

Words operator+(Words a, const Words& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

template <typename Command>
void offer(CLI::App& check, const StepOptions& how) {
  Command unused;
  CLI::App step;
  add_options(step, unused);
  offer_options(check, step, how);
}

/// The options of a step that the command has been given.
template <typename Command>
Words given(const CLI::App& check, const StepOptions& how) {
  Command unused;
  CLI::App step;
  add_options(step, unused);
  return given_words(check, step, how);
}

/// A length as text, times a factor in round numbers: "10cm" times 3 is "30cm".
std::string times(const std::string& length, double factor) {
  const char* at = length.data();
  const char* const end = at + length.size();
  double number = 0;
  if (!parse_number(at, end, number)) return length;
  return format_number(std::stod(fmt::format("{:.2g}", factor * number))) + std::string(at, end);
}

/// Whether the only input is a store.
bool is_one_store(const std::vector<std::filesystem::path>& inputs) {
  std::error_code unknown;
  for (const std::filesystem::path& input : inputs) {
    if (!std::filesystem::is_regular_file(input, unknown)) continue;
    if (describe_file(input).kind != FileKind::kStore) continue;
    if (inputs.size() == 1) return true;
    throw UsageError(input.string() +
                     ": is a store, which has its points already; give it alone, or scans alone");
  }
  return false;
}

Words again(bool replacing) { return {replacing ? "--force" : "--resume"}; }

}  // namespace

void offer_options_of_steps(CLI::App& check) {
  offer<RunOptions>(check, kRunOptions);
  offer<ConvertCommand>(check, kConvertOptions);
  offer<ConflictsCommand>(check, kConflictsOptions);
  offer<StationsCommand>(check, kStationsOptions);
  offer<ReportCommand>(check, kReportOptions);
  check.get_option("--clearance")
      ->description(fmt::format(
          "Distances of every point closer than this are found (default: {:g} times the radius)",
          kClearanceRadii));
  check.get_option("--profile")
      ->description(
          fmt::format("The least distance at every pose is found if it is below this (default: "
                      "{:g} times the radius)",
                      kProfileRadii));
}

CheckPlan::CheckPlan(const CheckCommand& options)
    : options_(options),
      check_(*options.command),
      scans_(options.inputs),
      has_store_(is_one_store(options.inputs)) {
  if (!has_store_) leave_out_models();
  if (!options.near) return;
  if (has_store_) {
    throw UsageError("--near makes a store of the scans near the path, and the input is a store");
  }
  constexpr std::array<std::pair<const char*, const char*>, 3> kRefused{
      {{"--seen", "--seen needs all points of the scans, and --near leaves some out"},
       {"--depth", "--depth needs all points of the scans, and --near leaves some out"},
       {"--origins-path",
        "--near and --origins-path would be read alike; expected one of them, or clearway convert "
        "first"}}};
  for (const auto& [option, why] : kRefused) {
    if (is_given(option)) throw UsageError(why);
  }
}

/// The files of the vehicle; none where they cannot be found out, which the search reports.
std::vector<std::filesystem::path> CheckPlan::models() const {
  if (is_given("--vehicle")) {
    try {
      return vehicle_inputs(value_of("--vehicle"), {});
    } catch (const Error&) {
      return {};
    }
  }
  if (!is_given("--model") || names_box(value_of("--model"))) return {};
  return {value_of("--model")};
}

/// Takes the files of the vehicle from the scans, because the vehicle would collide with itself.
/// Everything for a check may lie in one folder.
void CheckPlan::leave_out_models() {
  const std::vector<std::filesystem::path> all_models = models();
  const auto is_model = [&](const std::filesystem::path& file) {
    return std::ranges::any_of(all_models, [&](const std::filesystem::path& model) {
      std::error_code unknown;
      return std::filesystem::equivalent(file, model, unknown);
    });
  };
  std::vector<std::filesystem::path> scans;
  for (const std::filesystem::path& input : scans_) {
    std::error_code unknown;
    std::vector<std::filesystem::path> files{input};
    const bool is_folder = std::filesystem::is_directory(input, unknown);
    if (is_folder && !all_models.empty()) files = list_point_files({input});
    const auto kept = std::stable_partition(files.begin(), files.end(), std::not_fn(is_model));
    if (kept == files.end()) {
      scans.push_back(input);
      continue;
    }
    for (auto model = kept; model != files.end(); ++model) {
      remarks_.push_back(
          note("model-among-scans",
               model->string() + ": belongs to the vehicle, so it is not taken as a scan"));
    }
    if (is_folder) list_point_files({input}, &remarks_);
    scans.insert(scans.end(), files.begin(), kept);
  }
  if (scans.empty() && !scans_.empty()) {
    std::error_code unknown;
    const bool is_folder = std::filesystem::is_directory(scans_.front(), unknown);
    throw UsageError(scans_.front().string() +
                     (is_folder ? ": holds no scan beside the files of the vehicle"
                                : ": is no scan but belongs to the vehicle") +
                     "; expected scans as inputs");
  }
  scans_ = std::move(scans);
}

std::filesystem::path CheckPlan::environment() const {
  return has_store_ ? options_.inputs.front() : file(kStoreName);
}

Words CheckPlan::convert(bool replacing) const {
  Words words{"convert"};
  for (const std::filesystem::path& input : scans_) words.push_back(input.string());
  Words options = given<ConvertCommand>(check_, kConvertOptions);
  // Before its width is known, the words have no corridor whose bounds could be trusted.
  if (is_given("--near") && near_metres_ == 0) std::erase(options, "--trust-bounds");
  return words + Words{"-o", file(kStoreName).string()} + corridor() + options + again(replacing);
}

/// The words of a corridor around the path of the question, with how this is read.
Words CheckPlan::corridor() const {
  if (near_metres_ == 0) return {};
  Words words{"--near", value_of("--trajectory"), "--within", format_number(near_metres_)};
  for (const char* name : kReading) {
    if (is_given(name) && std::string_view(name) != "--lever-arm") {
      words = words + Words{name, value_of(name)};
    }
  }
  return words;
}

Words CheckPlan::resample() const {
  if (is_given("--between-poses")) return {};
  const Words vehicle = is_given("--vehicle") ? Words{"--model", value_of("--vehicle")} : Words{};
  return Words{"trajectory",
               "resample",
               value_of("--trajectory"),
               "-o",
               file(kPathName).string(),
               "--max-motion",
               value_of("--radius"),
               "--env",
               environment().string()} +
         vehicle + given<ChangeCommand>(check_, kResampleOptions) + Words{"--force"};
}

/// The words of a step with the denser path, which is in the environment's frame and names its unit
/// if that of the user does, so that what says how the file of the user is read goes.
Words CheckPlan::with_path(Words words) const {
  if (!has_denser_path_) return words;
  Words out;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::size_t equals = words[i].find('=');
    const std::string name = words[i].substr(0, equals);
    const bool takes_value = equals == std::string::npos;
    if (name == "--trajectory") {
      out.insert(out.end(), {name, file(kPathName).string()});
    } else if (std::ranges::find(kReading, name) == kReading.end()) {
      out.push_back(words[i]);
      continue;
    }
    if (takes_value) ++i;
  }
  return out;
}

Words CheckPlan::run(bool replacing) const {
  Words words = Words{"run", "--env", environment().string()} +
                with_path(given<RunOptions>(check_, kRunOptions)) + Words{"--first-pose"} +
                distances();
  if (has_budget() && is_given("--gap")) words = words + Words{"--gap", value_of("--gap")};
  return words + Words{"-o", file(kResultName).string()} + again(replacing);
}

Words CheckPlan::conflicts() const {
  Words ledger;
  if (has_ledger()) {
    ledger = {"--env", environment().string()};
    if (is_given("--date")) ledger = ledger + Words{"--date", value_of("--date")};
  }
  return Words{"conflicts", file(kResultName).string()} +
         with_path(given<ConflictsCommand>(check_, kConflictsOptions)) + ledger +
         Words{"-o", file(kConflictsName).string(), "--force"};
}

Words CheckPlan::stations() const {
  return Words{"stations", file(kResultName).string()} +
         with_path(given<StationsCommand>(check_, kStationsOptions)) +
         Words{"-o", file(kStationsName).string(), "--force"};
}

Words CheckPlan::report(const std::string& date) const {
  Words words = Words{"report", file(kResultName).string(), "--env", environment().string()} +
                with_path(given<ReportCommand>(check_, kReportOptions));
  if (!is_given("--date") && !date.empty()) words = words + Words{"--date", date};
  return words + Words{"-o", file(kReportName).string(), "--force"};
}

std::string CheckPlan::about_distances() const {
  std::string text;
  const Words words = distances();
  for (std::size_t i = 0; i + 1 < words.size(); i += 2) {
    const double radii = words[i] == "--clearance" ? kClearanceRadii : kProfileRadii;
    text += (text.empty() ? "" : " and ") +
            fmt::format("{} {} ({:g} times the radius)", words[i], words[i + 1], radii);
  }
  return text.empty() ? "" : "taken by default: " + text;
}

bool CheckPlan::has_ledger() const { return is_given("--ledger"); }

bool CheckPlan::is_given(const char* name) const {
  return tool::is_given(*check_.get_option(name));
}

std::string CheckPlan::value_of(const char* name) const {
  return is_given(name) ? check_.get_option(name)->results().back() : "";
}

bool CheckPlan::has_budget() const {
  constexpr std::array kErrors{"--error-scan", "--error-registration", "--error-pose",
                               "--error-angle", "--error-model"};
  return std::ranges::any_of(kErrors, [this](const char* name) { return is_given(name); });
}

/// Clearances and profile that the user has not asked for. No search between poses has them.
Words CheckPlan::distances() const {
  if (is_given("--between-poses")) return {};
  Words words;
  const std::string radius = value_of("--radius");
  if (!is_given("--clearance")) words = Words{"--clearance", times(radius, kClearanceRadii)};
  if (!is_given("--profile")) words = words + Words{"--profile", times(radius, kProfileRadii)};
  return words;
}

}  // namespace clearway::tool
