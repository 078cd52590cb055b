#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "core/geometry/quantisation.hpp"
#include "io/store/convert/distribute.hpp"
#include "io/store/convert/origin_table.hpp"
#include "io/store/convert/select_split.hpp"
#include "io/store/convert/split_tree.hpp"
#include "io/store/convert/stage_clocks.hpp"
#include "io/store/store_writer.hpp"

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

/// Bytes of memory to load, order and pack one full unit: for each point 20 bytes as distributed,
/// 32 for ordering and at most 20 packed; one more with classes, and eight more with origins, which
/// are looked up and packed.
constexpr std::uint64_t unit_bytes(bool has_classes, bool has_origins) {
  return kBucketPoints * (72 + (has_classes ? 1 : 0) + (has_origins ? 8 : 0));
}

/// Loads a unit, orders its buckets and packs its cells in the store's order. Cells are packed
/// piece by piece, because padded cells can be far larger than their points.
class OrderedUnit {
 public:
  /// origins: the points' origins, or null where the store has none.
  OrderedUnit(Distribution& distribution, std::size_t unit, const SplitTree& tree,
              const Lattice& lattice, const StoreMetadata& metadata, const OriginTable* origins,
              UnitBuffers& buffers, StageClocks& clocks);
  ~OrderedUnit();

  /// The next cells, which including padding hold at most kBucketPoints points but are at least
  /// one; empty at the end.
  std::vector<PackedCell> pack_next();
  /// Number of cells that pack_next() has not returned yet.
  std::size_t cells_left() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace clearway
