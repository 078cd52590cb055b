#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/cloud/packed_cloud.hpp"
#include "core/geometry/quantisation.hpp"
#include "core/util/macros.hpp"

/// A page: one run of bytes that holds what an engine needs of some planned cells, the same on the
/// host and on a device. Layout: PageCell[cells]; motion nodes uint32[nodes]; BlockBox[cells *
/// blocks_per_cell]; if points are ignored, masks uint64[cells * blocks_per_cell]; then the packed
/// payloads, except those that lie elsewhere in the memory of the page's address. Each section is
/// aligned to kPageAlignment bytes. After every payload at least kPagePadding bytes can be read, so
/// that a decoder may read whole words past it; those at the end of the page are zeros.
namespace clearway {

inline constexpr std::size_t kPageAlignment = 16;
inline constexpr std::size_t kPagePadding = 16;

/// The payload of one packed chunk (core/cloud/packed_cloud.hpp): value i is `minimum` plus the
/// `minbits` bits from bit i * minbits on, most significant first. With minbits 32 the payload is
/// the little-endian values themselves.
struct PageChunk {
  /// Offset of the payload from the beginning of the page, bytes, modulo 2^64: the payload may also
  /// lie before the page or behind it, in memory that outlives the page's search.
  std::uint64_t payload;
  std::int32_t minimum;
  std::uint32_t minbits;
};

/// The x, y and z of a cell.
using CellPayload = std::array<PageChunk, 3>;

struct PageCell {
  std::uint32_t cell;   ///< index of the cell in the cloud
  std::uint32_t count;  ///< number of points
  std::uint32_t first_node;
  std::uint32_t node_count;
  QuantumBox box;
  PageChunk chunks[3];  ///< x, y, z
};

/// The sizes of a page's sections.
struct PageShape {
  std::uint32_t cells = 0;
  std::uint32_t blocks_per_cell = 0;
  std::uint32_t nodes = 0;
  std::uint64_t payload_bytes = 0;  ///< bytes of all chunks in the page together
  bool masked = false;  ///< whether points may be ignored: one word for each block says which

  CLEARWAY_HD static constexpr std::uint64_t aligned(std::uint64_t bytes) {
    return divide_up(bytes, kPageAlignment) * kPageAlignment;
  }
  CLEARWAY_HD constexpr std::uint64_t nodes_at() const {
    return aligned(std::uint64_t{cells} * sizeof(PageCell));
  }
  CLEARWAY_HD constexpr std::uint64_t blocks_at() const {
    return nodes_at() + aligned(std::uint64_t{nodes} * sizeof(std::uint32_t));
  }
  CLEARWAY_HD constexpr std::uint64_t masks_at() const {
    return blocks_at() + aligned(std::uint64_t{cells} * blocks_per_cell * sizeof(BlockBox));
  }
  CLEARWAY_HD constexpr std::uint64_t payload_at() const {
    const std::uint64_t words = masked ? std::uint64_t{cells} * blocks_per_cell : 0;
    return masks_at() + aligned(words * sizeof(std::uint64_t));
  }
  CLEARWAY_HD constexpr std::uint64_t bytes() const {
    return aligned(payload_at() + payload_bytes + kPagePadding);
  }
  constexpr PageShape without_payloads() const {
    PageShape shape = *this;
    shape.payload_bytes = 0;
    return shape;
  }
};

/// View of a page at its address, on the host or on a device. Does not own it.
struct PageRef {
  const std::byte* begin;
  PageShape shape;

