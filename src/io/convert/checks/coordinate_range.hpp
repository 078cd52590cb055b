#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "clearway/vec3.hpp"

namespace clearway {

/// A point of the inputs, by file and number in it.
struct InputPoint {
  Vec3 at;
  std::size_t file = 0;
  std::uint64_t point = 0;
};

/// The range of the points' coordinates, and which of them lie far from the others: in one pass, in
/// constant memory, a function of the points in their order.
class CoordinateRange {
 public:
  /// The points that lie farther than `reach` from the median on some axis.
  struct Far {
    std::vector<InputPoint> points;  ///< in the order of the inputs; not all where `more`
    bool more = false;               ///< there may be others; the rest is not known then
    Vec3 lo{}, hi{};                 ///< of the rest
  };

  /// p: finite.
  void add(const Vec3& p, std::size_t file, std::uint64_t point);

  bool empty() const { return count_ == 0; }
  double lo(int axis) const { return extremes_[side(axis, false)].front().at[axis]; }
  double hi(int axis) const { return extremes_[side(axis, true)].front().at[axis]; }
  /// The point with the least or greatest coordinate.
  const InputPoint& extreme(int axis, bool greatest) const {
    return extremes_[side(axis, greatest)].front();
  }

  Far far_points(double reach) const;
  /// Every n-th point.
  const std::vector<Vec3>& samples() const { return samples_; }

 private:
  static constexpr std::size_t kKept = 16;  // on each side of each axis
  static constexpr std::size_t kMostSamples = std::size_t{1} << 14;

  static std::size_t side(int axis, bool greatest) {
    return 2 * static_cast<std::size_t>(axis) + (greatest ? 1 : 0);
  }
  void keep(std::size_t side, int axis, bool greatest, const InputPoint& p);
  double median(int axis) const;

  std::array<std::vector<InputPoint>, 6> extremes_;  // the most extreme first
  std::vector<Vec3> samples_;                        // of every (mask + 1)-th point
  std::uint64_t sample_mask_ = 0;
  std::uint64_t count_ = 0;
};

}  // namespace clearway
