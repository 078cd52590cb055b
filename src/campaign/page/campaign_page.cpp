#include "campaign/page/campaign_page.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include "campaign/page/campaign_style.hpp"
#include "campaign/page/page_cell.hpp"
#include "campaign/task_list.hpp"
#include "core/util/format.hpp"
#include "io/conflicts/json_text.hpp"

namespace clearway::campaign {
namespace {

using nlohmann::ordered_json;

std::string html_text(const std::string& text) {
  std::string out;
  for (const char c : valid_utf8(text)) {
    if (c == '<') {
      out += "&lt;";
    } else if (c == '&') {
      out += "&amp;";
    } else if (c == '"') {
      out += "&quot;";
    } else {
      out += c;
    }
  }
  return out;
}

std::size_t cells_of(const std::vector<TaskLook>& looks, CellKind kind) {
  return static_cast<std::size_t>(std::ranges::count(looks, kind, kind_of));
}

/// The names that the tasks have, in the order of the first ones.
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
      : plan_(plan), looks_(looks), date_(date), routes_(names_in(plan, &Task::route)) {
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
    failures();
    unfinished();
    text_ += "</main>\n<script type=\"application/json\" id=\"facts\">" + facts_text() +
             "</script>\n</body>\n</html>\n";
    return std::move(text_);
  }

 private:
  void head() {
    const std::string name = html_text(plan_.name);
    text_ +=
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
        "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; "
        "style-src 'unsafe-inline'\">\n"
        "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>" +
        name + "</title>\n<style>\n" + kCampaignStyle + "</style>\n</head>\n<body>\n<header><h1>" +
        name + "</h1><p>Clearway, " + html_text(date_) + "</p></header>\n<main>\n";
  }

  void summary() {
    const std::size_t unknown =
        cells_of(looks_, CellKind::kFailed) + cells_of(looks_, CellKind::kUnfinished);
    text_ += "<section aria-label=\"Summary\">\n<p class=\"answer\">" + answer(unknown) +
             "</p>\n<ul class=\"legend\">\n";
    for (const CellKind kind : kCellKinds) {
      const CellLook& look = look_of(kind);
      text_ += std::string("<li class=\"") + look.name + "\"><b>" +
               format_count(cells_of(looks_, kind)) +
               R"(</b> <span class="sign" aria-hidden="true">)" + look.sign + "</span> " +
               look.words + "</li>\n";
    }
    text_ +=
        "</ul>\n<p class='note'>A cell of the tables below gives the verdict and the least "
        "distance "
        "that is known. It links to the report of its run.</p>\n</section>\n";
  }

  std::string answer(std::size_t unknown) const {
    const std::size_t all = looks_.size();
    const std::size_t conflicts = cells_of(looks_, CellKind::kConflict);
    const std::string of = " of " + format_count(all) + (all == 1 ? " run " : " runs ");
    std::string text = conflicts > 0 ? format_count(conflicts) + of +
                                           (conflicts == 1 ? "finds" : "find") + " a conflict."
                       : unknown == 0 ? "No run finds a conflict."
                                      : "No conflict so far.";
    if (unknown > 0) {
      text += " " + format_count(unknown) + of + (unknown == 1 ? "has" : "have") + " no result.";
    }
    const std::size_t doubtful = cells_of(looks_, CellKind::kDoubtful);
    if (doubtful > 0)
      text +=
          " " + format_count(doubtful) + (doubtful == 1 ? " is" : " are") + " clear with warnings.";
    return text;
  }

  void table(const std::string& radius) {
    const std::string title = "Radius " + html_text(radius) + unit_of(radius);
    text_ += "<section>\n<h2>" + title +
             "</h2>\n<div class=\"scroll\" role=\"region\" tabindex=\"0\" aria-label=\"" + title +
             "\">\n<table class=\"matrix" + (routes_.size() > kFewRoutes ? " many" : "") +
             "\">\n<thead><tr><th scope=\"col\">vehicle</th>";
    for (const std::string& route : routes_) {
      text_ += "<th scope=\"col\">" + html_text(route) + "<small>" +
               html_text(environment_of_[route]) + "</small></th>";
    }
    text_ += "</tr></thead>\n<tbody>\n";
    for (const std::string& vehicle : names_in(plan_, &Task::vehicle)) {
      text_ += "<tr><th scope=\"row\">" + html_text(vehicle) + "</th>";
      for (const std::string& route : routes_) cell(at_.at({vehicle, route, radius}));
      text_ += "</tr>\n";
    }
    text_ += "</tbody>\n</table>\n</div>\n</section>\n";
  }

