#include "clearway/ledger.hpp"

#include <optional>
#include <system_error>

#include "clearway/error.hpp"
#include "core/util/progress.hpp"
#include "findings/ledger/judge_ledger.hpp"
#include "findings/ledger/ledger_files.hpp"
#include "io/result/answer.hpp"
#include "io/result/result.hpp"
#include "search/ledger_evidence.hpp"

namespace clearway {
namespace {

constexpr double kWorseBy = 0.02;  // metres

Day day_of_run(const std::string& date) {
  if (date.empty()) return today();
  const auto read = day_of(date);
  if (!read) throw UsageError("the day \"" + date + "\": expected one such as 2026-06-30");
  return read->day;
}

/// Reads a ledger, or begins one where there is none and it may be made.
LedgerFiles open_ledger(const LedgerOptions& options, const std::string& unit) {
  const std::string name = options.table.string();
  if (options.table.extension() != ".csv") {
    throw UsageError(name + ": expected the name of a table that ends in .csv");
  }
  const std::filesystem::path places = places_of(options.table);
  std::error_code unknown;
  const auto exists = [&](const std::filesystem::path& path) {
    return std::filesystem::exists(path, unknown);
  };
  // A first update puts the places there before the table.
  for (int waits = 0; !exists(options.table) && exists(places);) {
    if (!wait_for_update(options.table, waits)) break;
  }
  if (exists(options.table)) return read_ledger(options.table, unit);
  if (exists(places)) {
    throw InputError(name + ": is missing, and its places are there: " + places.string() + "; " +
                     advice_on_missing_table(options.table, unit));
  }
  if (!options.update) {
    throw UsageError(name + ": does not exist", Remedy::kMakeLedger);
  }
  return {};
}

/// The options with the table itself where they name a link to it, because its places are beside
/// it.
LedgerOptions with_real_table(LedgerOptions options) {
  std::error_code unknown;
  const std::filesystem::path real = std::filesystem::canonical(options.table, unknown);
  if (!unknown && std::filesystem::is_symlink(options.table, unknown)) options.table = real;
  return options;
}

/// What is left without the accepted conflicts.
OutsideOfAccepted outside_of(const GroupedResult& found, const Ledger& ledger) {
  OutsideOfAccepted out;
  const auto is_accepted = [&](std::uint32_t conflict) {
    return conflict > 0 && ledger.conflicts[conflict - 1].status == LedgerStatus::kAccepted;
  };
  for (const std::uint32_t conflict : found.conflict_of) out.colliding += !is_accepted(conflict);
  for (const std::uint32_t conflict : found.conflict_of_near) out.near += !is_accepted(conflict);
  Answer answer = counted_answer(found.result.reader());
  answer.colliding_points = 0;
  answer.near_points = out.near;
  answer.certain = {};
  out.verdict = out.colliding > 0 ? Verdict::kConflict : answer.verdict();
  return out;
}

}  // namespace

Ledger apply_ledger(const GroupedResult& found, const ConflictOptions& find,
                    const LedgerOptions& given) {
  const LedgerOptions options = with_real_table(given);
  const ResultHeader& header = found.result.reader().header();
  const std::string unit = symbol_of(unit_of(header));
  CallbackProgress progress(options.progress, options.stop);
  LedgerJudging how;
  how.today = day_of_run(options.date);
  how.metre = 1 / metres_per_unit(header);
  how.worse_by = options.worse_by.value_or(kWorseBy * how.metre);
  LedgerFiles files = open_ledger(options, unit);
  const LedgerEvidence evidence(found, find, options, progress);
  how.why_not_gone = [&](std::span<const LedgerPlaces* const> rows) {
    return evidence.why_not_gone(rows);
  };
  std::optional<LedgerUpdate> update;
  if (options.update) {
    update.emplace(options.table, &progress);
    files = open_ledger(options, unit);  // nobody else changes it from here on
  }
  Ledger ledger = judge_ledger(found, files, how);
  if (update) {
    update_ledger(found, how, ledger, files);
    update->publish(files, unit);
  }
  ledger.outside = outside_of(found, ledger);
  return ledger;
}

}  // namespace clearway
