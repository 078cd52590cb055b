#include <fcntl.h>
#include <spawn.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <initializer_list>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "clearway/clearway.hpp"
#include "cli/check/check_plan.hpp"
#include "cli/check/check_record.hpp"
#include "cli/commands.hpp"
#include "cli/input_roles.hpp"
#include "cli/steps.hpp"
#include "cli/support/console.hpp"
#include "cli/support/options.hpp"
#include "cli/support/program.hpp"
#include "cli/support/program_json.hpp"
#include "cli/vehicle/vehicle_inputs.hpp"
#include "core/query/error_budget.hpp"
#include "core/util/shell_words.hpp"
#include "core/util/stopwatch.hpp"
#include "io/files/json.hpp"
#include "io/files/thread_limit.hpp"
#include "io/models/model_input.hpp"
#include "io/result/journal.hpp"
#include "io/result/result.hpp"
#include "io/scans/length_unit.hpp"
#include "io/scans/point_reader.hpp"
#include "io/store/convert/convert.hpp"
#include "io/store/convert/input_agreement.hpp"
#include "io/store/file_kind.hpp"
#include "search/check_corridor.hpp"
#include "search/check_query.hpp"
#include "search/device_estimate.hpp"
#include "search/devices.hpp"

namespace clearway::tool {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

/// Scans have hardly ever more bytes for a point.
constexpr std::uint64_t kMostBytesOfPoint = 64;

constexpr const char* kGoesOn = "the same command goes on from what was finished";

constexpr const char* kAnswersThis =
    "--force answers this question in its place, and keeps what still agrees, or -o names another "
    "folder";

/// Advice on errors of a step in terms of check's own options, where that of the step would be
/// wrong. kAnswersThis is about an output that is there already.
constexpr std::pair<Remedy, const char*> kAdvice[]{
    {Remedy::kOverwrite, kAnswersThis},
    {Remedy::kReadOrOverwrite, kAnswersThis},
    {Remedy::kResumeOrOverwrite, kAnswersThis},
    {Remedy::kOverwriteNotResume, kAnswersThis},
    {Remedy::kRestoreOptions, kAnswersThis},
    {Remedy::kOtherPart, kAnswersThis},
    {Remedy::kResume, kGoesOn},
    {Remedy::kNewProcess, kGoesOn},
    {Remedy::kCpuDevice,
     "--device cpu does without a GPU; nvidia-smi lists the GPUs that can be used"},
    {Remedy::kStandardInput, "write it into a file first"},
    {Remedy::kSampleMesh,
     "if it is the vehicle, --model takes it; clearway model FILE --spacing METRES -o FILE.ply "
     "samples its surface to points, which stand beside scans, and --skip-unreadable leaves it "
     "out"},
    {Remedy::kFreeDisk, "free some room, or give -o a folder on a disk with more"}};

/// The advice on an error; null where that of the step is right.
const char* advice_on(const Error& error) {
  const auto found =
      std::ranges::find(kAdvice, error.remedy(), &std::pair<Remedy, const char*>::first);
  return found == std::end(kAdvice) ? nullptr : found->second;
}

/// Calls a step. Errors whose advice is about options that check does not have get check's own.
template <typename Call>
auto in_terms_of_check(const Call& call) {
  const auto said_anew = [](const auto& error) {
    const char* const advice = advice_on(error);
    return advice == nullptr
               ? error
               : std::decay_t<decltype(error)>(error.what() + std::string("; ") + advice,
                                               Remedy::kNone, error.amount());
  };
  try {
    return call();
  } catch (const UsageError& error) {
    throw said_anew(error);
  } catch (const InputError& error) {
    throw said_anew(error);
  } catch (const ResourceError& error) {
    throw said_anew(error);
  }
}

/// A step that writes one file and can be repeated: its options, and the words of its command line.
template <typename Command>
class Step {
 public:
  explicit Step(Words words) : words_(std::move(words)) {
    add_options(app_, options_);
    app_.parse(Words(words_.rbegin(), words_.rend() - 1));  // CLI11 takes the last one first
  }

  Command& options() { return options_; }
  /// The whole command line, without the program's name.
  const Words& words() const { return words_; }
  /// All that the output depends on.
  ordered_json key() const { return key_of(app_); }

