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

/// The model of a run, or one body of its vehicle, as far as an estimate needs it.
struct EstimatedModel {
  Box box{};
  std::uint64_t points = 0;
  std::span<const Pose> poses;
};

/// Decides into how many shards runs are divided, by an estimate of their seconds.
class RunEstimate {
 public:
  /// shard_seconds: the time that one shard is to take; 0 divides no run.
  explicit RunEstimate(double shard_seconds) : shard_seconds_(shard_seconds) {}

  bool is_asked_for() const { return shard_seconds_ > 0; }

  /// The number of shards of a run with these models, at least 1. The estimate is for the device
  /// that the run asks for: a GPU, or the CPU with the run's threads, or with one thread where it
  /// names none.
  std::uint32_t shards(const RunOptions& run, const std::vector<EstimatedModel>& models);

 private:
  double shard_seconds_;
  std::optional<Store> store_;  ///< the store of the last run that was estimated
};

}  // namespace clearway::tool
