#pragma once

#include <cuda_runtime_api.h>

#include <cstdint>

#include "core/grid/grid_view.hpp"

namespace clearway {

/// Memory in which the points of a page are sorted: keys and slots, before and after.
struct GridSortRef {
  std::uint32_t* keys;
  std::uint32_t* order;
  std::uint32_t* sorted_keys;
  std::uint32_t* sorted_order;
  void* scratch;
  std::size_t scratch_bytes;
};

/// Scratch bytes to sort `count` slots; asks the current device. Throws ResourceError.
std::size_t grid_sort_bytes(std::uint32_t count);

/// Builds the grids of a page: of `page`, buckets and occupancies are cleared and filled, points
/// written. Enqueued on `stream`, not synchronised. Throws ResourceError.
void build_grids(const GridSceneView& scene, const GridPageView& page, const GridSortRef& sort,
                 cudaStream_t stream);

/// Clears and fills the page's answer. next_task: one word; statistics: added to. Enqueued on
/// `stream`, not synchronised. Throws ResourceError.
void search_grids(const GridSceneView& scene, const GridPageView& page, std::uint64_t tasks,
                  std::uint64_t* next_task, GridStatistics* statistics, cudaStream_t stream);

/// As load_sweep_kernels does: of this file, but for those that sort.
void load_grid_kernels() noexcept;

}  // namespace clearway
