#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/geometry/quantisation.hpp"
#include "io/store/convert/distribute.hpp"
#include "io/store/convert/origin_table.hpp"
#include "io/store/convert/split_tree.hpp"
#include "io/store/convert/stage_clocks.hpp"
#include "io/store/convert/unit_buffers.hpp"
#include "io/store/store_writer.hpp"

namespace clearway {

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
