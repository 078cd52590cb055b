#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <vector>

#include "clearway/error.hpp"
#include "core/geometry/quantisation.hpp"
#include "core/util/macros.hpp"

namespace clearway {

/// Number of points of one block, a leaf of the tree inside a cell.
inline constexpr std::uint32_t kBlockPoints = 64;
/// Diagonal of a block of points of a surface in units of their spacing: it is 8 spacings wide and
/// 8 high.
inline constexpr double kSpacingsOfBlock = 11.3;

CLEARWAY_HD constexpr std::uint64_t divide_up(std::uint64_t n, std::uint64_t unit) {
  return (n + unit - 1) / unit;
}

/// The split rule of the store's k-d order: of n > unit points made of units of `unit` points (the
/// last may be short), the left part has unit * ceil(ceil(n / unit) / 2) points.
CLEARWAY_HD constexpr std::uint64_t left_count(std::uint64_t n, std::uint64_t unit) {
  return unit * divide_up(divide_up(n, unit), 2);
}

/// One cell of a store: `count` points (never 0) and their box.
struct Cell {
  std::uint32_t count;
  QuantumBox box;
};

/// A node of the explicit top of the store's k-d tree, in preorder: its left child follows it.
/// A leaf (right == 0) is a bucket, whose cells follow the store's split rule.
struct TopNode {
  std::uint32_t first_cell;
  std::uint32_t cell_count;
  std::uint32_t right;  ///< index of the right child, 0 for a leaf
  friend bool operator==(const TopNode&, const TopNode&) = default;
};

/// A node of the whole tree over cells, in preorder: the left child of node i is i + 1. A leaf
/// (right == 0) is one cell.
struct TreeNode {
  std::uint32_t first_cell;
  std::uint32_t cell_count;
  std::uint32_t right;
  QuantumBox box;  ///< box around the node's points
};

/// Expands the top tree down to single cells and gives every node the box of its cells. Empty for
/// no cells. Throws InputError if `top` is not a tree over exactly these cells.
std::vector<TreeNode> build_cell_tree(std::span<const TopNode> top, std::span<const Cell> cells);

// The bytes of one chunk of a store's point datasets, as HDF5's scale-offset filter writes them
// for integers with an undefined fill value (docs/design/store-format.md, "Packed chunks"): a
// 21-byte header (minbits, 8, minimum, zeros), then value - minimum in `minbits` bits each, most
// significant bit first. Value: std::int32_t, std::uint32_t, std::uint64_t or std::uint8_t.

inline constexpr std::size_t kPackedHeaderBytes = 21;

template <std::integral Value>
inline constexpr unsigned kValueBits = 8 * sizeof(Value);

/// Size of a chunk of `count` values in `minbits` bits, bytes.
template <std::integral Value>
constexpr std::uint64_t packed_bytes(std::uint64_t count, unsigned minbits) {
  if (minbits == kValueBits<Value>) return kPackedHeaderBytes + count * sizeof(Value);
  return kPackedHeaderBytes + count * minbits / 8 + 1;
}

/// A validated view of a packed chunk: values can be read at random, never past the chunk's bytes.
/// Does not own the bytes.
template <std::integral Value>
class PackedChunk {
 public:
  using Unsigned = std::make_unsigned_t<Value>;

  PackedChunk() = default;

  /// bytes: a whole chunk of exactly `count` values; throws InputError otherwise, to which the
  /// caller adds file and cell.
  PackedChunk(std::span<const std::byte> bytes, std::uint32_t count);

  /// A chunk that was validated before, made from the parts of its header and the payload after it.
  static PackedChunk of_payload(const std::byte* payload, std::uint32_t count, unsigned minbits,
                                Value minimum);

  std::uint32_t size() const { return count_; }
  unsigned minbits() const { return minbits_; }
  /// Minimum from the header; not that of the values if minbits() is the full width.
  Value minimum() const { return static_cast<Value>(minimum_); }
  /// The bytes after the header.
  const std::byte* payload() const { return payload_; }

  /// Value number `index`, which must be below size().
  Value operator[](std::uint32_t index) const;

  /// Decodes values first .. first + out.size() - 1 into `out`.
  void decode(std::uint32_t first, std::span<Value> out) const;

 private:
  std::uint64_t window(std::uint64_t byte) const;

