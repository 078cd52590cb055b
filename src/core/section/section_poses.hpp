#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "clearway/pose.hpp"
#include "core/geometry/inside.hpp"
#include "core/section/section_lattice.hpp"

namespace clearway {

/// A stretch of the path with poses of the load: bin number `number` has poses first ..
/// first + count - 1 of the load.
struct SectionBin {
  std::uint64_t number;
  std::uint32_t first, count;
  friend bool operator==(const SectionBin&, const SectionBin&) = default;
};

/// The bins that have a pose, ascending. chainage: of each pose of the path. path_pose: for each
/// pose of the load, the index of the path's pose, ascending. Throws UsageError for bins so short
/// that a number does not fit 32 bits.
std::vector<SectionBin> section_bins(std::span<const double> chainage,
                                     std::span<const std::uint32_t> path_pose, double bin);

/// A range of a place's coordinates on each axis.
struct PlaceBounds {
  double from[3], to[3];
};

/// Consecutive poses of the load, and a bound on each axis of where they see a point
/// (docs/design/section.md, "The bound").
struct SectionPoseNode {
  static constexpr std::uint32_t kManyBins = 0xffffffff;

  double position[3];                 ///< of the reference pose
  double row[3][3];                   ///< inverse of its rotation
  double spread[3][3];                ///< greatest change of each entry of the inverse
  double shift_from[3], shift_to[3];  ///< range of the part that does not depend on the point
  std::uint32_t first, count;         ///< poses of the load
  std::uint32_t right;       ///< index of the right child, 0 for a leaf; the left one follows
  std::uint32_t bin;         ///< index of the bin of all its poses, or kManyBins
  std::uint32_t first_pose;  ///< the first of its poses, as a pose of the path

  bool is_leaf() const { return right == 0; }

  /// Where poses of the node see a box of points with this centre and these half sides. slack: see
  /// section_rounding().
  CLEARWAY_HD PlaceBounds bounds(const Vec3& centre, const Vec3& half, double slack) const {
    const double d[3] = {centre.x - position[0], centre.y - position[1], centre.z - position[2]};
    const double h[3] = {half.x, half.y, half.z};
    PlaceBounds out;
    for (int a = 0; a < 3; ++a) {
      double middle = 0, reach = slack;
      for (int k = 0; k < 3; ++k) {
        middle += row[a][k] * d[k];
        reach += std::fabs(row[a][k]) * h[k] + spread[a][k] * (std::fabs(d[k]) + h[k]);
      }
      out.from[a] = middle - reach + shift_from[a];
      out.to[a] = middle + reach + shift_to[a];
    }
    return out;
  }
};

/// The poses of a load, and a tree over them, in preorder, whose nodes lie in one bin or hold whole
/// bins.
class SectionPoses {
 public:
  static constexpr std::uint32_t kLeafPoses = 4;

  /// The spans must outlive this object, and there must be a pose.
  SectionPoses(std::span<const Pose> poses, std::span<const std::uint32_t> path_pose,
               std::span<const SectionBin> bins);

  std::span<const SectionPoseNode> nodes() const { return nodes_; }
  const PullBack& pull_back(std::uint32_t pose) const { return pull_backs_[pose]; }
  /// The pose of the path that a pose of the load belongs to.
  std::uint32_t path_pose(std::uint32_t pose) const { return path_pose_[pose]; }
  std::uint64_t allocated_bytes() const {
    return nodes_.capacity() * sizeof(SectionPoseNode) + pull_backs_.capacity() * sizeof(PullBack);
  }

 private:
  void add_bins(std::uint32_t first, std::uint32_t count);
  void add_poses(std::uint32_t first, std::uint32_t count, std::uint32_t bin);
  std::size_t open(std::uint32_t first, std::uint32_t count, std::uint32_t bin);

  std::span<const Pose> poses_;
  std::span<const std::uint32_t> path_pose_;
  std::span<const SectionBin> bins_;
  std::vector<PullBack> pull_backs_;
  std::vector<SectionPoseNode> nodes_;
};

/// eps of docs/design/section.md, an upper bound on the rounding of a place. largest_point: the
/// greatest |coordinate| of the environment's points.
double section_rounding(double largest_point, std::span<const Pose> poses,
                        const SectionParameters& parameters, const SectionLattice& lattice);

/// How far the load's own range and window move between two poses, as seen from either.
struct SectionMotion {
  double along = 0;   ///< greatest change of x'
  double across = 0;  ///< greatest change in the plane of y' and z'
};

SectionMotion section_motion(std::span<const Pose> poses, const SectionParameters& parameters);

}  // namespace clearway
