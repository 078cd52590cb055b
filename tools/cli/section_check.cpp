#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "clearway/error.hpp"
#include "clearway/outline.hpp"
#include "clearway/section.hpp"
#include "cli/section_inputs.hpp"
#include "cli/support/console.hpp"
#include "cli/support/lengths.hpp"
#include "cli/support/options.hpp"
#include "cli/support/program.hpp"
#include "cli/support/program_json.hpp"
#include "core/describe/section_report.hpp"
#include "io/files/facts_json.hpp"
#include "report/section_words.hpp"

namespace clearway::tool {
namespace {

using nlohmann::ordered_json;

struct SectionCheckCommand {
  std::filesystem::path section;
  LoadInput load;
  SiteInput site;
  LengthOptions lengths;
  bool json = false;
};

using Witnesses = std::vector<std::optional<SectionWitness>>;

ordered_json witness_json(const std::optional<SectionWitness>& witness) {
  if (!witness) return nullptr;
  return {{"source", witness->source}, {"xyz", witness->xyz}, {"class", witness->point_class}};
}

/// The places of a check, as members of JSON. witnesses: of each stop, or empty where nobody asked
/// for them.
void add_places(ordered_json& out, const SectionCheck& check, const Witnesses& witnesses,
                const Section& section) {
  out["stops"] = json_of_fact(check.stops);
  for (std::size_t i = 0; i < witnesses.size(); ++i) {
    out["stops"][i]["witness"] = witness_json(witnesses[i]);
  }
  if (section.data().unknown) out["unknowns"] = json_of_fact(check.unknowns);
}

void add_verdict(ordered_json& out, const SectionCheck& check) {
  out["verdict"] = name_of(check.verdict);
  out["reason"] = check.reason.empty() ? ordered_json(nullptr) : ordered_json(check.reason);
  out["first_pose"] = out["chainage"] = out["cell"] = nullptr;
  if (check.stop) {
    out["first_pose"] = check.stop->first_pose;
    out["chainage"] = check.stop->chainage;
    out["cell"] = check.stop->cell;
  }
}

void add_warnings(ordered_json& out, const Section& section, const LoadInput& load) {
  std::vector<Message> warnings = section.data().warnings;
  warnings.insert(warnings.end(), load.messages.begin(), load.messages.end());
  out["warnings"] = warnings;
}

ordered_json json_of(const SectionCheck& check, double margin, const Witnesses& witnesses,
                     const Section& section, const SectionCheckCommand& options) {
  ordered_json out =
      program_json({{"section", options.section}, {"outline", options.load.outline}});
  out["margin"] = margin;
  add_verdict(out, check);
  if (options.site.has_store()) {
    out["witness"] = witnesses.empty() ? ordered_json(nullptr) : witness_json(witnesses.front());
  }
  add_places(out, check, witnesses, section);
  add_warnings(out, section, options.load);
  return out;
}

ordered_json json_of(const OutlineRowCheck& check, const OutlineRow& row, bool by_station,
                     const Section& section) {
  ordered_json out{{"line", check.line},
                   {"chainage_from", check.chainage_from},
                   {"chainage_to", check.chainage_to}};
  if (by_station) {
    out["station_from"] = row.from;
    out["station_to"] = row.to;
  }
  out["outline"] = check.file.string();
  out["margin"] = check.margin;
  out["bins"] = json_of_fact(check.bins);
  add_verdict(out, check.check);
  if (!check.bins) out["verdict"] = nullptr;
  add_places(out, check.check, {}, section);
  return out;
}

ordered_json json_of(const OutlineTableCheck& check, const OutlineTable& table,
                     const Witnesses& witnesses, const Section& section,
                     const SectionCheckCommand& options) {
  ordered_json out = program_json({{"section", options.section}, {"table", options.load.table}});
  add_verdict(out, check);
  out["row"] = check.stop ? ordered_json(check.stop->row) : ordered_json(nullptr);
  auto rows = ordered_json::array();
  for (std::size_t i = 0; i < check.rows.size(); ++i) {
    rows.push_back(json_of(check.rows[i], table.rows[i], table.by_station, section));
  }
  out["rows"] = std::move(rows);
  out["gaps"] = json_of_fact(check.gaps);
  add_places(out, check, witnesses, section);
  for (std::size_t i = 0; i < check.stops.size(); ++i) out["stops"][i]["row"] = check.stops[i].row;
  add_warnings(out, section, options.load);
  return out;
}

/// The points that stop the load first in each stretch; empty without store and path.
Witnesses witnesses_of(const SectionCheck& check, const Section& section, const SiteInput& site) {
  if (!site.store) return {};
  std::vector<SectionPlace> places;
  for (const SectionStop& stop : check.stops) places.push_back({stop.first_pose, stop.cell});
  return section_witnesses(section.data(), *site.store, site.path, places);
}

int exit_code_of(SectionVerdict verdict) {
  return verdict == SectionVerdict::kPasses    ? kDone
         : verdict == SectionVerdict::kStopped ? kDiffers
                                               : kUndecided;
}

int check_outline(SectionCheckCommand& options, const Section& section, double metres) {
  const std::vector<OutlinePoint> outline = read_load(options.load, section, metres);
  const double margin = options.load.margin.value_or(section.data().parameters.margin);
  check_site(options.site, nullptr);
  options.site.read(section, metres);
  SectionCheck check;
  try {
    check = section.check(outline, margin);
  } catch (const UsageError& error) {
    throw UsageError(options.load.outline.string() + ": " + error.what());
  }
  const Witnesses witnesses = witnesses_of(check, section, options.site);
  for (const Message& warning : section.data().warnings) log_message(warning);
  const std::string sentence = verdict_sentence(check, section.data(), margin);
  if (options.json) {
    spdlog::info("{}", sentence);
    print(indented_text(json_of(check, margin, witnesses, section, options)));
  } else {
    print(sentence + "\n");
  }
  return exit_code_of(check.verdict);
}

int check_table(SectionCheckCommand& options, const Section& section, double metres) {
  const OutlineTable table = read_load_table(options.load, section, metres);
  check_site(options.site, &table);
  options.site.read(section, metres);
  const OutlineTableCheck check =
      section.check(table, options.load.margin, options.site.labels.station);
  const Witnesses witnesses = witnesses_of(check, section, options.site);
  for (const Message& warning : section.data().warnings) log_message(warning);
  std::string text = table_sentence(check, section.data()) + "\n";
  if (options.json) {
    spdlog::info("{}", text.substr(0, text.size() - 1));
    print(indented_text(json_of(check, table, witnesses, section, options)));
    return exit_code_of(check.verdict);
  }
  for (const OutlineRowCheck& row : check.rows) {
    text += "  " + row_words(row, section.data()) + "\n";
  }
  print(text);
  return exit_code_of(check.verdict);
}

int run_check(SectionCheckCommand& options) {
  if (!options.load.is_given()) throw CLI::RequiredError("--outline or --table");
  const Section section(options.section);
  const double metres = convert_for(options.lengths, section, options.section);
  return options.load.table.empty() ? check_outline(options, section, metres)
                                    : check_table(options, section, metres);
}

}  // namespace

void add_section_check(CLI::App& section, int& exit_code) {
  const auto options = std::make_shared<SectionCheckCommand>();
  CLI::App* command = section.add_subcommand(
      "check", "Say whether a load with this outline passes, and where it is stopped");
  add_file(*command, "SECTION", options->section, "Section of clearway section find")->required();
  add_load_options(*command, options->load, options->lengths);
  add_site_options(*command, options->site, options->lengths);
  command->add_flag("--json", options->json, "Print one JSON object");
  command->footer(
      "Exit code 0: the load passes.\n"
      "Exit code 1: it is stopped.\n"
      "Exit code 6: unknown, because the load with its margin leaves the window, the margin "
      "exceeds\n"
      "that of the section, the section is in doubt, no beam crossed what the load needs, or\n"
      "the table has no outline for a part of the path.\n"
      "Example: clearway section check section.h5 --outline load.csv --margin 0.1\n"
      "Example: clearway section check section.h5 --table outlines.csv");
  command->callback([options, &exit_code] { exit_code = run_check(*options); });
}

}  // namespace clearway::tool
