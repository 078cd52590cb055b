#pragma once

#include <span>

#include "core/cloud/packed_cloud.hpp"
#include "core/page/page_engine.hpp"
#include "core/query/search_result.hpp"

namespace clearway {

/// The entry of a point of a page; `cells` are the page's cells.
std::uint64_t entry_of(const PackedCloud& cloud, std::span<const PlannedCell> cells,
                       std::uint32_t point);

/// Adds the answer of a page of these cells to `all`. Cells are disjoint and a block is a word, so
/// different pages may be collected at once and in any order; the nearest points of poses are only
/// offered. Throws InputError if the source index of such a point cannot be read.
void collect_page(const PackedCloud& cloud, std::span<const PlannedCell> cells,
                  const PageResult& answer, SearchResult& all);

}  // namespace clearway
