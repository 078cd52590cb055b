#pragma once

#include <cstdint>

#include "core/grid/grid_scene.hpp"
#include "core/page/page_pool.hpp"
#include "gpu/cuda_page_engine.hpp"

namespace clearway {

/// The engine `grid` on one CUDA device. For each page it sorts the points into regular grids and
/// then searches the model in them group by group, with a warp for each pair of group and pose. All
/// memory is allocated when the engine is made. Source: Schauer et al. (the paper), section 3.2.
class CudaGridEngine final : public CudaPageEngine {
 public:
  /// Uploads the scene, which must outlive the engine. Throws ResourceError with CUDA's reason.
  CudaGridEngine(int device, const GridScene& scene, const SlotLayout& layout);

  bool pages_alike() const override { return false; }

  /// Counts of all finished pages. Must not be called during a search.
  GridStatistics statistics() const;
};

/// Device memory of a CudaGridEngine besides its slots, bytes; cuda_grid_slot_bytes() is that of
/// each slot, for which it asks the current device how much sorting needs.
std::uint64_t cuda_grid_bytes(const GridScene& scene);
std::uint64_t cuda_grid_slot_bytes(const GridScene& scene, const SlotLayout& layout);

/// Page-locked host memory of each slot, bytes.
std::uint64_t cuda_grid_pinned_bytes(const GridScene& scene, const SlotLayout& layout);

}  // namespace clearway
