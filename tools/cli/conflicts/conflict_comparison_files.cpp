#include "cli/conflicts/conflict_comparison_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "clearway/error.hpp"
#include "core/util/format.hpp"
#include "io/conflicts/markup_text.hpp"
#include "io/formats/text/csv_cell.hpp"
#include "io/formats/text/text_writer.hpp"
#include "io/system/file.hpp"
#include "io/system/file_ending.hpp"

namespace clearway::tool {
namespace {

using nlohmann::ordered_json;

ordered_json json_of_conflict(const Conflict& c) {
  ordered_json out{{"id", c.id},
                   {"points", c.points},
                   {"source", c.source},
                   {"lo", {c.box.lo.x, c.box.lo.y, c.box.lo.z}},
                   {"hi", {c.box.hi.x, c.box.hi.y, c.box.hi.z}},
                   {"centroid", {c.centroid.x, c.centroid.y, c.centroid.z}},
                   {"chainage_from", c.chainage_from},
                   {"chainage_to", c.chainage_to},
                   {"obstacle_chainage", nullptr},
                   {"least_distance", nullptr},
                   {"side", name_of(c.side)}};
  if (c.obstacle_chainage) out["obstacle_chainage"] = *c.obstacle_chainage;
  if (c.least_distance) out["least_distance"] = *c.least_distance;
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
          {"lo", {group.box.lo.x, group.box.lo.y, group.box.lo.z}},
          {"hi", {group.box.hi.x, group.box.hi.y, group.box.hi.z}},
          {"chainage_from", group.chainage_from},
          {"chainage_to", group.chainage_to}};
}

/// A row of the table that is written as CSV or HTML.
struct Row {
  std::string status;
  const Conflict* a = nullptr;
  const Conflict* b = nullptr;
  const SmallGroup* small = nullptr;  ///< a group of b that is too small to be listed
  std::string note = {};
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
  for (const std::size_t i : found.new_small) {
    rows.push_back({"new small group", nullptr, nullptr, &b.small[i]});
  }
  for (const auto& [in_a, in_b] : found.worse) {
    rows.push_back({"worse", &conflict_at(a, in_a), &conflict_at(b, in_b)});
  }
  for (const std::uint32_t id : found.match.gone) rows.push_back({"gone", &conflict_at(a, id)});
  for (const auto& pair : found.match.same) {
    if (std::ranges::find(found.worse, pair) != found.worse.end()) continue;
    rows.push_back({"same", &conflict_at(a, pair.first), &conflict_at(b, pair.second)});
  }
  return rows;
}

constexpr const char* kColumns[] = {
    "status", "id_a",     "id_b",     "chainage_from",    "chainage_to",      "obstacle_chainage",
    "side",   "points_a", "points_b", "least_distance_a", "least_distance_b", "x",
    "y",      "z",        "note"};

/// The texts of a row, one for each of kColumns. number: makes the text of a coordinate or length.
template <typename Number>
std::vector<std::string> cells_of(const Row& row, Number number) {
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
  if (shown != nullptr) {
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
    for (const std::string& cell : cells_of(row, [](double v) { return format_number(v); })) {
      line += csv_cell(cell) + ",";
    }
    line.back() = '\n';
    out += line;
  }
  return out;
}

std::string html_of(const ComparedConflicts& found) {
  std::string out =
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<title>Conflicts compared</title>\n<style>\nbody { font: 15px/1.5 sans-serif; margin: 2em; "
      "}\ntable { border-collapse: collapse; }\nth, td { padding: 0.2em 0.7em; border-bottom: 1px "
      "solid #ccc; text-align: right; }\nth:first-child, td:first-child, td:last-child { "
      "text-align: left; }\ntr.new, tr.worse, tr.question { font-weight: bold; }\n</style>\n"
      "</head>\n<body>\n<h1>Conflicts compared</h1>\n";
  out += "<p>a: " + markup_text(found.a.file) + "<br>b: " + markup_text(found.b.file) +
         "</p>\n<p><strong>" + markup_text(sentence_of(found)) +
         "</strong></p>\n<p>Lengths are in " + found.a.unit + ".</p>\n<table>\n<tr>";
  for (const char* column : kColumns) {
    std::string title = column;
    std::ranges::replace(title, '_', ' ');
    out += "<th scope=\"col\">" + title + "</th>";
  }
  out += "</tr>\n";
  const auto number = [](double v) { return fmt::format("{:.3f}", v); };
  for (const Row& row : rows_of(found)) {
    out += "<tr class=\"" + row.status.substr(0, row.status.find(' ')) + "\">";
    for (const std::string& cell : cells_of(row, number))
      out += "<td>" + markup_text(cell) + "</td>";
    out += "</tr>\n";
  }
  return out + "</table>\n</body>\n</html>\n";
}

}  // namespace

std::string sentence_of(const ComparedConflicts& found) {
  std::string out;
  const auto add = [&out](std::size_t count, const char* one, const char* many) {
    if (count == 0) return;
    out += (out.empty() ? "" : ", ") + format_count(count) + " " + (count == 1 ? one : many);
  };
  add(found.match.added.size(), "new conflict", "new conflicts");
  add(found.worse.size(), "conflict is worse", "conflicts are worse");
  add(found.new_small.size(), "new group is too small to be listed",
      "new groups are too small to be listed");
  if (out.empty()) out = "no new conflicts";
  if (found.questions.empty()) return out;
  return out + ", but b answers another question than a" +
         (found.other_question_allowed ? ", which was allowed"
                                       : "; --allow-other-question compares them nevertheless");
}

std::string json_of(const ComparedConflicts& found) {
  const auto side = [](const ComparedResult& of) {
    return ordered_json{{"file", of.file},
                        {"unit", of.unit},
                        {"radius", of.radius},
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
  for (const std::size_t i : found.new_small) {
    small.push_back(json_of_small(found.b.conflicts.small[i]));
  }
  const ordered_json out{{"a", side(found.a)},
                         {"b", side(found.b)},
                         {"holds", found.holds()},
                         {"questions", questions},
                         {"new", json_of_list(found.b.conflicts, found.match.added)},
                         {"new_small", small},
                         {"worse", json_of_pairs(found, found.worse)},
                         {"worse_by", found.worse_by},
                         {"distances_known", found.distances_known},
                         {"gone", json_of_list(found.a.conflicts, found.match.gone)},
                         {"same", json_of_pairs(found, found.match.same)}};
  // File names need not be UTF-8.
  return out.dump(-1, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

void check_comparison_ending(const std::filesystem::path& output) {
  const std::string ending = file_ending(output);
  if (ending == ".csv" || ending == ".json" || ending == ".html") return;
  throw UsageError(output.string() +
                   ": unknown output format; the name must end in .csv, .json or .html");
}

void write_comparison(const ComparedConflicts& found, const std::filesystem::path& output,
                      const std::filesystem::path& path) {
  const std::string ending = file_ending(output);
  const File file = File::create(path);
  TextWriter out(file);
  out << (ending == ".csv" ? csv_of(found) : ending == ".json" ? json_of(found) : html_of(found));
  out.flush();
}

}  // namespace clearway::tool
