#include "campaign/outcome.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>

#include "clearway/answer.hpp"
#include "clearway/ledger.hpp"
#include "core/query/point_classes.hpp"
#include "core/query/verdict_words.hpp"
#include "core/util/format.hpp"
#include "io/result/floor_facts.hpp"

namespace clearway::campaign {
namespace {

Outcome outcome_by(const Json& facts, const Json& verdict) {
  if (verdict == "clear") {
    return facts["warnings"].empty() ? Outcome::kClear : Outcome::kClearWithWarnings;
  }
  return verdict == "conflict" ? Outcome::kConflict : Outcome::kUndecided;
}

/// A member of the facts; null where it is missing.
Json member(const Json& facts, const char* name) {
  return facts.is_null() ? Json() : facts.value(name, Json());
}

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

std::size_t count_of(const std::vector<TaskStatus>& runs, Outcome outcome) {
  return static_cast<std::size_t>(std::ranges::count(runs, outcome, outcome_of));
}

std::string counts_text(const std::vector<TaskStatus>& runs) {
  std::vector<std::string> counts;
  for (const OutcomeWords& of : kOutcomes) {
    counts.push_back(format_count(count_of(runs, of.outcome)) + " " + of.word);
  }
  return fmt::format("{}: {}", counted(runs.size(), "run"), fmt::join(counts, ", "));
}

Json counts_json(const std::vector<TaskStatus>& runs) {
  Json out;
  for (const OutcomeWords& of : kOutcomes) out[of.name] = count_of(runs, of.outcome);
  return out;
}

Json ledgers_of(const std::vector<TaskStatus>& runs) {
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

std::string joined(std::initializer_list<std::string> parts, const char* separator) {
  std::string text;
  for (const std::string& part : parts) {
    if (!part.empty()) text += (text.empty() ? "" : separator) + part;
  }
  return text;
}

std::string caveats_of(const Json& facts, const std::string& unit) {
  return joined({warning_words(facts), classified_clause(facts), ignored_words(facts),
                 floor_clause(facts, unit), open_words(facts, unit), ledger_clause(facts)},
                "; ");
}

bool is_in_doubt(const Json& facts) {
  return !reason_clause(facts, Reason::kQuestionInDoubt).empty();
}

std::string open_words(const Json& facts, const std::string& unit) {
  return joined({reason_clause(facts, Reason::kNear), reason_clause(facts, Reason::kFew),
                 reason_clause(facts, Reason::kErrorsExceedMargin),
                 reason_clause(facts, Reason::kQuestionInDoubt), unseen_clause(facts, unit)},
                ", ");
}

std::string ignored_words(const Json& facts, bool noun) {
  const Json ignored = member(facts, "ignored");
  if (ignored.is_null() || ignored["points"] == 0) return "";
  const auto points = ignored["points"].get<std::uint64_t>();
  const std::string text = (noun ? counted(points, "point") : format_count(points)) + " ignored";
  const Json& colliding = ignored["colliding"];
  if (colliding.is_null()) return text;
  return text + ", of which " + format_count(colliding.get<std::uint64_t>()) + " would collide";
}

std::string floor_clause(const Json& facts, const std::string& unit) {
  const Json floor = member(facts, "floor");
  if (floor.is_null()) return "";
  return format_count(floor["colliding"].get<std::uint64_t>()) + " below " +
         floor_words(floor, unit) + " not judged";
}

}  // namespace clearway::campaign
