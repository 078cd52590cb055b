#include "findings/group/near_cells.hpp"

#include <cstddef>
#include <limits>

namespace clearway {
namespace {

/// Up to this number, comparing all pairs is cheaper than looking for the nearest points.
constexpr std::size_t kFewPairs = 64;
/// Up to this number, comparing all pairs is cheaper than building trees.
constexpr std::size_t kAllPairs = 4096;

/// A place, which need not be that of a point, in units of the gap.
struct Target {
  double x, y, z;
};

Target target_at(const Neighbourhood& neighbourhood, const GridPoint& p) {
  return {p.q[0] * neighbourhood.step(0), p.q[1] * neighbourhood.step(1),
          p.q[2] * neighbourhood.step(2)};
}

Target middle_of(const Neighbourhood& neighbourhood, std::span<const GridPoint> points) {
  const Target a = target_at(neighbourhood, points.front());
  const Target b = target_at(neighbourhood, points[points.size() / 2]);
  return {(a.x + b.x) / 2, (a.y + b.y) / 2, (a.z + b.z) / 2};
}

/// The point nearest to a place by double precision, which is a guess.
const GridPoint& nearest(const Neighbourhood& neighbourhood, std::span<const GridPoint> points,
                         const Target& target) {
  double least = std::numeric_limits<double>::infinity();
  std::size_t best = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Target p = target_at(neighbourhood, points[i]);
    const double x = p.x - target.x, y = p.y - target.y, z = p.z - target.z;
    const double squared = x * x + y * y + z * z;
    if (squared < least) {
      least = squared;
      best = i;
    }
  }
  return points[best];
}

}  // namespace

bool any_neighbours(const Neighbourhood& neighbourhood, std::span<const GridPoint> a,
                    std::span<const GridPoint> b) {
  for (const GridPoint& p : a) {
    for (const GridPoint& q : b) {
      if (are_neighbours(neighbourhood, p, q)) return true;
    }
  }
  return false;
}

Nearness compare_cells(const Neighbourhood& neighbourhood, std::span<const GridPoint> a,
                       std::span<const GridPoint> b) {
  const std::size_t pairs = a.size() * b.size();
  if (pairs > kFewPairs) {
    if (are_neighbours(neighbourhood, a.front(), b.front())) return Nearness::kNear;
    const GridPoint* in_a = &nearest(neighbourhood, a, middle_of(neighbourhood, b));
    const GridPoint* in_b = &nearest(neighbourhood, b, target_at(neighbourhood, *in_a));
    if (are_neighbours(neighbourhood, *in_a, *in_b)) return Nearness::kNear;
    in_a = &nearest(neighbourhood, a, target_at(neighbourhood, *in_b));
    if (are_neighbours(neighbourhood, *in_a, *in_b)) return Nearness::kNear;
    if (pairs > kAllPairs) return Nearness::kOpen;
  }
  return any_neighbours(neighbourhood, a, b) ? Nearness::kNear : Nearness::kFar;
}

}  // namespace clearway
