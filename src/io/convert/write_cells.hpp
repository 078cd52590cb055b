#pragma once

#include <cstddef>

#include "core/util/progress.hpp"
#include "io/convert/distribute/distribution.hpp"
#include "io/convert/lattice.hpp"
#include "io/convert/split_tree.hpp"
#include "io/convert/stage_clocks.hpp"
#include "io/store/store_metadata.hpp"
#include "io/store/store_writer.hpp"

namespace clearway {

/// Partitions and packs the units, several at a time as memory allows, and writes their cells in
/// order.
void write_cells(Distribution& distribution, const SplitTree& tree, const Lattice& lattice,
                 const StoreMetadata& metadata, std::size_t units_in_flight, StoreWriter& writer,
                 StageClocks& clocks, Progress& progress);

}  // namespace clearway
