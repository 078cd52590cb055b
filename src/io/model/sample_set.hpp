#pragma once

#include <cstdint>
#include <vector>

#include "clearway/vec3.hpp"

namespace clearway {

/// Points in a hash grid that finds those within a reach.
class SampleSet {
 public:
  /// reach: above 0; coordinates are at most 2^31 times as large.
  explicit SampleSet(double reach) : reach_(reach), heads_(1024, kNone) {}

  const std::vector<Vec3>& points() const { return points_; }
  std::vector<Vec3> take_points() { return std::move(points_); }
  std::size_t size() const { return points_.size(); }

  void add(const Vec3& point);

  /// Calls use(point) until it returns true, at most kMostLooks times and the last added point
  /// first. It is called for the points within the reach of `place`, except for some at the reach
  /// up to rounding, and for some farther ones. Returns whether `use` returned true.
  template <typename Use>
  bool any_near(const Vec3& place, Use use) const {
    const Cell middle = cell_of(place);
    std::uint32_t looks = 0;
    for (std::int64_t x = middle.x - 1; x <= middle.x + 1; ++x) {
      for (std::int64_t y = middle.y - 1; y <= middle.y + 1; ++y) {
        for (std::int64_t z = middle.z - 1; z <= middle.z + 1; ++z) {
          for (std::uint32_t i = heads_[slot_of({x, y, z})]; i != kNone; i = next_[i]) {
            if (use(points_[i])) return true;
            if (++looks == kMostLooks) return false;
          }
        }
      }
    }
    return false;
  }

 private:
  static constexpr std::uint32_t kNone = ~std::uint32_t{0};
  /// Most calls of `use` in any_near(). Without a limit, all vertices of a fine part that a coarse
  /// triangle passes would be examined for each of the triangle's places.
  static constexpr std::uint32_t kMostLooks = 1024;

  struct Cell {
    std::int64_t x, y, z;
  };

  Cell cell_of(const Vec3& point) const;
  /// The slot of a cell; cells that share a slot share their points.
  std::size_t slot_of(const Cell& cell) const {
    std::uint64_t hash = static_cast<std::uint64_t>(cell.x) * 0x9E3779B97F4A7C15;
    hash = (hash ^ (hash >> 32) ^ static_cast<std::uint64_t>(cell.y)) * 0xD6E8FEB86659FD93;
    hash = (hash ^ (hash >> 32) ^ static_cast<std::uint64_t>(cell.z)) * 0xD6E8FEB86659FD93;
    return (hash ^ (hash >> 32)) & (heads_.size() - 1);
  }
  void grow();

  double reach_;
  std::vector<Vec3> points_;
  std::vector<std::uint32_t> next_;  // next point of the same slot
  // First point of each slot; the number of slots is a power of two.
  std::vector<std::uint32_t> heads_;
};

}  // namespace clearway
