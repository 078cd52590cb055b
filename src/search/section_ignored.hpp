#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "clearway/section.hpp"
#include "core/messages/messages.hpp"
#include "core/section/section_map.hpp"
#include "core/section/section_poses.hpp"
#include "io/scans/length_unit.hpp"

namespace clearway {

/// The cells of a section that ignored points alone block, and where on the path the high ones of
/// them are blocked.
struct CellsOfIgnored : SectionIgnoredCells {
  /// Stretches of the path in whose bins a high cell is blocked by ignored points.
  std::vector<PoseRange> high_stretches = {};
};

/// maps: of the points that count. ignored: of the ignored points, for the same bins. high_from:
/// the least z of a cell that counts as high. path_pose: of the poses of the load.
CellsOfIgnored cells_of_ignored(const SectionMaps& maps, const SectionMaps& ignored,
                                const SectionLattice& lattice, std::span<const SectionBin> bins,
                                std::span<const std::uint32_t> path_pose, double high_from);

/// Warns where a load may pass only because of what the section ignores: "ignored-collide" where
/// ignored points alone block more cells than all others do, and "ignored-high" where some of these
/// cells are well above the ground. blocked: cells that the other points block. unit: the
/// environment's.
void warn_of_cells_of_ignored(const SectionData& section, const CellsOfIgnored& found,
                              std::uint64_t blocked, LengthUnit unit, MessageLog& log);

}  // namespace clearway
