#pragma once

#include <cstdint>

#include "core/cloud/packed_cloud.hpp"
#include "core/page/page_pool.hpp"
#include "core/sweep/sweep_ref.hpp"
#include "gpu/cuda_page_engine.hpp"

namespace clearway {

/// The sweep engine on one CUDA device: model field, model and motion tree stay there; a warp
/// searches a block of points (core/sweep/sweep_block.hpp). All memory is taken when it is made.
template <typename Element>
class CudaSweepEngineOf final : public CudaPageEngine {
 public:
  /// Uploads what `sweep` refers to. With a profile that and the cloud outlive it, else nothing of
  /// the arguments is needed afterwards. Throws ResourceError with CUDA's reason.
  CudaSweepEngineOf(int device, const SweepRefOf<Element>& sweep, const PackedCloud& cloud,
                    const SlotLayout& layout);

  /// Of all pages finished. Not during a search.
  SweepStatistics statistics() const;
};

using CudaSweepEngine = CudaSweepEngineOf<Vec3>;

extern template class CudaSweepEngineOf<Vec3>;
extern template class CudaSweepEngineOf<Triangle>;
extern template class CudaSweepEngineOf<SolidTriangle>;

/// Device memory that a CudaSweepEngine takes beside its slots, and for each of them.
template <typename Element>
std::uint64_t cuda_sweep_bytes(const SweepRefOf<Element>& sweep);
template <typename Element>
std::uint64_t cuda_sweep_slot_bytes(const SweepRefOf<Element>& sweep, const PackedCloud& cloud,
                                    const SlotLayout& layout);

/// Page-locked host memory of a slot.
template <typename Element>
std::uint64_t cuda_sweep_pinned_bytes(const SweepRefOf<Element>& sweep, const PackedCloud& cloud,
                                      const SlotLayout& layout);

}  // namespace clearway
