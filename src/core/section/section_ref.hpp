#pragma once

#include <cstdint>
#include <vector>

#include "core/section/section_map.hpp"
#include "core/section/section_poses.hpp"

namespace clearway {

/// The poses of a load and the maps of its bins as a search sees them, on the host or on a device.
/// Owns nothing.
struct SectionRef {
  std::uint32_t node_count, pose_count, bin_count;
  const SectionPoseNode* nodes;    ///< SectionPoses::nodes()
  const PullBack* pull_backs;      ///< of each pose of the load
  const std::uint32_t* path_pose;  ///< of each pose of the load: the pose of the path
  SectionLattice lattice;
  double slack;  ///< section_rounding()
  SectionMapShape shape;
  std::uint32_t* entries;  ///< of the maps of all bins, one map after another

  /// Number of the entries of all maps.
  std::uint64_t entry_count() const { return bin_count * shape.entries; }

  CLEARWAY_HD SectionMapRef map(std::uint32_t bin) const {
    return {&shape, entries + bin * shape.entries};
  }

  /// Whether a pose of the node may block a cell, by a point of the box with this centre and these
  /// half sides, that no earlier pose has blocked. half: null for a point. For a node of many bins
  /// only the places decide.
  CLEARWAY_HD bool may_block(const SectionPoseNode& node, const Vec3& centre,
                             const Vec3* half) const {
    const PlaceBounds bounds = node.bounds(centre, half, lattice, slack);
    if (bounds.first_in_range == node.count) return false;
    SectionRect rect{};
    if (!lattice.cover(bounds.from[1], bounds.to[1], bounds.from[2], bounds.to[2], rect)) {
      return false;
    }
    return node.bin == SectionPoseNode::kManyBins ||
           !map(node.bin).is_blocked_by(rect, node.first_pose + bounds.first_in_range);
  }
  CLEARWAY_HD bool may_block(const SectionPoseNode& node, const Box& box) const {
    const Vec3 half = 0.5 * box.size();
    return may_block(node, box.centre(), &half);
  }

  /// One step of a point down the tree of a bin: blocks cells where the node is a leaf. Returns the
  /// node at which the point goes on.
  CLEARWAY_HD std::uint32_t step(std::uint32_t at, const Vec3& point) const {
    const SectionPoseNode& node = nodes[at];
    if (!may_block(node, point, nullptr)) return node.end;
    if (node.is_leaf()) block(node, point);
    return at + 1;
  }

  /// Blocks the cells of the places of a point at the poses of a node of one bin.
  CLEARWAY_HD void block(const SectionPoseNode& node, const Vec3& point) const {
    const SectionMapRef firsts = map(node.bin);
    for (std::uint32_t pose = node.first; pose < node.first + node.count; ++pose) {
      std::uint32_t column = 0, row = 0;
      if (lattice.find(pull_backs[pose].apply(point), column, row)) {
        firsts.block(column, row, path_pose[pose]);
      }
    }
  }
};

/// All of them must outlive what is returned. slack: section_rounding().
SectionRef section_ref(const SectionPoses& poses, const SectionLattice& lattice, double slack,
                       SectionMaps& maps);

/// The nodes of the bins in which points of the box may block something that is not blocked yet, in
/// the order of the path.
std::vector<std::uint32_t> bins_in_reach(const SectionRef& section, const Box& points);

}  // namespace clearway
