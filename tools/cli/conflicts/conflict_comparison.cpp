#include "cli/conflicts/conflict_comparison.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "clearway/error.hpp"
#include "cli/support/console.hpp"
#include "cli/support/options.hpp"
#include "cli/support/trajectory_options.hpp"
#include "cli/vehicle/vehicle_inputs.hpp"
#include "cli/verdict.hpp"
#include "core/query/verdict_words.hpp"
#include "core/trajectory/chainage.hpp"
#include "core/util/format.hpp"
#include "findings/conflict_rank.hpp"
#include "findings/match_conflicts.hpp"
#include "io/files/file.hpp"
#include "io/files/json.hpp"
#include "io/files/pending_file.hpp"
#include "io/files/text_writer.hpp"
#include "io/result/answer.hpp"
#include "io/result/conflicts/conflict_words.hpp"
#include "io/result/result.hpp"

namespace clearway::tool {
namespace {

/// One of the two results that are compared.
struct ComparedSide {
  ComparedSide(ConflictComparison& options, const SearchedFiles& files,
               const Conflicts* grouped_as = nullptr)
      : opened(options, files), has_shifts(!files.model.empty() || !files.vehicle.empty()) {
    repeat_warnings(result.reader(), result.reader().name() + ": ");
    opened.read();
    opened.log_messages();
    ConflictOptions find = options.find;
    if (files.model.empty()) find.model = nullptr;
    find.station = {};
    if (grouped_as != nullptr) {
      find.gap = grouped_as->gap;
      find.min_points = grouped_as->min_points;
    }
    conflicts = find_conflicts(result, opened.poses, find, &conflict_of, &conflict_of_near);
    chainage = chainage_of(opened.poses);
    for (double& metres : chainage) metres += find.chainage_start;
  }

  ComparedResult compared() {
    const ResultHeader& header = result.reader().header();
    const Answer answer = counted_answer(result.reader());
    ComparedResult out;
    out.file = result.reader().name();
    out.radius = header.radius;
    out.unit = symbol_of(unit_of(header));
    out.conflicts = std::move(conflicts);
    out.verdict = answer.verdict();
    out.words = verdict_words(answer.verdict(), !answer.warnings.empty());
    out.doubts = answer.doubts();
    for (const Reason reason : answer.reasons()) out.reasons.emplace_back(name_of(reason));
    out.chainage = chainage;
    for (const Pose& pose : opened.poses) out.path.push_back(pose.position());
    out.scanned = result.reader().findings().scanned;
    out.has_distances = header.clearance > 0;
    out.has_surface = header.model_triangles > 0;
    out.has_solids = header.model_solids > 0;
    out.has_shifts = has_shifts;
    return out;
  }
  GroupedResult grouped() const {
    return {result, conflicts, conflict_of, conflict_of_near, opened.poses};
  }

