#pragma once

#include <cstdint>
#include <vector>

#include "io/convert/distribute.hpp"
#include "io/convert/split_tree.hpp"
#include "io/store_writer.hpp"

namespace clearway {

/// Memory that loading, ordering and packing one full unit takes: 20 bytes a point as distributed,
/// 32 for ordering, 20 packed at the most.
inline constexpr std::uint64_t kUnitBytes = kBucketPoints * 72;

/// Loads unit `unit`, orders its buckets and packs their cells, in the store's order.
std::vector<PackedCell> pack_unit(const Distribution& distribution, std::size_t unit,
                                  const SplitTree& tree, const Lattice& lattice,
                                  const Quantisation& quantisation, std::uint32_t cell_points);

}  // namespace clearway
