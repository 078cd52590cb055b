#pragma once

#include <cstdint>
#include <span>

#include "clearway/box.hpp"
#include "core/section/section_map.hpp"
#include "core/section/section_poses.hpp"
#include "core/seen/cubes.hpp"

namespace clearway {

/// Blocks cells of a section by whole cubes of seen space, as the search for points does by points
/// (docs/design/section.md, "Seen space"). Several threads may search different bricks at once.
class SectionCubes {
 public:
  /// All of them must outlive this object. rounding: section_rounding().
  SectionCubes(const CubeLattice& cubes, const Quantisation& quantisation,
               const SectionPoses& poses, const SectionLattice& lattice, double rounding);

  /// Whether a pose may see a cube of the brick in the range and over a cell of the window.
  bool may_reach(const Brick& brick) const;

  /// Blocks the cells under the cubes of a brick whose bits are set. words: eight of the brick.
  void search(const Brick& brick, std::span<const std::uint64_t> words, SectionMaps& maps) const;

 private:
  struct Cubes;

  bool covers(const SectionPoseNode& node, const Vec3& centre, const Vec3& half,
              SectionRect& rect) const;
  bool may_block(const SectionPoseNode& node, const Box& middles, SectionMaps& maps) const;
  void visit(std::uint32_t node, const Cubes& cubes, SectionMaps& maps) const;
  void visit_poses(const SectionPoseNode& node, const Cubes& cubes, SectionMaps& maps) const;

  const CubeLattice& cubes_;
  const Quantisation& quantisation_;
  const SectionPoses& poses_;
  const SectionLattice& lattice_;
  Vec3 half_;     ///< half sides of a cube
  double slack_;  ///< by which a cube is widened on each side
};

}  // namespace clearway
