#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/cloud/packed_cloud.hpp"
#include "core/section/section_map.hpp"
#include "core/section/section_poses.hpp"

namespace clearway {

/// Blocks cells of a section by the points of a cloud, by branch and bound over boxes of points and
/// nodes of poses (docs/design/section.md, "The walk"). Several threads may search different blocks
/// at once.
class SectionSearch {
 public:
  /// All of them must outlive this object. slack: section_rounding().
  SectionSearch(const PackedCloud& cloud, const SectionPoses& poses, const SectionLattice& lattice,
                double slack, SectionMaps& maps)
      : cloud_(cloud), poses_(poses), lattice_(lattice), slack_(slack), maps_(maps) {}

  /// The nodes of the bins in which the cell's points may block something that is not blocked yet.
  std::vector<std::uint32_t> bins_in_reach(std::uint32_t cell) const;

  /// Searches blocks first .. end - 1 of a cell. bins: those of bins_in_reach(). searched: a word
  /// for each block of the cell, of its points that count; empty where all do.
  void search(std::uint32_t cell, const std::array<PackedChunk<std::int32_t>, 3>& coordinates,
              std::span<const std::uint64_t> searched, std::span<const std::uint32_t> bins,
              std::uint32_t first, std::uint32_t end) const;

 private:
  struct Points;

  bool may_block(const SectionPoseNode& node, const Box& points) const;
  void visit(std::uint32_t node, const Points& points) const;
  void visit_poses(const SectionPoseNode& node, const Points& points) const;

  const PackedCloud& cloud_;
  const SectionPoses& poses_;
  const SectionLattice& lattice_;
  const double slack_;
  SectionMaps& maps_;
};

}  // namespace clearway
