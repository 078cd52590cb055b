#include "campaign/page/campaign_page.hpp"

#include <algorithm>
#include <array>
#include <initializer_list>
#include <map>
#include <utility>

#include "campaign/outcome.hpp"
#include "campaign/page/campaign_style.hpp"
#include "campaign/page/page_cell.hpp"
#include "campaign/task_list.hpp"
#include "core/util/format.hpp"
#include "io/conflicts/markup_text.hpp"

namespace clearway::campaign {
namespace {

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
    for (const Outcome outcome : kOutcomes) {
      const OutcomeWords& words = words_of(outcome);
      text_ += std::string("<li class=\"") + words.name + "\"><b>" +
               format_count(counts_.of(outcome)) +
               R"(</b> <span class="sign" aria-hidden="true">)" + words.sign + "</span> " +
               words.words + "</li>\n";
    }
    text_ +=
        "</ul>\n<p class='note'>A cell of the tables below gives the verdict and the least "
        "distance that is known. It links to the report of its run.</p>\n</section>\n";
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
    add(Outcome::kDoubtful, "is clear with warnings", "are clear with warnings");
    add(Outcome::kClear, "is clear", "are clear");
    add(Outcome::kFailed, "has failed", "have failed");
    add(Outcome::kUnfinished, "is not done", "are not done");
    std::string text = "Of " + counted(all, "run") + " ";
    for (std::size_t i = 0; i < parts.size(); ++i) {
      text += (i == 0 ? "" : i + 1 == parts.size() ? " and " : ", ") + parts[i];
    }
    text += ".";
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
    const std::string title = "Radius " + markup_text(radius) + unit_of(radius);
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

  /// The unit behind a radius. A radius that is a plain number is in the unit of the environments.
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
    if (look.status == TaskStatus::kDone) text_ += cell_caveats(look.state->facts);
    text_ += link.empty() ? "</td>" : "</a></td>";
  }

  /// The caveats of a run as numbers only, because the sections below the tables have the words.
  static std::string cell_caveats(const ordered_json& facts) {
    std::string text;
    if (const std::size_t warnings = facts["warnings"].size(); warnings > 0) {
      text = counted(warnings, "warning");
    }
    if (!ignored_words(facts).empty()) {
      const auto points = facts["ignored"]["points"].get<std::uint64_t>();
      text += (text.empty() ? "" : ", ") + format_count(points) + " ignored";
    }
    if (!is_exact(facts)) text += (text.empty() ? "" : ", ") + std::string("not exact");
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