 private:
  Words words_;
  CLI::App app_;
  Command options_;
};

/// Opens a page in the browser of the user. Only says so where there is no program for it.
void open_page(const fs::path& page) {
  for (const char* program : {"xdg-open", "open"}) {
    const std::string path = page.string();
    char* const words[] = {const_cast<char*>(program), const_cast<char*>(path.c_str()), nullptr};
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    // What a browser says is not for the user of this command.
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
    pid_t child = 0;
    const int failed = ::posix_spawnp(&child, program, &actions, nullptr, words, environ);
    posix_spawn_file_actions_destroy(&actions);
    if (failed == 0) return;
  }
  spdlog::warn("--open: neither xdg-open nor open can be started here; open {} in a browser",
               page.string());
}

class Check {
 public:
  explicit Check(const CheckCommand& options) : options_(options), plan_(options) {}

  Verdict run() {
    log_messages_once();
    parse_all();
    prepare_folder();
    record_.emplace(options_.folder);
    claim_folder();
    start_gpus();
    if (options_.near) choose_corridor();
    step_time_ = Stopwatch();
    if (!plan_.has_store()) {
      convert_scans();
      end_step("convert");
    }
    fill_path();
    end_step("path");
    const RunOutcome found = search_widening();
    end_step("run");
    const ordered_json conflicts = find_conflicts();
    end_step("conflicts");
    make_stations();
    end_step("stations");
    write_page();
    end_step("report");
    record_->write();
    print_answer(found, conflicts);
    if (options_.open) open_page(plan_.file(kReportName));
    return outside_.value_or(found.report.verdict());
  }

 private:
  /// Notes the seconds since the step before.
  void end_step(const char* step) {
    seconds_.emplace_back(step, step_time_.seconds());
    step_time_ = Stopwatch();
  }

  /// Does a step that goes on with what is there; where that is of another question and may be
  /// replaced, does it once more in its place. do_step: gets whether it replaces.
  template <typename Do>
  static auto go_on_or_replace(bool may_replace, const Do& do_step) {
    try {
      return do_step(false);
    } catch (const UsageError& error) {
      if (advice_on(error) != kAnswersThis || !may_replace) throw;
    }
    return do_step(true);
  }

  /// What is remembered of the file that a step makes, an object. It is made unless it is there.
  /// make: returns what to remember.
  template <typename Command, typename Make>
  ordered_json made(const char* name, const Step<Command>& step, const Make& make,
                    bool may_be_known = true) {
    const ordered_json what = step.key();
    ordered_json known = may_be_known ? record_->find(name, what) : ordered_json();
    reused_[name] = known.is_object();
    if (!known.is_object()) {
      known = in_terms_of_check(make);
      record_->note(name, what, known);
    }
    return known;
  }

  /// Parses the options of all steps, so that every mistake in them is found before the first step.
  void parse_all() {
    if (options_.command->get_option("--model")->empty() &&
        options_.command->get_option("--vehicle")->empty()) {
      throw CLI::RequiredError("--model");
    }
    if (!plan_.has_store()) Step<ConvertCommand>(plan_.convert(false));
    Step<RunOptions> search(plan_.run(false));
    Step<ConflictsCommand>(plan_.conflicts());
    Step<StationsCommand>(plan_.stations());
    Step<ReportCommand>(plan_.report(""));
    in_terms_of_check([&] {
      RunOptions& options = search.options();
      model_options_of(options);
      check_query(options.query, options.search);
      if (!options.vehicle.empty()) check_vehicle_search(options.search);
      check_roles(options);
    });
  }

  /// Refuses files in the wrong place. Where input_roles.hpp names options of single commands,
  /// check names its own.
  void check_roles(const RunOptions& run) const {
    std::vector<fs::path> files{run.model, run.trajectory};
    if (!run.vehicle.empty()) files = vehicle_inputs(run.vehicle, std::move(files));
    for (const fs::path& input : files) {
      std::error_code unknown;
      if (!fs::is_other(fs::status(input, unknown))) continue;
      throw UsageError(input.string() +
                       ": is a pipe or device; expected a file, because each step has to read it "
                       "again. Write it into a file first");
    }
    if (run.vehicle.empty() && !names_box(run.model)) {
      refuse_kinds(run.model, {FileKind::kStore},
                   "a model (points of the vehicle in its own frame)",
                   "stores and scans are the inputs that come first");
    }
    if (run.vehicle.empty()) check_is_model(run.model);
    refuse_kinds(run.trajectory, {FileKind::kPoints, FileKind::kMesh, FileKind::kStore},
                 "a trajectory (a list of poses)",
                 "the inputs that come first are scans, and --model takes the vehicle");
    check_is_trajectory(run.trajectory);
    if (!options_.command->get_option("--columns")->empty()) return;
    std::error_code unknown;
    for (const fs::path& input : options_.inputs) {
      if (!fs::is_regular_file(input, unknown)) continue;
      refuse_kinds(input, {FileKind::kTrajectory}, "a scan",
                   "--trajectory takes it, or --columns says that it holds points");
      refuse_kinds(input, {FileKind::kResult, FileKind::kJournal}, "a scan or a store",
                   "expected what was searched for it");
    }
  }

