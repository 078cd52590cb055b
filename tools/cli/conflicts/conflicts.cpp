#include <fmt/chrono.h>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cstddef>
#include <ctime>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cli/commands.hpp"
#include "cli/conflicts/conflict_inputs.hpp"
#include "cli/input_roles.hpp"
#include "cli/steps.hpp"
#include "cli/support/console.hpp"
#include "cli/support/options.hpp"
#include "cli/support/program.hpp"
#include "cli/support/trajectory_options.hpp"
#include "cli/vehicle/vehicle_inputs.hpp"
#include "cli/verdict.hpp"
#include "core/geometry/point_box.hpp"
#include "core/query/error_budget.hpp"
#include "core/query/point_classes.hpp"
#include "core/trajectory/chainage.hpp"
#include "core/util/format.hpp"
#include "findings/check_conflicts.hpp"
#include "findings/conflict_rank.hpp"
#include "findings/ledger/ledger_date.hpp"
#include "io/files/pending_file.hpp"
#include "io/models/sample_mesh.hpp"
#include "io/result/answer.hpp"
#include "io/result/conflicts/conflict_fields.hpp"
#include "io/result/conflicts/conflict_file.hpp"
#include "io/result/conflicts/conflict_words.hpp"
#include "io/result/conflicts/ledger_words.hpp"
#include "io/result/conflicts/write_conflicts.hpp"
#include "io/result/result.hpp"

