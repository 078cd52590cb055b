#include "core/cloud/packed_cloud.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <string>

#include "clearway/error.hpp"
#include "core/geometry/sweep_bounds.hpp"
#include "core/util/macros.hpp"

namespace clearway {
namespace {

class Builder {
 public:
  Builder(std::span<const TopNode> top, std::span<const Cell> cells) : top_(top), cells_(cells) {
    nodes_.reserve(2 * cells.size());
  }

  std::vector<TreeNode> build() {
    if (top_.empty() != cells_.empty()) fail();
    if (top_.empty()) return {};
    if (top_[0].first_cell != 0 || top_[0].cell_count != cells_.size()) fail();
    const std::uint32_t visited = add_top(0, 0);
    if (visited != top_.size()) fail();
    return std::move(nodes_);
  }

 private:
  static constexpr unsigned kDeepest = 256;  // far beyond what 2^32 cells need

  [[noreturn]] static void fail() {
    throw InputError("the tree of cells is inconsistent, expected a binary tree in preorder");
  }

  /// Adds the subtree of top node `index`; returns the index after its last top node.
  std::uint32_t add_top(std::uint32_t index, unsigned depth) {
    const TopNode node = top_[index];
    if (depth > kDeepest || node.cell_count == 0) fail();
    if (node.right == 0) {
      add_bucket(node.first_cell, node.cell_count);
      return index + 1;
    }
    if (node.right <= index + 1 || node.right >= top_.size()) fail();
    const TopNode left = top_[index + 1];
    const TopNode right = top_[node.right];
    if (left.first_cell != node.first_cell || left.cell_count >= node.cell_count ||
        right.first_cell != left.first_cell + left.cell_count ||
        right.cell_count != node.cell_count - left.cell_count) {
      fail();
    }
    const std::size_t self = open(node.first_cell, node.cell_count);
    if (add_top(index + 1, depth + 1) != node.right) fail();
    const auto right_node = static_cast<std::uint32_t>(nodes_.size());
    const std::uint32_t next = add_top(node.right, depth + 1);
    close(self, right_node);
    return next;
  }

  void add_bucket(std::uint32_t first, std::uint32_t count) {
    if (count == 1) {
      nodes_.push_back({first, 1, 0, cells_[first].box});
      return;
    }
    const std::size_t self = open(first, count);
    const auto left = static_cast<std::uint32_t>(left_count(count, 1));
    add_bucket(first, left);
    const auto right_node = static_cast<std::uint32_t>(nodes_.size());
    add_bucket(first + left, count - left);
    close(self, right_node);
  }

  std::size_t open(std::uint32_t first, std::uint32_t count) {
    nodes_.push_back({first, count, 0, {}});
    return nodes_.size() - 1;
  }

  void close(std::size_t self, std::uint32_t right) {
    nodes_[self].right = right;
    nodes_[self].box = nodes_[self + 1].box.united(nodes_[right].box);
  }

  std::span<const TopNode> top_;
  std::span<const Cell> cells_;
  std::vector<TreeNode> nodes_;
};

}  // namespace

std::vector<TreeNode> build_cell_tree(std::span<const TopNode> top, std::span<const Cell> cells) {
  return Builder(top, cells).build();
}

namespace {

constexpr std::size_t kMinimumAt = 5;  // uint32 minbits, one byte 8, then uint64 minimum

template <std::integral Value>
struct Header {
  std::uint32_t minbits;
  Value minimum;
};

template <std::integral Value>
Header<Value> header_for(Value minimum, Value maximum) {
  using Unsigned = std::make_unsigned_t<Value>;
  const auto range =
      static_cast<Unsigned>(static_cast<Unsigned>(maximum) - static_cast<Unsigned>(minimum));
  // For such a range HDF5 gives up before it notes the minimum.
  if (range > std::numeric_limits<Unsigned>::max() - 2) return {kValueBits<Value>, 0};
  return {static_cast<std::uint32_t>(std::bit_width(range)), minimum};  // ceil(log2(range + 1))
}

template <std::integral Value>
struct Range {
  Value least, greatest;
};

/// Has no branches, so that it takes full vectors. Inlined, because templates cannot be cloned.
template <std::integral Value>
[[gnu::always_inline]] inline Range<Value> find_range(const Value* values, std::size_t n) {
  Range<Value> range{values[0], values[0]};
  for (std::size_t i = 1; i < n; ++i) {
    range.least = values[i] < range.least ? values[i] : range.least;
    range.greatest = values[i] > range.greatest ? values[i] : range.greatest;
  }
  return range;
}

CLEARWAY_SIMD_CLONES
Range<std::int32_t> range_of(const std::int32_t* values, std::size_t n) {
  return find_range(values, n);
}

CLEARWAY_SIMD_CLONES
Range<std::uint32_t> range_of(const std::uint32_t* values, std::size_t n) {
  return find_range(values, n);
}

CLEARWAY_SIMD_CLONES
Range<std::uint64_t> range_of(const std::uint64_t* values, std::size_t n) {
  return find_range(values, n);
}

CLEARWAY_SIMD_CLONES
Range<std::uint8_t> range_of(const std::uint8_t* values, std::size_t n) {
  return find_range(values, n);
}

constexpr unsigned kMostJoinedBits = 57;  // with 7 pending bits they fill a word

/// Packs values in `minbits` bits, most significant bit first.
template <std::integral Value>
class BitPacker {
 public:
  using Unsigned = std::make_unsigned_t<Value>;

