#pragma once

#include <cstdint>
#include <nanoflann.hpp>
#include <span>

#include "clearway/vec3.hpp"

namespace clearway::bench {

/// Points as nanoflann reads them.
struct NanoflannPoints {
  std::span<const Vec3> points;

  std::size_t kdtree_get_point_count() const { return points.size(); }
  double kdtree_get_pt(std::size_t index, std::size_t axis) const {
    return points[index][static_cast<int>(axis)];
  }
  template <typename Bounds>
  bool kdtree_get_bbox(Bounds&) const {
    return false;
  }
};

/// nanoflann's k-d tree over points in doubles.
using NanoflannTree =
    nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, NanoflannPoints>,
                                        NanoflannPoints, 3, std::uint32_t>;

/// Points in a leaf of the tree.
inline constexpr std::size_t kLeafPoints = 12;

}  // namespace clearway::bench
