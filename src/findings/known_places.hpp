#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "clearway/conflicts.hpp"
#include "clearway/result.hpp"
#include "findings/match_conflicts.hpp"

namespace clearway {

/// A result with its conflicts.
struct GroupedResult {
  const Result& result;
  const Conflicts& conflicts;
  std::span<const std::uint32_t> conflict_of;  ///< of each row, 0: of a small group
};

/// Looks at what box by box found no partner: another scan of the same things has other points, so
/// that a group falls into two, or a few points stand apart. A conflict of b that `match` calls new
/// is moved to the same ones where each of its points has, within the gap, a point of a conflict of
/// a; it then goes with the one that most of its points are near. Returns the small groups of b, as
/// indices of Conflicts::small, that have a point without any colliding point of a within the gap.
std::vector<std::size_t> match_points(const GroupedResult& a, const GroupedResult& b, double gap,
                                      ConflictMatch& match);

}  // namespace clearway
