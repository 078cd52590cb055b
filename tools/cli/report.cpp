#include "clearway/report.hpp"

#include <spdlog/fmt/chrono.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <ctime>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "clearway/clearway.hpp"
#include "clearway/error.hpp"
#include "cli/commands.hpp"
#include "cli/conflicts/conflict_inputs.hpp"
#include "cli/input_roles.hpp"
#include "cli/run_again.hpp"
#include "cli/section_inputs.hpp"
#include "cli/steps.hpp"
#include "cli/support/console.hpp"
#include "cli/support/lengths.hpp"
#include "cli/support/options.hpp"
#include "cli/support/program.hpp"
#include "cli/support/trajectory_options.hpp"
#include "cli/vehicle/vehicle_inputs.hpp"
#include "core/query/verdict_words.hpp"
#include "core/util/format.hpp"
#include "findings/ledger/ledger_date.hpp"
#include "io/files/pending_file.hpp"
#include "io/models/vehicle_file.hpp"
#include "io/result/answer.hpp"
#include "io/result/conflicts/shift_file.hpp"
#include "io/store/file_kind.hpp"
#include "report/write_report.hpp"

namespace clearway::tool {

std::string now_in_utc() {
  const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  return fmt::format("{:%Y-%m-%d %H:%M} UTC", fmt::gmtime(now));
}

namespace {

std::string file_name(const std::filesystem::path& path) {
  const std::filesystem::path name = path.filename();
  return name.empty() ? path.parent_path().filename().string() : name.string();
}

void name_files(ReportCommand& options) {
  options.report.result_name = file_name(options.result);
  options.report.environment_name = file_name(options.environment);
  options.report.model_name = file_name(options.vehicle.empty() ? options.model : options.vehicle);
  options.report.trajectory_name = file_name(options.trajectory);
  options.report.ledger_name = file_name(options.ledger.options.table);
  if (options.report.date.empty()) options.report.date = now_in_utc();
}

/// Reads again what was searched. The page shows the warnings of reading.
Query read_query_again(ReportCommand& options, OpenedResult& opened, const Store& store) {
  opened.read(&store);
  const std::span<const Message> read(opened.messages);
  const bool all_named =
      options.vehicle.empty() && options.lengths.all_have_units() &&
      names_unit(options.trajectory_options.metres_per_unit, read.first(opened.messages_of_path)) &&
      names_unit(options.model_options.unit, read.subspan(opened.messages_of_path));
  std::vector<Message>& warnings = options.report.warnings;
  std::ranges::copy_if(opened.messages, std::back_inserter(warnings), [](const Message& message) {
    return message.severity != Message::Severity::kNote;
  });
  if (auto note = all_named ? note_on_feet(store) : std::nullopt) {
    warnings.push_back(std::move(*note));
  }
  Query query({}, {}, opened.result.parameters());
  query.poses = std::move(opened.poses);
  query.model = std::move(opened.model);
  query.bodies = std::move(opened.bodies);
  options.report.labels = opened.labels;
  options.report.bodies = query.bodies;
  if (options.vehicle.empty()) return query;
  for (const BodyEntry& body :
       read_vehicle_file(options.vehicle, options.model_options.environment_unit)) {
    options.report.mounts.push_back(body.mount);
  }
  return query;
}

/// Conflicts that were compared with the ledger of the command: those of an earlier step, or
/// `here`, where they are put. The day of the ledger is that of the page, where it shows one.
const FoundConflicts& compare_with_ledger(ReportCommand& options, const Result& result,
                                          const Store& store, const Query& query,
                                          const FoundConflicts* found, FoundConflicts& here) {
  if (found != nullptr && found->ledger) return *found;
  if (day_of(options.report.date)) options.ledger.options.date = options.report.date;
  here.question = result.reader().header();
  here.options = options.find;
  here.options.model = query.bodies.empty() ? &query.model : nullptr;
  std::vector<std::uint32_t> conflict_of_near;
  here.conflicts =
      find_conflicts(result, query.poses, here.options, &here.conflict_of, &conflict_of_near);
  here.ledger = apply_ledger_of(
      options.ledger, {result, here.conflicts, here.conflict_of, conflict_of_near, query.poses},
      here.options, &store);
  return here;
}

void log_summary(const ReportCommand& options, const ReportSummary& summary, const Result& result) {
  const Conflicts& found = summary.conflicts;
  std::string conflicts = "conflicts are not known, as the result has no first poses";
  if (result.parameters().first_pose) conflicts = counted(found.listed.size(), "conflict");
  if (found.small_groups > 0) {
    conflicts += (found.listed.empty() ? " that is listed, but " : " and ") +
                 counted(found.small_groups, "group") + " too small to be listed";
  }
  const bool is_warned_of =
      !options.report.warnings.empty() || !counted_answer(result.reader()).warnings.empty();
  spdlog::info("{}: {}, {}, {}, {}", options.outputs.front().string(),
               verdict_words(summary.verdict, is_warned_of),
               counted(result.size(), "colliding point"), conflicts, format_size(summary.bytes));
  if (!result.parameters().first_pose) {
    spdlog::info(
        "this command makes a result with conflicts:\n  {}",
        run_again(result.reader(), *options.command, options.trajectory, Remedy::kAskForFirstPose));
  }
}

/// The ending of a file's name in small letters, such as ".svg".
std::string ending_of(const std::filesystem::path& path) {
  std::string ending = path.extension().string();
  std::ranges::transform(ending, ending.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending;
}

/// Throws UsageError unless there is one output, which is a page.
void check_one_page(const ReportCommand& options) {
  for (const std::filesystem::path& output : options.outputs) {
    if (ending_of(output) != ".svg") continue;
    throw UsageError(output.string() +
                     ": only a section has a picture; expected an output that "
                     "ends in .html");
  }
  if (options.outputs.size() > 1) {
    throw UsageError("--output: a result has one page; give the option once");
  }
}

void check_model_or_vehicle(const ReportCommand& options) {
  if (options.model.empty() && options.vehicle.empty()) throw CLI::RequiredError("--model");
  refuse_overwriting(options.outputs.front(),
                     options.with({options.environment, options.shifts, options.section,
                                   options.ledger.options.table}));
  if (options.vehicle.empty()) check_is_model(options.model);
}

/// The options that a page of a result and one of a section share.
void add_options_of_both(CLI::App& command, ReportCommand& options) {
  add_file(command, "FILE", options.result,
           "Result of clearway run, or section of clearway section find")
      ->required();
  CLI::Option* environment =
      add_file(command, "--env", options.environment,
               "The store that was searched; of a section, for the points that stop the load");
  CLI::Option* trajectory = add_file(command, "--trajectory", options.trajectory, kTrajectoryHelp);
  environment->needs(trajectory);
  command
      .add_option("-o,--output", options.outputs,
                  "The page, an HTML file; of a section also the picture, an SVG file, in place of "
                  "the page or besides it")
      ->allow_extra_args(false)
      ->type_name("FILE")
      ->required();
  add_trajectory_options(command, options.trajectory_options, options.lengths);
  {
    const GroupScope group(command, OptionGroup::kPage);
    add_page_texts(command, options.report);
  }
  command.add_flag("--force", options.force, "Overwrite existing outputs")
      ->group(title_of(OptionGroup::kFiles));
  command.add_flag("--json", options.json, "Print what the page says as one JSON object");
}

void add_inputs_of_result(CLI::App& command, ReportCommand& options) {
  const GroupScope group(command, OptionGroup::kInputs);
  CLI::Option* model = add_file(command, "--model", options.model, "The model that was moved");
  add_vehicle_option(command, options.vehicle,
                     "Instead of --model: the vehicle of several bodies that was moved", model);
  add_file(command, "--section", options.section,
           "Section of clearway section find on the same path, which the page then shows too");
  add_file(command, "--shifts", options.shifts,
           "Shifts that free the path and its conflicts, which the page then names: JSON of "
           "clearway shift -o");
  add_model_options(command, options.model_options, options.lengths);
}

void add_classes(CLI::App& command, ReportCommand& options) {
  const GroupScope group(command, OptionGroup::kPage);
  command
      .add_option_function<std::vector<std::string>>(
          "--classes",
          [&options](const std::vector<std::string>& texts) {
            options.classes.clear();
            for (const std::string& text : texts) {
              options.classes.push_back(parse_length("--classes", text));
            }
          },
          "Distances below which a point is a hit, near, or to be watched, for example "
          "0.05,0.1,0.3 (default: the radius and the clearance)")
      ->delimiter(',')
      ->type_name("METRES,...");
}

void add_sizes(CLI::App& command, ReportOptions& options, LengthOptions& lengths) {
  const GroupScope group(command, OptionGroup::kPage);
  command
      .add_option("--max-points", options.max_points,
                  "Environment points on the page at most; they are thinned evenly")
      ->type_name("N")
      ->check(CLI::Range(std::uint64_t{1000}, std::uint64_t{20'000'000}))
      ->capture_default_str();
  lengths.add(command, "--every", options.every,
              "Length of a stretch in the table of stations (default: 5, or so long that there are "
              "at most 200)");
}

void add_options_of_result(CLI::App& command, ReportCommand& options) {
  add_inputs_of_result(command, options);
  add_classes(command, options);
  add_sizes(command, options.report, options.lengths);
  add_conflict_options(command, options);
  add_axis_options(command, options);
  add_ledger_options(command, options.ledger, options.lengths);
}

}  // namespace

ReportSummary perform(ReportCommand& options, const FoundConflicts* found) {
  check_one_page(options);
  check_model_or_vehicle(options);
  OpenedResult opened(options, options);
  const Result& result = opened.result;
  const Store store(options.environment);
  for (const ParsedLength& length : options.classes) {
    options.report.classes.push_back(length.in_units_of(store.metres_per_unit()));
  }
  const Query query = read_query_again(options, opened, store);
  options.report.overwrite = options.force;
  options.report.conflicts = options.find;
  if (!options.shifts.empty()) {
    options.report.shifts = read_shifts(options.shifts, result.reader());
  }
  name_files(options);
  std::optional<Section> section;
  if (!options.section.empty()) {
    section.emplace(options.section);
    options.report.section = &*section;
    options.report.section_name = file_name(options.section);
  }
  FoundConflicts here;
  if (options.ledger.is_given()) {
    found = &compare_with_ledger(options, result, store, query, found, here);
    options.report.ledger = found->ledger;
  }
  ReportSummary summary = write_report(result, store, query.model, query.poses,
                                       options.outputs.front(), options.report, found);
  log_summary(options, summary, result);
  return summary;
}

void add_options(CLI::App& command, ReportCommand& options) {
  add_options_of_both(command, options);
  add_options_of_result(command, options);
  options.command = &command;
}

namespace {

/// What the page of a section takes besides the options of both pages.
struct SectionPage {
  LoadInput load;
  SectionHeights heights;
  std::filesystem::path conflicts;
};

void add_options_of_section(CLI::App& command, SectionPage& options, LengthOptions& lengths) {
  const GroupScope group(command, OptionGroup::kSection);
  add_load_options(command, options.load, lengths);
  lengths.add(command, "--band", options.heights.band,
              "Height of a band of the map of widths (default: 0.1 m)");
  lengths.add(command, "--base", options.heights.base, kBaseHelp, FieldRange::kAny);
  add_file(command, "--conflicts", options.conflicts,
           "Names for what stops the load: a CSV file of clearway conflicts on the same "
           "path, with a column `name` if you add one")
      ->needs(command.get_option("--env"));
}

/// Throws UsageError where options need an outline or a table that is not given.
void check_load_is_given(const CLI::App& command, const LoadInput& load) {
  if (load.is_given()) return;
  for (const char* name : {"--margin", "--mirror", "--unit", "--conflicts"}) {
    if (command.count(name) > 0) {
      throw UsageError(std::string(name) + " needs the load: --outline or --table");
    }
  }
}

/// Throws UsageError where an output is neither a page nor a picture, or is an input.
void check_outputs(const ReportCommand& both, const SectionPage& options) {
  std::vector<std::filesystem::path> inputs{both.result};
  for (const auto& input : {options.load.outline, options.load.table, both.environment,
                            both.trajectory, options.conflicts}) {
    if (!input.empty()) inputs.push_back(input);
  }
  bool has_page = false;
  for (const std::filesystem::path& output : both.outputs) {
    const std::string ending = ending_of(output);
    if (ending != ".html" && ending != ".htm" && ending != ".svg") {
      throw UsageError(output.string() +
                       ": unknown output format; the name must end in .html for a page, or in "
                       ".svg for the picture");
    }
    has_page = has_page || ending != ".svg";
    refuse_overwriting(output, inputs);
  }
  if (both.json && !has_page) {
    throw UsageError("--json prints what a page says; expected an output that ends in .html");
  }
}

/// The texts of a page of a section, and what the page is made of but store and path. metres: of
/// the section's unit.
SectionPageOptions page_of(ReportCommand& both, SectionPage& options, const Section& section,
                           double metres) {
  SectionPageOptions page;
  static_cast<PageTexts&>(page) = both.report;
  if (page.date.empty()) page.date = now_in_utc();
  page.overwrite = both.force;
  page.heights = options.heights;
  page.section_name = file_name(both.result);
  if (!both.environment.empty()) page.environment_name = file_name(both.environment);
  if (!both.trajectory.empty()) page.trajectory_name = file_name(both.trajectory);
  if (!options.load.is_given()) return page;
  if (options.load.table.empty()) {
    page.outline = read_load(options.load, section, metres);
    page.outline_name = file_name(options.load.outline);
  } else {
    page.table = read_load_table(options.load, section, metres);
    page.outline_name = file_name(options.load.table);
  }
  page.warnings = options.load.messages;
  page.margin = options.load.margin;
  return page;
}

SectionPageSummary write_outputs(const std::vector<std::filesystem::path>& outputs,
                                 const Section& section, const SectionPageOptions& page) {
  SectionPageSummary summary;
  for (const std::filesystem::path& output : outputs) {
    if (ending_of(output) == ".svg") {
      write_section_picture(section, output, page, page.overwrite);
      spdlog::info("{}: the picture of the section", output.string());
      continue;
    }
    summary = write_section_page(section, output, page);
    spdlog::info("{}: {}; {}", output.string(), summary.sentence, format_size(summary.bytes));
  }
  return summary;
}

SectionPageSummary report_section(ReportCommand& both, SectionPage& options) {
  check_load_is_given(*both.command, options.load);
  check_outputs(both, options);
  const Section section(both.result);
  const double metres = convert_for(both.lengths, section, both.result);
  SectionPageOptions page = page_of(both, options, section, metres);
  SiteInput site{both.environment, both.trajectory, both.trajectory_options};
  check_site(site, page.table.rows.empty() ? nullptr : &page.table);
  site.read(section, metres);
  page.station = site.labels.station;
  if (site.store) {
    page.store = &*site.store;
    page.path = &site.path;
  }
  if (!options.conflicts.empty()) page.obstacles = read_obstacles(options.conflicts);
  for (const Message& warning : section.data().warnings) log_message(warning);
  return write_outputs(both.outputs, section, page);
}

bool is_section(const std::filesystem::path& path) {
  std::error_code unknown;
  return std::filesystem::is_regular_file(path, unknown) &&
         describe_file(path).kind == FileKind::kSection;
}

/// Some of the options of a command.
using Options = std::vector<const CLI::Option*>;

/// The options that a function adds to a command.
template <typename Add>
Options added(const CLI::App& command, Add&& add) {
  const std::size_t before = command.get_options().size();
  add();
  Options options = command.get_options();
  options.erase(options.begin(), options.begin() + static_cast<std::ptrdiff_t>(before));
  return options;
}

/// Throws UsageError where the command was given any of these options. why: what the message says
/// after the option's name.
void refuse_options(const Options& options, const std::string& why) {
  for (const CLI::Option* option : options) {
    if (!option->empty()) throw UsageError("--" + option->get_lnames().front() + " " + why);
  }
}

struct ReportOfAny {
  ReportCommand both;
  SectionPage section;
  Options of_result, of_section;
};

std::string write_any(ReportOfAny& options) {
  ReportCommand& both = options.both;
  const std::string name = both.result.string();
  if (is_section(both.result)) {
    refuse_options(options.of_result, "is for the page of a result, but " + name + " is a section");
    return report_section(both, options.section).facts;
  }
  refuse_options(options.of_section, "is for the page of a section, but " + name + " is none");
  if (both.environment.empty()) throw CLI::RequiredError("--env");
  std::string facts;
  advising_to_run_again(*both.command, {{both.result, both.trajectory}},
                        [&] { facts = perform(both).facts; });
  spdlog::info("open it in a browser: it is one file and needs no network");
  return facts;
}

}  // namespace

void add_report(CLI::App& program) {
  const auto options = std::make_shared<ReportOfAny>();
  CLI::App* command = program.add_subcommand(
      "report", "Write a page that shows a result or a section: one HTML file for any browser");
  ReportCommand& both = options->both;
  both.command = command;
  add_options_of_both(*command, both);
  options->of_result = added(*command, [&] { add_options_of_result(*command, both); });
  options->of_section =
      added(*command, [&] { add_options_of_section(*command, options->section, both.lengths); });
  command->footer(
      "A result needs --env, --trajectory, and --model or --vehicle, those of the run: they are\n"
      "compared by their hashes. Ask the run for --first-pose, --clearance and --profile: the "
      "page\n"
      "shows all of them. The page of a section shows the widths, and with --outline whether the\n"
      "load passes.\n"
      "Example: clearway report out.h5 --env site.h5 --model car.ply --trajectory path.txt -o "
      "report.html\n"
      "Example: clearway report section.h5 --outline load.csv --margin 0.1 -o section.html");
  command->callback([options] {
    run_stoppable(options->both.outputs.front(), kStartsAgain, [&] {
      const std::string facts = write_any(*options);
      if (options->both.json) print(facts + "\n");
    });
  });
}

}  // namespace clearway::tool
