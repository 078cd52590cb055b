#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "core/cloud/packed_cloud.hpp"

namespace clearway {

class KeptOnDevice;

/// What stays on the GPUs between the questions of a session. Only in a build with CUDA is anything
/// kept. Thread safe.
class KeptOnGpus {
 public:
  /// The cloud outlives it.
  explicit KeptOnGpus(const PackedCloud& cloud) : cloud_(cloud) {}

  bool are_of(const PackedCloud& cloud) const { return &cloud == &cloud_; }

  /// The part of a budget of device memory that is left to questions.
  std::uint64_t left_of(std::uint64_t budget_bytes) const;

  /// Whether a model and its field, of so many bytes, stay on the GPUs.
  bool keeps_model(std::uint64_t bytes, std::uint64_t budget_bytes) const;

  using OnDevices = std::map<int, std::shared_ptr<KeptOnDevice>>;
  /// What is kept on these GPUs, by CUDA's numbers; empty where nothing is, because there was too
  /// little memory.
  OnDevices on(const std::vector<int>& gpus, std::uint64_t budget_bytes);

  /// Gives back what is kept now. What engines use stays as long as they.
  void forget_all();
  /// Keeps nothing on the GPUs from now on, for questions that need their memory. What engines use
  /// stays as long as they. Returns whether anything was kept before.
  bool give_way();

 private:
  const PackedCloud& cloud_;
  mutable std::mutex mutex_;
  bool keeps_ = true;
  OnDevices devices_;
};

}  // namespace clearway
