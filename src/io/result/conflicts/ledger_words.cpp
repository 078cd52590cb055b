#include "io/result/conflicts/ledger_words.hpp"

#include <cstddef>
#include <vector>

#include "clearway/answer.hpp"
#include "core/describe/ledger.hpp"
#include "core/util/format.hpp"
#include "io/result/conflicts/conflict_fields.hpp"

namespace clearway {
namespace {

template <typename Columns, typename Row>
Json row_json(const Columns& columns, const Row& row) {
  std::vector<ConflictField> fields;
  add_fields(fields, columns, row);
  return json_of(fields);
}

}  // namespace

Json ledger_json(const Ledger& ledger) {
  Json out{{"date", ledger.date}};
  const LedgerCounts counts = ledger.counts();
  for (std::size_t i = 0; i < counts.size(); ++i) {
    out[name_of(static_cast<LedgerStatus>(i))] = counts[i];
  }
  out["accepted_conflicts"] = ledger.accepted_conflicts();
  out["outside"] = {{"verdict", name_of(ledger.outside.verdict)},
                    {"colliding_points", ledger.outside.colliding},
                    {"near_points", ledger.outside.near}};
  out["rows"] = Json::array();
  for (const LedgerRow& row : ledger.rows) {
    Json one = row_json(kLedgerRowColumns, row);
    one["conflicts"] = row.conflicts;
    one["lo"] = row.box ? Json(row.box->lo) : Json();
    one["hi"] = row.box ? Json(row.box->hi) : Json();
    out["rows"].push_back(one);
  }
  out["conflicts"] = Json::array();
  for (const LedgerEntry& entry : ledger.conflicts) {
    out["conflicts"].push_back(row_json(kLedgerEntryColumns, entry));
  }
  return out;
}

std::string ledger_counts_words(const Ledger& ledger) {
  std::string out;
  const LedgerCounts counts = ledger.counts();
  for (std::size_t i = 0; i < counts.size(); ++i) {
    if (counts[i] == 0) continue;
    out += (out.empty() ? "" : ", ") + format_count(counts[i]) + " " +
           name_of(static_cast<LedgerStatus>(i));
  }
  return out.empty() ? "empty" : out;
}

std::string ledger_sentence(const Ledger& ledger) {
  const std::uint64_t accepted = ledger.accepted_conflicts(), all = ledger.conflicts.size();
  if (all == 0) return "";
  std::string out;
  if (accepted == 0) {
    out = all == 1 ? "The ledger does not accept the conflict"
                   : "The ledger accepts none of the " + counted(all, "conflict");
  } else if (accepted == all) {
    out = all == 1 ? "The ledger accepts the conflict"
                   : "The ledger accepts all " + counted(all, "conflict");
  } else {
    out = "The ledger accepts " + format_count(accepted) + " of the " + counted(all, "conflict");
  }
  switch (ledger.outside.verdict) {
    case Verdict::kConflict:
      if (accepted == all) {
        out += ", but " + counted(ledger.outside.colliding, "point") +
               (ledger.outside.colliding == 1 ? " of a small group collides"
                                              : " of small groups collide");
      }
      return out + ".";
    case Verdict::kUndecided:
      return out + "; without what is accepted the verdict would be undecided.";
    default:
      return out + "; without what is accepted the verdict would be clear.";
  }
}

}  // namespace clearway
