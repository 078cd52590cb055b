#pragma once

#include <cuda_runtime_api.h>

#include <cstddef>
#include <cstdint>

#include "core/page/page_result_arrays.hpp"
#include "core/util/array_run.hpp"
#include "gpu/cuda_check.hpp"
#include "gpu/device_arrays.hpp"

namespace clearway {

/// Bytes that a slot's largest page takes in each run of memory. Slots lie one after the other in
/// memory that an engine takes at once, so a run's begin is as aligned as an allocation.
struct CudaSlotSize {
  std::uint64_t page;    ///< a multiple of kPageAlignment
  std::uint64_t plan;    ///< what the host adds to the page
  std::uint64_t result;  ///< PageResultArrays
  std::uint64_t work;    ///< on the device alone

  std::uint64_t upload() const { return whole(page + plan); }
  std::uint64_t found() const { return whole(result); }
  std::uint64_t pinned() const { return upload() + found(); }
  std::uint64_t device() const { return pinned() + whole(work); }

 private:
  static constexpr std::uint64_t whole(std::uint64_t bytes) {
    return divide_up(bytes, ArrayRun::kAlignment) * ArrayRun::kAlignment;
  }
};

/// What the host added to a page.
struct CudaPagePlan {
  std::uint64_t bytes = 0, tasks = 0;
};

/// A page in its slot, all addresses on the device.
struct CudaPage {
  PageRef page;
  const std::byte* plan;
  std::uint64_t tasks;
  std::uint64_t* hits;
  std::uint32_t* first_poses;    ///< null where not asked for
  Clearance* clearances;         ///< likewise
  std::span<ProfileFact> facts;  ///< likewise
  ProfileCounts* fact_counts;
  std::byte* work;
  cudaStream_t stream;
};

/// What an engine does with a page on a device, and what it keeps there for all pages.
class CudaPageSearch {
 public:
  virtual ~CudaPageSearch() = default;

  /// Makes its device the current one of the thread.
  void use_device() const { check_cuda(cudaSetDevice(device_)); }

  int device() const { return device_; }
  const ResultParts& parts() const { return parts_; }

  /// Device memory beside the slots.
  std::uint64_t device_bytes() const { return arrays_.bytes(); }

  virtual const CudaSlotSize& slot_size() const = 0;

  /// Writes to `begin`, on the host, what is to be sent behind the page.
  virtual CudaPagePlan plan(const PageRef& /*page*/, std::byte* /*begin*/) const { return {}; }

  /// Clears and fills the page's result. Enqueued on its stream, not synchronised. Throws
  /// ResourceError.
  virtual void enqueue(const CudaPage& page) const = 0;

  /// Makes a profile of what was listed of a page, both on the host: valid until the slot's next
  /// page. Only with a profile.
  virtual std::span<const ProfileFact> profile(std::uint32_t /*slot*/, const PageRef& /*page*/,
                                               std::span<const ProfileFact> /*listed*/,
                                               std::uint32_t /*count*/) {
    return {};
  }

 protected:
  /// The device is the current one from here on.
  CudaPageSearch(int device, const ResultParts& parts) : device_(device), parts_(parts) {
    use_device();
  }

  DeviceArrays arrays_;  ///< to be filled by the constructor alone

 private:
  int device_;
  ResultParts parts_;
};

}  // namespace clearway
