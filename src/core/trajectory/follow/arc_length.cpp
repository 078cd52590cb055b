#include "core/trajectory/follow/arc_length.hpp"

#include <array>
#include <cmath>

namespace clearway {
namespace {

/// The Gauss-Legendre rule with eight places on [-1, 1], of which this is one half.
struct Node {
  double place, weight;
};
constexpr std::array<Node, 4> kNodes{{{0.18343464249564980, 0.36268378337836198},
                                      {0.52553240991632899, 0.31370664587788729},
                                      {0.79666647741362674, 0.22238103445337447},
                                      {0.96028985649753623, 0.10122853629037626}}};

double by_eight_places(const PositionCurve& curve, double from, double to) {
  const double middle = from + (to - from) / 2, half = (to - from) / 2;
  double sum = 0;
  for (const Node& node : kNodes) {
    const double away = half * node.place;
    sum +=
        node.weight * (curve.velocity(middle - away).norm() + curve.velocity(middle + away).norm());
  }
  return sum * half;
}

/// Greatest number of halvings, deep enough for a cusp: beyond it no two parameters of the interval
/// differ.
constexpr int kMostHalvings = 40;

double refined(const PositionCurve& curve, double from, double to, double whole, int halvings) {
  const double middle = from + (to - from) / 2;
  const double left = by_eight_places(curve, from, middle);
  const double right = by_eight_places(curve, middle, to);
  const double sum = left + right;
  if (halvings == 0 || !(std::abs(sum - whole) > 1e-12 + 1e-15 * sum)) return sum;
  return refined(curve, from, middle, left, halvings - 1) +
         refined(curve, middle, to, right, halvings - 1);
}

}  // namespace

double arc_length(const PositionCurve& curve, double from, double to) {
  return refined(curve, from, to, by_eight_places(curve, from, to), kMostHalvings);
}

double parameter_at(const PositionCurve& curve, double length, double whole) {
  if (!(length > 0)) return 0;
  if (!(length < whole)) return 1;
  double low = 0, high = 1, at = length / whole;
  double low_length = 0;
  // Halving alone would end after 60 tries, so this many always suffice.
  for (int tries = 0; tries < 120; ++tries) {
    const double here = low_length + arc_length(curve, low, at);
    const double missing = length - here;
    if (std::abs(missing) <= 1e-13 + 1e-16 * whole) break;
    if (missing > 0) {
      low = at;
      low_length = here;
    } else {
      high = at;
    }
    const double next = at + missing / curve.velocity(at).norm();
    at = next > low && next < high ? next : low + (high - low) / 2;
    if (!(at > low && at < high)) break;
  }
  return at;
}

}  // namespace clearway
