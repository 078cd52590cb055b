#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "clearway/conflicts.hpp"

namespace clearway {

/// Conflicts of two results, by their ids.
struct ConflictMatch {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> same;  ///< of a and of b, ascending
  std::vector<std::uint32_t> gone;                            ///< only of a
  std::vector<std::uint32_t> added;                           ///< only of b
};

/// Matches by place, one with one: two may match whose boxes, each grown by the gap on every side,
/// overlap, or that touch as they are. Those that overlap most come first; of equal ones those of
/// smaller ids.
ConflictMatch match_conflicts(const Conflicts& a, const Conflicts& b, double gap);

}  // namespace clearway
