#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/cloud/packed_cloud.hpp"
#include "core/section/section_ref.hpp"

namespace clearway {

/// Blocks cells of a section by the points of a cloud, by branch and bound over boxes of points and
/// nodes of poses (docs/design/section.md, "The walk"). Several threads may search different blocks
/// at once.
class SectionSearch {
 public:
  /// The cloud, and what the section refers to, must outlive this object.
  SectionSearch(const PackedCloud& cloud, const SectionRef& section)
      : cloud_(cloud), section_(section) {}

  /// Searches blocks first .. end - 1 of a cell. bins: those of bins_in_reach() for its box.
  /// searched: a word for each block of the cell, of its points that count; empty where all do.
  void search(std::uint32_t cell, const std::array<PackedChunk<std::int32_t>, 3>& coordinates,
              std::span<const std::uint64_t> searched, std::span<const std::uint32_t> bins,
              std::uint32_t first, std::uint32_t end) const;

 private:
  struct Points;

  void visit(std::uint32_t node, const Points& points) const;
  void visit_poses(const SectionPoseNode& node, const Points& points) const;

  const PackedCloud& cloud_;
  const SectionRef section_;
};

}  // namespace clearway