  OpenedResult opened;
  const Result& result = opened.result;
  Conflicts conflicts;
  std::vector<std::uint32_t> conflict_of, conflict_of_near;
  std::vector<double> chainage;  ///< of each pose, metres
  bool has_shifts = false;
};

/// Whether two results are about the same points.
bool have_same_points(const Result& a, const Result& b) {
  const ResultHeader &in_a = a.reader().header(), &in_b = b.reader().header();
  return in_a.environment_points == in_b.environment_points &&
         in_a.environment_hash == in_b.environment_hash;
}

/// Whether all files of the scans of b are older than those of a; nothing where their dates show no
/// order.
std::optional<bool> is_older(const Result& b, const Result& a) {
  const ScanDates &of_b = b.reader().findings().scanned, &of_a = a.reader().findings().scanned;
  if (!of_b.known() || !of_a.known()) return std::nullopt;
  if (of_b.last < of_a.first) return true;
  return of_a.last < of_b.first ? std::optional(false) : std::nullopt;
}

/// Whether a conflict is worse in b than in a.
enum class Worse { kNo, kYes, kUnknown };

/// Whether two conflicts have the same points, as far as their numbers and places show.
bool are_same(const Conflict& a, const Conflict& b) {
  return a.points == b.points && a.box.lo == b.box.lo && a.box.hi == b.box.hi &&
         a.centroid == b.centroid;
}

/// A conflict is worse where it comes nearer, or reaches deeper, by more than `worse_by`. How deep
/// a point is behind a surface does not follow from distances, but from the shift that its own
/// points need.
Worse worse(const ComparedConflicts& found, const Conflict& a, const Conflict& b) {
  if (found.distances_known && b.least_distance) {
    if (!a.least_distance || *b.least_distance < *a.least_distance - found.worse_by) {
      return Worse::kYes;
    }
    const bool touches = *b.least_distance <= std::max(found.worse_by, kTouching);
    if (!touches || found.b.has_solids) return Worse::kNo;
    // With a model of points there is no depth, unless the shifts give it.
    const bool shifts_known = found.a.has_shifts && found.b.has_shifts;
    if (!found.b.has_surface && !shifts_known) return Worse::kNo;
  }
  if (found.questions.empty() && are_same(a, b)) return Worse::kNo;
  if (!found.a.has_shifts || !found.b.has_shifts) return Worse::kUnknown;
  const double before = least_own_shift(a), now = least_own_shift(b);
  if (std::isinf(before) && std::isinf(now)) return Worse::kUnknown;
  return now > before + found.worse_by ? Worse::kYes : Worse::kNo;
}

/// Sets which conflicts are worse, and of which it is not known.
void find_worse(ComparedConflicts& found) {
  for (const auto& pair : found.match.same) {
    const Worse kind = worse(found, conflict_at(found.a.conflicts, pair.first),
                             conflict_at(found.b.conflicts, pair.second));
    if (kind == Worse::kYes) found.worse.push_back(pair);
    if (kind == Worse::kUnknown) found.unknown_worse.push_back(pair);
  }
}

}  // namespace

std::string worsening_text(const ComparedConflicts& found, const Conflict& a, const Conflict& b) {
  const auto change = [&](std::optional<double> before, std::optional<double> now,
                          const char* none) {
    const auto text = [&](const auto& v) { return v ? fmt::format("{:.3f}", *v) : none; };
    return text(before) + " -> " + text(now) + " " + found.a.unit;
  };
  const bool nearer = found.distances_known && b.least_distance &&
                      (!a.least_distance || *b.least_distance < *a.least_distance - found.worse_by);
  if (nearer) return change(a.least_distance, b.least_distance, "unknown");
  const auto shift = [](const Conflict& c) {
    const double least = least_own_shift(c);
    return std::isinf(least) ? std::nullopt : std::optional(least);
  };
  return "its own points need a shift of " + change(shift(a), shift(b), "more than 2");
}

namespace {

std::string line_of(const Conflict& c) {
  const std::string classes = class_words(c);
  return fmt::format("  {:>5}  {:>19}  {:>11} {:<6}  {:>7}  {:.3f} {:.3f} {:.3f}{}{}\n", c.id,
                     fmt::format("{:.2f} - {:.2f}", c.chainage_from, c.chainage_to),
                     format_count(c.points), c.points == 1 ? "point" : "points", name_of(c.side),
                     c.centroid.x, c.centroid.y, c.centroid.z, classes.empty() ? "" : "; ",
                     classes);
}

/// The chainages of a part of a conflict of one side.
std::array<double, 2> chainages_of(const ConflictPart& part, const ComparedResult& side) {
  return {side.chainage[part.first_pose], side.chainage[part.last_pose]};
}

std::string part_line(const ConflictPart& part, const ComparedResult& side) {
  const auto [from, to] = chainages_of(part, side);
  const Vec3 middle = part.box.centre();
  return fmt::format("  {:>5}  {:>19}  {:>11} {:<6}  {:.3f} {:.3f} {:.3f}\n", part.conflict,
                     fmt::format("{:.2f} - {:.2f}", from, to), format_count(part.points),
                     part.points == 1 ? "point" : "points", middle.x, middle.y, middle.z);
}

/// A title with a number, and the lines of at most `show` items.
template <typename Items, typename Line>
std::string list_text(const std::string& title, const Items& items, std::uint64_t show, Line line) {
  std::string text = title + ": " + format_count(items.size()) + "\n";
  std::uint64_t shown = 0;
  for (const auto& item : items) {
    if (shown++ == show) break;
    text += line(item);
  }
  if (items.size() > show) text += "  and " + format_count(items.size() - show) + " more\n";
  return text;
}

std::string side_text(const char* name, const ComparedResult& side) {
  const Conflicts& found = side.conflicts;
  std::string text =
      fmt::format("{}: {} of {} in {}\n", name, counted(found.listed.size(), "conflict"),
                  counted(found.colliding_points - found.small_points, "point"), side.file);
  if (found.small_groups > 0) {
    text += fmt::format("{}: {} of {} {} too small to be listed\n", name,
                        counted(found.small_groups, "group"), counted(found.small_points, "point"),
                        found.small_groups == 1 ? "is" : "are");
  }
  return text;
}

std::string text_of(const ComparedConflicts& found, std::uint64_t show) {
  const Conflicts &a = found.a.conflicts, &b = found.b.conflicts;
  std::string text = side_text("a", found.a) + side_text("b", found.b) +
                     fmt::format("both are grouped with a gap of {} {} and at least {}\n",
                                 format_brief(a.gap), found.a.unit, counted(a.min_points, "point"));
  for (const QueryDifference& query : found.questions) {
    text += "queries differ: " + query.what + ": " + query.a + " / " + query.b + "\n";
  }
  const auto of_b = [&](std::uint32_t id) { return line_of(conflict_at(b, id)); };
  text += list_text("new, only in b", found.match.added, show, of_b);
  if (!found.match.grown.empty()) {
    text += list_text("parts of other conflicts that are new", found.match.grown, show,
                      [&](const ConflictPart& part) { return part_line(part, found.b); });
  }
  if (!found.match.small.empty()) {
    text += list_text(
        "new groups that are too small to be listed", found.match.small, show, [&](std::size_t i) {
          const SmallGroup& group = b.small[i];
          return fmt::format("  {:>5}  {:>19}  {:>11} {:<6}  {:.3f} {:.3f} {:.3f}\n", "",
                             fmt::format("{:.2f} - {:.2f}", group.chainage_from, group.chainage_to),
                             format_count(group.points), group.points == 1 ? "point" : "points",
                             group.box.lo.x, group.box.lo.y, group.box.lo.z);
        });
  }
  const bool shifts_known = found.a.has_shifts && found.b.has_shifts;
  if (found.distances_known || shifts_known) {
    text += list_text("worse by more than " + format_brief(found.worse_by) + " " + found.a.unit,
                      found.worse, show, [&](const auto& pair) {
                        std::string line = of_b(pair.second);
                        line.pop_back();
                        return line + "  " +
                               worsening_text(found, conflict_at(a, pair.first),
                                              conflict_at(b, pair.second)) +
                               "\n";
                      });
  } else {
    text += "worse: not known, because the results have no clearances (run --clearance)\n";
  }
  if (!found.unknown_worse.empty() && found.distances_known) {
    text +=
        list_text(std::string("not known whether they are worse, because nothing shows how deep "
                              "they are inside the model") +
                      (shifts_known ? "" : " (--model or --vehicle finds it by shifts)"),
                  found.unknown_worse, show, [&](const auto& pair) { return of_b(pair.second); });
  }
  const auto of_a = [&](std::uint32_t id) { return line_of(conflict_at(a, id)); };
  if (!found.match.not_searched.empty()) {
    text += list_text("not searched in b, so not known", found.match.not_searched, show,
                      [&](const NotSearched& part) {
                        std::string line = part_line(part, found.a);
                        line.pop_back();
                        return line + fmt::format("  {}\n", fmt::join(part.reasons, ", "));
                      });
  }
  if (!found.match.shrunk.empty()) {
    text += list_text("in b too small to be listed", found.match.shrunk, show, of_a);
  }
  text += list_text("gone, only in a", found.match.gone, show, of_a);
  text += "the same in both: " + format_count(found.same_in_b()) + "\n";
  return text + sentence_of(found) + "\n";
}

}  // namespace

void add_conflict_comparison(CLI::App& command, ConflictComparison& options,
                             CLI::Option* conflicts) {
  const std::vector<CLI::Option*> before = command.get_options();
  const GroupScope inputs(command, OptionGroup::kInputs);
  add_file(command, "--trajectory", options.trajectory, "The trajectory of A, and of B");
  add_file(command, "--trajectory-b", options.b.trajectory,
           "The trajectory of B, where it is another");
  add_file(command, "--model", options.model,
           "The model of A, and of B: for shifts, which show how deep a surface is touched");
  add_file(command, "--model-b", options.b.model, "The model of B, where it is another");
  add_file(command, "--vehicle", options.vehicle,
           "The vehicle of several bodies of A, and of B: for sides and shifts");
  add_file(command, "--vehicle-b", options.b.vehicle, "The vehicle of B, where it is another");
  add_model_options(command, options.model_options, options.lengths);
  add_conflict_options(command, options);
  add_trajectory_options(command, options.trajectory_options, options.lengths);
  add_axis_options(command, options);
  {
    const GroupScope conflict_group(command, OptionGroup::kConflicts);
    options.lengths.add(
        command, "--worse-by", options.worse_by,
        "A conflict is worse where it comes nearer, or reaches deeper, by more than "
        "this (default: 0.02)",
        FieldRange::kFromZero);
    command.add_flag("--allow-other-question", options.allow_other_question,
                     "Compare results of different questions; they differ otherwise (exit code 1)");
  }
  add_file(command, "-o,--output", options.outputs,
           "Write the comparison to a file: .csv, .json or .html; may be repeated")
      ->expected(1)
      ->take_all();
  const GroupScope files(command, OptionGroup::kFiles);
  command.add_flag("--force", options.force, "Overwrite an existing output");
  for (CLI::Option* option : command.get_options()) {
    if (std::ranges::find(before, option) == before.end()) option->needs(conflicts);
  }
}

int compare_conflicts(ConflictComparison& options) {
  if (options.trajectory.empty()) {
    throw UsageError("--conflicts needs --trajectory, the trajectory of the runs");
  }
  for (const auto of :
       {&SearchedFiles::trajectory, &SearchedFiles::model, &SearchedFiles::vehicle}) {
    if ((options.b.*of).empty()) options.b.*of = options.*of;
  }
  NewOutputs<ComparisonFormat> outputs(options, comparison_format_of,
                                       options.b.with(options.with({})));
  ComparedSide in_a(options, options);
  // Both are grouped as a is, so that a scan of another density has the same groups.
  ComparedSide in_b(options, options.b, &in_a.conflicts);
  ComparedConflicts found;
  found.questions =
      question_differences(in_a.result.reader().header(), in_b.result.reader().header());
  found.other_question_allowed = options.allow_other_question;
  found.worse_by = options.worse_by;
  found.match =
      match_conflicts(in_a.grouped(), in_b.grouped(), in_a.conflicts.gap, options.worse_by);
  found.same_points = have_same_points(in_a.result, in_b.result);
  found.is_older = found.same_points ? false : is_older(in_b.result, in_a.result);
  found.a = in_a.compared();
  found.b = in_b.compared();
  found.distances_known = found.a.has_distances && found.b.has_distances;
  if (found.a.unit != found.b.unit) {
    throw InputError(found.b.file + ": its coordinates are in " + found.b.unit + ", expected " +
                     found.a.unit + " as in " + found.a.file);
  }
  find_worse(found);
  std::size_t written = 0;
  outputs.write([&](ComparisonFormat format, const std::filesystem::path& path) {
    write_comparison(found, format, options.outputs[written++], path);
  });
  print(options.json ? json_of(found) : text_of(found, options.show));
  return found.exit_code();
}

namespace {

using nlohmann::ordered_json;

ordered_json json_of_conflict(const Conflict& c) {
  ordered_json out{{"id", c.id},
                   {"points", c.points},
                   {"source", c.source},
                   {"lo", c.box.lo},
                   {"hi", c.box.hi},
                   {"centroid", c.centroid},
                   {"chainage_from", c.chainage_from},
                   {"chainage_to", c.chainage_to},
                   {"obstacle_chainage", or_null(c.obstacle_chainage)},
                   {"least_distance", or_null(c.least_distance)},
                   {"own_shift_left", or_null(c.own_shift_left)},
                   {"own_shift_right", or_null(c.own_shift_right)},
                   {"side", name_of(c.side)}};
  if (c.main_class) out["main_class"] = *c.main_class;
  if (c.main_class_points) out["main_class_points"] = *c.main_class_points;
  return out;
}

ordered_json json_of_list(const Conflicts& conflicts, const std::vector<std::uint32_t>& ids) {
  auto out = ordered_json::array();
  for (const std::uint32_t id : ids) out.push_back(json_of_conflict(conflict_at(conflicts, id)));
  return out;
}

ordered_json json_of_pairs(const ComparedConflicts& found,
                           const std::vector<std::pair<std::uint32_t, std::uint32_t>>& pairs) {
  auto out = ordered_json::array();
  for (const auto& [in_a, in_b] : pairs) {
    out.push_back({{"a", json_of_conflict(conflict_at(found.a.conflicts, in_a))},
                   {"b", json_of_conflict(conflict_at(found.b.conflicts, in_b))}});
  }
  return out;
}

ordered_json json_of_small(const SmallGroup& group) {
  return {{"points", group.points},
          {"source", group.source},
          {"lo", group.box.lo},
          {"hi", group.box.hi},
          {"chainage_from", group.chainage_from},
          {"chainage_to", group.chainage_to}};
}

ordered_json json_of_part(const ConflictPart& part, const ComparedResult& side) {
  const auto [from, to] = chainages_of(part, side);
  return {{"id", part.conflict}, {"points", part.points}, {"source", part.source},
          {"lo", part.box.lo},   {"hi", part.box.hi},     {"chainage_from", from},
          {"chainage_to", to}};
}

/// A row of the table that is written as CSV or HTML.
struct Row {
  std::string status;
  const Conflict* a = nullptr;
  const Conflict* b = nullptr;
  const SmallGroup* small = nullptr;  ///< a group of b that is too small to be listed
  std::string note = {};
  /// A part of the conflict of b, or without one of a
  const ConflictPart* part = nullptr;
};

std::vector<Row> rows_of(const ComparedConflicts& found) {
  std::vector<Row> rows;
  for (const QueryDifference& query : found.questions) {
    rows.push_back(
        {"question", nullptr, nullptr, nullptr, query.what + ": " + query.a + " / " + query.b});
  }
  const Conflicts &a = found.a.conflicts, &b = found.b.conflicts;
  for (const std::uint32_t id : found.match.added) {
    rows.push_back({"new", nullptr, &conflict_at(b, id)});
  }
  for (const ConflictPart& part : found.match.grown) {
    rows.push_back({"new part", nullptr, &conflict_at(b, part.conflict), nullptr, "", &part});
  }
  for (const std::size_t i : found.match.small) {
    rows.push_back({"new small group", nullptr, nullptr, &b.small[i]});
  }
  for (const auto& [in_a, in_b] : found.worse) {
    rows.push_back({"worse", &conflict_at(a, in_a), &conflict_at(b, in_b), nullptr,
                    worsening_text(found, conflict_at(a, in_a), conflict_at(b, in_b))});
  }
  for (const NotSearched& part : found.match.not_searched) {
    rows.push_back({"not searched", &conflict_at(a, part.conflict), nullptr, nullptr,
                    fmt::format("{}", fmt::join(part.reasons, ", ")), &part});
  }
  for (const std::uint32_t id : found.match.shrunk) {
    rows.push_back({"too small", &conflict_at(a, id), nullptr, nullptr,
                    "b has a group there that is too small to be listed"});
  }
  for (const std::uint32_t id : found.match.gone) rows.push_back({"gone", &conflict_at(a, id)});
  for (const auto& pair : found.match.same) {
    if (std::ranges::find(found.worse, pair) != found.worse.end()) continue;
    const bool unknown = std::ranges::find(found.unknown_worse, pair) != found.unknown_worse.end();
    rows.push_back({"same", &conflict_at(a, pair.first), &conflict_at(b, pair.second), nullptr,
                    unknown ? "it is not known whether it is worse" : ""});
  }
  return rows;
}

constexpr const char* kColumns[] = {
    "status", "id_a",     "id_b",     "chainage_from",    "chainage_to",      "obstacle_chainage",
    "side",   "points_a", "points_b", "least_distance_a", "least_distance_b", "x",
    "y",      "z",        "note"};

/// The cells of a row, one for each of kColumns. number: formats a coordinate or length.
template <typename Number>
std::vector<std::string> cells_of(const ComparedConflicts& found, const Row& row, Number number) {
  const Conflict* const shown = row.b != nullptr ? row.b : row.a;
  const auto of = [](const Conflict* c, auto value) {
    return c != nullptr ? std::to_string(value(*c)) : std::string();
  };
  const auto id = [](const Conflict& c) { return c.id; };
  const auto points = [](const Conflict& c) { return c.points; };
  const auto distance = [&](const Conflict* c) {
    return c != nullptr && c->least_distance ? number(*c->least_distance) : std::string();
  };
  std::vector<std::string> cells{row.status, of(row.a, id), of(row.b, id)};
  if (row.part != nullptr) {
    const ConflictPart& part = *row.part;
    const auto [from, to] = chainages_of(part, row.b != nullptr ? found.b : found.a);
    const Vec3 middle = part.box.centre();
    const std::string size = std::to_string(part.points);
    cells.insert(cells.end(), {number(from), number(to), "", name_of(shown->side),
                               row.b == nullptr ? size : "", row.b != nullptr ? size : "", "", "",
                               number(middle.x), number(middle.y), number(middle.z)});
  } else if (shown != nullptr) {
    cells.insert(cells.end(),
                 {number(shown->chainage_from), number(shown->chainage_to),
                  shown->obstacle_chainage ? number(*shown->obstacle_chainage) : std::string(),
                  name_of(shown->side), of(row.a, points), of(row.b, points), distance(row.a),
                  distance(row.b), number(shown->centroid.x), number(shown->centroid.y),
                  number(shown->centroid.z)});
  } else if (row.small != nullptr) {
    const SmallGroup& small = *row.small;
    cells.insert(cells.end(), {number(small.chainage_from), number(small.chainage_to), "", "", "",
                               std::to_string(small.points), "", ""});
    for (int k = 0; k < 3; ++k) {
      cells.push_back(number((small.box.lo[k] + small.box.hi[k]) / 2));
    }
  } else {
    cells.resize(std::size(kColumns) - 1);
  }
  cells.push_back(row.note);
  return cells;
}

std::string csv_of(const ComparedConflicts& found) {
  std::string out;
  for (const char* column : kColumns) out += (out.empty() ? "" : ",") + std::string(column);
  out += "\n";
  for (const Row& row : rows_of(found)) {
    std::string line;
    for (const std::string& cell :
         cells_of(found, row, [](double v) { return format_number(v); })) {
      line += csv_cell(cell) + ",";
    }
    line.back() = '\n';
    out += line;
  }
  return out;
}

}  // namespace

namespace {

/// A clause for a result that could not find anything; empty for others.
std::string undecided_text(const ComparedResult& side, const char* name) {
  if (!side.undecided()) return "";
  if (side.verdict != Verdict::kUndecided) {
    return fmt::format("; {} is not known as a whole, because its run warned of {}", name,
                       fmt::join(side.doubts, ", "));
  }
  if (side.doubts.empty()) {
    return fmt::format("; {} is undecided ({})", name, fmt::join(side.reasons, ", "));
  }
  return fmt::format("; {} is undecided, because {}", name, doubt_words(side.doubts));
}

/// A clause about which scan is the later one; empty where the dates of the files say that it is b.
std::string order_text(const ComparedConflicts& found) {
  if (found.is_same_scan()) return "; both results are about the same scan, so nothing is compared";
  if (!found.is_older) {
    return "; the dates of the files do not show that b is the later scan, so it is taken as given";
  }
  if (!*found.is_older) return "";
  return "; by the dates of the files b is older than a: are they the wrong way round?";
}

/// A clause about the conflicts that are gone; empty where none is, and where both scans are the
/// same.
std::string gone_text(const ComparedConflicts& found) {
  const std::size_t gone = found.match.gone.size();
  if (gone == 0 || found.same_points) return "";
  return "; " + counted(gone, "conflict") + (gone == 1 ? " is" : " are") +
         " gone if b was scanned there, where gaps are known only by its warnings";
}

}  // namespace

std::size_t ComparedConflicts::same_in_b() const {
  std::vector<std::uint32_t> ids;
  for (const auto& pair : match.same) ids.push_back(pair.second);
  std::ranges::sort(ids);
  return static_cast<std::size_t>(std::unique(ids.begin(), ids.end()) - ids.begin());
}

std::string sentence_of(const ComparedConflicts& found) {
  std::string out;
  const auto add = [&out](std::size_t count, const char* one, const char* many) {
    if (count == 0) return;
    out += (out.empty() ? "" : ", ") + format_count(count) + " " + (count == 1 ? one : many);
  };
  add(found.match.added.size(), "new conflict", "new conflicts");
  std::set<std::uint32_t> worse;  // a conflict of b may be worse than several of a
  for (const auto& pair : found.worse) worse.insert(pair.second);
  add(worse.size(), "conflict is worse", "conflicts are worse");
  add(found.match.grown.size(), "part of another conflict is new",
      "parts of other conflicts are new");
  add(found.match.small.size(), "new group is too small to be listed",
      "new groups are too small to be listed");
  if (out.empty()) out = "no new conflicts";
  if (const std::size_t unknown = found.unknown_worse.size(); unknown > 0) {
    out += ", and " + counted(unknown, "conflict") + " of which it is not known whether " +
           (unknown == 1 ? "it is worse" : "they are worse");
  }
  if (const std::size_t open = found.match.not_searched.size(); open > 0) {
    out += "; b has not searched " + counted(open, "place", "places") + " where a has a conflict";
  }
  out += gone_text(found) + undecided_text(found.b, "b") + undecided_text(found.a, "a") +
         order_text(found);
  if (found.questions.empty()) return out;
  return out + (out.find(';') == std::string::npos ? ", but" : ";") +
         " b answers another question than a" +
         (found.other_question_allowed ? ", which was allowed"
                                       : "; --allow-other-question compares them nevertheless");
}

std::string json_of(const ComparedConflicts& found) {
  const auto side = [](const ComparedResult& of) {
    return ordered_json{{"file", of.file},
                        {"unit", of.unit},
                        {"radius", of.radius},
                        {"verdict", name_of(of.verdict)},
                        {"doubts", of.doubts},
                        {"conflicts", of.conflicts.listed.size()},
                        {"colliding_points", of.conflicts.colliding_points},
                        {"small_groups", of.conflicts.small_groups},
                        {"small_points", of.conflicts.small_points}};
  };
  auto questions = ordered_json::array();
  for (const QueryDifference& query : found.questions) {
    questions.push_back({{"what", query.what}, {"a", query.a}, {"b", query.b}});
  }
  auto small = ordered_json::array();
  for (const std::size_t i : found.match.small) {
    small.push_back(json_of_small(found.b.conflicts.small[i]));
  }
  auto grown = ordered_json::array();
  for (const ConflictPart& part : found.match.grown) grown.push_back(json_of_part(part, found.b));
  auto not_searched = ordered_json::array();
  for (const NotSearched& part : found.match.not_searched) {
    not_searched.push_back(json_of_part(part, found.a));
    not_searched.back()["reasons"] = part.reasons;
  }
  const ordered_json out{{"a", side(found.a)},
                         {"b", side(found.b)},
                         {"holds", found.holds()},
                         {"same_scan", found.is_same_scan()},
                         {"older", or_null(found.is_older)},
                         {"questions", questions},
                         {"new", json_of_list(found.b.conflicts, found.match.added)},
                         {"new_parts", grown},
                         {"new_small", small},
                         {"worse", json_of_pairs(found, found.worse)},
                         {"unknown_worse", json_of_pairs(found, found.unknown_worse)},
                         {"worse_by", found.worse_by},
                         {"gap", found.a.conflicts.gap},
                         {"min_points", found.a.conflicts.min_points},
                         {"distances_known", found.distances_known},
                         {"not_searched", not_searched},
                         {"too_small", json_of_list(found.a.conflicts, found.match.shrunk)},
                         {"gone", json_of_list(found.a.conflicts, found.match.gone)},
                         {"same", json_of_pairs(found, found.match.same)}};
  // File names need not be UTF-8.
  return indented_text(out, -1);
}

ComparisonFormat comparison_format_of(const std::filesystem::path& output) {
  const std::string ending = file_ending(output);
  if (ending == ".csv") return ComparisonFormat::kCsv;
  if (ending == ".json") return ComparisonFormat::kJson;
  if (ending == ".html") return ComparisonFormat::kHtml;
  throw UsageError(output.string() +
                   ": unknown output format; the name must end in .csv, .json or .html");
}

void write_comparison(const ComparedConflicts& found, ComparisonFormat format,
                      const std::filesystem::path& output, const std::filesystem::path& path) {
  const File file = File::create(path);
  TextWriter out(file);
  out << (format == ComparisonFormat::kCsv    ? csv_of(found)
          : format == ComparisonFormat::kJson ? json_of(found)
                                              : html_of(found, output));
  out.flush();
}

}  // namespace clearway::tool