  static void refuse_kinds(const fs::path& path, std::initializer_list<FileKind> kinds,
                           const char* expected, const char* advice) {
    const FileDescription file = describe_file(path);
    if (std::ranges::find(kinds, file.kind) == kinds.end()) return;
    throw InputError(path.string() + ": is " + file.words + ", not " + expected + "; " + advice);
  }

  void prepare_folder() {
    std::error_code failed;
    for (const fs::path& input : options_.inputs) {
      std::error_code unknown;
      if (input == "-") {
        throw UsageError(
            "-: expected scans in files or folders, because each step has to find them again; "
            "clearway convert - makes a store of standard input, which this command takes");
      }
      if (fs::is_directory(input, unknown) && fs::equivalent(input, options_.folder, unknown)) {
        throw UsageError(
            options_.folder.string() +
            ": is the folder of the scans; expected another one after -o, for example " +
            (options_.folder / "check").string());
      }
    }
    fs::create_directories(options_.folder, failed);
    if (fs::is_directory(options_.folder)) return;
    const std::string why = failed ? failed.message() : "it is no folder";
    throw ResourceError(options_.folder.string() + ": cannot make the folder: " + why +
                        "; -o names one that can be written");
  }

  /// Refuses to overwrite tables and pages that no check made. From here on the folder is one of a
  /// check, also if it is interrupted before its end.
  void claim_folder() {
    for (const char* name : {kConflictsName, kStationsName, kReportName}) {
      std::error_code unknown;
      const fs::path file = plan_.file(name);
      if (record_->exists() || options_.force || !fs::exists(file, unknown)) continue;
      throw UsageError(file.string() +
                       ": exists already, and no check has made it; --force overwrites it, or -o "
                       "names another folder");
    }
    record_->write();
  }

  /// Reads trajectory and model once before a conversion, which may take long, so that a mistake in
  /// them is found at once. What depends on the store is left to the search.
  void try_inputs() const {
    Step<RunOptions> step(plan_.run(false));
    RunOptions& options = step.options();
    options.lengths.convert(1);
    try {
      const std::vector<Pose> poses =
          read_trajectory(options.trajectory, options.trajectory_options);
      check_has_poses(poses, options.trajectory);
      if (options.vehicle.empty()) {
        read_model(options.model, model_options_of(options));
      } else {
        read_vehicle(
            options.vehicle, poses,
            {model_options_of(options), options.trajectory_options, options.search.threads});
      }
    } catch (const Error& error) {
      const Remedy remedy = error.remedy();
      if (remedy != Remedy::kNameCrs && remedy != Remedy::kDeclareLength) throw;
    }
  }

  /// Starts the GPUs beside the conversion, where the search surely takes them: where options name
  /// them, or where the scans are so large that they have very many points.
  void start_gpus() {
    const SearchOptions machine = Step<RunOptions>(plan_.run(false)).options().search;
    if (has_begun() || plan_.has_store() || machine.engine == Engine::kGrid) return;
    started_ = start_devices(machine);
    const std::uint64_t points = bytes_of_scans() / kMostBytesOfPoint;
    const bool many = points >= surely_many_points(threads_or_all(machine.threads));
    if (!started_ && many) started_ = std::make_shared<const DeviceStart>(machine);
  }

  /// The bytes of the scans; of what cannot be read, nothing.
  std::uint64_t bytes_of_scans() const {
    std::uint64_t bytes = 0;
    try {
      for (const fs::path& scan : list_point_files(plan_.scans())) {
        std::error_code failed;
        const std::uint64_t size = fs::file_size(scan, failed);
        if (!failed) bytes += size;
      }
    } catch (const Error&) {
      return 0;  // the conversion reports it
    }
    return bytes;
  }

