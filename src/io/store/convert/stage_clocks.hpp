#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "clearway/convert.hpp"

namespace clearway {

/// The stages of a conversion, for measuring what its threads do.
enum class Stage : std::uint8_t {
  kRead,        ///< reading inputs and converting them to the store's integers
  kHash,        ///< hashing points and files in order, one thread at a time
  kCount,       ///< counting points in the counting grid
  kGroup,       ///< grouping points by unit
  kDistribute,  ///< writing groups to the regions of their units
  kLoad,        ///< loading the regions of units
  kOrder,       ///< partitioning units into k-d order
  kPack,
  kWrite,    ///< writing packed cells and the index, one thread at a time
  kConfirm,  ///< re-reading the chunks that were written
  kSync,     ///< waiting for the disk
};

/// Thread-seconds of each stage. Several threads may measure at once.
class StageClocks {
  using Clock = std::chrono::steady_clock;

 public:
  class Running {
   public:
    explicit Running(std::atomic<std::int64_t>& nanoseconds) : nanoseconds_(nanoseconds) {}
    ~Running() {
      using std::chrono::nanoseconds;
      nanoseconds_ += std::chrono::duration_cast<nanoseconds>(Clock::now() - start_).count();
    }
    Running(const Running&) = delete;
    Running& operator=(const Running&) = delete;

   private:
    std::atomic<std::int64_t>& nanoseconds_;
    Clock::time_point start_ = Clock::now();
  };

  /// Measures until the returned object is destroyed. Meant for pieces of work, not for single
  /// points.
  [[nodiscard]] Running measure(Stage stage) {
    return Running(nanoseconds_[static_cast<std::size_t>(stage)]);
  }

  std::vector<StageSeconds> seconds() const {
    std::vector<StageSeconds> all;
    for (std::size_t i = 0; i < kNames.size(); ++i) {
      all.push_back({kNames[i], static_cast<double>(nanoseconds_[i]) * 1e-9});
    }
    return all;
  }

 private:
  static constexpr std::array<const char*, 11> kNames{"read",       "hash",    "count", "group",
                                                      "distribute", "load",    "order", "pack",
                                                      "write",      "confirm", "sync"};
  std::array<std::atomic<std::int64_t>, kNames.size()> nanoseconds_{};
};

}  // namespace clearway
