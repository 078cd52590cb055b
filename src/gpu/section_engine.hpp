#pragma once

#include <cstdint>
#include <span>

#include "core/cloud/packed_cloud.hpp"
#include "core/page/page_pool.hpp"
#include "core/section/section_ref.hpp"
#include "gpu/cuda_page_engine.hpp"

namespace clearway {

/// Blocks cells of a section by the points of pages on one CUDA device, with a warp for each block
/// of points. It has maps of its own, in which nothing is blocked at first; its pages find no
/// points. The nodes of a page's cells are those of bins_in_reach(). All memory is allocated when
/// the engine is made.
class CudaSectionEngine final : public CudaPageEngine {
 public:
  /// section: of the host; its entries are not looked at. Throws ResourceError with CUDA's reason.
  CudaSectionEngine(int device, const SectionRef& section, const PackedCloud& cloud,
                    const SlotLayout& layout);

  /// Copies the entries of all maps to `to`. Must not be called while a page is in flight.
  void read_entries(std::span<std::uint32_t> to) const;
};

/// Device memory of a CudaSectionEngine besides its slots, bytes; cuda_section_slot_bytes() is that
/// of each slot.
std::uint64_t cuda_section_bytes(const SectionRef& section);
std::uint64_t cuda_section_slot_bytes(const PackedCloud& cloud, const SlotLayout& layout);

/// Page-locked host memory of each slot, bytes.
std::uint64_t cuda_section_pinned_bytes(const PackedCloud& cloud, const SlotLayout& layout);

}  // namespace clearway
