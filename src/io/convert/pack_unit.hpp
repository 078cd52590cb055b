#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/geometry/quantisation.hpp"
#include "io/convert/distribute/distribution.hpp"
#include "io/convert/split_tree.hpp"
#include "io/convert/stage_clocks.hpp"
#include "io/convert/unit_buffers.hpp"
#include "io/store/store_writer.hpp"

namespace clearway {

/// Memory that loading, ordering and packing one full unit takes: 20 bytes a point as distributed,
/// 32 for ordering, 20 packed at the most, and with classes one more.
constexpr std::uint64_t unit_bytes(bool has_classes) {
  return kBucketPoints * (has_classes ? 73 : 72);
}

/// Loads a unit and orders its buckets; packs its cells in the store's order, piece by piece, as
/// padded cells can be far larger than their points.
class OrderedUnit {
 public:
  OrderedUnit(Distribution& distribution, std::size_t unit, const SplitTree& tree,
              const Lattice& lattice, const StoreMetadata& metadata, UnitBuffers& buffers,
              StageClocks& clocks);
  ~OrderedUnit();

  /// The next cells, with padding at most kBucketPoints points but at least a cell; empty at the
  /// end.
  std::vector<PackedCell> pack_next();
  /// Cells that pack_next() has not given yet.
  std::size_t cells_left() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace clearway