  CLEARWAY_HD const PageCell& cell(std::uint32_t index) const {
    return reinterpret_cast<const PageCell*>(begin)[index];
  }
  /// Motion nodes of the cell, in the order of their poses.
  CLEARWAY_HD const std::uint32_t* nodes(const PageCell& cell) const {
    return reinterpret_cast<const std::uint32_t*>(begin + shape.nodes_at()) + cell.first_node;
  }
  /// Boxes of the cell's blocks.
  CLEARWAY_HD const BlockBox* blocks(std::uint32_t index) const {
    return reinterpret_cast<const BlockBox*>(begin + shape.blocks_at()) +
           std::uint64_t{index} * shape.blocks_per_cell;
  }
  /// The points of a block that are to be searched, as bits; bits after the cell's last point are
  /// 0.
  CLEARWAY_HD std::uint64_t searched(std::uint32_t index, std::uint32_t block) const {
    if (shape.masked) {
      return reinterpret_cast<const std::uint64_t*>(
          begin + shape.masks_at())[std::uint64_t{index} * shape.blocks_per_cell + block];
    }
    const std::uint32_t first = block * kBlockPoints, count = cell(index).count;
    if (first >= count) return 0;
    return count - first >= kBlockPoints ? ~std::uint64_t{0}
                                         : ~std::uint64_t{0} >> (kBlockPoints - (count - first));
  }
  /// Whether point `point` of a cell is to be searched.
  CLEARWAY_HD bool is_searched(std::uint32_t index, std::uint32_t point) const {
    if (!shape.masked) return point < cell(index).count;
    return (searched(index, point / kBlockPoints) >> (point % kBlockPoints) & 1) != 0;
  }
  /// The payload of a chunk.
  CLEARWAY_HD const std::byte* payload(const PageChunk& chunk) const {
    return reinterpret_cast<const std::byte*>(reinterpret_cast<std::uintptr_t>(begin) +
                                              chunk.payload);
  }
  /// Position of point `index` of a cell, metres.
  CLEARWAY_HD Vec3 position(const Quantisation& quantisation, const PageCell& cell,
                            std::uint32_t index) const {
    return clearway::position(quantisation, value(cell.chunks[0], index),
                              value(cell.chunks[1], index), value(cell.chunks[2], index));
  }
  /// Stored integer number `index` of a chunk; index must be below the cloud's cell_points.
  CLEARWAY_HD std::int32_t value(const PageChunk& chunk, std::uint32_t index) const;
};

// ---- implementation

CLEARWAY_HD inline std::int32_t PageRef::value(const PageChunk& chunk, std::uint32_t index) const {
  if (chunk.minbits == 0) return chunk.minimum;
  const std::uint64_t bit = std::uint64_t{index} * chunk.minbits;
  // Reads whole aligned words; what is past the last payload can be read too.
  const std::uintptr_t byte = reinterpret_cast<std::uintptr_t>(payload(chunk)) + bit / 8;
  const auto* words = reinterpret_cast<const std::uint32_t*>(byte - byte % 4);
  const auto shift = static_cast<std::uint32_t>(8 * (byte % 4));
  const std::uint64_t low = std::uint64_t{words[1]} << 32 | words[0];
  const std::uint64_t window =
      shift == 0 ? low : low >> shift | std::uint64_t{words[2]} << (64 - shift);
  if (chunk.minbits == 32) return static_cast<std::int32_t>(static_cast<std::uint32_t>(window));
  std::uint64_t reversed = 0;  // compilers make this a single byte swap
  for (int i = 0; i < 8; ++i) reversed |= (window >> (8 * i) & 0xff) << (56 - 8 * i);
  const std::uint64_t delta = reversed << (bit % 8) >> (64 - chunk.minbits);
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(chunk.minimum) +
                                   static_cast<std::uint32_t>(delta));
}

/// Where the coordinates of a cell lie on the host, as seen from a page.
inline CellPayload payload_at(const std::array<PackedChunk<std::int32_t>, 3>& packed,
                              const std::byte* page) {
  CellPayload at;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    at[axis] = {reinterpret_cast<std::uintptr_t>(packed[axis].payload()) -
                    reinterpret_cast<std::uintptr_t>(page),
                packed[axis].minimum(), packed[axis].minbits()};
  }
  return at;
}

/// Makes the cells of a page find their coordinates from another address than before. page: on the
/// host. now, before: the new and the old address, on the host or on a device.
inline void move_payloads(std::byte* page, std::uint32_t cells, const std::byte* now,
                          const std::byte* before) {
  const std::uint64_t farther =
      reinterpret_cast<std::uintptr_t>(before) - reinterpret_cast<std::uintptr_t>(now);
  for (std::uint32_t i = 0; i < cells; ++i) {
    for (PageChunk& chunk : reinterpret_cast<PageCell*>(page)[i].chunks) chunk.payload += farther;
  }
}

/// A chunk of a page on the host, for decoding many values at once. count: the cloud's cell_points.
inline PackedChunk<std::int32_t> packed_chunk(const PageRef& page, const PageChunk& chunk,
                                              std::uint32_t count) {
  return PackedChunk<std::int32_t>::of_payload(page.payload(chunk), count, chunk.minbits,
                                               chunk.minimum);
}

}  // namespace clearway
