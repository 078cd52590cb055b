#include "cli/check/check_plan.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <functional>
#include <system_error>
#include <utility>

#include "clearway/error.hpp"
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

/// How check deals with the options of a step.
struct StepOptions {
  Words without;                                                  ///< those that check sets itself
  std::vector<std::pair<std::string, std::string>> renamed = {};  ///< of the step, and of check
  bool takes_denser_path = true;  ///< whether it takes the path with more poses where there is one

  /// The name that check gives an option of the step; empty where it offers none.
  std::string name_in_check(const std::string& name) const {
    if (std::ranges::find(without, name) != without.end()) return "";
    const auto other =
        std::ranges::find(renamed, name, &std::pair<std::string, std::string>::first);
    return other == renamed.end() ? name : other->second;
  }
};

namespace {

const StepOptions kConvertOptions{
    {"--output", "--force", "--resume", "--near", "--within", "--json", "--help"},
    {{"--lever-arm", "--origins-lever-arm"},
     {"--trajectory-format", "--origins-format"},
     {"--angles", "--origins-angles"},
     {"--trajectory-crs", "--origins-crs"},
     {"--trajectory-datum", "--origins-datum"},
     {"--trajectory-unit", "--origins-unit"}},
    false};
// --gap is that of conflicts, and only a run with an error budget takes it.
const StepOptions kRunOptions{{"--env", "--output", "--first-pose", "--gap", "--shard", "--force",
                               "--resume", "--fail-on-collision", "--json", "--help"}};
const StepOptions kResampleOptions{
    {"--output", "--env", "--max-motion", "--force", "--json", "--help"}, {}, false};
// The run turns the model, and what reads its result knows that.
const StepOptions kConflictsOptions{{"--output", "--env", "--forward", "--up", "--date",
                                     "--fail-on-collision", "--force", "--json", "--help"}};
// --show is about conflicts, which check prints.
const StepOptions kStationsOptions{
    {"--output", "--forward", "--up", "--show", "--force", "--json", "--help"}};
// A section of a store that check is about to make cannot be there.
const StepOptions kReportOptions{{"--env", "--output", "--section", "--forward", "--up", "--shifts",
                                  "--force", "--json", "--help"}};

/// A distance that is asked for up to so many times the radius, unless the user says otherwise.
struct UsualDistance {
  const char* option;
  double radii;
  const char* description;
};

constexpr UsualDistance kUsualDistances[]{
    {"--clearance", 3, "Distances of every point closer than this are found"},
    {"--profile", 5, "The least distance at every pose is found if it is below this"}};

/// The options that say how the path of the question is read.
constexpr std::array kReading{"--trajectory-format", "--lever-arm",        "--angles",
                              "--trajectory-crs",    "--trajectory-datum", "--trajectory-unit"};

Words operator+(Words a, const Words& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

/// The long name of an option with its hyphens; empty for a positional argument.
std::string long_name(const CLI::Option& option) {
  return option.get_lnames().empty() ? "" : "--" + option.get_lnames().front();
}

/// Adds an option that takes what another one takes, and keeps it as text.
void add_like(CLI::App& check, const CLI::Option& original, const std::string& name) {
  const bool renamed = name != long_name(original);
  const std::string description =
      original.get_description() + (renamed ? "; of --origins-path" : "");
  const std::string group =
      renamed ? std::string(title_of(OptionGroup::kStore)) : original.get_group();
  if (is_flag(original)) {
    check.add_flag(name, description)->group(group);
    return;
  }
  CLI::Option* option = check.add_option(name, CLI::callback_t(), description);
  option->type_name(original.get_type_name())->group(group);
  if (!original.get_default_str().empty()) option->default_str(original.get_default_str());
  if (original.get_required()) option->required();
  if (original.get_items_expected_max() > 1) {
    option->expected(1, CLI::detail::expected_max_vector_size)
        ->allow_extra_args(original.get_allow_extra_args())
        ->take_all();
  }
}

/// Offers the options of a step that check does not have yet.
template <typename Command>
void offer(CLI::App& check, const StepOptions& how) {
  Command unused;
  CLI::App step;
  add_options(step, unused);
  for (const CLI::Option* option : step.get_options()) {
    const std::string name = how.name_in_check(long_name(*option));
    if (name.empty() || check.get_option_no_throw(name) != nullptr) continue;
    add_like(check, *option, name);
  }
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
  for (const auto& [option, radii, description] : kUsualDistances) {
    check.get_option(option)->description(
        fmt::format("{} (default: {:g} times the radius)", description, radii));
  }
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

/// The options of a step that the command has been given. The denser path is in the environment's
/// frame and names its unit if that of the user does, so that what says how the file of the user is
/// read goes.
template <typename Command>
Words CheckPlan::given(const StepOptions& how) const {
  Command unused;
  CLI::App step;
  add_options(step, unused);
  const bool is_denser = how.takes_denser_path && has_denser_path_;
  Words words;
  for (const CLI::Option* option : step.get_options()) {
    const std::string of_step = long_name(*option), name = how.name_in_check(of_step);
    const CLI::Option* given = name.empty() ? nullptr : check_.get_option_no_throw(name);
    if (given == nullptr || !tool::is_given(*given)) continue;
    if (is_denser && std::ranges::find(kReading, of_step) != kReading.end()) continue;
    Words values = given->results();
    if (is_denser && of_step == "--trajectory") values = {file(kPathName).string()};
    if (is_flag(*option)) values = {""};
    for (const std::string& value : values) {
      if (is_flag(*option)) {
        words.push_back(of_step);
      } else if (value.starts_with('-') || value.empty()) {
        words.push_back(of_step + "=" + value);
      } else {
        words.insert(words.end(), {of_step, value});
      }
    }
  }
  return words;
}

Words CheckPlan::convert(bool replacing) const {
  Words words{"convert"};
  for (const std::filesystem::path& input : scans_) words.push_back(input.string());
  Words options = given<ConvertCommand>(kConvertOptions);
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
         vehicle + given<ChangeCommand>(kResampleOptions) + Words{"--force"};
}

Words CheckPlan::run(bool replacing) const {
  Words words = Words{"run", "--env", environment().string()} + given<RunOptions>(kRunOptions) +
                Words{"--first-pose"} + distances();
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
         given<ConflictsCommand>(kConflictsOptions) + ledger +
         Words{"-o", file(kConflictsName).string(), "--force"};
}

Words CheckPlan::stations() const {
  return Words{"stations", file(kResultName).string()} + given<StationsCommand>(kStationsOptions) +
         Words{"-o", file(kStationsName).string(), "--force"};
}

Words CheckPlan::report(const std::string& date) const {
  Words words = Words{"report", file(kResultName).string(), "--env", environment().string()} +
                given<ReportCommand>(kReportOptions);
  if (!is_given("--date") && !date.empty()) words = words + Words{"--date", date};
  return words + Words{"-o", file(kReportName).string(), "--force"};
}

std::string CheckPlan::about_distances() const {
  Words parts;
  const Words words = distances();
  for (std::size_t i = 0; i + 1 < words.size(); i += 2) {
    const auto& usual = *std::ranges::find(kUsualDistances, words[i], &UsualDistance::option);
    parts.push_back(
        fmt::format("{} {} ({:g} times the radius)", words[i], words[i + 1], usual.radii));
  }
  return parts.empty() ? "" : fmt::format("taken by default: {}", fmt::join(parts, " and "));
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
  for (const UsualDistance& usual : kUsualDistances) {
    if (is_given(usual.option)) continue;
    words = words + Words{usual.option, times(value_of("--radius"), usual.radii)};
  }
  return words;
}

}  // namespace clearway::tool
