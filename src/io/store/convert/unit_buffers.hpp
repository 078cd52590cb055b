#pragma once

#include <cstddef>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "io/store/convert/select_split.hpp"

namespace clearway {

/// Buffers for the points of units, reused for later units because new memory costs a page fault
/// every 256 points. Thread-safe.
class UnitBuffers {
 public:
  using Buffer = std::unique_ptr<BucketPoint[]>;

  /// points: number of points in the largest unit.
  explicit UnitBuffers(std::size_t points) : points_(points) {}

  /// A buffer with arbitrary contents.
  Buffer take() {
    {
      const std::lock_guard lock(mutex_);
      if (!free_.empty()) {
        Buffer buffer = std::move(free_.back());
        free_.pop_back();
        return buffer;
      }
      free_.reserve(++made_);
    }
    return std::make_unique_for_overwrite<BucketPoint[]>(points_);
  }

  void give_back(Buffer buffer) noexcept {  // cannot throw, as free_ has room for all buffers
    const std::lock_guard lock(mutex_);
    free_.push_back(std::move(buffer));
  }

 private:
  std::size_t points_;
  std::mutex mutex_;
  std::size_t made_ = 0;
  std::vector<Buffer> free_;
};

}  // namespace clearway
