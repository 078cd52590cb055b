#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "clearway/conflicts.hpp"
#include "clearway/result.hpp"

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

/// A result with its conflicts.
struct GroupedResult {
  const Result& result;
  const Conflicts& conflicts;
  /// The conflict of each row; 0 for rows of small groups.
  std::span<const std::uint32_t> conflict_of;
};

/// Looks again at conflicts of b for which matching by boxes found no partner: another scan of the
/// same things has other points, so that a group falls into two, or a few points stand apart. A
/// conflict that `match` calls new becomes one of the same where each of its points has, within the
/// gap, a point of a conflict of a; it is then matched with the conflict that most of its points
/// are near. Returns the small groups of b, as indices of Conflicts::small, that have a point
/// without any colliding point of a within the gap.
std::vector<std::size_t> match_points(const GroupedResult& a, const GroupedResult& b, double gap,
                                      ConflictMatch& match);

}  // namespace clearway
