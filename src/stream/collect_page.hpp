#pragma once

#include <span>

#include "core/answer.hpp"
#include "core/packed_cloud.hpp"
#include "core/page_engine.hpp"

namespace clearway {

/// Adds the answer of a page of these cells to `all`. Cells are disjoint and a block is a word, so
/// different pages may be collected at once and in any order.
void collect_page(const PackedCloud& cloud, std::span<const PlannedCell> cells,
                  const PageAnswer& answer, Answer& all);

}  // namespace clearway
