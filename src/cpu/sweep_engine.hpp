#pragma once

#include <memory>
#include <mutex>

#include "core/cell_engine.hpp"
#include "core/packed_cloud.hpp"
#include "core/sweep_filter.hpp"

namespace clearway {

/// The sweep engine on the CPU: descends a cell's implicit tree and the motion tree together, down
/// to points, each decoded once. The cloud and the filter outlive it.
class SweepEngine final : public CellEngine {
 public:
  SweepEngine(const PackedCloud& cloud, const SweepFilter& filter)
      : cloud_(cloud), filter_(filter) {}

  CellAnswer search(const PlannedCell& planned) override;

  /// Of all searches so far. Not during one.
  const SweepStatistics& statistics() const { return statistics_; }

 private:
  const PackedCloud& cloud_;
  const SweepFilter& filter_;
  std::mutex mutex_;
  SweepStatistics statistics_;
};

}  // namespace clearway
