#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "stream/write/source_parts.hpp"

namespace clearway {

/// Orders the rows of a part by source index. Each thread has its own PartOrder.
template <typename Row>
class PartOrder {
 public:
  /// without_copy: orders more slowly, but takes no memory.
  explicit PartOrder(bool without_copy) : without_copy_(without_copy) {}

  static std::uint64_t most_bytes() { return SourceParts::kMostRows * sizeof(Row); }

  void order(std::span<Row> rows) {
    if (without_copy_ || rows.size() < kFew || !by_rank(rows))
      std::ranges::sort(rows, {}, &Row::source);
  }

 private:
  /// Fewer rows are sorted faster than all words of the part's bits are visited.
  static constexpr std::size_t kFew = 256;
  static constexpr std::size_t kWords = SourceParts::kMostRows / 64;

  /// Puts each row at the number of rows with a smaller source index. Returns false, with nothing
  /// done, if two rows have the same one.
  bool by_rank(std::span<Row> rows) {
    std::array<std::uint64_t, kWords> bits{};
    for (const Row& row : rows) {
      std::uint64_t& word = bits[row.source / 64 % kWords];
      const std::uint64_t bit = std::uint64_t{1} << (row.source % 64);
      if ((word & bit) != 0) return false;
      word |= bit;
    }
    std::array<std::uint32_t, kWords> before;
    std::uint32_t rank = 0;
    for (std::size_t word = 0; word < kWords; ++word) {
      before[word] = rank;
      rank += static_cast<std::uint32_t>(std::popcount(bits[word]));
    }
    copy_.assign(rows.begin(), rows.end());
    for (const Row& row : copy_) {
      const std::size_t word = row.source / 64 % kWords;
      const std::uint64_t below = (std::uint64_t{1} << (row.source % 64)) - 1;
      rows[before[word] + static_cast<std::uint32_t>(std::popcount(bits[word] & below))] = row;
    }
    return true;
  }

  bool without_copy_;
  std::vector<Row> copy_;
};

}  // namespace clearway
