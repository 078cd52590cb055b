#pragma once

#include <cstdint>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <vector>

#include "core/cloud/packed_cloud.hpp"
#include "gpu/cuda_slots.hpp"
#include "gpu/resident_cells.hpp"

namespace clearway {

/// What stays on one CUDA device between the questions of a session: cells, models with their
/// fields, and the slots of engines. Thread safe.
class KeptOnDevice {
 public:
  /// Keeps at most `bytes` on the device, half of them for cells. The cloud outlives it. Makes the
  /// device the current one of the thread. Throws ResourceError.
  KeptOnDevice(int device, const PackedCloud& cloud, std::uint64_t bytes);
  /// Waits for nothing: engines that use it hold what they use.
  ~KeptOnDevice();
  KeptOnDevice(const KeptOnDevice&) = delete;
  KeptOnDevice& operator=(const KeptOnDevice&) = delete;

  ResidentCells& cells() { return cells_; }
  int device() const { return device_; }

  /// A model on the device, with what it was made of: bytes there, and its owner.
  struct KeptModel {
    std::shared_ptr<const void> key;  ///< the field, which stays as long as its copy
    std::shared_ptr<const void> model;
    std::uint64_t bytes = 0;
  };
  /// The most bytes that models take together where `bytes` may be kept.
  static std::uint64_t most_model_bytes(std::uint64_t bytes);
  /// The copy of a model's field on the device, by make() unless it is kept. The least recently
  /// used ones are forgotten. make: returns the copy and its bytes.
  std::shared_ptr<const void> model(const std::shared_ptr<const void>& field,
                                    const std::function<KeptModel()>& make);

  /// Slots that are enough, made unless some are kept.
  std::unique_ptr<CudaSlots> slots(std::uint32_t slots, const CudaSlotSize& size,
                                   std::uint64_t array_bytes);
  /// Keeps slots whose work is done.
  void keep(std::unique_ptr<CudaSlots> slots);

 private:
  const int device_;
  const std::uint64_t bytes_;
  ResidentCells cells_;
  std::mutex mutex_;
  std::list<KeptModel> models_;  ///< the most recently used one first
  std::vector<std::unique_ptr<CudaSlots>> slots_;
};

}  // namespace clearway
