#include "campaign/page/campaign_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <string_view>
#include <utility>

#include "campaign/embedded.hpp"
#include "campaign/outcome.hpp"
#include "core/util/format.hpp"
#include "io/result/conflicts/conflict_words.hpp"
#include "io/result/conflicts/markup_text.hpp"
#include "io/scans/length_unit.hpp"

namespace clearway::campaign {
namespace {

using Runs = std::vector<TaskStatus>;

/// A path as the text of a link, in which every byte that is not plain becomes %XX.
std::string link_text(const std::string& path) {
  constexpr std::string_view kPlain =
      "/-._~0123456789abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ";
  std::string link;
  for (const char c : path) {
    link += kPlain.find(c) != std::string_view::npos
                ? std::string(1, c)
                : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return link;
}

/// The link of a run, relative to the campaign's folder: for a failed one its log; for a finished
/// one its report or, where there is none, its run.json; otherwise empty.
std::string link_of(const TaskStatus& run) {
  const std::string folder = run.task->folder().string() + "/";
  if (run.status == Status::kFailed) {
    const std::string of = run.shard > 0 ? "shards/" + std::to_string(run.shard) + "/" : "";
    return link_text(folder + of + "log.txt");
  }
  if (run.status != Status::kDone) return "";
  const std::vector<std::string>& outputs = run.task->outputs;
  const bool report = std::ranges::find(outputs, kReportName) != outputs.end();
  return link_text(folder + (report ? kReportName : "run.json"));
}

/// A length as it was written, with a blank before its unit: "50 cm" for "50cm".
std::string spaced_length(std::string length) {
  const std::size_t unit = length.find_first_not_of("0123456789.+-eE");
  if (unit != std::string::npos && unit > 0 && length[unit] != ' ') length.insert(unit, 1, ' ');
  return length;
}

constexpr std::string_view kTouches = "touches";

/// A least distance to 0.1 mm, for example "0.032 m"; below 1 mm the surfaces meet, as far as a
/// scan can show. A distance below 0 is a depth inside a solid.
std::string distance_words(double distance, const std::string& unit) {
  if (std::abs(distance) < kTouching) return std::string(kTouches);
  const std::string length = format_number(std::round(std::abs(distance) * 1e4) / 1e4) + " " + unit;
  return distance >= 0 ? length : length + " deep inside";
}

bool is_doubtful(const TaskStatus& run) {
  return outcome_of(run) == Outcome::kUndecided && is_in_doubt(run.facts());
}

/// The least distance of a run, for example "0.032 m, left"; where it is not known, a bound such as
/// "< 0.1 m". Empty where nothing is known, because the run is not done or its search could not
/// have found anything.
std::string least_words(const TaskStatus& run) {
  if (run.status != Status::kDone || is_doubtful(run)) return "";
  const Task& task = *run.task;
  const Json& facts = run.facts();
  if (const Json& least = facts["least"]; !least.is_null()) {
    const auto distance = least["distance"].get<double>();
    const Json side = facts.value("least_side", Json());
    // A point inside the vehicle has no side of it.
    return distance_words(distance, task.unit) +
           (distance >= 0 && side.is_string() ? ", " + side.get<std::string>() : "");
  }
  const auto asked = [&](const char* name) { return task.question[name].get<double>(); };
  const bool is_conflict = outcome_of(run) == Outcome::kConflict;
  const double bound = is_conflict
                           ? asked("radius")
                           : std::max({asked("radius"), asked("clearance"), asked("profile")});
  return (is_conflict ? "< " : "≥ ") + format_length(bound) + " " + task.unit;
}

std::string count_words(std::uint64_t count, const std::string& words) {
  return count == 0 ? "" : format_count(count) + words;
}

/// How many conflicts a run lists, and the chainage of its least distance or, without distances, of
/// its first place, such as "3 conflicts, at 31.02 m". Empty where nothing is known.
std::string place_words(const TaskStatus& run) {
  if (run.status != Status::kDone) return "";
  const Json& facts = run.facts();
  std::string conflicts, accepted, place;
  if (facts.contains("conflicts")) {
    const auto count = facts["conflicts"]["count"].get<std::uint64_t>();
    conflicts = count == 0 ? "" : counted(count, "conflict");
  }
  if (facts.contains("ledger")) {
    accepted = count_words(facts["ledger"]["accepted_conflicts"], " accepted");
  }
  const Json& at = facts["least"].is_null() ? facts["first"] : facts["least"];
  if (!at.is_null() && !is_doubtful(run)) {
    const double chainage = std::round(at["chainage"].get<double>() * 100) / 100;
    place = "at " + format_number(chainage) + " " + run.task->unit;
  }
  return joined({conflicts, accepted, place}, ", ");
}

/// What is known of a run, as a line of text.
std::string details_of(const TaskStatus& run) {
  if (run.status == Status::kFailed) {
    return fmt::format("{}exit code {}: {}",
                       run.shard > 0 ? "shard " + std::to_string(run.shard) + ": " : "",
                       run.state->exit_code, run.state->message);
  }
  if (run.status == Status::kOutdated) return std::string("outdated: ") + run.changed;
  if (run.status != Status::kDone) return name_of(run.status);
  const std::string least = least_words(run);
  const bool is_distance = !least.empty() && !least.starts_with(kTouches);
  const auto points = run.facts()["colliding_points"].get<std::uint64_t>();
  return joined(
      {joined({words_of(outcome_of(run)).word, (is_distance ? "least distance " : "") + least,
               place_words(run), points > 0 ? counted(points, "colliding point") : ""},
              ", "),
       caveats_of(run.facts(), run.task->unit)},
      "; ");
}

/// The caveats of a run as numbers only, because the sections below the tables have the words.
std::string short_caveats(const TaskStatus& run) {
  if (run.status != Status::kDone) return "";
  const Json& facts = run.facts();
  const std::size_t warnings = facts["warnings"].size();
  return joined(
      {warnings > 0 ? counted(warnings, "warning") : "", floor_clause(facts, run.task->unit),
       ignored_words(facts, false), open_words(facts, run.task->unit)},
      ", ");
}

/// The names that the runs have, each once, in the order of the first runs.
std::vector<std::string> names_in(const Runs& runs, std::string Task::*name) {
  std::vector<std::string> names;
  for (const TaskStatus& run : runs) {
    if (std::ranges::find(names, run.task->*name) == names.end()) {
      names.push_back(run.task->*name);
    }
  }
  return names;
}

std::string in_element(const char* element, const std::string& text) {
  return text.empty() ? "" : fmt::format("<{0}>{1}</{0}>", element, text);
}

/// A cell of the table of a radius.
std::string cell_of(const TaskStatus& run) {
  const OutcomeWords& words = words_of(outcome_of(run));
  const std::string link = link_of(run), least = least_words(run);
  const std::string word = run.status == Status::kFailed
                               ? fmt::format("failed ({})", run.state->exit_code)
                           : run.status == Status::kDone ? words.word
                                                         : name_of(run.status);
  return fmt::format(
      "<td class=\"{}\" title=\"{}\">{}<span class=\"sign\" aria-hidden=\"true\">{}</span> "
      "<span class=\"word\">{}</span>{}{}{}{}{}</td>",
      words.name,
      markup_text(run.task->vehicle + " on " + run.task->route + ": " + details_of(run)),
      link.empty() ? "" : "<a href=\"" + link + "\">", words.sign, word,
      least.empty() ? "" : "<br>", in_element("b", least), in_element("small", place_words(run)),
      in_element("small", short_caveats(run)), link.empty() ? "" : "</a>");
}

/// The unit after a radius. A radius that is a plain number is in the unit of the environments.
std::string unit_of(const std::string& radius, const Runs& runs) {
  const std::vector<std::string> units = names_in(runs, &Task::unit);
  const bool is_plain = radius.find_first_not_of("0123456789.") == std::string::npos;
  return is_plain && units.size() == 1 ? " " + units[0] : "";
}

/// The table of vehicles and routes for a radius.
std::string table_of(const std::string& radius, const Runs& runs) {
  constexpr std::size_t kFewRoutes = 10;
  const std::string title = "Radius " + markup_text(spaced_length(radius)) + unit_of(radius, runs);
  std::map<std::string, std::string> environments;
  std::map<std::pair<std::string, std::string>, const TaskStatus*> run_at;
  for (const TaskStatus& run : runs) {
    environments[run.task->route] = run.task->environment;
    if (run.task->radius == radius) run_at[{run.task->vehicle, run.task->route}] = &run;
  }
  const std::vector<std::string> routes = names_in(runs, &Task::route);
  std::string head, rows;
  for (const std::string& route : routes) {
    head += fmt::format("<th scope=\"col\">{}<small>{}</small></th>", markup_text(route),
                        markup_text(environments[route]));
  }
  for (const std::string& vehicle : names_in(runs, &Task::vehicle)) {
    rows += "<tr><th scope=\"row\">" + markup_text(vehicle) + "</th>";
    for (const std::string& route : routes) rows += cell_of(*run_at.at({vehicle, route}));
    rows += "</tr>\n";
  }
  return fmt::format(
      "<section>\n<h2>{0}</h2>\n<div class=\"scroll\" role=\"region\" tabindex=\"0\" "
      "aria-label=\"{0}\">\n<table class=\"matrix{1}\">\n<thead><tr><th scope=\"col\">vehicle</th>"
      "{2}</tr></thead>\n<tbody>\n{3}</tbody>\n</table>\n</div>\n</section>\n",
      title, routes.size() > kFewRoutes ? " many" : "", head, rows);
}

/// One sentence that counts every run once, and one about runs that left points out of the search.
std::string answer_of(const Runs& runs) {
  std::vector<std::string> parts;
  for (const OutcomeWords& of : kOutcomes) {
    const std::size_t count = count_of(runs, of.outcome);
    if (count > 0) parts.push_back(format_count(count) + " " + (count == 1 ? of.one : of.several));
  }
  const auto ignoring = static_cast<std::size_t>(std::ranges::count_if(
      runs, [](const TaskStatus& run) { return !ignored_words(run.facts()).empty(); }));
  return "Of " + counted(runs.size(), "run") + " " + format_list(parts) + "." +
         (ignoring == 0
              ? ""
              : " In " + counted(ignoring, "run") + " points were left out of the search.");
}

std::string summary_of(const Runs& runs) {
  std::string counts, meanings;
  for (const OutcomeWords& of : kOutcomes) {
    const std::size_t count = count_of(runs, of.outcome);
    if (count == 0) continue;
    counts += fmt::format(
        "<li class=\"{}\"><span class=\"sign\" aria-hidden=\"true\">{}</span> <b>{}</b> {}</li>\n",
        of.name, of.sign, format_count(count), of.word);
    meanings += in_element("li", of.meaning) + "\n";
  }
  return fmt::format(
      "<section aria-label=\"Summary\">\n<p class=\"answer\">{}</p>\n<ul class=\"legend\">\n{}"
      "</ul>\n<details class=\"note\"><summary>What the cells say</summary>\n<ul>\n{}<li>the "
      "verdict, the least distance that is known, how many conflicts are listed, the side and the "
      "chainage of the least distance or of the first place; a link to the report of the run</li>\n"
      "</ul>\n</details>\n</section>\n",
      answer_of(runs), counts, meanings);
}

/// The cells of a row, as HTML.
using Row = std::vector<std::string>;

/// A section with a list; empty where it has no rows.
std::string list_of(const char* title, const Row& columns, const std::vector<Row>& rows) {
  if (rows.empty()) return "";
  std::string head, body;
  for (const std::string& column : columns) head += "<th scope=\"col\">" + column + "</th>";
  for (const Row& row : rows) {
    body += "<tr>";
    for (const std::string& cell : row) body += "<td>" + cell + "</td>";
    body += "</tr>\n";
  }
  return fmt::format(
      "<section>\n<h2>{}</h2>\n<div class=\"scroll\">\n<table class=\"list\">\n<thead><tr>{}</tr>"
      "</thead>\n<tbody>\n{}</tbody>\n</table>\n</div>\n</section>\n",
      title, head, body);
}

using RunList = std::vector<const TaskStatus*>;

/// Names of runs with links, such as "truck/north/0.1, ..."; only the first ones of many.
std::string links_to(const RunList& runs) {
  constexpr std::size_t kMost = 12;
  std::string text;
  for (std::size_t i = 0; i < runs.size() && i < kMost; ++i) {
    text += fmt::format("{}<a href=\"{}\">{}</a>", i == 0 ? "" : ", ", link_of(*runs[i]),
                        markup_text(runs[i]->task->name()));
  }
  if (runs.size() > kMost) text += " and " + format_count(runs.size() - kMost) + " more";
  return text;
}

/// Lists each kind of warning once, with the text of the first run that has it.
std::string warnings_of(const Runs& runs) {
  std::map<std::string, std::pair<std::string, RunList>> found;
  for (const TaskStatus& run : runs) {
    if (run.status != Status::kDone) continue;
    const Json& codes = run.facts()["warnings"];
    const Json& texts = run.facts()["warning_texts"];
    for (std::size_t i = 0; i < codes.size(); ++i) {
      auto& [text, with] = found[codes[i].get<std::string>()];
      if (with.empty()) text = texts[i].get<std::string>();
      if (with.empty() || with.back() != &run) with.push_back(&run);
    }
  }
  std::vector<Row> rows;
  for (const auto& [code, of] : found) {
    const auto& [text, with] = of;
    rows.push_back(
        {format_count(with.size()), markup_text(code), markup_text(text), links_to(with)});
  }
  return list_of("Warnings", {"runs", "warning", "what the first of them says", "in"}, rows);
}

std::string ignored_of(const Runs& runs) {
  std::map<std::string, RunList> found;
  for (const TaskStatus& run : runs) {
    const std::string words = ignored_words(run.facts());
    if (!words.empty()) found[words].push_back(&run);
  }
  std::vector<Row> rows;
  for (const auto& [words, with] : found) {
    rows.push_back({format_count(with.size()), words, links_to(with)});
  }
  return list_of("Left out of the search", {"runs", "points", "in"}, rows);
}

std::string failures_of(const Runs& runs) {
  std::vector<Row> rows;
  for (const TaskStatus& run : runs) {
    if (run.status != Status::kFailed) continue;
    rows.push_back(
        {std::to_string(run.task->number), links_to({&run}), markup_text(details_of(run))});
  }
  return list_of("Failed", {"task", "run", "what happened"}, rows);
}

std::string unfinished_of(const Runs& runs) {
  TaskList tasks;
  std::string changes;
  for (const TaskStatus& run : runs) {
    if (outcome_of(run) != Outcome::kUnfinished) continue;
    tasks.push_back(run.task->number);
    if (run.changed.empty()) continue;
    changes += in_element("li", markup_text(run.task->name() + ": " + run.changed) +
                                    ", so its verdict would be of an earlier file") +
               "\n";
  }
  if (tasks.empty()) return "";
  return fmt::format(
      "<section>\n<h2>Not done</h2>\n<p>Tasks {}. <code>clearway campaign run DIR --all</code> "
      "goes on with them.</p>\n{}</section>\n",
      task_list_text(tasks), changes.empty() ? "" : "<ul>\n" + changes + "</ul>\n");
}

/// The facts of a page as JSON in which nothing can end the HTML element around it.
std::string facts_text(const Json& facts) {
  std::string text;
  for (const char c : facts.dump(-1, ' ', false, Json::error_handler_t::replace)) {
    text += c == '<' ? std::string("\\u003c") : std::string(1, c);
  }
  return text;
}

}  // namespace

Json page_facts(const Plan& plan, const std::vector<TaskStatus>& runs, const std::string& date) {
  Json out{{"campaign", plan.name}, {"date", date}, {"tasks", runs.size()}};
  out.update(counts_json(runs));
  out["runs"] = Json::array();
  for (const TaskStatus& of : runs) {
    const Task& task = *of.task;
    Json run{{"task", task.number},          {"vehicle", task.vehicle},
             {"route", task.route},          {"environment", task.environment},
             {"radius", task.radius},        {"unit", task.unit},
             {"status", name_of(of.status)}, {"outcome", words_of(outcome_of(of)).name},
             {"page", link_of(of)}};
    if (of.status == Status::kDone) run.update(of.facts());
    if (!of.changed.empty()) run["changed"] = of.changed;
    if (of.status == Status::kFailed) {
      run["exit_code"] = of.state->exit_code;
      run["message"] = of.state->message;
    }
    out["runs"].push_back(std::move(run));
  }
  return out;
}

std::string page_text(const Json& facts, const std::vector<TaskStatus>& runs) {
  std::string tables;
  for (const std::string& radius : names_in(runs, &Task::radius)) tables += table_of(radius, runs);
  return fmt::format(
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; "
      "style-src 'unsafe-inline'\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<title>{0}</title>\n<style>\n{1}</style>\n</head>\n<body>\n<header><h1>{0}</h1>"
      "<p>Clearway, {2}</p></header>\n<main>\n{3}{4}{5}{6}{7}{8}</main>\n"
      "<script type=\"application/json\" id=\"facts\">{9}</script>\n</body>\n</html>\n",
      markup_text(facts["campaign"].get<std::string>()), kPageStyle,
      markup_text(facts["date"].get<std::string>()), summary_of(runs), tables, warnings_of(runs),
      ignored_of(runs), failures_of(runs), unfinished_of(runs), facts_text(facts));
}

}  // namespace clearway::campaign
