#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/util/progress.hpp"
#include "findings/ledger/ledger_places.hpp"
#include "findings/ledger/ledger_table.hpp"
#include "io/files/pending_file.hpp"

namespace clearway {

/// The table of a ledger with the places of its rows.
struct LedgerFiles {
  LedgerTable table;
  /// Of each row; none for a row that somebody added by hand, or where there is no places file.
  std::vector<std::optional<LedgerPlaces>> places;
};

/// Reads a ledger. unit: the name of the unit of the result. Throws InputError where the table is
/// none of a ledger, or table and places are of different runs. A table without a places file has
/// no places.
LedgerFiles read_ledger(const std::filesystem::path& table, const std::string& unit);

/// What to do where there are places and no table. Throws as read_places().
std::string advice_on_missing_table(const std::filesystem::path& table, const std::string& unit);

/// Waits a moment where another process is writing the ledger, at most so often. Returns whether it
/// did, so that the files are to be read again.
bool wait_for_update(const std::filesystem::path& table, int& waits);

/// A ledger that is about to be replaced. Holds both files from its construction on, so that no
/// other process changes them between reading and writing.
class LedgerUpdate {
 public:
  /// How long an update waits for that of another process, which may have to read the whole store.
  static constexpr std::chrono::seconds kMostWait{600};

  /// Waits while another process updates the ledger, which is a stage of `progress` unless null.
  /// Throws ResourceError where it takes longer than most_wait, and Interrupted.
  explicit LedgerUpdate(const std::filesystem::path& table, Progress* progress = nullptr,
                        std::chrono::milliseconds most_wait = kMostWait);

  /// Replaces both files. The places come first: killed in between, the new table is complete
  /// under its partial name.
  void publish(const LedgerFiles& files, const std::string& unit);

 private:
  std::filesystem::path path_;
  std::optional<PendingFile> table_, places_;
};

}  // namespace clearway
