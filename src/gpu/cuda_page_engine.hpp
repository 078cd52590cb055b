#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/page/page_engine.hpp"

namespace clearway {

class CudaPageSearch;
struct CudaPagePlan;
class DeviceClock;

/// An engine on one CUDA device: its slots, and the way of a page through them. A page is uploaded,
/// searched, and its result copied back, all on the slot's stream. All memory is allocated when the
/// engine is made.
class CudaPageEngine : public PageEngine {
 public:
  /// Waits for pages in flight.
  ~CudaPageEngine() override;

  std::uint32_t slots() const final;
  std::span<std::byte> page(std::uint32_t slot) final;
  void start(std::uint32_t slot, const PageShape& shape) final;
  void wait(std::uint32_t slot) final;
  PageResult finish(std::uint32_t slot) final;

  /// Memory allocated on the device, without CUDA's context, in bytes; pinned_bytes() is the
  /// page-locked memory on the host.
  std::uint64_t device_bytes() const;
  std::uint64_t pinned_bytes() const;

 protected:
  /// Makes the engine on the current device, which must be that of `search`. Throws ResourceError
  /// with CUDA's reason.
  CudaPageEngine(std::uint32_t slots, std::unique_ptr<CudaPageSearch> search);

  const CudaPageSearch& search() const { return *search_; }

 private:
  struct SlotMemory;
  struct Slot;

  void enqueue(const Slot& slot, const CudaPagePlan& plan) const;

  std::unique_ptr<CudaPageSearch> search_;
  std::unique_ptr<SlotMemory> memory_;
  std::vector<Slot> slots_;
  std::unique_ptr<DeviceClock> clock_;
};

}  // namespace clearway