  /// The frame of the environment that the scans will make.
  EnvironmentFrame frame_of_scans() const {
    Step<ConvertCommand> step(plan_.convert(false));
    const ConvertCommand& scans = step.options();
    step.options().lengths.convert(1);
    const CommonCrs common = declared_crs(scans.inputs, scans.conversion);
    const bool is_assumed = common.unit == LengthUnit::kUnknown;
    return {common.crs, is_assumed ? 1 : metres_of(common.unit), is_assumed};
  }

  /// The distance from the path, in metres, that the question needs: so that no point that is left
  /// out can matter to it.
  double corridor_of_question() {
    Step<RunOptions> step(plan_.run(false));
    RunOptions& options = step.options();
    const EnvironmentFrame frame = frame_of_scans();
    options.lengths.convert(frame.metres_per_unit);
    inputs_ = std::make_shared<RunInputs>(
        in_threads(options.search.threads, [&] { return read_inputs(options, frame); }));
    const Query& read = inputs_->query;
    Query query(read.model, read.poses, options.query);
    query.bodies = read.bodies;
    const auto errors = given_errors(query);
    const double radius = errors ? errors->near_radius(query.radius) : query.radius;
    std::vector<Vec3> path;
    for (const Pose& pose : query.poses) {
      path.push_back({pose.translation[0], pose.translation[1], pose.translation[2]});
    }
    // The denser path runs beside the straight lines between poses, and steps of the store add to
    // an error budget.
    constexpr double kBeside = 0.5;
    const double wanted = CorridorCheck::wanted(query, std::move(path), radius);
    return std::ceil(wanted * frame.metres_per_unit + kBeside);
  }

  /// Makes the plan keep only what the question can reach. A store that an earlier check widened
  /// stays as wide.
  void choose_corridor() {
    double metres = in_terms_of_check([&] { return corridor_of_question(); });
    corridor_key_ = key_of_corridor();
    plan_.keep_near(std::max(metres, record_->corridor(corridor_key_)));
  }

  /// What the width of the corridor depends on: the scans, and what is searched for in them.
  ordered_json key_of_corridor() const {
    ordered_json run = Step<RunOptions>(plan_.run(false)).key();
    run["inputs"].erase("--env");  // the store that has the corridor
    return {{"run", run}, {"convert", Step<ConvertCommand>(plan_.convert(false)).key()}};
  }

  void convert_scans() {
    for (const Message& remark : plan_.remarks()) log_message(remark);
    std::error_code unknown;
    const bool is_there = fs::exists(plan_.environment(), unknown);
    in_terms_of_check([&] {
      if (!inputs_ && !is_there) try_inputs();
      // Where there is no store, only an unfinished conversion is in the way.
      go_on_or_replace(options_.force || !is_there, [&](bool replacing) {
        Step<ConvertCommand> step(plan_.convert(replacing));
        const ConvertReport report = perform(step.options());
        note_step(kStoreName, step.words(), report.was_finished);
      });
    });
  }

  /// Puts poses in between where the model moves farther than the radius from one pose to the next,
  /// because what lies there would be missed. A path that cannot be filled stays as it is, with the
  /// warning of the search.
  void fill_path() {
    const Words words = plan_.resample();
    if (words.empty()) return;
    const Words of_step(words.begin() + 1, words.end());
    try {
      const double motion = motion_to_fill(Step<ChangeCommand>(of_step).options());
      if (motion == 0) return;
      Step<ChangeCommand> step(of_step);
      made(kPathName, step, [&] {
        perform(step.options());
        return ordered_json::object();
      });
      spdlog::info(
          "{}: from one pose to the next the model moves by up to {:.4g} {}, farther than the "
          "radius, so this path has poses in between, on a smooth curve. All numbers of poses are "
          "of "
          "this path",
          plan_.file(kPathName).string(), motion, step.options().unit);
      plan_.take_denser_path();
      note_step(kPathName, words, reused_[kPathName]);
    } catch (const InputError& error) {
      spdlog::info("no poses are put between those of the path: {}", error.what());
    }
  }

  /// Searches. Where the corridor proves too narrow, the store is made anew with one that is wide
  /// enough.
  RunOutcome search_widening() {
    try {
      return search();
    } catch (const InputError& error) {
      if (!options_.near || error.remedy() != Remedy::kWiderCorridor) throw;
      spdlog::info("{}. The scans are converted once more, with --within {:g}", error.what(),
                   error.amount());
      record_->note_corridor(corridor_key_, error.amount());
      plan_.keep_near(error.amount());
    }
    Step<ConvertCommand> wider(plan_.convert(true));
    in_terms_of_check([&] { return perform(wider.options()); });
    commands_.clear();
    note_step(kStoreName, wider.words(), false);
    fill_path();  // it is made for the store
    return search();
  }

