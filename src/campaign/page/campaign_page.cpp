#include "campaign/page/campaign_page.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <map>
#include <string>
#include <utility>

#include "campaign/plan.hpp"
#include "campaign/task_state.hpp"
#include "core/util/format.hpp"
#include "io/result/conflicts/conflict_words.hpp"
#include "io/result/conflicts/markup_text.hpp"
#include "io/scans/length_unit.hpp"

namespace clearway::campaign {
namespace {

/// The style sheet of a campaign's page.
extern const char* const kCampaignStyle;

const char* const kCampaignStyle = R"css(:root {
  --ink: #111827; --soft: #4b5563; --line: #d1d5db; --focus: #1d4ed8;
  font: 15px/1.45 system-ui, "Segoe UI", "DejaVu Sans", Arial, sans-serif; color: var(--ink);
}
* { box-sizing: border-box; }
body { margin: 0; background: #eef0f3; }
header { display: flex; align-items: baseline; gap: 0.3rem 1.4rem; flex-wrap: wrap;
  padding: 0.5rem 1.2rem; background: var(--ink); color: #fff; }
header h1 { font-size: 1.15rem; margin: 0; overflow-wrap: anywhere; }
header p { margin: 0; color: #cbd5e1; font-size: 0.9rem; }
main { padding: 0.8rem 1.2rem; display: grid; gap: 0.8rem; }
section { background: #fff; border: 1px solid var(--line); border-radius: 8px;
  padding: 0.8rem 1.1rem; min-width: 0; }
h2 { font-size: 1.15rem; margin: 0 0 0.5rem; }
:focus-visible { outline: 3px solid var(--focus); outline-offset: 2px; }
.answer { font-size: 1.5rem; font-weight: 600; margin: 0 0 0.6rem; line-height: 1.25; }
.legend { list-style: none; display: flex; flex-wrap: wrap; gap: 0.3rem 0.5rem; margin: 0; padding: 0; }
.legend li { padding: 0.1rem 0.6rem; border-radius: 5px; font-size: 0.88rem; }
details.note summary { cursor: pointer; }
details.note ul { margin: 0.2rem 0 0; padding-left: 1.2rem; }
.sign { display: inline-block; width: 1.1em; text-align: center; font-weight: 700; }
.conflict { --back: #fbdccf; --front: #8a2404; --edge: #b4330a; }
.clear_with_warnings { --back: #fff3cd; --front: #6b4700; --edge: #a16207; }
.undecided { --back: #e9e3f8; --front: #4a2a8a; --edge: #7c5cc4; }
.clear { --back: #e3f4ef; --front: #005645; --edge: #9fd3c4; }
.failed { --back: #3f4652; --front: #fff; --edge: #111827; }
.not_done { --back: #fff; --front: #4b5563; --edge: #9ca3af; }
.legend li, .matrix td { background: var(--back); color: var(--front);
  border: 1.5px solid var(--edge); }
.legend .not_done, .matrix .not_done { border-style: dashed; }
.note { margin: 0.5rem 0 0; color: var(--soft); font-size: 0.9rem; }
.scroll { overflow: auto; max-height: 85vh; }
table { border-collapse: separate; border-spacing: 3px; font-variant-numeric: tabular-nums; }
.matrix th { background: #fff; text-align: left; padding: 0.25rem 0.6rem; font-weight: 600;
  min-width: 6rem; max-width: 16rem; overflow-wrap: break-word; hyphens: auto; }
.matrix thead th { position: sticky; top: 0; z-index: 2; vertical-align: bottom; }
.matrix th:first-child { position: sticky; left: 0; z-index: 1; }
.matrix thead th:first-child { z-index: 3; }
.matrix small { display: block; font-weight: 400; color: var(--soft); }
.matrix td { border-radius: 5px; min-width: 6.6rem; padding: 0; line-height: 1.25; }
.matrix td > a, .matrix td:not(:has(a)) { padding: 0.3rem 0.5rem; }
.matrix td > a { display: block; color: inherit; text-decoration: none; }
.matrix td > a:hover .word, .matrix td > a:focus .word { text-decoration: underline; }
.matrix td small { padding-left: 1.7em; color: inherit; min-width: 9rem; }
.matrix td b { font-weight: 600; padding-left: 1.4em; white-space: nowrap; }
.list { border-spacing: 0; width: 100%; }
.list th { text-align: left; background: #e5e9ef; padding: 0.2rem 0.5rem; }
.list td { padding: 0.2rem 0.5rem; border-top: 1px solid #e5e7eb; vertical-align: top;
  overflow-wrap: break-word; }
.list td:first-child { width: 4rem; }
.list td:nth-child(2) { width: 22%; }
.list a { color: var(--focus); }
@media (max-width: 600px) {
  main { padding: 0.5rem; }
  section { padding: 0.6rem 0.7rem; }
  .answer { font-size: 1.2rem; }
  .matrix th:first-child { max-width: 7.5rem; font-size: 0.88rem; padding: 0.25rem 0.3rem; }
  .matrix td small { min-width: 0; padding-left: 0; }
  .list thead { display: none; }
  .list tr { display: block; border-top: 2px solid var(--line); padding: 0.3rem 0; }
  .list td, .list td:first-child, .list td:nth-child(2) { display: block; width: auto; border: 0; padding: 0.05rem 0; }
}
@page { size: A4 landscape; margin: 12mm; }
@media print {
  :root { font-size: 8.5pt; }
  body { background: #fff; print-color-adjust: exact; -webkit-print-color-adjust: exact; }
  header { background: none; color: var(--ink); padding: 0 0 2mm; border-bottom: 1px solid; }
  header p { color: var(--soft); }
  main { display: block; padding: 3mm 0 0; }
  section { border: 0; padding: 0; margin: 0 0 6mm; }
  .scroll { overflow: visible; max-height: none; }
  .matrix th, .matrix thead th, .matrix th:first-child { position: static; }
  thead { display: table-header-group; }
  tr, .legend { break-inside: avoid; }
  h2 { break-after: avoid; }
  .matrix td { min-width: 0; }
  .many { font-size: 6pt; border-spacing: 1px; width: 100%; table-layout: fixed; }
  .many th:first-child { width: 28mm; }
  .many th { padding: 0.3mm; }
  .many .word { display: none; }
  .many td b { padding: 0; white-space: normal; }
  .matrix.many td > a, .matrix.many td:not(:has(a)) { padding: 0.4mm; }
}
)css";

using nlohmann::ordered_json;

/// A path as the text of a link, in which every byte that is not plain becomes %XX.
std::string link_text(const std::string& path) {
  constexpr std::string_view kPlain = "/-._~", kDigits = "0123456789ABCDEF";
  std::string link;
  for (const char c : path) {
    const auto byte = static_cast<unsigned char>(c);
    const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    if (letter || kPlain.find(c) != std::string_view::npos) {
      link += c;
    } else {
      link += {'%', kDigits[byte >> 4], kDigits[byte & 15]};
    }
  }
  return link;
}

/// The word in a cell: "conflict", "undecided", "clear", "clear with warnings", "failed (3)", or
/// the name of the task's status, such as "missing".
std::string cell_word(const TaskLook& look) {
  const Outcome outcome = outcome_of(look);
  switch (outcome) {
    case Outcome::kFailed:
      return "failed (" + std::to_string(look.state->exit_code) + ")";
    case Outcome::kUnfinished:
      return name_of(look.status);
    default:
      return words_of(outcome).word;
  }
}

/// A length as it was written, with a blank before its unit: "50 cm" for "50cm".
std::string spaced_length(std::string length) {
  const std::size_t unit = length.find_first_not_of("0123456789.+-eE");
  if (unit != std::string::npos && unit > 0 && length[unit] != ' ') length.insert(unit, 1, ' ');
  return length;
}

/// The side on which the least distance is, such as ", left"; empty where that is not known, and
/// for a point inside the vehicle, which has no side of it.
std::string cell_side(const ordered_json& facts) {
  if (facts["least"]["distance"].get<double>() < 0) return "";
  const ordered_json side = facts.value("least_side", ordered_json());
  return side.is_string() ? ", " + side.get<std::string>() : "";
}

constexpr std::string_view kTouches = "touches";

/// A least distance to 0.1 mm, for example "0.032 m"; below 1 mm the surfaces meet, as far as a
/// scan can show. A distance below 0 is a depth inside a solid.
std::string distance_words(double distance, const std::string& unit) {
  if (std::abs(distance) < kTouching) return std::string(kTouches);
  const std::string length = format_number(std::round(std::abs(distance) * 1e4) / 1e4) + " " + unit;
  return distance >= 0 ? length : length + " deep inside";
}

/// The least distance in a cell, for example "0.032 m, left"; where it is not known, a bound such
/// as "< 0.1 m". Empty where nothing is known, because the task is not done or its search could not
/// have found anything.
std::string cell_distance(const Task& task, const TaskLook& look) {
  const Outcome outcome = outcome_of(look);
  if (look.status != TaskStatus::kDone) return "";
  const ordered_json& facts = look.state->facts;
  if (outcome == Outcome::kUndecided && is_in_doubt(facts)) return "";
  const ordered_json& least = facts["least"];
  if (!least.is_null()) {
    return distance_words(least["distance"].get<double>(), task.unit) + cell_side(facts);
  }
  const auto radius = task.question["radius"].get<double>();
  const double asked = std::max(
      {radius, task.question["clearance"].get<double>(), task.question["profile"].get<double>()});
  return (outcome != Outcome::kConflict ? "≥ " + format_length(asked)
                                        : "< " + format_length(radius)) +
         " " + task.unit;
}

/// How many conflicts a run lists, and the chainage of its least distance or, without distances, of
/// its first place, such as "3 conflicts, at 31.02 m". Empty where nothing is known.
std::string cell_place(const Task& task, const TaskLook& look) {
  if (look.status != TaskStatus::kDone) return "";
  const ordered_json& facts = look.state->facts;
  std::vector<std::string> parts;
  if (const ordered_json conflicts = facts.value("conflicts", ordered_json());
      !conflicts.is_null()) {
    const auto count = conflicts["count"].get<std::uint64_t>();
    if (count > 0) parts.push_back(counted(count, "conflict"));
    const ordered_json ledger = facts.value("ledger", ordered_json());
    const auto accepted = ledger.is_null() ? 0 : ledger["accepted_conflicts"].get<std::uint64_t>();
    if (accepted > 0) parts.push_back(format_count(accepted) + " accepted");
  }
  const bool in_doubt = outcome_of(look) == Outcome::kUndecided && is_in_doubt(facts);
  const ordered_json& at = facts["least"].is_null() ? facts["first"] : facts["least"];
  if (!at.is_null() && !in_doubt) {
    const double chainage = std::round(at["chainage"].get<double>() * 100) / 100;
    parts.push_back("at " + format_number(chainage) + " " + task.unit);
  }
  std::string text;
  for (const std::string& part : parts) text += (text.empty() ? "" : ", ") + part;
  return text;
}

/// The details of a cell, as a line of text.
std::string cell_details(const Task& task, const TaskLook& look) {
  if (look.status == TaskStatus::kFailed) {
    return (look.shard > 0 ? "shard " + std::to_string(look.shard) + ": " : "") + "exit code " +
           std::to_string(look.state->exit_code) + ": " + look.state->message;
  }
  if (look.status == TaskStatus::kOutdated) {
    return std::string(name_of(look.status)) + ": " + look.changed;
  }
  if (look.status != TaskStatus::kDone) return name_of(look.status);
  const ordered_json& facts = look.state->facts;
  std::string text = words_of(outcome_of(look)).word;
  const std::string distance = cell_distance(task, look), caveats = caveats_of(facts, task.unit);
  if (!distance.empty())
    text += (distance.starts_with(kTouches) ? ", " : ", least distance ") + distance;
  if (const std::string where = cell_place(task, look); !where.empty()) text += ", " + where;
  const auto points = facts["colliding_points"].get<std::uint64_t>();
  if (points > 0) {
    text += ", " + counted(points, "colliding point");
  }
  return text + (caveats.empty() ? "" : "; " + caveats);
}

/// The link of a cell, relative to the campaign's folder: for a failed task its log; for a finished
/// one its report or, where there is none, its run.json; otherwise empty.
std::string cell_link(const Task& task, const TaskLook& look) {
  const std::string folder = task.folder().string() + "/";
  if (look.status == TaskStatus::kFailed) {
    const std::string of = look.shard > 0 ? "shards/" + std::to_string(look.shard) + "/" : "";
    return link_text(folder + of + "log.txt");
  }
  if (look.status != TaskStatus::kDone) return "";
  const bool report = std::ranges::find(task.outputs, kReportName) != task.outputs.end();
  return link_text(folder + (report ? kReportName : "run.json"));
}

using nlohmann::ordered_json;

/// The names that the tasks have, each once, in the order of their first tasks.
template <typename Name>
std::vector<std::string> names_in(const Plan& plan, const Name& name) {
  std::vector<std::string> names;
  std::map<std::string, bool> seen;
  for (const Task& task : plan.tasks) {
    if (!std::exchange(seen[task.*name], true)) names.push_back(task.*name);
  }
  return names;
}

class CampaignPage {
 public:
  CampaignPage(const Plan& plan, const std::vector<TaskLook>& looks, const std::string& date)
      : plan_(plan),
        looks_(looks),
        date_(date),
        counts_(looks),
        routes_(names_in(plan, &Task::route)) {
    for (std::size_t i = 0; i < plan.tasks.size(); ++i) {
      const Task& task = plan.tasks[i];
      at_[{task.vehicle, task.route, task.radius}] = i;
      environment_of_[task.route] = task.environment;
    }
  }

  std::string text() {
    head();
    summary();
    const auto radii = names_in(plan_, &Task::radius);
    for (const std::string& radius : radii) table(radius);
    warnings();
    ignored();
    failures();
    unfinished();
    text_ += "</main>\n<script type=\"application/json\" id=\"facts\">" + facts_text() +
             "</script>\n</body>\n</html>\n";
    return std::move(text_);
  }

 private:
  void head() {
    const std::string name = markup_text(plan_.name);
    text_ +=
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
        "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; "
        "style-src 'unsafe-inline'\">\n"
        "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>" +
        name + "</title>\n<style>\n" + kCampaignStyle + "</style>\n</head>\n<body>\n<header><h1>" +
        name + "</h1><p>Clearway, " + markup_text(date_) + "</p></header>\n<main>\n";
  }

  void summary() {
    text_ += "<section aria-label=\"Summary\">\n<p class=\"answer\">" + answer() +
             "</p>\n<ul class=\"legend\">\n";
    std::string meanings;
    for (const Outcome outcome : kOutcomes) {
      const OutcomeWords& words = words_of(outcome);
      if (counts_.of(outcome) == 0) continue;
      text_ += std::string("<li class=\"") + words.name +
               R"("><span class="sign" aria-hidden="true">)" + words.sign + "</span> <b>" +
               format_count(counts_.of(outcome)) + "</b> " + words.word + "</li>\n";
      meanings += std::string("<li>") + words.words + "</li>\n";
    }
    text_ +=
        "</ul>\n<details class=\"note\"><summary>What the cells say</summary>\n<ul>\n" + meanings +
        "<li>the verdict, the least distance that is known, how many conflicts are listed, the "
        "side "
        "and the chainage of the least distance or of the first place; a link to the report of the "
        "run</li>\n</ul>\n</details>\n</section>\n";
  }

  /// One sentence that counts every run once, and one about runs that left points out of the
  /// search.
  std::string answer() const {
    const std::size_t all = looks_.size();
    std::vector<std::string> parts;
    const auto add = [&](Outcome outcome, const char* one, const char* several) {
      const std::size_t count = counts_.of(outcome);
      if (count > 0) parts.push_back(format_count(count) + " " + (count == 1 ? one : several));
    };
    add(Outcome::kConflict, "finds a conflict", "find a conflict");
    add(Outcome::kUndecided, "is undecided", "are undecided");
    add(Outcome::kClearWithWarnings, "is clear with warnings", "are clear with warnings");
    add(Outcome::kClear, "is clear", "are clear");
    add(Outcome::kFailed, "has failed", "have failed");
    add(Outcome::kUnfinished, "is not done", "are not done");
    std::string text = "Of " + counted(all, "run") + " " + format_list(parts) + ".";
    if (const std::size_t runs = runs_that_ignore(); runs > 0) {
      text += " In " + counted(runs, "run") + " points were left out of the search.";
    }
    return text;
  }

  const ordered_json* facts_of(std::size_t index) const {
    const TaskLook& look = looks_[index];
    return look.status == TaskStatus::kDone ? &look.state->facts : nullptr;
  }

  std::size_t runs_that_ignore() const {
    std::size_t runs = 0;
    for (std::size_t i = 0; i < looks_.size(); ++i) {
      if (facts_of(i) != nullptr && !ignored_words(*facts_of(i)).empty()) ++runs;
    }
    return runs;
  }

  void table(const std::string& radius) {
    const std::string title = "Radius " + markup_text(spaced_length(radius)) + unit_of(radius);
    text_ += "<section>\n<h2>" + title +
             "</h2>\n<div class=\"scroll\" role=\"region\" tabindex=\"0\" aria-label=\"" + title +
             "\">\n<table class=\"matrix" + (routes_.size() > kFewRoutes ? " many" : "") +
             "\">\n<thead><tr><th scope=\"col\">vehicle</th>";
    for (const std::string& route : routes_) {
      text_ += "<th scope=\"col\">" + markup_text(route) + "<small>" +
               markup_text(environment_of_[route]) + "</small></th>";
    }
    text_ += "</tr></thead>\n<tbody>\n";
    for (const std::string& vehicle : names_in(plan_, &Task::vehicle)) {
      text_ += "<tr><th scope=\"row\">" + markup_text(vehicle) + "</th>";
      for (const std::string& route : routes_) cell(at_.at({vehicle, route, radius}));
      text_ += "</tr>\n";
    }
    text_ += "</tbody>\n</table>\n</div>\n</section>\n";
  }

  /// The unit after a radius. A radius that is a plain number is in the unit of the environments.
  std::string unit_of(const std::string& radius) const {
    if (radius.find_first_not_of("0123456789.") != std::string::npos) return "";
    for (const Task& task : plan_.tasks) {
      if (task.unit != plan_.tasks[0].unit) return "";
    }
    return " " + plan_.tasks[0].unit;
  }

  void cell(std::size_t index) {
    const Task& task = plan_.tasks[index];
    const TaskLook& look = looks_[index];
    const OutcomeWords& kind = words_of(outcome_of(look));
    const std::string link = cell_link(task, look), distance = cell_distance(task, look);
    text_ += std::string("<td class=\"") + kind.name + "\" title=\"" +
             markup_text(task.vehicle + " on " + task.route + ": " + cell_details(task, look)) +
             "\">";
    if (!link.empty()) text_ += "<a href=\"" + link + "\">";
    text_ += std::string(R"(<span class="sign" aria-hidden="true">)") + kind.sign +
             R"(</span> <span class="word">)" + cell_word(look) + "</span>";
    if (!distance.empty()) text_ += "<br><b>" + distance + "</b>";
    if (const std::string where = cell_place(task, look); !where.empty()) {
      text_ += "<small>" + where + "</small>";
    }
    if (look.status == TaskStatus::kDone) text_ += cell_caveats(look.state->facts, task.unit);
    text_ += link.empty() ? "</td>" : "</a></td>";
  }

  /// The caveats of a run as numbers only, because the sections below the tables have the words.
  static std::string cell_caveats(const ordered_json& facts, const std::string& unit) {
    std::string text;
    if (const std::size_t warnings = facts["warnings"].size(); warnings > 0) {
      text = counted(warnings, "warning");
    }
    if (const std::string floor = floor_clause(facts, unit); !floor.empty()) {
      text += (text.empty() ? "" : ", ") + floor;
    }
    if (!ignored_words(facts).empty()) {
      const auto points = facts["ignored"]["points"].get<std::uint64_t>();
      text += (text.empty() ? "" : ", ") + format_count(points) + " ignored";
      if (const ordered_json& colliding = facts["ignored"]["colliding"]; !colliding.is_null()) {
        text += ", of which " + format_count(colliding.get<std::uint64_t>()) + " would collide";
      }
    }
    if (const std::string open = open_words(facts, unit); !open.empty()) {
      text += (text.empty() ? "" : ", ") + open;
    }
    return text.empty() ? "" : "<small>" + text + "</small>";
  }

  /// Names of runs with links, such as "truck/north/0.1, ..."; only the first ones of many.
  std::string run_links(const std::vector<std::size_t>& runs) const {
    constexpr std::size_t kMost = 12;
    std::string text;
    for (std::size_t i = 0; i < runs.size() && i < kMost; ++i) {
      const Task& task = plan_.tasks[runs[i]];
      text += (i == 0 ? "" : ", ") + ("<a href=\"" + cell_link(task, looks_[runs[i]]) + "\">") +
              markup_text(task.name()) + "</a>";
    }
    if (runs.size() > kMost) text += " and " + format_count(runs.size() - kMost) + " more";
    return text;
  }

  void begin_list(const char* title, std::initializer_list<const char*> columns) {
    text_ += std::string("<section>\n<h2>") + title +
             "</h2>\n<div class=\"scroll\">\n<table class=\"list\">\n<thead><tr>";
    for (const char* column : columns) {
      text_ += std::string("<th scope=\"col\">") + column + "</th>";
    }
    text_ += "</tr></thead>\n<tbody>\n";
  }
  void add_row(std::initializer_list<std::string> cells) {
    text_ += "<tr>";
    for (const std::string& cell : cells) text_ += "<td>" + cell + "</td>";
    text_ += "</tr>\n";
  }
  void end_list() { text_ += "</tbody>\n</table>\n</div>\n</section>\n"; }

  /// Lists each kind of warning once, with the text of the first run that has it.
  void warnings() {
    std::map<std::string, std::vector<std::size_t>> runs_of;
    std::map<std::string, std::string> first_text;
    for (std::size_t i = 0; i < looks_.size(); ++i) {
      if (facts_of(i) == nullptr) continue;
      const ordered_json& codes = (*facts_of(i))["warnings"];
      const ordered_json texts = facts_of(i)->value("warning_texts", ordered_json::array());
      for (std::size_t k = 0; k < codes.size(); ++k) {
        const auto code = codes[k].get<std::string>();
        std::vector<std::size_t>& runs = runs_of[code];
        if (runs.empty() && k < texts.size()) first_text[code] = texts[k].get<std::string>();
        if (runs.empty() || runs.back() != i) runs.push_back(i);
      }
    }
    if (runs_of.empty()) return;
    begin_list("Warnings", {"runs", "warning", "what the first of them says", "in"});
    for (const auto& [code, runs] : runs_of) {
      add_row({format_count(runs.size()), markup_text(code), markup_text(first_text[code]),
               run_links(runs)});
    }
    end_list();
  }

  void ignored() {
    std::map<std::string, std::vector<std::size_t>> runs_of;
    for (std::size_t i = 0; i < looks_.size(); ++i) {
      if (facts_of(i) == nullptr) continue;
      const std::string words = ignored_words(*facts_of(i));
      if (!words.empty()) runs_of[words].push_back(i);
    }
    if (runs_of.empty()) return;
    begin_list("Left out of the search", {"runs", "points", "in"});
    for (const auto& [words, runs] : runs_of) {
      add_row({format_count(runs.size()), words, run_links(runs)});
    }
    end_list();
  }

  void failures() {
    if (counts_.of(Outcome::kFailed) == 0) return;
    begin_list("Failed", {"task", "run", "what happened"});
    for (std::size_t i = 0; i < looks_.size(); ++i) {
      if (outcome_of(looks_[i]) != Outcome::kFailed) continue;
      add_row({std::to_string(plan_.tasks[i].number), run_links({i}),
               markup_text(cell_details(plan_.tasks[i], looks_[i]))});
    }
    end_list();
  }

  void unfinished() {
    TaskList tasks;
    std::string changes;
    for (std::size_t i = 0; i < looks_.size(); ++i) {
      if (outcome_of(looks_[i]) != Outcome::kUnfinished) continue;
      tasks.push_back(plan_.tasks[i].number);
      if (looks_[i].changed.empty()) continue;
      changes += "<li>" + markup_text(plan_.tasks[i].name() + ": " + looks_[i].changed) +
                 ", so its verdict would be of an earlier file</li>\n";
    }
    if (tasks.empty()) return;
    text_ += "<section>\n<h2>Not done</h2>\n<p>Tasks " + task_list_text(tasks) +
             ". <code>clearway campaign run DIR --all</code> goes on with them.</p>\n" +
             (changes.empty() ? "" : "<ul>\n" + changes + "</ul>\n") + "</section>\n";
  }

  /// The page's facts as JSON in which nothing can end the HTML element around it.
  std::string facts_text() const {
    const std::string json = page_facts(plan_, looks_, date_)
                                 .dump(-1, ' ', false, ordered_json::error_handler_t::replace);
    std::string text;
    for (const char c : json) text += c == '<' ? std::string("\\u003c") : std::string(1, c);
    return text;
  }

  static constexpr std::size_t kFewRoutes = 10;

  const Plan& plan_;
  const std::vector<TaskLook>& looks_;
  const std::string& date_;
  const OutcomeCounts counts_;
  std::vector<std::string> routes_;
  std::map<std::array<std::string, 3>, std::size_t> at_;
  std::map<std::string, std::string> environment_of_;
  std::string text_;
};

}  // namespace

ordered_json page_facts(const Plan& plan, const std::vector<TaskLook>& looks,
                        const std::string& date) {
  ordered_json out{{"campaign", plan.name}, {"date", date}, {"tasks", plan.tasks.size()}};
  out.update(OutcomeCounts(looks).json());
  out["runs"] = ordered_json::array();
  for (std::size_t i = 0; i < looks.size(); ++i) {
    const Task& task = plan.tasks[i];
    const TaskLook& look = looks[i];
    ordered_json run{{"task", task.number},
                     {"vehicle", task.vehicle},
                     {"route", task.route},
                     {"environment", task.environment},
                     {"radius", task.radius},
                     {"unit", task.unit},
                     {"status", name_of(look.status)},
                     {"outcome", words_of(outcome_of(look)).name},
                     {"page", cell_link(task, look)}};
    if (look.status == TaskStatus::kDone) run.update(look.state->facts);
    if (!look.changed.empty()) run["changed"] = look.changed;
    if (look.status == TaskStatus::kFailed) {
      run["exit_code"] = look.state->exit_code;
      run["message"] = look.state->message;
    }
    out["runs"].push_back(std::move(run));
  }
  return out;
}

std::string page_text(const Plan& plan, const std::vector<TaskLook>& looks,
                      const std::string& date) {
  return CampaignPage(plan, looks, date).text();
}

}  // namespace clearway::campaign
