#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/hit_set.hpp"
#include "core/packed_cloud.hpp"
#include "core/page_engine.hpp"

namespace clearway {

/// The shape of a page of these cells.
PageShape shape_of(const PackedCloud& cloud, std::span<const PlannedCell> cells);

/// Fills a page from the cloud's packed values. `bytes` is as large as shape_of says, or larger.
PageShape stage_page(const PackedCloud& cloud, std::span<const PlannedCell> cells,
                     std::span<std::byte> bytes);

/// Runs an engine over the cells, `cells_a_page` to a page, with all its slots in flight.
HitSet run_page_engine(const PackedCloud& cloud, std::span<const PlannedCell> cells,
                       std::size_t cells_a_page, bool first_pose, PageEngine& engine);

}  // namespace clearway
