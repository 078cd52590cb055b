#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "clearway/error.hpp"
#include "clearway/report.hpp"
#include "clearway/section.hpp"
#include "cli/commands.hpp"
#include "cli/input_roles.hpp"
#include "cli/section_inputs.hpp"
#include "cli/steps.hpp"
#include "cli/support/console.hpp"
#include "cli/support/lengths.hpp"
#include "cli/support/options.hpp"
#include "cli/support/program.hpp"
#include "cli/support/trajectory_options.hpp"
#include "core/util/format.hpp"
#include "io/files/pending_file.hpp"
#include "io/scans/length_unit.hpp"

namespace clearway::tool {

CLI::Option* add_load_options(CLI::App& command, LoadInput& load, LengthOptions& lengths) {
  CLI::Option* outline =
      command
          .add_option("--outline", load.outline,
                      "The outline of the load as text: y,z of each corner in a line, y to the "
                      "left and z up, or with --mirror height,half_width")
          ->type_name("FILE");
  lengths.add(command, "--margin", load.margin,
              "Distance to keep on all sides; at most that of the section, which is the default",
              FieldRange::kFromZero);
  command.add_flag("--mirror", load.how.mirror,
                   "The file has height,half_width of the one half of a symmetric outline");
  add_outline_unit(command, load.how.unit);
  return outline;
}

double convert_for(const LengthOptions& lengths, const Section& section,
                   const std::filesystem::path& file) {
  const LengthUnit unit = length_unit_of(section.data().length_unit);
  if (unit == LengthUnit::kUnknown) {
    return lengths.convert_for(file.string(), section.data().crs_wkt);
  }
  const double metres = unit == LengthUnit::kDegrees ? 1 : metres_of(unit);
  lengths.convert(metres);
  return metres;
}

std::vector<OutlinePoint> read_load(LoadInput& load, const Section& section, double metres) {
  std::vector<OutlinePoint> outline =
      read_outline(load.outline, {.mirror = load.how.mirror}, &load.messages);
  for (const Message& message : load.messages) log_message(message);
  const FileUnit& unit = load.how.unit;
  if (!unit.is_known()) return outline;
  if (length_unit_of(section.data().length_unit) == LengthUnit::kUnknown &&
      (is_foot(unit.metres()) || unit.metres() == kMetresPerInch)) {
    spdlog::warn("{}", unit_assumed_text("corners of the outline", unit.metres()));
  }
  const UnitFactor factor(unit.metres_in(metres), metres);
  for (OutlinePoint& p : outline) p = {factor(p.y), factor(p.z)};
  return outline;
}

void add_site_options(CLI::App& command, SiteInput& site, LengthOptions& lengths) {
  CLI::Option* environment =
      command
          .add_option("--env", site.environment,
                      "The store that the section was found in: the points that stop the load are "
                      "looked up there")
          ->type_name("FILE");
  CLI::Option* trajectory =
      command
          .add_option("--trajectory", site.trajectory, "The path that the section was found for")
          ->type_name("FILE");
  environment->needs(trajectory);
  trajectory->needs(environment);
  add_trajectory_options(command, site.trajectory_options, lengths);
}

void SiteInput::read() {
  if (!is_given()) return;
  check_is_trajectory(trajectory);
  check_is_store(environment);
  store.emplace(environment);
  set_environment_unit(*store, trajectory_options);
  trajectory_options.default_crs = store->crs_wkt();
  std::vector<Message> told;
  path = read_trajectory(trajectory, trajectory_options, &told);
  for (const Message& message : told) log_message(message);
}

namespace {

struct ReportOfSection {
  std::filesystem::path section, conflicts;
  std::vector<std::filesystem::path> outputs;
  LoadInput load;
  SiteInput site;
  SectionPageOptions page;
  LengthOptions lengths;
  bool json = false;
};

std::string ending_of(const std::filesystem::path& path) {
  std::string ending = path.extension().string();
  std::ranges::transform(ending, ending.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending;
}

/// Throws UsageError where an output is neither a page nor a picture, or is an input.
void check_outputs(const ReportOfSection& options) {
  std::vector<std::filesystem::path> inputs{options.section};
  for (const auto& input : {options.load.outline, options.site.environment, options.site.trajectory,
                            options.conflicts}) {
    if (!input.empty()) inputs.push_back(input);
  }
  for (const std::filesystem::path& output : options.outputs) {
    const std::string ending = ending_of(output);
    if (ending != ".html" && ending != ".htm" && ending != ".svg") {
      throw UsageError(output.string() +
                       ": unknown output format; the name must end in .html for a page, or in "
                       ".svg for the picture");
    }
    refuse_overwriting(output, inputs);
  }
}

SectionPageSummary write_outputs(const ReportOfSection& options, const Section& section) {
  SectionPageSummary summary;
  for (const std::filesystem::path& output : options.outputs) {
    if (ending_of(output) == ".svg") {
      write_section_picture(section, output, options.page, options.page.overwrite);
      spdlog::info("{}: the picture of the section", output.string());
      continue;
    }
    summary = write_section_page(section, output, options.page);
    spdlog::info("{}: {}; {}", output.string(), summary.sentence, format_size(summary.bytes));
  }
  return summary;
}

void run_report(ReportOfSection& options) {
  check_outputs(options);
  const Section section(options.section);
  const double metres = convert_for(options.lengths, section, options.section);
  SectionPageOptions& page = options.page;
  page.section_name = options.section.filename().string();
  if (page.date.empty()) page.date = now_in_utc();
  if (!options.load.outline.empty()) {
    page.outline = read_load(options.load, section, metres);
    page.warnings.insert(page.warnings.end(), options.load.messages.begin(),
                         options.load.messages.end());
    page.margin = options.load.margin;
    page.outline_name = options.load.outline.filename().string();
  }
  options.site.read();
  if (options.site.is_given()) {
    page.store = &*options.site.store;
    page.path = &options.site.path;
  }
  if (!options.conflicts.empty()) page.obstacles = read_obstacles(options.conflicts);
  for (const Message& warning : section.data().warnings) log_message(warning);
  const SectionPageSummary summary = write_outputs(options, section);
  if (options.json) print(summary.facts + "\n");
}

void add_texts(CLI::App& command, SectionPageOptions& page) {
  const GroupScope group(command, OptionGroup::kPage);
  add_page_texts(command, page.title, page.project, page.client, page.author, page.date);
}

}  // namespace

void add_section_report(CLI::App& section) {
  const auto options = std::make_shared<ReportOfSection>();
  CLI::App* command = section.add_subcommand(
      "report", "Write a page or a picture that shows the section, and what stops a load");
  command->add_option("SECTION", options->section, "Section of clearway section find")
      ->type_name("FILE")
      ->required();
  command
      ->add_option("-o,--output", options->outputs,
                   "The page, an HTML file, or the picture, an SVG file; may be given for both")
      ->allow_extra_args(false)
      ->type_name("FILE")
      ->required();
  CLI::Option* outline = nullptr;
  {
    const GroupScope group(*command, OptionGroup::kAsked);
    outline = add_load_options(*command, options->load, options->lengths);
    for (const char* name : {"--margin", "--mirror", "--unit"}) {
      command->get_option(name)->needs(outline);
    }
    options->lengths.add(*command, "--band", options->page.heights.band,
                         "Height of a band of the map of widths (default: 0.1 m)");
    options->lengths.add(*command, "--base", options->page.heights.base, kBaseHelp,
                         FieldRange::kAny);
  }
  add_site_options(*command, options->site, options->lengths);
  command
      ->add_option("--conflicts", options->conflicts,
                   "Names for what stops the load: a CSV file of clearway conflicts on the same "
                   "path, with a column `name` if you add one")
      ->type_name("FILE")
      ->needs(command->get_option("--env"))
      ->needs(outline);
  add_texts(*command, options->page);
  command->add_flag("--force", options->page.overwrite, "Overwrite existing outputs");
  command->add_flag("--json", options->json, "Print what the page says as one JSON object");
  command->footer(
      "Without --outline the page shows the widths alone.\n"
      "With --env and --trajectory it names the points that stop the load, with --conflicts also "
      "the obstacles.\n"
      "Example: clearway section report section.h5 --outline load.csv --margin 0.1 -o page.html");
  command->callback([options] {
    if (options->json && std::ranges::none_of(options->outputs, [](const auto& output) {
          return ending_of(output) != ".svg";
        })) {
      throw UsageError("--json prints what a page says; expected an output that ends in .html");
    }
    run_stoppable(options->outputs.front(), kStartsAgain, [&] { run_report(*options); });
  });
}

}  // namespace clearway::tool
