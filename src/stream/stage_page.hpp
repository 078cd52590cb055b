#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/cloud/packed_cloud.hpp"
#include "core/page/page_engine.hpp"
#include "core/query/ignored_points.hpp"

namespace clearway {

/// Fills `page`, on kPageAlignment and at least the size of the page of these cells, from the
/// cloud: headers, motion nodes, block boxes, where points are ignored masks, and packed
/// coordinates, which are read straight into it. Adds to ignored_points those of these cells.
/// Thread safe. Throws what reading the cells throws.
PageShape stage_page(const PackedCloud& cloud, std::span<const PlannedCell> cells,
                     std::span<std::byte> page, const IgnoredPoints& ignored,
                     std::uint64_t& ignored_points);

/// The same where no point is ignored.
PageShape stage_page(const PackedCloud& cloud, std::span<const PlannedCell> cells,
                     std::span<std::byte> page);

}  // namespace clearway