  RunOutcome search() {
    return in_terms_of_check([&] {
      const std::string defaults = plan_.about_distances();
      if (!defaults.empty()) spdlog::info("{}", defaults);
      return go_on_or_replace(options_.force,
                              [this](bool replacing) { return perform_run(replacing); });
    });
  }

  /// replacing: see CheckPlan::run().
  RunOutcome perform_run(bool replacing) {
    Step<RunOptions> step(plan_.run(replacing));
    RunOptions& options = step.options();
    options.json = options_.json;
    options.names_nearest = false;
    if (!replacing) options.search.resume = has_begun();
    options.search.started = started_;
    options.inputs = std::move(inputs_);
    try {
      RunOutcome outcome = perform(options);
      note_step(kResultName, step.words(), outcome.report.was_finished);
      return outcome;
    } catch (const UsageError&) {
      started_ = options.search.started;  // another try goes on with the devices
      throw;
    }
  }

  /// Whether there is a result, or a journal of one. A first search has nothing to resume.
  bool has_begun() const {
    const fs::path result = plan_.file(kResultName);
    std::error_code unknown;
    return fs::exists(result, unknown) || fs::exists(journal_of(result), unknown);
  }

  /// Returns what the step says: its text, and sentences about the worst conflict and about what
  /// the ledger accepts.
  ordered_json find_conflicts() {
    Step<ConflictsCommand> step(plan_.conflicts());
    const auto find = [&] {
      const ConflictsOutcome outcome = perform(step.options(), &found_.emplace());
      spdlog::info("{}: written", plan_.file(kConflictsName).string());
      if (plan_.has_ledger()) outside_ = outcome.outside;
      return ordered_json{
          {"text", outcome.text}, {"worst", outcome.worst}, {"accepted", outcome.accepted}};
    };
    // The ledger may have changed.
    const ordered_json said = made(kConflictsName, step, find, !plan_.has_ledger());
    note_step(kConflictsName, step.words(), reused_[kConflictsName]);
    return said;
  }

  void make_stations() {
    Step<StationsCommand> step(plan_.stations());
    made(kStationsName, step, [&] {
      const StationsOutcome outcome = perform(step.options());
      spdlog::info("{}: written", plan_.file(kStationsName).string());
      return ordered_json{{"text", outcome.text}};
    });
    note_step(kStationsName, step.words(), reused_[kStationsName]);
  }

  void write_page() {
    const Step<ReportCommand> undated(plan_.report(""));
    const auto write = [&] {
      const std::string date = now_in_utc();
      Step<ReportCommand> step(plan_.report(date));
      const ReportSummary page = perform(step.options(), found_ ? &*found_ : nullptr);
      return ordered_json{{"date", date},
                          {"warnings", ordered_json::parse(page.facts)["warnings"]}};
    };
    const ordered_json said = made(kReportName, undated, write, !plan_.has_ledger());
    warnings_ = said.value("warnings", ordered_json::array());
    note_step(kReportName, plan_.report(said.value("date", "")), reused_[kReportName]);
  }

  /// Keeps the command line of a step, for the user to repeat it.
  void note_step(const char* name, const Words& words, bool was_there) {
    commands_.push_back(shell_line(words));
    reused_[name] = was_there;
    nothing_done_ = nothing_done_ && was_there;
  }

  void print_answer(const RunOutcome& found, const ordered_json& conflicts) const {
    std::string sentence = found.sentence;
    for (const char* part : {"worst", "accepted"}) {
      const std::string text = conflicts.value(part, "");
      if (!text.empty()) sentence += " " + text;
    }
    if (nothing_done_) {
      spdlog::info("{}: has the answer to this question already; nothing was to be done",
                   options_.folder.string());
    }
    if (options_.json) {
      spdlog::info("{}", sentence);
      print(indented_text(json_of(found, sentence)));
      return;
    }
    spdlog::info("seconds: {}", seconds_text());
    std::string text = "these commands did it, and each can be given again by hand:\n";
    for (const std::string& command : commands_) text += "  " + command + "\n";
    print(text + "\n" + conflicts.value("text", "") + "\n" + sentence + "\n");
    if (options_.open) return;
    spdlog::info("open {} in a browser: it is one file and needs no network",
                 plan_.file(kReportName).string());
  }

