#pragma once

#include <vector>

#include "core/cloud/packed_cloud.hpp"
#include "core/page/page_engine.hpp"
#include "core/query/ignored_points.hpp"
#include "core/section/section_ref.hpp"

namespace clearway {

/// Takes the points of a cloud in pages of a few cells through the body of the kernel on the host,
/// with a loop over the lanes of a warp, or through what block_pages_with() has set. Blocks the
/// cells of the section's maps.
void block_pages(const PackedCloud& cloud, const IgnoredPoints& ignored, const SectionRef& section);

/// Sets what block_pages() does from now on.
void block_pages_with(void (*run)(const PackedCloud& cloud, const IgnoredPoints& ignored,
                                  const SectionRef& section));

/// The cells of a cloud that may block something, each with its bins_in_reach().
std::vector<PlannedCell> section_cells(const PackedCloud& cloud, const SectionRef& section);

/// The greatest number of cells of a page in these runs.
inline constexpr std::uint32_t kSectionPageCells = 3;

}  // namespace clearway
