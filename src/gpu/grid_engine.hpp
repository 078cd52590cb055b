#pragma once

#include <cstdint>

#include "core/grid/grid_scene.hpp"
#include "core/page/page_pool.hpp"
#include "gpu/cuda_page_engine.hpp"

namespace clearway {

/// The engine `grid` on one CUDA device: per page the points sorted into regular grids, then the
/// model searched in them group by group, a warp a pair of group and pose. All memory is taken when
/// it is made. Source: Schauer et al. (the paper), section 3.2.
class CudaGridEngine final : public CudaPageEngine {
 public:
  /// Uploads the scene, which outlives the engine. Throws ResourceError with CUDA's reason.
  CudaGridEngine(int device, const GridScene& scene, const SlotLayout& layout);

  bool pages_alike() const override { return false; }

  /// Of all pages finished. Not during a search.
  GridStatistics statistics() const;
};

/// Device memory that a CudaGridEngine takes beside its slots, and for each of them. The latter
/// asks the current device how much sorting needs.
std::uint64_t cuda_grid_bytes(const GridScene& scene);
std::uint64_t cuda_grid_slot_bytes(const GridScene& scene, const SlotLayout& layout);

/// Page-locked host memory of a slot.
std::uint64_t cuda_grid_pinned_bytes(const GridScene& scene, const SlotLayout& layout);

}  // namespace clearway
