#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "clearway/answer.hpp"
#include "clearway/box.hpp"
#include "clearway/conflicts.hpp"
#include "clearway/progress.hpp"
#include "clearway/store.hpp"

/// The life of conflicts: a table of them that people edit, by which those of the next scan are
/// recognised.
namespace clearway {

/// What a ledger says of a row or of a conflict. Its table has the first four; the others are found
/// in each run (docs/design/findings.md).
enum class LedgerStatus {
  kNew,       ///< no row knew the conflict, or nobody has decided about its row yet
  kOpen,      ///< somebody has to act
  kAccepted,  ///< the owner of the row has accepted it
  kResolved,  ///< it was removed
  kWorse,     ///< accepted, but it has become worse, so that it counts as open
  kExpired,   ///< accepted until a day that is over, so that it counts as open
  kGone,      ///< the run shows that nothing collides there any more
  /// No conflict is there, but the run does not show that it is gone.
  kNotSearched
};
inline constexpr std::size_t kLedgerStatuses = 8;

/// "new", "open", "accepted", "resolved", "worse", "expired", "gone" or "not-searched"
inline const char* name_of(LedgerStatus status) {
  constexpr std::array<const char*, kLedgerStatuses> kNames{
      "new", "open", "accepted", "resolved", "worse", "expired", "gone", "not-searched"};
  return kNames[static_cast<std::size_t>(status)];
}

/// Numbers of rows by status, in the order of LedgerStatus.
using LedgerCounts = std::array<std::uint64_t, kLedgerStatuses>;

/// A row of a ledger.
struct LedgerRow {
  std::string key;  ///< its name in the table
  /// Its status in the table: kNew, kOpen, kAccepted or kResolved.
  LedgerStatus status = LedgerStatus::kNew;
  LedgerStatus shown = LedgerStatus::kNew;  ///< its status in this run
  std::string why;                          ///< why `shown` is not `status`; otherwise mostly empty
  std::string owner, comment, until;        ///< what the table has there
  std::vector<std::uint32_t> conflicts;     ///< ids of the conflicts that belong to it, ascending
  std::optional<Box> box;                   ///< box around its places; none without places
  std::string first_seen, last_seen;        ///< days on which it was found, as in 2026-06-30
};

/// What the ledger says of a conflict.
struct LedgerEntry {
  std::uint32_t conflict = 0;  ///< Conflict::id
  LedgerStatus status = LedgerStatus::kNew;
  std::string key;                    ///< of the row that decides; empty where it has none
  std::string why;                    ///< as of LedgerRow
  std::string owner, comment, until;  ///< of the row that decides
};

/// What is left of an answer without the accepted conflicts.
struct OutsideOfAccepted {
  std::uint64_t colliding = 0;  ///< colliding points in no accepted conflict
  std::uint64_t near = 0;       ///< near points in no accepted conflict
  /// kConflict where a colliding point is left, of a small group too; otherwise what the verdict
  /// would be if the points of accepted conflicts were not there.
  Verdict verdict = Verdict::kUnknown;
};

/// A ledger after it was compared with a result.
struct Ledger {
  std::vector<LedgerRow> rows;  ///< in the order of the table; those that an update adds come last
  std::vector<LedgerEntry> conflicts;  ///< of each listed conflict, by its id
  std::string date;                    ///< the day of the run, as in 2026-06-30
  /// Whether rows were added for conflicts that had none.
  bool is_updated = false;
  OutsideOfAccepted outside;

  /// The number of rows and of conflicts without a row by status.
  LedgerCounts counts() const {
    LedgerCounts counts{};
    for (const LedgerRow& row : rows) ++counts[static_cast<std::size_t>(row.shown)];
    for (const LedgerEntry& entry : conflicts) {
      if (entry.key.empty()) ++counts[static_cast<std::size_t>(entry.status)];
    }
    return counts;
  }
  std::uint64_t accepted_conflicts() const {
    std::uint64_t count = 0;
    for (const LedgerEntry& entry : conflicts) count += entry.status == LedgerStatus::kAccepted;
    return count;
  }
};

struct LedgerOptions {
  /// The table, a CSV file; its places are in a file beside it, whose name ends in .places.h5 in
  /// place of .csv.
  std::filesystem::path table;
  /// Whether to write what was found into both files; they are made if they do not exist.
  bool update = false;
  /// An accepted conflict is worse if it is nearer, or needs a larger shift or trim, by more than
  /// this; in the unit of the environment. None: 0.02 m.
  std::optional<double> worse_by = {};
  /// The day of the run, as in 2026-06-30, which `until` is compared with; empty: today in UTC.
  std::string date = {};
  /// The store that was searched. Without it, or without the model in the conflicts' options, no
  /// row is gone.
  const Store* store = nullptr;
  std::uint64_t memory_bytes = std::uint64_t{4} << 30;
  int threads = 0;  ///< 0: all cores
  ProgressCallback progress = nullptr;
  StopFlag stop = nullptr;
};

/// Compares the conflicts of a result with a ledger, and updates it where options.update is set.
/// find: the options with which the conflicts were found; their model or bodies are those of the
/// search. Throws InputError for a table that is not a ledger's, for a table and places of
/// different runs, and where store, model, bodies or poses are not those of the result; UsageError
/// for a table that does not exist without an update; ResourceError where another process writes
/// the ledger.
Ledger apply_ledger(const GroupedResult& found, const ConflictOptions& find,
                    const LedgerOptions& options);

}  // namespace clearway