namespace clearway::tool {
namespace {

bool has_distances(const Conflicts& conflicts) {
  return std::ranges::any_of(conflicts.listed,
                             [](const Conflict& c) { return c.least_distance.has_value(); });
}

bool has_depths(const Conflicts& conflicts) {
  return std::ranges::any_of(conflicts.listed,
                             [](const Conflict& c) { return c.points_inside.value_or(0) > 0; });
}

/// The conflicts from the worst on, at most `most`.
std::vector<const Conflict*> worst_first(const Conflicts& conflicts, std::size_t most) {
  std::vector<const Conflict*> out = by_rank(conflicts);
  if (out.size() > most) out.resize(most);
  return out;
}

std::string length_cell(const std::optional<double>& length, int digits) {
  return length ? fmt::format("{:.{}f}", *length, digits) : "-";
}

/// A length that is known to be at least so much.
std::string bound_cell(const std::optional<double>& length) {
  return length ? ">= " + length_cell(length, 3) : "-";
}

std::string missing_cell(const Conflict& c, double metre) {
  const std::string words = missing_words(c, "", metre);
  constexpr std::string_view kAtLeast = "at least ";
  if (words.starts_with(kAtLeast)) return ">= " + words.substr(kAtLeast.size());
  return words.empty() ? "-" : words;
}

/// The class of most points, with their number where it is not all: "high noise (18)", "40 ground
/// (2)".
std::string class_cell(const Conflict& c) {
  const std::string words = class_words(static_cast<std::uint8_t>(c.main_class.value_or(0)));
  if (words.empty()) return "-";
  return c.main_class_points == c.points ? words : format_count(*c.main_class_points) + " " + words;
}

/// Columns of a terminal's line that the table takes at most.
constexpr std::size_t kTableWidth = 100;

/// A table of some conflicts, with what their file knows. The centroid is left out where it does
/// not fit; the files of conflicts have it.
std::string table_of(const ConflictFile& file, const std::vector<const Conflict*>& rows) {
  std::vector<TextColumn<Conflict>> columns;
  const auto add = [&](const char* title, const auto& cell) {
    columns.push_back({title, 0, cell});
  };
  const Conflicts& all = file.conflicts;
  const double metre = file.metres_per_unit();
  add("id", [](const Conflict& c) { return std::to_string(c.id); });
  if (file.ledger != nullptr) {
    const std::vector<LedgerEntry>& entries = file.ledger->conflicts;
    add("ledger",
        [&](const Conflict& c) { return std::string(name_of(entries[c.id - 1].status)); });
    add("row", [&](const Conflict& c) {
      const std::string& key = entries[c.id - 1].key;
      return key.empty() ? "-" : key;
    });
  }
  add("chainage", [](const Conflict& c) { return range_text(c.chainage_from, c.chainage_to); });
  if (rows.front()->station_from) {
    add("station (m)", [](const Conflict& c) {
      return c.station_from && c.station_to ? range_text(*c.station_from, *c.station_to) : "-";
    });
  }
  add("obstacle", [](const Conflict& c) { return length_cell(c.obstacle_chainage, 2); });
  add("points", [](const Conflict& c) { return format_count(c.points); });
  add("side", [](const Conflict& c) { return std::string(name_of(c.side)); });
  if (has_distances(all)) {
    add("distance", [](const Conflict& c) { return length_cell(c.least_distance, 3); });
    add("missing", [metre](const Conflict& c) { return missing_cell(c, metre); });
  }
  if (has_depths(all)) {
    add("depth", [](const Conflict& c) { return length_cell(c.depth.value_or(0), 3); });
    add("inside", [](const Conflict& c) { return format_count(c.points_inside.value_or(0)); });
  }
  if (all.knows_trims) {
    add("trim", [](const Conflict& c) { return length_cell(rounded_up(least_trim(c)), 3); });
  }
  if (all.knows_shifts) {
    add("own shift left",
        [](const Conflict& c) { return bound_cell(rounded_up(c.own_shift_left)); });
    add("own shift right",
        [](const Conflict& c) { return bound_cell(rounded_up(c.own_shift_right)); });
  }
  if (rows.front()->certain) {
    add("class",
        [](const Conflict& c) { return c.certain.value_or(false) ? "certain" : "possible"; });
  }
  if (std::ranges::any_of(rows, [](const Conflict* c) { return !class_words(*c).empty(); })) {
    add("classified", class_cell);
  }
  add("centroid", [](const Conflict& c) {
    return fmt::format("{:.3f} {:.3f} {:.3f}", c.centroid.x, c.centroid.y, c.centroid.z);
  });
  std::string text = table_text(columns, rows);
  if (text.find('\n') <= kTableWidth) return text;
  columns.pop_back();
  return table_text(columns, rows);
}

/// A clause with the stations of a group, empty without stations.
std::string station_clause(const SmallGroup& group) {
  if (!group.station_from || !group.station_to) return "";
  return fmt::format(" (station {:.2f} - {:.2f} m)", *group.station_from, *group.station_to);
}

/// A line about the groups that are not listed, and where the first of them is.
std::string small_text(const ConflictFile& file) {
  const Conflicts& c = file.conflicts;
  if (c.small_groups == 0) return "";
  const SmallGroup& first = c.small.front();
  return (c.listed.empty() ? "" : "not listed: ") + counted(c.small_groups, "group") +
         " of fewer than " + counted(c.min_points, "point") + ", together " +
         counted(c.small_points, "point") + "; " +
         (c.small_groups == 1 ? "it is" : "the first is") +
         fmt::format(
             " at chainage {:.2f} - {:.2f}{}, {:.3f} {:.3f} {:.3f}. --min-points 1 lists {}\n",
             first.chainage_from, first.chainage_to, station_clause(first),
             (first.box.lo.x + first.box.hi.x) / 2, (first.box.lo.y + first.box.hi.y) / 2,
             (first.box.lo.z + first.box.hi.z) / 2, c.small_groups == 1 ? "it" : "them");
}

std::string totals_text(const ConflictFile& file) {
  const Conflicts& c = file.conflicts;
  const std::uint64_t points = c.colliding_points + c.near_points;
  if (points == 0) return "no conflicts, because no point collides\n";
  const std::string classes = classified_words(c.classes, points);
  const std::string path = " along " + format_brief(c.path_length) + " " + symbol_of(file.unit()) +
                           " of path" + (classes.empty() ? "" : "; " + classes) + "\n";
  if (c.listed.empty()) {
    const bool near = c.near_points > 0;
    const char* does = near ? " may collide" : c.small_points == 1 ? " collides" : " collide";
    return counted(c.small_points, "point") + does + path +
           "no conflict is listed, for every group is small: " + small_text(file);
  }
  return counted(c.listed.size(), "conflict") + " of " + counted(points - c.small_points, "point") +
         path + small_text(file);
}

/// Where the worst conflict is and what could be done about it; empty where none is listed.
std::string worst_text(const ConflictFile& file) {
  const Conflict* const worst = worst_of(file.conflicts);
  return worst == nullptr
             ? ""
             : "The worst place is " + conflict_words(*worst, words_about(*worst, file));
}

/// How the points were grouped, and how far apart they are.
std::string grouping_text(const ConflictFile& file) {
  const Conflicts& c = file.conflicts;
  const std::string unit = symbol_of(file.unit());
  std::string text = "points at most " + format_brief(c.gap) + " " + unit +
                     " apart are one conflict, from " + counted(c.min_points, "point") + " on";
  if (c.spacing) {
    text += "; colliding points are " + format_brief(*c.spacing) + " " + unit + " apart";
  }
  if (file.header.budget) {
    if (file.header.gap != c.gap || c.min_points != kLeastCertainGroup) {
      text += "; the verdict groups by " + format_brief(file.header.gap) + " " + unit + " and " +
              counted(kLeastCertainGroup, "point");
    }
  }
  return text + "\n";
}

/// A table of the worst conflicts, from the worst on. At most `most` are shown; the others are
/// counted.
std::string conflict_text(const ConflictFile& file, std::size_t most) {
  const Conflicts& conflicts = file.conflicts;
  std::string text = totals_text(file);
  if (conflicts.colliding_points + conflicts.near_points > 0) text += grouping_text(file);
  if (conflicts.listed.empty() || most == 0) return text;
  const std::vector<const Conflict*> rows = worst_first(conflicts, most);
  if (rows.size() < conflicts.listed.size()) text += fmt::format("the worst {}, ", rows.size());
  text += fmt::format("lengths in {}:\n", symbol_of(file.unit()));
  return text + table_of(file, rows);
}

/// A line about a row of the ledger that needs one, because its status or a reason says more than
/// the table of conflicts does; otherwise empty.
std::string row_text(const LedgerRow& row) {
  if (row.why.empty() && !row.conflicts.empty()) return "";
  if (row.why.empty() && row.shown == LedgerStatus::kResolved) return "";
  std::string text = fmt::format("  row {}: {}", row.key, name_of(row.shown));
  if (!row.why.empty()) text += ", because " + row.why;
  if (!row.owner.empty()) text += " (" + row.owner + ")";
  return text + "\n";
}

/// The rows and conflicts by status, and the rows that need words; at most `most` of these.
std::string ledger_text(const Ledger& ledger, const std::filesystem::path& table,
                        std::size_t most) {
  std::string text = fmt::format("ledger {}: {}{}\n", table.string(), ledger_counts_words(ledger),
                                 ledger.is_updated ? "; updated" : "");
  std::size_t shown = 0, left = 0;
  for (const LedgerRow& row : ledger.rows) {
    const std::string line = row_text(row);
    if (line.empty()) continue;
    if (shown < most) {
      text += line;
      ++shown;
    } else {
      ++left;
    }
  }
  if (left > 0) text += "  and " + counted(left, "more row", "more rows") + "\n";
  return text;
}

/// What the ledger accepts, in a sentence; empty without conflicts.
std::string accepted_text(const Ledger& ledger, Verdict verdict) {
  const bool stays = verdict == Verdict::kConflict && ledger.accepted_conflicts() > 0;
  return (stays ? "The verdict stays conflict. " : "") + ledger_sentence(ledger);
}

/// The number of places of a surface that a picture shows.
constexpr double kDrawnPlaces = 20'000;

/// What is drawn of a model: its points, or places of its triangles.
std::vector<Vec3> drawn(const Model& model) {
  if (!model.is_surface()) return model.vertices;
  return drawn_points({model.vertices, model.triangles}, kDrawnPlaces);
}

/// What the pictures of conflicts show besides them: the model, or the bodies of the vehicle.
std::vector<std::vector<Vec3>> drawn_models(const OpenedResult& opened) {
  std::vector<std::vector<Vec3>> out;
  if (!opened.model.empty()) out.push_back(drawn(opened.model));
  for (const Body& body : opened.bodies) out.push_back(drawn(body.model));
  return out;
}

void tell_of_unknown_sides(const ConflictsCommand& options, const Result& result,
                           const Conflicts& conflicts) {
  if (result.bodies().empty() || !options.vehicle.empty() || conflicts.listed.empty()) return;
  spdlog::info(
      "{}: sides are unknown, and offsets are from the path. --vehicle takes the file of the run, "
      "and shows both from each conflict's body",
      options.result.string());
}

/// A day, or a time in UTC, in the form of ISO 8601.
std::string full_date(const std::string& text) {
  constexpr std::size_t kDay = 10;  // its characters
  const std::string full = text.size() == kDay ? text + "T00:00:00Z" : text;
  const std::optional<WrittenDay> day = day_of(full.substr(0, kDay));
  std::tm time{};
  const bool has_time = full.size() > kDay &&
                        ::strptime(full.c_str() + kDay, "T%H:%M:%SZ", &time) != nullptr &&
                        time.tm_sec < 60;
  if (day && has_time && full == fmt::format("{}T{:%H:%M:%S}Z", text_of(day->day), time))
    return full;
  throw CLI::ValidationError("--date", text +
                                           ": expected a day such as 2025-03-31, or a time such "
                                           "as 2025-03-31T12:00:00Z");
}

void add_sides(CLI::App& command, ConflictsCommand& options) {
  add_axis_options(command, options);
  CLI::Option* model =
      add_file(command, "--model", options.model,
               "The model of the run: for lateral shifts, the sides of older results, and BCF "
               "pictures");
  add_vehicle_option(
      command, options.vehicle,
      "The vehicle of several bodies of the run: for sides, lateral shifts and BCF pictures",
      model);
  add_model_options(command, options.model_options, options.lengths);
}

}  // namespace

ConflictsOutcome perform(ConflictsCommand& options, FoundConflicts* found) {
  NewOutputs<ConflictFormat> outputs(
      options, conflict_format_of,
      options.with({options.ledger.options.table, options.ledger.environment}));
  OpenedResult opened(options, options);
  const Result& result = opened.result;
  const std::vector<Pose>& poses = opened.poses;
  repeat_warnings(result.reader());
  opened.read();
  opened.log_messages();
  const bool has_pictures = outputs.has(ConflictFormat::kBcf);
  std::vector<std::uint32_t> conflict_of, conflict_of_near;
  const bool has_ledger = options.ledger.is_given();
  const bool wants_rows = has_pictures || has_ledger || found != nullptr;
  Conflicts conflicts =
      find_conflicts(result, poses, options.find, wants_rows ? &conflict_of : nullptr,
                     has_ledger ? &conflict_of_near : nullptr);
  ConflictPictures pictures;
  if (has_pictures) {
    pictures = {conflict_points(result.reader(), conflicts, conflict_of), drawn_models(opened)};
  }
  const Answer answer = counted_answer(result.reader());
  ConflictFile file{conflicts, options.find, result.reader().header(), answer, poses,
                    {},        options.date};
  file.warnings = conflict_warnings(conflicts, file.unit());
  std::optional<Ledger> ledger;
  if (has_ledger) {
    ledger = apply_ledger_of(
        options.ledger, {result, conflicts, conflict_of, conflict_of_near, poses}, options.find);
    file.ledger = &*ledger;
  }
  outputs.write([&](ConflictFormat format, const std::filesystem::path& path) {
    write_conflicts(file, pictures, format, path);
  });
  for (const Message& warning : file.warnings) log_message(warning);
  tell_of_unknown_sides(options, result, conflicts);
  ConflictsOutcome outcome{
      conflict_text(file, options.show),
      worst_text(file),
      "{\n" + member_lines(summary_of(file)) + "\n}\n",
      verdict_to_repeat(result.reader(), {{.station = opened.labels.station}, chainage_of(poses)},
                        symbol_of(file.unit())),
      ledger ? accepted_text(*ledger, answer.verdict()) : "",
      ledger ? ledger->outside.verdict : answer.verdict()};
  if (ledger) outcome.text += ledger_text(*ledger, options.ledger.options.table, options.show);
  if (found != nullptr) {
    *found = {std::move(conflicts), std::move(conflict_of), result.reader().header(), options.find,
              std::move(ledger)};
  }
  return outcome;
}

void add_options(CLI::App& command, ConflictsCommand& options) {
  add_result_inputs(command, options);
  add_file(command, "-o,--output", options.outputs,
           "Output: .csv, .json, .geojson, .gpkg or .bcf; may be given several times");
  add_conflict_options(command, options);
  add_trajectory_options(command, options.trajectory_options, options.lengths);
  add_sides(command, options);
  add_count_option(command, "--show", options.show, 0, 1'000'000'000,
                   "Print a table of so many conflicts");
  add_ledger_options(command, options.ledger, options.lengths);
  add_update_option(command, options.ledger, options.lengths);
  add_file(command, "--env", options.ledger.environment,
           "With --ledger: the store that was searched; without it and the model, no row is "
           "gone");
  command
      .add_option_function<std::string>(
          "--date",
          [&options](const std::string& text) {
            options.date = full_date(text);
            options.ledger.options.date = options.date.substr(0, 10);
          },
          "Date that BCF and GeoPackage show, for example 2025-03-31 (default: 2000-01-01, so that "
          "equal conflicts give equal files); and the day of the ledger (default: today in UTC)")
      ->group(title_of(OptionGroup::kConflicts))
      ->type_name("DATE");
  command.add_flag("--force", options.force, "Overwrite existing outputs");
  command.add_flag("--fail-on-collision", options.fail_on_collision,
                   "Exit with code 1 where a point collides, and 6 where the verdict is undecided; "
                   "what the ledger accepts does not count");
  command.add_flag("--json", options.json, "Print one JSON object, without the conflicts");
}

void add_conflicts(CLI::App& program, int& exit_code) {
  const auto options = std::make_shared<ConflictsCommand>();
  CLI::App* command = program.add_subcommand(
      "conflicts", "Group the colliding points of a result to conflicts, place by place");
  add_options(*command, *options);
  command->footer(
      "Points at most the gap apart belong to one conflict, also through other points. Conflicts "
      "are\n"
      "numbered along the path, and the table begins with the worst. Those of a result with\n"
      "clearances have their least distance.\n"
      "Example: clearway conflicts out.h5 --trajectory path.txt -o conflicts.csv");
  command->callback([options, command, &exit_code] {
    work_on_result(*command, *options, [&] {
      const auto [text, worst, json, verdict, accepted, outside] = perform(*options);
      if (options->json) {
        if (!verdict.empty()) spdlog::info("the verdict of this result is {}", verdict);
        print(json);
      } else {
        print(text + (worst.empty() ? "" : worst + "\n") +
              (verdict.empty() ? "" : "the verdict of this result is " + verdict + "\n") +
              (accepted.empty() ? "" : accepted + "\n"));
      }
      if (options->fail_on_collision) exit_code = exit_code_of(outside);
    });
  });
}

}  // namespace clearway::tool
