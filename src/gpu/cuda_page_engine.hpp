#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/cloud/packed_cloud.hpp"
#include "core/page/page_engine.hpp"

namespace clearway {

class CudaPageSearch;
struct CudaPagePlan;
class CudaSlots;
class KeptOnDevice;

/// An engine on one CUDA device: its slots, and the way of a page through them. A page is uploaded,
/// searched, and its result copied back, all on the slot's stream. All memory is allocated when the
/// engine is made.
class CudaPageEngine : public PageEngine {
 public:
  /// Waits for pages in flight.
  ~CudaPageEngine() override;

  std::uint32_t slots() const final;
  std::span<std::byte> page(std::uint32_t slot) final;
  std::optional<CellPayload> kept(std::uint32_t slot, std::uint32_t cell) final;
  void start(std::uint32_t slot, const PageShape& shape) final;
  void start_beside(PageEngine& first, std::uint32_t slot, const PageShape& shape) final;
  void wait(std::uint32_t slot) final;
  PageResult finish(std::uint32_t slot) final;
  void release(std::uint32_t slot) final;

  /// Memory allocated on the device, without CUDA's context, in bytes; pinned_bytes() is the
  /// page-locked memory on the host.
  std::uint64_t device_bytes() const;
  std::uint64_t pinned_bytes() const;

 protected:
  /// Makes the engine on the current device, which must be that of `search`. Throws ResourceError
  /// with CUDA's reason.
  CudaPageEngine(std::uint32_t slots, std::unique_ptr<CudaPageSearch> search);
  /// memory: slots that are enough. kept: where they go back to, and where cells of the cloud stay.
  CudaPageEngine(std::uint32_t slots, std::unique_ptr<CudaPageSearch> search,
                 std::unique_ptr<CudaSlots> memory, const PackedCloud& cloud,
                 std::shared_ptr<KeptOnDevice> kept);

  const CudaPageSearch& search() const { return *search_; }

 private:
  struct Slot;

  void make_slots(std::uint32_t slots);
  void start(Slot& slot, const PageShape& shape, const Slot* first);
  void enqueue(Slot& slot, const CudaPagePlan& plan) const;
  void keep_cells(Slot& slot) const;
  void release_cells(Slot& slot, bool are_filled);
  PageRef page_on_host(const Slot& slot) const;

  std::shared_ptr<KeptOnDevice> kept_;  ///< may be null
  const PackedCloud* cloud_ = nullptr;  ///< only where something is kept
  std::unique_ptr<CudaSlots> memory_;   ///< has arrays of the search
  std::unique_ptr<CudaPageSearch> search_;
  std::vector<Slot> slots_;
};

}  // namespace clearway
