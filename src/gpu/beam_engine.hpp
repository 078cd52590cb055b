#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/cloud/packed_cloud.hpp"
#include "core/page/page_pool.hpp"
#include "core/seen/beams.hpp"
#include "gpu/cuda_page_engine.hpp"

namespace clearway {

/// Follows the beams to the points of pages on one CUDA device, with a thread for each beam. It
/// clears the bits of a copy of the brick map; its pages find no points. All memory is allocated
/// when the engine is made.
class CudaBeamEngine final : public CudaPageEngine {
 public:
  /// beams: outlives the engine. Throws ResourceError with CUDA's reason.
  CudaBeamEngine(int device, const Beams& beams, const PackedCloud& cloud,
                 const SlotLayout& layout);

  // The following must not be called while a page is in flight.

  /// The words of the brick map, in which the bits of all cubes that were seen are 0.
  std::vector<std::uint64_t> words() const;
  BeamCounts counts() const;
};

/// Device memory of a CudaBeamEngine besides its slots, bytes; cuda_beam_slot_bytes() is that of
/// each slot.
std::uint64_t cuda_beam_bytes(const Beams& beams);
std::uint64_t cuda_beam_slot_bytes(const Beams& beams, const PackedCloud& cloud,
                                   const SlotLayout& layout);

/// Page-locked host memory of each slot, bytes.
std::uint64_t cuda_beam_pinned_bytes(const Beams& beams, const PackedCloud& cloud,
                                     const SlotLayout& layout);

}  // namespace clearway
