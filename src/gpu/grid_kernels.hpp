#pragma once

#include <cuda_runtime_api.h>

#include <cstdint>

#include "core/grid/grid_view.hpp"

namespace clearway {

/// Memory for sorting the points of a page: keys and slots, before and after.
struct GridSortRef {
  std::uint32_t* keys;
  std::uint32_t* order;
  std::uint32_t* sorted_keys;
  std::uint32_t* sorted_order;
  void* scratch;
  std::size_t scratch_bytes;
};

/// Bytes of scratch memory for sorting `count` slots; asks the current device. Throws
/// ResourceError.
std::size_t grid_sort_bytes(std::uint32_t count);

/// Builds the grids of a page: clears and fills its buckets and occupancies, and writes its points.
/// Enqueued on `stream`, not synchronised. Throws ResourceError.
void build_grids(const GridSceneView& scene, const GridPageView& page, const GridSortRef& sort,
                 cudaStream_t stream);

/// Searches the grids of a page: clears and fills its answer. next_task: one word; statistics:
/// added to. Enqueued on `stream`, not synchronised. Throws ResourceError.
void search_grids(const GridSceneView& scene, const GridPageView& page, std::uint64_t tasks,
                  std::uint64_t* next_task, GridStatistics* statistics, cudaStream_t stream);

/// Loads the kernels of the grid engine, except those that sort, on the current device, because
/// CUDA otherwise loads a kernel when it is first used.
void load_grid_kernels() noexcept;

}  // namespace clearway
