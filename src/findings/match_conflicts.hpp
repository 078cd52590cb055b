#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "clearway/conflicts.hpp"
#include "clearway/result.hpp"
#include "findings/searched_places.hpp"

namespace clearway {

/// Some of the points of a conflict.
struct ConflictPart {
  std::uint32_t conflict = 0;  ///< id of the conflict
  std::uint64_t points = 0;
  std::uint64_t source = 0;  ///< smallest source index of the points
  Box box{};                 ///< box around the points, metres
  /// The least first pose and the greatest last pose of the points
  std::uint32_t first_pose = 0, last_pose = 0;
};

/// A part of a conflict of a that b has no point near, and would not have found either.
struct NotSearched : ConflictPart {
  /// Why b would not have found it, in alphabetical order: words of SearchedPlaces.
  std::vector<std::string> reasons;
};

/// Which conflicts two results have in common, by their ids.
struct ConflictMatch {
  /// Ids of a and of b, ascending. A conflict of either is paired with the one of the other that
  /// most of its points are near, so one that fell into two, or two that became one, are in several
  /// pairs.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> same;
  /// Ids of conflicts of a that b has no point near, although it would have found them.
  std::vector<std::uint32_t> gone;
  /// Ids of conflicts of a of which b has left a group that is too small to be listed.
  std::vector<std::uint32_t> shrunk;
  std::vector<NotSearched> not_searched;  ///< by ascending id; part of one may be the same in b
  std::vector<std::uint32_t> added;       ///< ids of conflicts of b that a has no conflict near
  /// The points of b's other conflicts near which a has no point, by ascending id.
  std::vector<ConflictPart> grown;
  /// Small groups of b, as indices of Conflicts::small, that have a point without any of a near.
  std::vector<std::size_t> small;
};

/// Matches conflicts of two results point by point: a point is near another one at most `gap` away,
/// by the exact distance. Points of small groups count as points. tolerance: points of a that do
/// not collide, but whose clearance is at most the radius and this, count as well, so that a
/// surface which is just not touched in one of two scans is not new in the other. Throws as reading
/// the tables does.
ConflictMatch match_conflicts(const GroupedResult& a, const GroupedResult& b, double gap,
                              double tolerance);

}  // namespace clearway
