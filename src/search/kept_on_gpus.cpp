#include "search/kept_on_gpus.hpp"

#include "clearway/error.hpp"
#ifdef CLEARWAY_CUDA
#include "gpu/kept_on_device.hpp"
#endif

namespace clearway {
namespace {

/// The share of the budget that may stay on a GPU between questions.
constexpr std::uint64_t kKeptOfFour = 3;

std::uint64_t kept_of(std::uint64_t budget_bytes) { return budget_bytes / 4 * kKeptOfFour; }

}  // namespace

std::uint64_t KeptOnGpus::left_of(std::uint64_t budget_bytes) const {
  const std::lock_guard lock(mutex_);
  return keeps_ ? budget_bytes - kept_of(budget_bytes) : budget_bytes;
}

bool KeptOnGpus::keeps_model([[maybe_unused]] std::uint64_t bytes,
                             [[maybe_unused]] std::uint64_t budget_bytes) const {
#ifdef CLEARWAY_CUDA
  const std::lock_guard lock(mutex_);
  return keeps_ && bytes <= KeptOnDevice::most_model_bytes(kept_of(budget_bytes));
#else
  return false;
#endif
}

KeptOnGpus::OnDevices KeptOnGpus::on([[maybe_unused]] const std::vector<int>& gpus,
                                     [[maybe_unused]] std::uint64_t budget_bytes) {
  const std::lock_guard lock(mutex_);
  if (!keeps_) return {};
#ifdef CLEARWAY_CUDA
  try {
    for (const int gpu : gpus) {
      std::shared_ptr<KeptOnDevice>& kept = devices_[gpu];
      if (!kept) kept = std::make_shared<KeptOnDevice>(gpu, cloud_, kept_of(budget_bytes));
    }
  } catch (const ResourceError&) {  // others have taken the memory since it was asked for
    keeps_ = false;
    devices_.clear();
  }
#endif
  return devices_;
}

void KeptOnGpus::forget_all() {
  OnDevices ended;
  const std::lock_guard lock(mutex_);
  ended.swap(devices_);
}

bool KeptOnGpus::give_way() {
  OnDevices ended;
  const std::lock_guard lock(mutex_);
  const bool kept = keeps_;
  keeps_ = false;
  ended.swap(devices_);
  return kept;
}

}  // namespace clearway
