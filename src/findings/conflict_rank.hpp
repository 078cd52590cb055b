#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "clearway/conflicts.hpp"

namespace clearway {

/// The shorter of the conflict's own shifts; infinity where it has none.
inline double least_own_shift(const Conflict& c) {
  const double none = std::numeric_limits<double>::infinity();
  return std::min(c.own_shift_left.value_or(none), c.own_shift_right.value_or(none));
}

/// The least of the conflict's trims; none where it has none.
inline std::optional<double> least_trim(const Conflict& c) {
  std::optional<double> least;
  for (const auto& trim : {c.trim_left, c.trim_right, c.trim_above, c.trim_below}) {
    if (trim && (!least || *trim < *least)) least = trim;
  }
  return least;
}

/// Orders conflicts from the worst on: first those with points inside a solid, the deepest first;
/// then the others of which points collide, by the least that is known to free them, the largest
/// first; then those whose points are only near, the nearest first. Equal ones are ordered by their
/// points, most first, and then along the path.
class WorseFirst {
 public:
  explicit WorseFirst(const Conflicts& of)
      : knows_shifts_(of.knows_shifts), knows_trims_(of.knows_trims) {}

  bool operator()(const Conflict& a, const Conflict& b) const {
    const auto of_a = key(a), of_b = key(b);
    if (of_a != of_b) return of_a < of_b;
    if (a.points != b.points) return a.points > b.points;
    return a.id < b.id;
  }

 private:
  /// The kind of a conflict, and what orders those of a kind; the worst first.
  std::pair<int, double> key(const Conflict& c) const {
    if (c.depth.value_or(0) > 0 && !c.depth_source) return {0, -*c.depth};
    if (c.colliding > 0) return {1, -least_that_frees(c)};
    return {2, c.least_distance.value_or(kNone)};
  }

  /// The least of the known shifts and trims, where none that exists is infinite; 0 if none is
  /// known.
  double least_that_frees(const Conflict& c) const {
    if (!knows_shifts_ && !knows_trims_) return 0;
    const double shift = knows_shifts_ ? least_own_shift(c) : kNone;
    return knows_trims_ ? std::min(shift, least_trim(c).value_or(kNone)) : shift;
  }

  static constexpr double kNone = std::numeric_limits<double>::infinity();
  bool knows_shifts_, knows_trims_;
};

/// Sets the rank of each conflict, 1 for the worst.
inline void rank(Conflicts& conflicts) {
  std::vector<Conflict*> order;
  for (Conflict& conflict : conflicts.listed) order.push_back(&conflict);
  std::ranges::sort(order, [worse = WorseFirst(conflicts)](const Conflict* a, const Conflict* b) {
    return worse(*a, *b);
  });
  for (std::size_t i = 0; i < order.size(); ++i) {
    order[i]->rank = static_cast<std::uint32_t>(i + 1);
  }
}

/// The conflicts from the worst on.
inline std::vector<const Conflict*> by_rank(const Conflicts& conflicts) {
  std::vector<const Conflict*> out;
  for (const Conflict& conflict : conflicts.listed) out.push_back(&conflict);
  std::ranges::sort(out, {}, &Conflict::rank);
  return out;
}

}  // namespace clearway
