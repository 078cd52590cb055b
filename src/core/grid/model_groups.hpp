#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "clearway/vec3.hpp"
#include "core/geometry/box.hpp"

namespace clearway {

/// Number of points of a group, which one warp searches.
inline constexpr std::uint32_t kGroupPoints = 32;

/// Number of groups of a part.
inline constexpr std::uint32_t kPartGroups = 32;

/// A bounding sphere: none of its points is farther from the centre than the radius, rounding
/// included.
struct GridSphere {
  Vec3 centre;  ///< inside the model's box
  double radius;
};

/// A model in k-d order. Group g is the points 32 g .. 32 g + 31, part p the groups 32 p .. 32 p +
/// 31 (the last ones may be short); each is compact in space.
class ModelGroups {
 public:
  explicit ModelGroups(std::span<const Vec3> model);

  std::span<const Vec3> points() const { return points_; }
  std::span<const GridSphere> groups() const { return groups_; }
  std::span<const GridSphere> parts() const { return parts_; }
  const Box& box() const { return box_; }

 private:
  std::vector<Vec3> points_;
  std::vector<GridSphere> groups_, parts_;
  Box box_{};
};

}  // namespace clearway