  /// "convert 1.42, run 1.90, conflicts 0.61; 3.93 in all", without steps of no time.
  std::string seconds_text() const {
    std::string text;
    double all = 0;
    for (const auto& [step, seconds] : seconds_) {
      all += seconds;
      if (seconds < 0.005) continue;
      text += fmt::format("{}{} {:.2f}", text.empty() ? "" : ", ", step, seconds);
    }
    return text + fmt::format("{}{:.2f} in all", text.empty() ? "" : "; ", all);
  }

  ordered_json json_of(const RunOutcome& found, const std::string& sentence) const {
    ordered_json out = program_json({{"env", plan_.environment()},
                                     {"result", plan_.file(kResultName)},
                                     {"conflicts", plan_.file(kConflictsName)},
                                     {"stations", plan_.file(kStationsName)},
                                     {"report", plan_.file(kReportName)}});
    out["verdict"] = name_of(found.report.verdict());
    if (outside_) out["outside_of_accepted"] = name_of(*outside_);
    out["sentence"] = sentence;
    out["warnings"] = warnings_;
    out["nothing_done"] = nothing_done_;
    out["reused"] = reused_;
    out["commands"] = commands_;
    for (const auto& [step, seconds] : seconds_) out["seconds"][step] = seconds;
    out["run"] = found.json;
    return out;
  }

  const CheckCommand& options_;
  CheckPlan plan_;
  std::optional<CheckRecord> record_;
  ordered_json warnings_;      ///< all that the page shows, which are those of all steps
  ordered_json corridor_key_;  ///< what the question's corridor depends on; null without --near
  std::vector<std::string> commands_;
  ordered_json reused_ = ordered_json::object();
  std::shared_ptr<const DeviceStart> started_;  ///< null where no GPU was started early
  std::shared_ptr<RunInputs> inputs_;           ///< null where none were read before the search
  std::optional<FoundConflicts> found_;         ///< where the table of conflicts was made anew
  /// With a ledger, the verdict on what is left without its accepted conflicts.
  std::optional<Verdict> outside_;
  std::vector<std::pair<std::string, double>> seconds_;  ///< of each step, in their order
  Stopwatch step_time_;
  bool nothing_done_ = true;
};

void add_check_options(CLI::App& command, CheckCommand& options) {
  command
      .add_option(
          "INPUT", options.inputs,
          "Scans as clearway convert takes them, folders of scans, or one store of clearway "
          "convert")
      ->type_name("PATH")
      ->required();
  command.add_option("-o,--output", options.folder, "The folder for everything that is made")
      ->type_name("DIR")
      ->required();
  offer_options_of_steps(command);
  command
      .add_flag("--near", options.near,
                "Keep only the points near the path that this question can reach, which makes the "
                "store small. Another question may need it anew")
      ->group(title_of(OptionGroup::kCorridor));
  command.add_flag("--open", options.open, "Open the report in the browser")
      ->group(title_of(OptionGroup::kPage));
  command.add_flag(
      "--force", options.force,
      "Answer another question than the one that the folder has: replace what does not "
      "agree, and keep the rest");
  command.add_flag("--fail-on-collision", options.fail_on_collision,
                   "Exit with code 1 where a point collides, and 6 where the verdict is undecided; "
                   "what the ledger accepts does not count");
  command.add_flag("--json", options.json, "Print one JSON object about the check");
}

}  // namespace

void add_check(CLI::App& program, int& exit_code) {
  const auto options = std::make_shared<CheckCommand>();
  CLI::App* command = program.add_subcommand("check",
                                             "From scans, a vehicle and its path to the finding: "
                                             "convert, run, conflicts, stations, report");
  add_check_options(*command, *options);
  options->command = command;
  command->footer(
      "Writes into the folder: site.h5, the store; result.h5, with first poses, clearances and "
      "profile;\n"
      "conflicts.csv; stations.csv; report.html; and check.json, from which the command knows "
      "what\n"
      "is there.\n"
      "The same command again makes only what is missing, also after it was interrupted. Another\n"
      "question in the same folder needs --force, and uses the store again.\n"
      "Prints the commands that it consists of, the conflicts, and the verdict of clearway run.\n"
      "Example: clearway check scans --model car.obj --trajectory path.txt --radius 0.1 -o site");
  command->callback([options, &exit_code] {
    run_stoppable(options->folder, kGoesOn, [&] {
      const Verdict verdict = Check(*options).run();
      if (options->fail_on_collision) exit_code = exit_code_of(verdict);
    });
  });
}

}  // namespace clearway::tool
