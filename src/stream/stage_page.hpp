#pragma once

#include <cstddef>
#include <span>

#include "core/cloud/packed_cloud.hpp"
#include "core/page/page_engine.hpp"

namespace clearway {

/// Fills `page`, on kPageAlignment and at least the size of the page of these cells, from the
/// cloud: headers, motion nodes, block boxes and packed coordinates, which are read straight into
/// it. Thread safe. Throws what reading the cells throws.
PageShape stage_page(const PackedCloud& cloud, std::span<const PlannedCell> cells,
                     std::span<std::byte> page);

}  // namespace clearway
