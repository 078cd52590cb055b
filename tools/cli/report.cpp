#include "clearway/report.hpp"

#include <spdlog/fmt/chrono.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <ctime>
#include <filesystem>
#include <memory>

#include "clearway/clearway.hpp"
#include "clearway/error.hpp"
#include "cli/commands.hpp"
#include "cli/conflicts/conflict_inputs.hpp"
#include "cli/input_roles.hpp"
#include "cli/run_again.hpp"
#include "cli/steps.hpp"
#include "cli/support/console.hpp"
#include "cli/support/lengths.hpp"
#include "cli/support/options.hpp"
#include "cli/support/trajectory_options.hpp"
#include "cli/vehicle/vehicle_inputs.hpp"
#include "core/util/format.hpp"
#include "io/files/pending_file.hpp"
#include "io/models/vehicle_file.hpp"
#include "io/result/conflicts/shift_file.hpp"

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
  if (options.report.date.empty()) options.report.date = now_in_utc();
}

/// Takes the number of points that --model-above left out from the note of the model's reader.
void note_left_out(ReportCommand& options, const std::vector<Message>& messages) {
  options.report.model_above = options.model_options.above;
  for (const Message& told : messages) {
    for (const auto& [name, value] : told.numbers) {
      if (name == "left_out") options.report.model_left_out = static_cast<std::uint64_t>(value);
    }
  }
}

void read_model_again(ReportCommand& options, const Result& result, Query& query) {
  std::vector<Message>& warnings = options.report.warnings;
  if (options.vehicle.empty()) {
    query.model =
        read_model(options.model, model_options_of(result, options.model_options), &warnings);
    return;
  }
  query.bodies = read_bodies_of(options.vehicle, options.model_options, options, query.poses,
                                result, warnings);
  options.report.bodies = query.bodies;
  for (const BodyEntry& body :
       read_vehicle_file(options.vehicle, options.model_options.environment_unit)) {
    options.report.mounts.push_back(body.mount);
  }
}

Query read_query_again(ReportCommand& options, const Result& result, const Store& store) {
  std::vector<Message>& warnings = options.report.warnings;
  options.trajectory_options.default_crs = store.crs_wkt();
  Query query({}, {}, result.parameters());
  query.poses = read_trajectory(options.trajectory, options.trajectory_options, &warnings,
                                &options.report.labels);
  const std::size_t of_path = warnings.size();
  read_model_again(options, result, query);
  note_left_out(options, warnings);
  const std::span<const Message> told(warnings);
  const bool all_named =
      options.vehicle.empty() && options.lengths.all_have_units() &&
      names_unit(options.trajectory_options.metres_per_unit, told.first(of_path)) &&
      names_unit(options.model_options.unit, told.subspan(of_path));
  std::erase_if(warnings, [](const Message& m) { return m.severity == Message::Severity::kNote; });
  if (auto note = all_named ? note_on_feet(store) : std::nullopt) {
    warnings.push_back(std::move(*note));
  }
  return query;
}

void log_summary(const ReportCommand& options, const ReportSummary& summary, const Result& result) {
  const Conflicts& found = summary.conflicts;
  std::string conflicts = "conflicts are not known, as the result has no first poses";
  if (result.parameters().first_pose) conflicts = counted(found.listed.size(), "conflict");
  if (found.small_groups > 0) {
    conflicts += (found.listed.empty() ? " that is listed, but " : " and ") +
                 counted(found.small_groups, "group") + " too small to be listed";
  }
  spdlog::info("{}: {}, {}, {}, {}", options.output.string(), name_of(summary.verdict),
               counted(result.size(), "colliding point"), conflicts, format_size(summary.bytes));
  if (!result.parameters().first_pose) {
    spdlog::info(
        "this command makes a result with conflicts:\n  {}",
        run_again(result.reader(), *options.command, options.trajectory, Remedy::kAskForFirstPose));
  }
  spdlog::info("open it in a browser: it is one file and needs no network");
}