  BitPacker(Value minimum, unsigned minbits, std::byte* to, const std::byte* end)
      : minimum_(static_cast<Unsigned>(minimum)), minbits_(minbits), to_(to), end_(end) {}

  void pack(std::span<const Value> values) {
    if (4 * minbits_ <= kMostJoinedBits) {
      values = pack_joined<4>(values);
    } else if (2 * minbits_ <= kMostJoinedBits) {
      values = pack_joined<2>(values);
    } else if (minbits_ <= kMostJoinedBits) {
      values = pack_joined<1>(values);
    }
    for (const Value value : values) {
      pending_ = (pending_ << minbits_) | delta(value);
      pending_bits_ += minbits_;
      while (pending_bits_ >= 8) {
        pending_bits_ -= 8;
        *to_++ = static_cast<std::byte>(static_cast<unsigned char>(pending_ >> pending_bits_));
      }
    }
    if (pending_bits_ > 0) {
      *to_ = static_cast<std::byte>(static_cast<unsigned char>(pending_ << (8 - pending_bits_)));
    }
  }

 private:
  __extension__ using Window = unsigned __int128;  // up to 7 pending bits and 63 new ones

  Unsigned delta(Value value) const {
    return static_cast<Unsigned>(static_cast<Unsigned>(value) - minimum_);
  }

  /// Packs kJoined values at a time, with a whole word at each store, as long as there is room for
  /// a word. Returns the values left.
  template <unsigned kJoined>
  std::span<const Value> pack_joined(std::span<const Value> values) {
    const unsigned bits = kJoined * minbits_;
    std::uint64_t word = 0;  // holds the pending bits as its highest bits
    unsigned used = 0;
    std::byte* to = to_;
    std::size_t i = 0;
    for (; i + kJoined <= values.size() && end_ - to >= 8; i += kJoined) {
      std::uint64_t joined = 0;
      for (unsigned k = 0; k < kJoined; ++k) joined = joined << minbits_ | delta(values[i + k]);
      word |= joined << (64 - bits - used);
      const std::uint64_t big_endian = __builtin_bswap64(word);
      std::memcpy(to, &big_endian, 8);
      used += bits;
      const unsigned whole = used / 8;
      to += whole;
      word = whole == 8 ? 0 : word << 8 * whole;
      used %= 8;
    }
    to_ = to;
    pending_ = used > 0 ? word >> (64 - used) : 0;
    pending_bits_ = used;
    return values.subspan(i);
  }

