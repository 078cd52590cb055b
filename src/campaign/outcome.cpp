#include "campaign/outcome.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <string_view>

#include "clearway/answer.hpp"
#include "clearway/ledger.hpp"
#include "core/query/point_classes.hpp"
#include "core/query/verdict_words.hpp"
#include "core/util/format.hpp"
#include "io/result/conflicts/conflict_words.hpp"
#include "io/result/floor_facts.hpp"

namespace clearway::campaign {
namespace {

using Runs = std::vector<TaskStatus>;

Outcome outcome_by(const Json& facts, const Json& verdict) {
  if (verdict == "clear") {
    return facts["warnings"].empty() ? Outcome::kClear : Outcome::kClearWithWarnings;
  }
  return verdict == "conflict" ? Outcome::kConflict : Outcome::kUndecided;
}

std::size_t count_of(const Runs& runs, Outcome outcome) {
  return static_cast<std::size_t>(std::ranges::count(runs, outcome, outcome_of));
}

/// A member of the facts; null where it is missing.
Json member(const Json& facts, const char* name) {
  return facts.is_null() ? Json() : facts.value(name, Json());
}

/// The parts that are not empty, with the separator between them.
std::string joined(std::initializer_list<std::string> parts, const char* separator) {
  std::string text;
  for (const std::string& part : parts) {
    if (!part.empty()) text += (text.empty() ? "" : separator) + part;
  }
  return text;
}

// In what follows, facts are those of a run that is done, and unit is that of its lengths, for
// example "m".

std::string warning_words(const Json& facts) {
  const auto codes = facts["warnings"].get<std::vector<std::string>>();
  if (codes.empty()) return "";
  return fmt::format("{} ({})", counted(codes.size(), "warning"), fmt::join(codes, ", "));
}

std::string classified_clause(const Json& facts) {
  ClassCounts counts;
  std::uint64_t points = 0;
  const Json classes = facts.value("classes", Json::object());
  for (const auto& [value, of_class] : classes.items()) {
    counts[static_cast<std::uint8_t>(std::stoul(value))] = of_class.get<std::uint64_t>();
    points += of_class.get<std::uint64_t>();
  }
  return classified_words(counts, points);
}

std::string reason_clause(const Json& facts, Reason reason) {
  const Json reasons = facts.value("reasons", Json::array());
  if (std::ranges::find(reasons, name_of(reason)) == reasons.end()) return "";
  return reason_words(reason, facts.value("doubts", std::vector<std::string>()));
}

std::string unseen_clause(const Json& facts, const std::string& unit) {
  const Json seen = member(facts, "seen");
  if (seen.is_null() || seen["listed_groups"] == 0) return "";
  const auto length = seen["not_scanned_length"].get<double>();
  return length > 0 ? "not scanned on " + format_brief(length) + " " + unit : "not scanned";
}

std::string ledger_clause(const Json& facts) {
  const std::string words = ledger_words(member(facts, "ledger"));
  return words.empty() ? "" : "ledger: " + words;
}

/// Why a run is undecided, and on how much of the path nobody knows what is there: "points are
/// near, the question is in doubt (model-unit), not scanned on 3.2 m". Empty where nothing of this
/// holds.
std::string open_words(const Json& facts, const std::string& unit) {
  return joined({reason_clause(facts, Reason::kNear), reason_clause(facts, Reason::kFew),
                 reason_clause(facts, Reason::kErrorsExceedMargin),
                 reason_clause(facts, Reason::kQuestionInDoubt), unseen_clause(facts, unit)},
                ", ");
}

/// For example "1,234 points ignored, of which 56 would collide"; empty where none is ignored.
/// noun: whether to say that they are points.
std::string ignored_words(const Json& facts, bool noun = true) {
  const Json ignored = member(facts, "ignored");
  if (ignored.is_null() || ignored["points"] == 0) return "";
  const auto points = ignored["points"].get<std::uint64_t>();
  const std::string text = (noun ? counted(points, "point") : format_count(points)) + " ignored";
  const Json& colliding = ignored["colliding"];
  if (colliding.is_null()) return text;
  return text + ", of which " + format_count(colliding.get<std::uint64_t>()) + " would collide";
}

/// For example "1,234 below 0.3 m not judged"; empty without a floor.
std::string floor_clause(const Json& facts, const std::string& unit) {
  const Json floor = member(facts, "floor");
  if (floor.is_null()) return "";
  return format_count(floor["colliding"].get<std::uint64_t>()) + " below " +
         floor_words(floor, unit) + " not judged";
}

// Words about one run for the page

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

constexpr std::string_view kTouches = "touches";

/// A least distance to 0.1 mm, for example "0.032 m"; below 1 mm the surfaces meet, as far as a
/// scan can show. A distance below 0 is a depth inside a solid.
std::string distance_words(double distance, const std::string& unit) {
  if (std::abs(distance) < kTouching) return std::string(kTouches);
  const std::string length = format_number(std::round(std::abs(distance) * 1e4) / 1e4) + " " + unit;
  return distance >= 0 ? length : length + " deep inside";
}

/// Whether a run is undecided because its question is in doubt, so that its distances say nothing.
bool is_doubtful(const TaskStatus& run) {
  return outcome_of(run) == Outcome::kUndecided &&
         !reason_clause(run.facts(), Reason::kQuestionInDoubt).empty();
}

/// The least distance of a run, for example "0.032 m, left"; where it is not known, a bound such as
/// "< 0.1 m". Empty where nothing is known, because its search could not have found anything.
std::string least_words(const TaskStatus& run) {
  if (is_doubtful(run)) return "";
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

/// How many conflicts a run lists, and the chainage of its least distance or, without distances, of
/// its first place, such as "3 conflicts, at 31.02 m".
std::string place_words(const TaskStatus& run) {
  const Json& facts = run.facts();
  const auto count = [&](const char* of, const char* name) {
    return facts.contains(of) ? facts[of][name].get<std::uint64_t>() : 0;
  };
  const std::uint64_t conflicts = count("conflicts", "count");
  const std::uint64_t accepted = count("ledger", "accepted_conflicts");
  std::string place;
  const Json& at = facts["least"].is_null() ? facts["first"] : facts["least"];
  if (!at.is_null() && !is_doubtful(run)) {
    const double chainage = std::round(at["chainage"].get<double>() * 100) / 100;
    place = "at " + format_number(chainage) + " " + run.task->unit;
  }
  return joined({conflicts > 0 ? counted(conflicts, "conflict") : "",
                 accepted > 0 ? format_count(accepted) + " accepted" : "", place},
                ", ");
}

/// What the page shows of a run: in its cell, where the caveats are numbers only, because the lists
/// below the tables have the words, and in full when it is pointed at.
Json words_of(const TaskStatus& run) {
  const OutcomeWords& outcome = words_of(outcome_of(run));
  Json out{{"sign", outcome.sign}, {"word", outcome.word}};
  if (run.status == Status::kFailed) {
    out["word"] = fmt::format("failed ({})", run.state->exit_code);
    out["details"] = fmt::format("{}exit code {}: {}",
                                 run.shard > 0 ? "shard " + std::to_string(run.shard) + ": " : "",
                                 run.state->exit_code, run.state->message);
  } else if (run.status != Status::kDone) {
    out["word"] = name_of(run.status);
    out["details"] = name_of(run.status) + (run.changed.empty() ? "" : ": " + run.changed);
  } else {
    const Json& facts = run.facts();
    const std::string least = least_words(run), place = place_words(run), unit = run.task->unit;
    const bool is_distance = !least.empty() && !least.starts_with(kTouches);
    const auto points = facts["colliding_points"].get<std::uint64_t>();
    const std::size_t warnings = facts["warnings"].size();
    out["least"] = least;
    out["place"] = place;
    out["caveats"] =
        joined({warnings > 0 ? counted(warnings, "warning") : "", floor_clause(facts, unit),
                ignored_words(facts, false), open_words(facts, unit)},
               ", ");
    out["ignored_words"] = ignored_words(facts);
    out["details"] = joined({joined({outcome.word, (is_distance ? "least distance " : "") + least,
                                     place, points > 0 ? counted(points, "colliding point") : ""},
                                    ", "),
                             caveats_of(facts, unit)},
                            "; ");
  }
  return out;
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

/// A radius as it was written, with a blank before its unit: "Radius 50 cm" for "50cm". A plain
/// number is in the unit of the environments.
std::string radius_title(std::string radius, const Runs& runs) {
  const std::size_t at = radius.find_first_not_of("0123456789.+-eE");
  const std::string& unit = runs.front().task->unit;
  if (at != std::string::npos && at > 0 && radius[at] != ' ') radius.insert(at, 1, ' ');
  const bool is_plain = radius.find_first_not_of("0123456789.") == std::string::npos;
  const bool is_one_unit =
      std::ranges::all_of(runs, [&](const TaskStatus& run) { return run.task->unit == unit; });
  return "Radius " + radius + (is_plain && is_one_unit ? " " + unit : "");
}

}  // namespace

Outcome outcome_of(const TaskStatus& run) {
  if (run.status == Status::kFailed) return Outcome::kFailed;
  if (run.status != Status::kDone) return Outcome::kUnfinished;
  return outcome_by(run.facts(), run.facts()["verdict"]);
}

Outcome outcome_outside(const TaskStatus& run) {
  const Json ledger = member(run.facts(), "ledger");
  return ledger.is_null() ? outcome_of(run) : outcome_by(run.facts(), ledger["outside"]);
}

std::string counts_text(const Runs& runs) {
  std::vector<std::string> counts;
  for (const OutcomeWords& of : kOutcomes) {
    counts.push_back(format_count(count_of(runs, of.outcome)) + " " + of.word);
  }
  return fmt::format("{}: {}", counted(runs.size(), "run"), fmt::join(counts, ", "));
}

Json counts_json(const Runs& runs) {
  Json out;
  for (const OutcomeWords& of : kOutcomes) out[of.name] = count_of(runs, of.outcome);
  return out;
}

Json ledgers_of(const Runs& runs) {
  Json sums;
  for (const TaskStatus& run : runs) {
    const Json ledger = member(run.facts(), "ledger");
    if (sums.is_null() && !ledger.is_null()) sums = Json::object();
    for (const auto& [key, count] : ledger.items()) {
      if (!count.is_number()) continue;
      sums[key] = sums.value(key, std::uint64_t{0}) + count.get<std::uint64_t>();
    }
  }
  return sums;
}

std::string ledger_words(const Json& ledger) {
  std::vector<std::string> counts;
  for (std::size_t i = 0; i < kLedgerStatuses && !ledger.is_null(); ++i) {
    const char* const status = name_of(static_cast<LedgerStatus>(i));
    const auto count = ledger.value(status, std::uint64_t{0});
    if (count > 0) counts.push_back(format_count(count) + " " + status);
  }
  return fmt::format("{}", fmt::join(counts, ", "));
}

std::string caveats_of(const Json& facts, const std::string& unit) {
  return joined({warning_words(facts), classified_clause(facts), ignored_words(facts),
                 floor_clause(facts, unit), open_words(facts, unit), ledger_clause(facts)},
                "; ");
}

Json report_facts(const Plan& plan, const Runs& runs, const std::string& date) {
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

Json report_words(const Runs& runs) {
  Json out{{"answer", answer_of(runs)}, {"outcomes", Json::array()}, {"radii", Json::object()}};
  for (const OutcomeWords& of : kOutcomes) {
    const std::size_t count = count_of(runs, of.outcome);
    if (count == 0) continue;
    out["outcomes"].push_back({{"name", of.name},
                               {"sign", of.sign},
                               {"word", of.word},
                               {"count", count},
                               {"meaning", of.meaning}});
  }
  TaskList unfinished;
  for (const TaskStatus& run : runs) {
    out["radii"][run.task->radius] = radius_title(run.task->radius, runs);
    out["runs"].push_back(words_of(run));
    if (outcome_of(run) == Outcome::kUnfinished) unfinished.push_back(run.task->number);
  }
  out["unfinished"] = task_list_text(unfinished);
  return out;
}

}  // namespace clearway::campaign
