#pragma once

#include <cstdint>

#include "core/cloud/packed_cloud.hpp"
#include "core/page/page_pool.hpp"
#include "core/sweep/sweep_ref.hpp"
#include "gpu/cuda_page_engine.hpp"

namespace clearway {

/// The sweep engine on one CUDA device. Model field, model and motion tree stay on the device; a
/// warp searches a block of points (core/sweep/sweep_block.hpp). All memory is allocated when the
/// engine is made.
template <typename Element>
class CudaSweepEngineOf final : public CudaPageEngine {
 public:
  /// Uploads what `sweep` refers to. With a profile, the data of `sweep` and the cloud must outlive
  /// the engine; otherwise no argument is needed afterwards. Throws ResourceError with CUDA's
  /// reason.
  CudaSweepEngineOf(int device, const SweepRefOf<Element>& sweep, const PackedCloud& cloud,
                    const SlotLayout& layout);

  /// An engine that uses and leaves what is kept on the device. field: the one of `sweep`. The
  /// cloud outlives the engine, and the data of `sweep` as for the constructor. Throws
  /// ResourceError with CUDA's reason.
  static std::unique_ptr<PageEngine> of_kept(const SweepRefOf<Element>& sweep,
                                             const std::shared_ptr<const void>& field,
                                             const PackedCloud& cloud, const SlotLayout& layout,
                                             std::shared_ptr<KeptOnDevice> kept);

  /// Counts of all finished pages. Must not be called during a search.
  SweepStatistics statistics() const;

 private:
  using CudaPageEngine::CudaPageEngine;
};

using CudaSweepEngine = CudaSweepEngineOf<Vec3>;

extern template class CudaSweepEngineOf<Vec3>;
extern template class CudaSweepEngineOf<Triangle>;
extern template class CudaSweepEngineOf<SolidTriangle>;

/// Device memory of a CudaSweepEngineOf besides its slots, bytes; cuda_sweep_slot_bytes() is that
/// of each slot.
template <typename Element>
std::uint64_t cuda_sweep_bytes(const SweepRefOf<Element>& sweep);
/// The part of cuda_sweep_bytes() that the model and its field take.
template <typename Element>
std::uint64_t cuda_model_bytes(const SweepRefOf<Element>& sweep);
template <typename Element>
std::uint64_t cuda_sweep_slot_bytes(const SweepRefOf<Element>& sweep, const PackedCloud& cloud,
                                    const SlotLayout& layout);

/// Page-locked host memory of each slot, bytes.
template <typename Element>
std::uint64_t cuda_sweep_pinned_bytes(const SweepRefOf<Element>& sweep, const PackedCloud& cloud,
                                      const SlotLayout& layout);

}  // namespace clearway