void check_model_or_vehicle(const ReportCommand& options) {
  if (options.model.empty() && options.vehicle.empty()) throw CLI::RequiredError("--model");
  std::vector<std::filesystem::path> inputs{options.result, options.environment, options.model,
                                            options.trajectory, options.shifts};
  if (!options.section.empty()) inputs.push_back(options.section);
  if (!options.vehicle.empty()) inputs = vehicle_inputs(options.vehicle, std::move(inputs));
  refuse_overwriting(options.output, inputs);
  if (options.vehicle.empty()) check_is_model(options.model);
}

void add_report_inputs(CLI::App& command, ReportCommand& options) {
  add_searched_inputs(command, "Result of clearway run", options.result, options.environment,
                      options.model, options.vehicle, options.trajectory);
  command
      .add_option(
          "--section", options.section,
          "Section of clearway section find on the same path, which the page then shows too")
      ->type_name("FILE");
  command
      .add_option("--shifts", options.shifts,
                  "Shifts that free the path and its conflicts, which the page then names: JSON of "
                  "clearway shift -o")
      ->type_name("FILE");
  command.add_option("-o,--output", options.output, "The page, an HTML file")
      ->type_name("FILE")
      ->required();
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

void add_page_options(CLI::App& command, ReportOptions& options, LengthOptions& lengths) {
  const GroupScope group(command, OptionGroup::kPage);
  add_page_texts(command, options.title, options.project, options.client, options.author,
                 options.date);
  command
      .add_option("--max-points", options.max_points,
                  "Environment points on the page at most; they are thinned evenly")
      ->type_name("N")
      ->check(CLI::Range(std::uint64_t{1000}, std::uint64_t{20'000'000}))
      ->capture_default_str();
  lengths.add(command, "--every", options.every,
              "Length of a stretch in the table of stations (default: 5, or so long that there are "
              "at most 200)");
  command.add_flag("--force", options.overwrite, "Overwrite an existing page")
      ->group(title_of(OptionGroup::kFiles));
}

}  // namespace

ReportSummary perform(ReportCommand& options) {
  ConsoleProgress progress;
  options.find.progress = [&progress](const ProgressUpdate& update) { progress.update(update); };
  options.find.stop = &stop_flag();
  check_model_or_vehicle(options);
  check_is_trajectory(options.trajectory);
  const Result result(options.result);
  check_kind_of_model(result, options.model, options.vehicle);
  check_axes(result, options);
  const Store store(options.environment);
  if (auto warning = options.lengths.convert_for(store)) {
    options.report.warnings.push_back(std::move(*warning));
  }
  set_environment_unit(store, options.trajectory_options, options.model_options);
  for (const ParsedLength& length : options.classes) {
    options.report.classes.push_back(length.in_units_of(store.metres_per_unit()));
  }
  options.report.conflicts = options.find;
  const Query query = read_query_again(options, result, store);
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
  ReportSummary summary =
      write_report(result, store, query.model, query.poses, options.output, options.report);
  log_summary(options, summary, result);
  return summary;
}

void add_options(CLI::App& command, ReportCommand& options) {
  add_report_inputs(command, options);
  add_classes(command, options);
  add_page_options(command, options.report, options.lengths);
  add_conflict_options(command, options);
  add_axis_options(command, options);
  command.add_flag("--json", options.json, "Print what the page says as one JSON object");
  options.command = &command;
}

void add_report(CLI::App& program) {
  const auto options = std::make_shared<ReportCommand>();
  CLI::App* command = program.add_subcommand(
      "report", "Write a page that shows what a run found: one HTML file for any browser");
  add_options(*command, *options);
  command->footer(
      "Store, model and trajectory are those of the run: they are compared by their hashes.\n"
      "Ask the run for --first-pose, --clearance and --profile: the page shows all of them.\n"
      "Example: clearway report out.h5 --env site.h5 --model car.ply --trajectory path.txt -o "
      "report.html");
  command->callback([options] {
    run_stoppable(options->output, kStartsAgain, [&] {
      advising_to_run_again(*options->command, {{options->result, options->trajectory}}, [&] {
        const ReportSummary summary = perform(*options);
        if (options->json) print(summary.facts + "\n");
      });
    });
  });
}

}  // namespace clearway::tool