  const std::byte* payload_ = nullptr;
  std::uint64_t payload_bytes_ = 0;
  Unsigned minimum_ = 0;
  unsigned minbits_ = 0;
  std::uint32_t count_ = 0;
};

/// Appends the packed chunk of `values` (at least one) to `out`. The byte that HDF5 1.10.8 leaves
/// uninitialised at the end of the payload is zero.
template <std::integral Value>
void append_packed_chunk(std::span<const Value> values, std::vector<std::byte>& out);

// ---- implementation

template <std::integral Value>
inline PackedChunk<Value> PackedChunk<Value>::of_payload(const std::byte* payload,
                                                         std::uint32_t count, unsigned minbits,
                                                         Value minimum) {
  PackedChunk chunk;
  chunk.payload_ = payload;
  chunk.payload_bytes_ = packed_bytes<Value>(count, minbits) - kPackedHeaderBytes;
  chunk.minimum_ = static_cast<Unsigned>(minimum);
  chunk.minbits_ = minbits;
  chunk.count_ = count;
  return chunk;
}

/// Eight bytes from `byte` on as a big-endian number; bytes past the payload read as zero.
template <std::integral Value>
inline std::uint64_t PackedChunk<Value>::window(std::uint64_t byte) const {
  std::uint64_t word = 0;
  if (byte + 8 <= payload_bytes_) [[likely]] {
    std::memcpy(&word, payload_ + byte, 8);
    return __builtin_bswap64(word);
  }
  for (unsigned i = 0; i < 8; ++i) {
    word <<= 8;
    if (byte + i < payload_bytes_) word |= std::to_integer<std::uint64_t>(payload_[byte + i]);
  }
  return word;
}

template <std::integral Value>
inline Value PackedChunk<Value>::operator[](std::uint32_t index) const {
  if (minbits_ == 0) return static_cast<Value>(minimum_);
  if (minbits_ == kValueBits<Value>) {
    Value value;
    std::memcpy(&value, payload_ + std::uint64_t{index} * sizeof(Value), sizeof(Value));
    return value;
  }
  const std::uint64_t bit = std::uint64_t{index} * minbits_;
  const auto shift = static_cast<unsigned>(bit % 8);
  std::uint64_t delta = window(bit / 8) << shift;
  if constexpr (sizeof(Value) == 8) {
    if (shift + minbits_ > 64) {  // takes bits of the ninth byte
      delta |= window(bit / 8 + 8) >> (64 - shift);
    }
  }
  delta >>= 64 - minbits_;
  return static_cast<Value>(static_cast<Unsigned>(minimum_ + static_cast<Unsigned>(delta)));
}

template <std::integral Value>
inline void PackedChunk<Value>::decode(std::uint32_t first, std::span<Value> out) const {
  if constexpr (sizeof(Value) == 4) {
    const std::uint64_t end_bit = (std::uint64_t{first} + out.size()) * minbits_;
    if (minbits_ > 0 && minbits_ < kValueBits<Value> && end_bit / 8 + 8 <= payload_bytes_) {
      std::uint64_t bit = std::uint64_t{first} * minbits_;
      for (std::size_t i = 0; i < out.size(); ++i, bit += minbits_) {
        std::uint64_t word;  // all eight bytes are inside the payload
        std::memcpy(&word, payload_ + bit / 8, 8);
        const std::uint64_t delta = __builtin_bswap64(word) << (bit % 8) >> (64 - minbits_);
        out[i] = static_cast<Value>(static_cast<Unsigned>(minimum_ + static_cast<Unsigned>(delta)));
      }
      return;
    }
  }
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i] = (*this)[first + static_cast<std::uint32_t>(i)];
  }
}

extern template class PackedChunk<std::int32_t>;
extern template class PackedChunk<std::uint32_t>;
extern template class PackedChunk<std::uint64_t>;
extern template class PackedChunk<std::uint8_t>;

/// The block boxes of a cell where they lie in memory, which need not be aligned: one for each
/// block of a full cell. Those of blocks past the cell's count are zero.
class BlockBoxes {
 public:
  explicit BlockBoxes(std::span<const std::byte> bytes) : bytes_(bytes) {}
  BlockBox operator[](std::size_t block) const {
    BlockBox box;
    std::memcpy(&box, bytes_.data() + block * sizeof box, sizeof box);
    return box;
  }
  std::span<const std::byte> bytes() const { return bytes_; }

 private:
  std::span<const std::byte> bytes_;
};

