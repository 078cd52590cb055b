#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "clearway/conflicts.hpp"

namespace clearway {

/// Which conflicts two results have in common, by their ids.
struct ConflictMatch {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> same;  ///< ids of a and of b, ascending
  std::vector<std::uint32_t> gone;                            ///< ids of conflicts that only a has
  std::vector<std::uint32_t> added;                           ///< ids of conflicts that only b has
};

/// Matches conflicts of two results by place, one with one. Two conflicts may match where their
/// boxes, each grown by the gap on every side, overlap, or where the boxes touch as they are. Pairs
/// that overlap most are matched first; among equal pairs, those with smaller ids.
ConflictMatch match_conflicts(const Conflicts& a, const Conflicts& b, double gap);

}  // namespace clearway