  /// A radius as a plain number is in the unit of the environments.
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
    const CellLook& kind = look_of(kind_of(look));
    const std::string link = cell_link(task, look), distance = cell_distance(task, look);
    text_ += std::string("<td class=\"") + kind.name + "\" title=\"" +
             html_text(task.vehicle + " on " + task.route + ": " + cell_details(task, look)) +
             "\">";
    if (!link.empty()) text_ += "<a href=\"" + link + "\">";
    text_ += std::string(R"(<span class="sign" aria-hidden="true">)") + kind.sign +
             R"(</span> <span class="word">)" + cell_word(look) + "</span>";
    if (!distance.empty()) text_ += "<br><b>" + distance + "</b>";
    text_ += link.empty() ? "</td>" : "</a></td>";
  }

  void failures() {
    if (cells_of(looks_, CellKind::kFailed) == 0) return;
    text_ +=
        "<section>\n<h2>Failed</h2>\n<table class=\"list\">\n<thead><tr><th scope=\"col\">task</th>"
        "<th scope=\"col\">run</th><th scope=\"col\">what happened</th></tr></thead>\n<tbody>\n";
    for (std::size_t i = 0; i < looks_.size(); ++i) {
      const Task& task = plan_.tasks[i];
      const TaskLook& look = looks_[i];
      if (kind_of(look) != CellKind::kFailed) continue;
      text_ += "<tr><td>" + std::to_string(task.number) + "</td><td><a href=\"" +
               cell_link(task, look) + "\">" + html_text(task.name()) + "</a></td><td>" +
               html_text(cell_details(task, look)) + "</td></tr>\n";
    }
    text_ += "</tbody>\n</table>\n</section>\n";
  }

  void unfinished() {
    TaskList tasks;
    for (std::size_t i = 0; i < looks_.size(); ++i) {
      if (kind_of(looks_[i]) == CellKind::kUnfinished) tasks.push_back(plan_.tasks[i].number);
    }
    if (tasks.empty()) return;
    text_ += "<section>\n<h2>Not done</h2>\n<p>Tasks " + task_list_text(tasks) +
             ". <code>clearway campaign run DIR --all</code> goes on with them.</p>\n</section>\n";
  }

  /// Nothing in it ends the element that it stands in.
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
  std::vector<std::string> routes_;
  std::map<std::array<std::string, 3>, std::size_t> at_;
  std::map<std::string, std::string> environment_of_;
  std::string text_;
};

}  // namespace

RunLooks run_looks(const Plan& plan, const std::vector<TaskLook>& looks) {
  RunLooks runs{{plan.name, {}}, {}};
  std::optional<TaskLook> failed;  // of the shards before their run
  for (std::size_t i = 0; i < looks.size(); ++i) {
    if (plan.tasks[i].shard) {
      if (looks[i].status == TaskStatus::kFailed && !failed) {
        failed = looks[i];
        failed->shard = plan.tasks[i].shard->number;
      }
      continue;
    }
    const bool done = looks[i].status == TaskStatus::kDone;
    runs.plan.tasks.push_back(plan.tasks[i]);
    runs.looks.push_back(failed && !done ? *failed : looks[i]);
    failed.reset();
  }
  return runs;
}

ordered_json page_facts(const Plan& plan, const std::vector<TaskLook>& looks,
                        const std::string& date) {
  ordered_json out{{"campaign", plan.name}, {"date", date}, {"tasks", plan.tasks.size()}};
  for (const CellKind kind : kCellKinds) out[look_of(kind).name] = cells_of(looks, kind);
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
                     {"page", cell_link(task, look)}};
    if (look.status == TaskStatus::kDone) run.update(look.state->facts);
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
