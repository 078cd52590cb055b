#pragma once

#include <cuda_runtime_api.h>

#include <cstddef>
#include <cstdint>

#include "core/page/page_pool.hpp"
#include "core/util/array_run.hpp"
#include "gpu/cuda_objects.hpp"
#include "gpu/cuda_slots.hpp"
#include "gpu/device_arrays.hpp"

namespace clearway {

/// Description of what the host added to a page.
struct CudaPagePlan {
  std::uint64_t bytes = 0, tasks = 0;
};

/// A page in its slot, with all addresses on the device.
struct CudaPage {
  PageRef page;
  const std::byte* plan;
  std::uint64_t tasks;
  std::uint64_t* hits;
  std::uint32_t* first_poses;    ///< null if not asked for
  Clearance* clearances;         ///< null if not asked for
  std::span<ProfileFact> facts;  ///< empty if not asked for
  ProfileCounts* fact_counts;
  std::byte* work;
  cudaStream_t stream;
};

/// What an engine does with a page on a device, and the data that it keeps there for all pages.
class CudaPageSearch {
 public:
  virtual ~CudaPageSearch() = default;

  /// Makes this device the current one of the thread.
  void use_device() const { check_cuda(cudaSetDevice(device_)); }

  int device() const { return device_; }
  const ResultParts& parts() const { return parts_; }

  /// Device memory besides the slots, bytes.
  virtual std::uint64_t device_bytes() const { return arrays_.bytes(); }

  virtual const CudaSlotSize& slot_size() const = 0;

  /// Plans the search of a page: writes to `begin`, on the host, the data that is uploaded right
  /// after the page.
  virtual CudaPagePlan plan(const PageRef& /*page*/, std::byte* /*begin*/) const { return {}; }

  /// Enqueues the search of a page on its stream: clears and fills the page's result. Not
  /// synchronised. Throws ResourceError.
  virtual void enqueue(const CudaPage& page) const = 0;

  /// Makes a profile of the facts that were listed for a page, both on the host. Valid until the
  /// slot's next page. Only called with a profile.
  virtual std::span<const ProfileFact> profile(std::uint32_t /*slot*/, const PageRef& /*page*/,
                                               std::span<const ProfileFact> /*listed*/,
                                               std::uint32_t /*count*/) {
    return {};
  }

 protected:
  /// Makes the device the current one of the thread. arrays: memory there for the arrays, as far as
  /// it is enough for them; more is allocated.
  CudaPageSearch(int device, const ResultParts& parts, std::span<std::byte> arrays = {})
      : arrays_(arrays), device_(device), parts_(parts) {
    use_device();
  }

  DeviceArrays arrays_;  ///< to be filled only by the constructor

 private:
  int device_;
  ResultParts parts_;
};

}  // namespace clearway
