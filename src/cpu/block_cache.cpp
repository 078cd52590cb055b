#include "cpu/block_cache.hpp"

namespace clearway {

BlockCache::BlockCache(const PackedCloud& cloud)
    : cloud_(cloud), tags_(kEntries, kNothing), entries_(kEntries) {}

Columns BlockCache::block(std::uint32_t cell, std::uint32_t block, std::uint32_t count) {
  const std::uint64_t tag = std::uint64_t{cell} * cloud_.blocks_per_cell() + block;
  const std::size_t entry = tag % kEntries;
  Positions& positions = entries_[entry];
  if (tags_[entry] != tag) {
    tags_[entry] = kNothing;
    decode(cell, block, count, positions);
    tags_[entry] = tag;
  }
  return {positions.axes[0], positions.axes[1], positions.axes[2]};
}

void BlockCache::decode(std::uint32_t cell, std::uint32_t block, std::uint32_t count,
                        Positions& out) {
  if (cell != open_cell_) {
    open_cell_ = 0xffffffff;
    chunks_ = cloud_.coordinates(cell);
    open_cell_ = cell;
  }
  const Quantisation& quantisation = cloud_.quantisation();
  std::array<std::int32_t, kBlockPoints> values{};
  for (int axis = 0; axis < 3; ++axis) {
    chunks_[axis].decode(block * kBlockPoints, std::span(values.data(), count));
    for (std::uint32_t i = 0; i < count; ++i) {
      out.axes[axis][i] = coordinate(quantisation, axis, values[i]);
    }
  }
}

}  // namespace clearway
