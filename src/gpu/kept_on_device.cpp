#include "gpu/kept_on_device.hpp"

#include <algorithm>

namespace clearway {
namespace {

/// Makes a device the current one of the thread.
int made_current(int device) {
  check_cuda(cudaSetDevice(device));
  return device;
}

// Shares of what may be kept on the device.
constexpr std::uint64_t kCellsShare = 2, kModelsShare = 4, kSlotsShare = 4;

}  // namespace

KeptOnDevice::KeptOnDevice(int device, const PackedCloud& cloud, std::uint64_t bytes)
    : device_(made_current(device)), bytes_(bytes), cells_(cloud, bytes / kCellsShare) {}

KeptOnDevice::~KeptOnDevice() { cudaSetDevice(device_); }

std::uint64_t KeptOnDevice::most_model_bytes(std::uint64_t bytes) { return bytes / kModelsShare; }

std::shared_ptr<const void> KeptOnDevice::model(const std::shared_ptr<const void>& field,
                                                const std::function<KeptModel()>& make) {
  // With the lock, because a second copy of the same field would take its memory twice.
  const std::lock_guard lock(mutex_);
  const auto kept =
      std::ranges::find_if(models_, [&](const KeptModel& one) { return one.key == field; });
  if (kept != models_.end()) {
    models_.splice(models_.begin(), models_, kept);
    return kept->model;
  }
  KeptModel made = make();
  std::uint64_t bytes = made.bytes;
  for (auto one = models_.begin(); one != models_.end();) {
    bytes += one->bytes;
    one = bytes <= most_model_bytes(bytes_) ? std::next(one) : models_.erase(one);
  }
  if (made.bytes > most_model_bytes(bytes_)) return made.model;  // it stays for its question alone
  models_.push_front(made);
  return made.model;
}

std::unique_ptr<CudaSlots> KeptOnDevice::slots(std::uint32_t slots, const CudaSlotSize& size,
                                               std::uint64_t array_bytes) {
  {
    const std::lock_guard lock(mutex_);
    const auto enough = std::ranges::find_if(
        slots_, [&](const auto& one) { return one->are_enough_for(slots, size, array_bytes); });
    if (enough != slots_.end()) {
      std::unique_ptr<CudaSlots> taken = std::move(*enough);
      slots_.erase(enough);
      return taken;
    }
  }
  return std::make_unique<CudaSlots>(slots, size, array_bytes);
}

void KeptOnDevice::keep(std::unique_ptr<CudaSlots> slots) {
  std::vector<std::unique_ptr<CudaSlots>> ended;  // freed without the lock
  const std::lock_guard lock(mutex_);
  slots_.insert(slots_.begin(), std::move(slots));
  std::uint64_t bytes = 0;
  std::erase_if(slots_, [&](std::unique_ptr<CudaSlots>& one) {
    bytes += one->device_bytes();
    if (bytes <= bytes_ / kSlotsShare) return false;
    ended.push_back(std::move(one));
    return true;
  });
}

}  // namespace clearway
