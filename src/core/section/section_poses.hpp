#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "clearway/pose.hpp"
#include "core/geometry/inside.hpp"
#include "core/section/section_lattice.hpp"

namespace clearway {

/// A stretch of the path that the load passes: bin number `number` has poses first ..
/// first + count - 1 of the load. Between poses, bins share poses.
struct SectionBin {
  std::uint64_t number;
  std::uint32_t first, count;
  friend bool operator==(const SectionBin&, const SectionBin&) = default;
};

/// Numbers of the first and the last bin of a part of the path.
struct SectionBinNumbers {
  double first, last;
};

/// The bins that poses first .. last of a path are in. Between poses, each pose stands for half of
/// the way to the pose before it and to the one after it, and is in all bins of these.
SectionBinNumbers bins_of_poses(std::span<const double> chainage, std::size_t first,
                                std::size_t last, const SectionParameters& parameters);

/// The bins that have a pose, ascending. chainage: of each pose of the path. path_pose: for each
/// pose of the load, the index of the path's pose, ascending, and between poses without a gap.
/// Throws UsageError for bins so short that a number does not fit 32 bits, or that there are more
/// than 2^24 of them between poses.
std::vector<SectionBin> section_bins(std::span<const double> chainage,
                                     std::span<const std::uint32_t> path_pose,
                                     const SectionParameters& parameters);

/// Where the poses of a node see a box of points.
struct PlaceBounds {
  double from[3], to[3];  ///< range of the place's coordinate on each axis
  /// The poses of the node before this one, counted from its first, see the whole box outside of
  /// the range of x'. It is the number of poses where all of them do.
  std::uint32_t first_in_range;
};

/// Consecutive poses of the load, and a bound on each axis of where they see a point.
///
/// The node has a reference pose with the inverse R' and the position p'. For each axis a and each
/// pose i of the node
///   x'_a = R'_a (e - p') + (R_i^-1 - R')_a (e - p') - (R_i^-1)_a (p_i - p').
/// The first term is that of one pose. The second is at most D_a . |e - p'|, where D_a (`spread`)
/// holds the greatest change of each entry of the row. The third does not depend on the point: the
/// node stores its least and its greatest value. A box of points with the middle c and the half
/// sides h adds |R'_a| . h to the first term and has |c - p'| + h in the second. So a straight
/// piece of path moves places along x' only, and y' and z' stay as narrow as the points are. Each
/// bound is widened by section_rounding(), which is more than the rounding of both the bound and
/// the place. Cells are monotone in the place, so the cells under the widened bound hold the cell
/// of every point at every pose.
///
/// The node also bounds when a point comes into the range, because a load moves on by about as much
/// from pose to pose. With v, the mean fall of x' from a pose to the next, the third term of x' at
/// pose i of the node is at least c - v i, where c is the least of the third term plus v i. So
/// where v is above 0, no pose before
///   ((R'_x (e - p') - D_x . |e - p'| - eps) + c - x_to) / v
/// has the point in the range; a load that goes backwards has the mirror image of this at x_from.
/// The number is rounded down, and eps is more than what its terms are rounded by, whatever v is.
struct SectionPoseNode {
  static constexpr std::uint32_t kManyBins = 0xffffffff;

  double position[3];                 ///< of the reference pose
  double row[3][3];                   ///< inverse of its rotation
  double spread[3][3];                ///< greatest change of each entry of the inverse
  double shift_from[3], shift_to[3];  ///< range of the part that does not depend on the point
  /// A line below, or where the load goes backwards above, the part of x' that does not depend on
  /// the point: pace_shift - i / pace at pose i of the node. pace: poses in which x' falls by 1, or
  /// less than 0 where it grows; 0 where there is no such line.
  double pace, pace_shift;
  std::uint32_t first, count;  ///< poses of the load
  std::uint32_t right;         ///< index of the right child, 0 for a leaf; the left one follows
  std::uint32_t bin;           ///< index of the bin of all its poses, or kManyBins
  std::uint32_t first_pose;    ///< the first of its poses, as a pose of the path
  std::uint32_t end;           ///< index of the node after the last one of its subtree

  CLEARWAY_HD bool is_leaf() const { return right == 0; }

  /// Where poses of the node see a box of points with this centre and these half sides, or a point
  /// where half is null. slack: see section_rounding().
  CLEARWAY_HD PlaceBounds bounds(const Vec3& centre, const Vec3* half,
                                 const SectionLattice& lattice, double slack) const {
    const double d[3] = {centre.x - position[0], centre.y - position[1], centre.z - position[2]};
    PlaceBounds out;
    for (int a = 0; a < 3; ++a) {
      double middle = 0, reach = slack;
      for (int k = 0; k < 3; ++k) {
        middle += row[a][k] * d[k];
        reach += spread[a][k] * std::fabs(d[k]);
        if (half != nullptr) reach += (std::fabs(row[a][k]) + spread[a][k]) * (*half)[k];
      }
      out.from[a] = middle - reach + shift_from[a];
      out.to[a] = middle + reach + shift_to[a];
      if (a == 0) {
        const double at = first_in_range(middle, reach, lattice.x_from, lattice.x_to);
        const bool misses = out.to[0] < lattice.x_from || out.from[0] > lattice.x_to;
        out.first_in_range = misses ? count : static_cast<std::uint32_t>(at);
      }
    }
    return out;
  }

  /// PlaceBounds::first_in_range as a number that is yet to be rounded down, of the middle and the
  /// reach along x that bounds() has.
  CLEARWAY_IN_CLONE CLEARWAY_HD double first_in_range(double middle, double reach, double x_from,
                                                      double x_to) const {
    const double border = pace < 0 ? x_from - reach : x_to + reach;
    const double at = pace * (middle + pace_shift - border);
    const double at_least = at > 0 ? at : 0.0;  // for NaN, too
    const auto all = static_cast<double>(count);
    return at_least < all ? at_least : all;
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
  std::span<const PullBack> pull_backs() const { return pull_backs_; }  ///< of each pose
  /// The poses of the path that the poses of the load belong to.
  std::span<const std::uint32_t> path_pose() const { return path_pose_; }
  std::uint64_t allocated_bytes() const {
    return nodes_.capacity() * sizeof(SectionPoseNode) + pull_backs_.capacity() * sizeof(PullBack);
  }

 private:
  void add_bins(std::uint32_t first, std::uint32_t count);
  void add_poses(std::uint32_t first, std::uint32_t count, std::uint32_t bin);
  std::size_t open(std::uint32_t first, std::uint32_t count, std::uint32_t bin);
  void add_pace(SectionPoseNode& node) const;

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

/// How far a box in the frame of a load moves between two poses, as seen from either.
struct SectionMotion {
  double along = 0;   ///< greatest change of x'
  double across = 0;  ///< greatest change in the plane of y' and z'
};

SectionMotion motion_of_step(const Pose& from, const Pose& to, const Box& load);

/// The greatest motion of range and window over all steps from a pose to the next.
SectionMotion section_motion(std::span<const Pose> poses, const SectionParameters& parameters);

}  // namespace clearway
