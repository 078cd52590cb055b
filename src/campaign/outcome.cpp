#include "campaign/outcome.hpp"

#include <algorithm>
#include <numeric>
#include <optional>

#include "core/util/format.hpp"

namespace clearway::campaign {
namespace {

using nlohmann::ordered_json;

std::string warning_words(const ordered_json& facts) {
  const ordered_json& codes = facts["warnings"];
  if (codes.empty()) return "";
  std::string text = counted(codes.size(), "warning") + " (";
  for (const auto& code : codes) {
    text += (text.ends_with('(') ? "" : ", ") + code.get<std::string>();
  }
  return text + ")";
}

}  // namespace

const OutcomeWords& words_of(Outcome outcome) {
  static constexpr std::array<OutcomeWords, kOutcomes.size()> kWords{
      {{"conflict", "■", "conflict", "conflict: a point is closer than the radius"},
       {"undecided", "?", "undecided",
        "undecided: the search could not have found anything, and the warnings say why"},
       {"doubtful", "△", "clear with warnings",
        "clear, but something was warned of: read the warnings below"},
       {"clear", "○", "clear", "clear: no point is closer than the radius"},
       {"failed", "✕", "failed", "failed: nothing is known"},
       {"not_done", "…", "not done",
        "not done yet, or a file has changed since: nothing is known"}}};
  return kWords.at(static_cast<std::size_t>(outcome));
}

Outcome outcome_of(const TaskLook& look) {
  if (look.status == TaskStatus::kFailed) return Outcome::kFailed;
  if (look.status != TaskStatus::kDone) return Outcome::kUnfinished;
  const ordered_json& facts = look.state->facts;
  if (facts["verdict"] == "clear") {
    return facts["warnings"].empty() ? Outcome::kClear : Outcome::kDoubtful;
  }
  return facts["verdict"] == "conflict" ? Outcome::kConflict : Outcome::kUndecided;
}

RunLooks run_looks(const Plan& plan, const std::vector<TaskLook>& looks) {
  RunLooks runs{{plan.name, {}}, {}};
  std::optional<TaskLook> failed;  // one of the shards that come before their run
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

OutcomeCounts::OutcomeCounts(const std::vector<TaskLook>& looks) {
  for (const TaskLook& look : looks) ++counts_.at(static_cast<std::size_t>(outcome_of(look)));
}

std::size_t OutcomeCounts::all() const {
  return std::accumulate(counts_.begin(), counts_.end(), std::size_t{0});
}

std::string OutcomeCounts::text() const {
  std::string text = counted(all(), "run") + ": ";
  for (const Outcome outcome : kOutcomes) {
    text += (outcome == kOutcomes.front() ? "" : ", ") + format_count(of(outcome)) + " " +
            words_of(outcome).word;
  }
  return text;
}

ordered_json OutcomeCounts::json() const {
  ordered_json out;
  for (const Outcome outcome : kOutcomes) out[words_of(outcome).name] = of(outcome);
  return out;
}

std::string ignored_words(const ordered_json& facts) {
  const ordered_json ignored = facts.value("ignored", ordered_json());
  if (ignored.is_null() || ignored["points"] == 0) return "";
  std::string text = counted(ignored["points"].get<std::uint64_t>(), "point") + " ignored";
  if (const ordered_json& colliding = ignored["colliding"]; !colliding.is_null()) {
    text += ", of which " + format_count(colliding.get<std::uint64_t>()) + " would collide";
  }
  return text;
}

bool is_exact(const ordered_json& facts) { return facts.value("exact", true); }

std::string caveats_of(const ordered_json& facts) {
  std::string text;
  for (const std::string& one : {warning_words(facts), ignored_words(facts),
                                 std::string(is_exact(facts) ? "" : "not exact")}) {
    if (!one.empty()) text += (text.empty() ? "" : "; ") + one;
  }
  return text;
}

}  // namespace clearway::campaign
