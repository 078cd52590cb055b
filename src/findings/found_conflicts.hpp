#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "clearway/conflicts.hpp"
#include "clearway/ledger.hpp"
#include "io/result/result_header.hpp"

namespace clearway {

/// Conflicts with what they were found for. A program that needs them twice finds them once.
struct FoundConflicts {
  Conflicts conflicts;
  std::vector<std::uint32_t> conflict_of;  ///< as find_conflicts() gives it
  ResultQuestion question;                 ///< that of the result
  ConflictOptions options;                 ///< pointers and spans in it are not followed
  std::optional<Ledger> ledger = {};       ///< where they were compared with one

  /// Whether these are the conflicts of a result with other options. Threads, memory and what
  /// watches the call change nothing of them; models, bodies and stations are those of the result.
  bool are_of(const ResultQuestion& asked, const ConflictOptions& with) const {
    return question == asked && options.gap == with.gap && options.min_points == with.min_points &&
           options.split == with.split && options.chainage_start == with.chainage_start &&
           options.forward == with.forward && options.up == with.up &&
           (options.model == nullptr) == (with.model == nullptr) &&
           options.bodies.size() == with.bodies.size() &&
           options.station.size() == with.station.size();
  }
};

}  // namespace clearway
