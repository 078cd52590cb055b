#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "clearway/conflicts.hpp"
#include "clearway/ledger.hpp"
#include "findings/ledger/ledger_date.hpp"
#include "findings/ledger/ledger_files.hpp"

namespace clearway {

/// How the conflicts of a result are judged by a ledger.
struct LedgerJudging {
  Day today;
  double worse_by = 0;  ///< in the unit of the environment
  double metre = 1;     ///< length of a metre in that unit
  /// Why this run does not show that nothing is at the places of rows any more: for each of them a
  /// text, or an empty one where it is shown. Not called without rows.
  std::function<std::vector<std::string>(std::span<const LedgerPlaces* const>)> why_not_gone;
};

/// Judges the rows of a ledger and the conflicts of a result. Changes no file. `outside` of the
/// return value is left to the caller.
Ledger judge_ledger(const GroupedResult& found, const LedgerFiles& files, const LedgerJudging& how);

/// Takes what was judged into the ledger: new places and values of rows that are not accepted, the
/// day on which rows were last seen, rows for conflicts that have none, and the status of what is
/// gone or there again. Rows that it adds are added to `judged` too.
void update_ledger(const GroupedResult& found, const LedgerJudging& how, Ledger& judged,
                   LedgerFiles& files);

}  // namespace clearway
