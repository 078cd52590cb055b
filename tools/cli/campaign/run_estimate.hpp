#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "clearway/box.hpp"
#include "clearway/pose.hpp"
#include "clearway/store.hpp"
#include "cli/run_options.hpp"

namespace clearway::tool {

/// The model of a run, or a body of its vehicle.
struct EstimatedModel {
  Box box{};
  std::uint64_t points = 0;
  std::span<const Pose> poses;
};

/// Into how many shards runs are divided, by an estimate of their seconds.
class RunEstimate {
 public:
  /// shard_seconds: of each shard; 0: no run is divided.
  explicit RunEstimate(double shard_seconds) : shard_seconds_(shard_seconds) {}

  bool is_asked_for() const { return shard_seconds_ > 0; }

  /// On the CPU with the threads that are asked for, or one; on a GPU where one is asked for.
  std::uint32_t shards(const RunOptions& run, const std::vector<EstimatedModel>& models);

 private:
  double shard_seconds_;
  std::optional<Store> store_;  ///< the last one
};

}  // namespace clearway::tool
