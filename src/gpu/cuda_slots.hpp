#pragma once

#include <cstdint>
#include <vector>

#include "core/util/array_run.hpp"
#include "gpu/cuda_objects.hpp"
#include "gpu/device_arrays.hpp"

namespace clearway {

/// Bytes that a slot's largest page takes in each run of memory. Slots lie one after another in
/// memory that an engine allocates at once, so each run begins with the alignment of an allocation.
struct CudaSlotSize {
  std::uint64_t page;    ///< the page, a multiple of kPageAlignment
  std::uint64_t plan;    ///< what the host adds to the page
  std::uint64_t result;  ///< the result as PageResultArrays
  std::uint64_t work;    ///< memory that is only on the device

  std::uint64_t upload() const { return ArrayRun::aligned(page + plan); }
  std::uint64_t found() const { return ArrayRun::aligned(result); }
  std::uint64_t pinned() const { return upload() + found(); }
  std::uint64_t device() const { return pinned() + ArrayRun::aligned(work); }
};

/// The stream of a slot, and what happened there.
struct CudaSlotStream {
  CudaStream stream;
  CudaEvent begun, uploaded, searched, finished;
};

/// The memory and streams of an engine's slots, and memory for arrays that all of them use. They
/// take milliseconds to make, so those of one question serve the next. To be made on the current
/// device.
class CudaSlots {
 public:
  /// For so many slots of a size, and so many bytes of arrays. Memory is allocated in few pieces,
  /// because each allocation takes time. Throws ResourceError with CUDA's reason.
  CudaSlots(std::uint32_t slots, const CudaSlotSize& size, std::uint64_t array_bytes)
      : host(slots * size.pinned()),
        device(slots * size.device()),
        arrays(array_bytes),
        streams(slots) {
    // A Clearance has padding, which is copied, too, so it must be initialised.
    if (device.bytes() > 0) check_cuda(cudaMemset(device.data(), 0, device.bytes()));
  }

  bool are_enough_for(std::uint32_t slots, const CudaSlotSize& size,
                      std::uint64_t array_bytes) const {
    return streams.size() >= slots && host.bytes() >= slots * size.pinned() &&
           device.bytes() >= slots * size.device() && arrays.bytes() >= array_bytes;
  }
  std::uint64_t device_bytes() const { return device.bytes() + arrays.bytes(); }

  PinnedBuffer host;
  DeviceBuffer device, arrays;
  std::vector<CudaSlotStream> streams;
  DeviceClock clock;
};

}  // namespace clearway
