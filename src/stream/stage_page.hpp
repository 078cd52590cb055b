#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/cloud/packed_cloud.hpp"
#include "core/page/page_engine.hpp"
#include "core/query/ignored_points.hpp"

namespace clearway {

/// Fills `page` with the cells from the cloud: headers, motion nodes, block boxes, masks if points
/// are ignored, and packed coordinates, which are read straight into it. page: aligned to
/// kPageAlignment, and at least as large as the page of these cells. ignored_points: increased by
/// the number of ignored points in these cells. Thread safe. Throws what reading the cells throws.
PageShape stage_page(const PackedCloud& cloud, std::span<const PlannedCell> cells,
                     std::span<std::byte> page, const IgnoredPoints& ignored,
                     std::uint64_t& ignored_points);

/// Fills `page` with the cells if no point is ignored.
PageShape stage_page(const PackedCloud& cloud, std::span<const PlannedCell> cells,
                     std::span<std::byte> page);

}  // namespace clearway