  Unsigned minimum_;
  unsigned minbits_;
  std::byte* to_;
  const std::byte* end_;
  Window pending_ = 0;
  unsigned pending_bits_ = 0;
};

}  // namespace

template <std::integral Value>
PackedChunk<Value>::PackedChunk(std::span<const std::byte> bytes, std::uint32_t count)
    : count_(count) {
  if (bytes.size() < kPackedHeaderBytes) {
    throw InputError("a packed chunk of " + std::to_string(bytes.size()) +
                     " bytes, expected at least " + std::to_string(kPackedHeaderBytes));
  }
  std::uint32_t minbits = 0;
  std::memcpy(&minbits, bytes.data(), 4);
  if (minbits > kValueBits<Value>) {
    throw InputError("a packed chunk with " + std::to_string(minbits) +
                     " bits a value, expected at most " + std::to_string(kValueBits<Value>));
  }
  const auto is_zero = [](std::byte b) { return b == std::byte{0}; };
  if (bytes[4] != std::byte{8} ||
      !std::all_of(bytes.begin() + kMinimumAt + 8, bytes.begin() + kPackedHeaderBytes, is_zero)) {
    throw InputError("a packed chunk whose header is not that of HDF5's scale-offset filter");
  }
  const std::uint64_t expected = packed_bytes<Value>(count, minbits);
  if (bytes.size() != expected) {
    throw InputError("a packed chunk of " + std::to_string(bytes.size()) + " bytes, expected " +
                     std::to_string(expected) + " for " + std::to_string(count) + " values of " +
                     std::to_string(minbits) + " bits");
  }
  std::uint64_t minimum = 0;
  std::memcpy(&minimum, bytes.data() + kMinimumAt, 8);
  minimum_ = static_cast<Unsigned>(minimum);
  minbits_ = minbits;
  payload_ = bytes.data() + kPackedHeaderBytes;
  payload_bytes_ = bytes.size() - kPackedHeaderBytes;
}

template <std::integral Value>
void append_packed_chunk(std::span<const Value> values, std::vector<std::byte>& out) {
  const auto [least, greatest] = range_of(values.data(), values.size());
  const auto [minbits, minimum] = header_for(least, greatest);
  const std::size_t start = out.size();
  out.resize(start + packed_bytes<Value>(values.size(), minbits));
  std::byte* to = out.data() + start;

  std::uint64_t minimum_word = 0;
  if constexpr (std::is_signed_v<Value>) {
    minimum_word = static_cast<std::uint64_t>(std::int64_t{minimum});
  } else {
    minimum_word = minimum;
  }
  std::memcpy(to, &minbits, 4);
  to[4] = std::byte{8};
  std::memcpy(to + kMinimumAt, &minimum_word, 8);
  to += kPackedHeaderBytes;

  if (minbits == kValueBits<Value>) {
    std::memcpy(to, values.data(), values.size_bytes());
    return;
  }
  if (minbits == 0) return;
  BitPacker<Value>(minimum, minbits, to, out.data() + out.size()).pack(values);
}

template class PackedChunk<std::int32_t>;
template class PackedChunk<std::uint32_t>;
template class PackedChunk<std::uint64_t>;
template class PackedChunk<std::uint8_t>;
template void append_packed_chunk(std::span<const std::int32_t>, std::vector<std::byte>&);
template void append_packed_chunk(std::span<const std::uint32_t>, std::vector<std::byte>&);
template void append_packed_chunk(std::span<const std::uint64_t>, std::vector<std::byte>&);
template void append_packed_chunk(std::span<const std::uint8_t>, std::vector<std::byte>&);

double PackedCloud::typical_block() const {
  constexpr std::uint64_t kBlockSample = 4096;
  const std::uint64_t count = cells().size();
  const std::uint64_t a_cell = std::max<std::uint64_t>(1, kBlockSample / count);
  const std::uint64_t stride = divide_up(count, kBlockSample);
  std::vector<double> diagonals;
  for (std::uint64_t at = 0; at < count; at += stride) {
    const auto index = static_cast<std::uint32_t>(at);
    const Cell& cell = cells()[index];
    const std::uint64_t in_cell = divide_up(cell.count, kBlockPoints);
    for (std::uint64_t i = 0; i < std::min(in_cell, a_cell); ++i) {
      const std::uint64_t block = i * in_cell / std::min(in_cell, a_cell);
      diagonals.push_back(2 * half_diagonal(block_box(index, static_cast<std::uint32_t>(block))));
    }
  }
  const auto middle = diagonals.begin() + static_cast<std::ptrdiff_t>(diagonals.size() / 2);
  std::nth_element(diagonals.begin(), middle, diagonals.end());
  return *middle;
}

double largest_coordinate(const PackedCloud& cloud) {
  if (cloud.tree().empty()) return 0;
  const Box box = cloud.bounds();
  double largest = 0;
  for (int k = 0; k < 3; ++k) {
    largest = std::max({largest, std::abs(box.lo[k]), std::abs(box.hi[k])});
  }
  return largest;
}

}  // namespace clearway
