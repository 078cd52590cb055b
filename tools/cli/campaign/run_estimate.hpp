#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>

#include "clearway/box.hpp"
#include "clearway/pose.hpp"
#include "clearway/store.hpp"
#include "cli/run_options.hpp"

namespace clearway::tool {

/// Into how many shards runs are divided, by an estimate of their seconds.
class RunEstimate {
 public:
  /// shard_seconds: of each shard; 0: no run is divided.
  explicit RunEstimate(double shard_seconds) : shard_seconds_(shard_seconds) {}

  bool is_asked_for() const { return shard_seconds_ > 0; }

  /// On the CPU with the threads that are asked for, or one; on a GPU where one is asked for.
  std::uint32_t shards(const RunOptions& run, const Box& model, std::uint64_t model_points,
                       std::span<const Pose> poses);

 private:
  double shard_seconds_;
  std::optional<Store> store_;  ///< the last one
};

}  // namespace clearway::tool