/// The environment as the engines see it: packed cells in k-d order. An *entry* is a place for a
/// point in that order: entry = cell * cell_entries() + index in the cell, so that block b of a
/// cell is 64 entries, one word of a HitSet. Entries past a cell's count are unused.
class PackedCloud {
 public:
  virtual ~PackedCloud() = default;

  virtual std::uint64_t point_count() const = 0;
  virtual std::uint32_t cell_points() const = 0;
  virtual const Quantisation& quantisation() const = 0;
  virtual std::span<const Cell> cells() const = 0;
  /// The tree over cells, in preorder. Empty for an empty cloud.
  virtual std::span<const TreeNode> tree() const = 0;
  /// The block boxes of a cell, which are checked against their hash at the first touch. Thread
  /// safe. Throws as coordinates() does.
  virtual BlockBoxes blocks(std::uint32_t cell) const = 0;

  /// The packed x, y and z of a cell, which are checked against the cell's hash at the first touch.
  /// Thread safe. Throws InputError naming file and cell if the bytes are not those that were
  /// written.
  virtual std::array<PackedChunk<std::int32_t>, 3> coordinates(std::uint32_t cell) const = 0;

  /// coordinates() for a look that is not part of a search: it does not count as a touch.
  virtual std::array<PackedChunk<std::int32_t>, 3> peek(std::uint32_t cell) const {
    return coordinates(cell);
  }

  /// coordinates() of which the caller reads one block.
  virtual std::array<PackedChunk<std::int32_t>, 3> coordinates_of_block(std::uint32_t cell) const {
    return coordinates(cell);
  }

  /// Size of the packed x, y and z of a cell together, bytes.
  virtual std::uint64_t packed_bytes(std::uint32_t cell) const = 0;

  /// Reads the packed x, y and z of a cell, one after another, into `to`, which has
  /// packed_bytes(cell) bytes, and checks them against the cell's hashes. The chunks returned are
  /// views of `to`. Thread safe. Throws InputError naming file and cell if the bytes are not those
  /// that were written, ResourceError if they cannot be read.
  virtual std::array<PackedChunk<std::int32_t>, 3> read_packed(std::uint32_t cell,
                                                               std::span<std::byte> to) const = 0;

  /// The packed x, y and z of a cell in memory that stays as it is while the cloud lives, where a
  /// decoder may read whole words past each payload; nothing where only copies can be read so.
  /// Thread safe. Throws as coordinates() does.
  virtual std::optional<std::array<PackedChunk<std::int32_t>, 3>> in_place(
      std::uint32_t /*cell*/) const {
    return std::nullopt;
  }

  /// The source index of a point by its index in its cell. Thread safe. Throws InputError if the
  /// cell is damaged.
  virtual std::uint64_t source_of(std::uint32_t cell, std::uint32_t index) const = 0;

  /// Whether points have classes; otherwise all points have class 0.
  virtual bool has_classes() const { return false; }
  /// The packed classes of a cell, in the order of its points; only if has_classes(). Thread safe.
  /// Throws InputError if the cell is damaged.
  virtual PackedChunk<std::uint8_t> classes(std::uint32_t /*cell*/) const { return {}; }

  /// A box around all points; with those that a store left out because they are far from a path.
  /// The cloud has at least one point.
  virtual Box bounds() const { return position_box(quantisation(), tree()[0].box); }

  /// The median diagonal of the blocks, metres, found from a sample where there are many. The cloud
  /// has at least one point.
  virtual double typical_block() const;

  /// Bytes of memory that cells and tree occupy, and the blocks of a cloud that lies in memory.
  virtual std::uint64_t allocated_bytes() const { return 0; }

  /// The box of a block of a cell. Throws as blocks() does.
  Box block_box(std::uint32_t cell, std::uint32_t block) const {
    return position_box(quantisation(), decode_block_box(cells()[cell].box, blocks(cell)[block]));
  }

  std::uint32_t blocks_per_cell() const {
    return static_cast<std::uint32_t>(divide_up(cell_points(), kBlockPoints));
  }
  std::uint32_t cell_entries() const { return blocks_per_cell() * kBlockPoints; }
  std::uint64_t entry_count() const { return std::uint64_t{cells().size()} * cell_entries(); }
};

/// The largest |coordinate| of the cloud's bounds(), metres; 0 for no points.
double largest_coordinate(const PackedCloud& cloud);

}  // namespace clearway
