#pragma once

#include <tbb/parallel_for.h>

#include <bit>
#include <cstdint>
#include <vector>

#include "core/cloud/kd_order.hpp"
#include "core/util/tsan_annotations.hpp"
#include "io/store/store_reader.hpp"

namespace clearway {

/// The cells that have entries of a set, and the number of these entries in all cells.
struct SetCells {
  std::vector<std::uint32_t> cells;
  std::uint64_t entries = 0;
};

/// Calls visit(entry of bit 0, bits) for each word of a cell.
template <typename Set, typename Visit>
void for_each_word(const StoreReader& store, const Set& set, std::uint32_t cell, Visit visit) {
  const std::uint64_t first = std::uint64_t{cell} * store.blocks_per_cell();
  const std::uint64_t blocks = divide_up(store.cells()[cell].count, kBlockPoints);
  for (std::uint64_t block = 0; block < blocks; ++block) {
    visit((first + block) * kBlockPoints, set.word(first + block));
  }
}

/// Calls visit(entry, index in the cell) for every entry of a cell that is in the set.
template <typename Set, typename Visit>
void for_each_entry(const StoreReader& store, const Set& set, std::uint32_t cell, Visit visit) {
  const std::uint64_t first = std::uint64_t{cell} * store.cell_entries();
  for_each_word(store, set, cell, [&](std::uint64_t entry, std::uint64_t bits) {
    for (; bits != 0; bits &= bits - 1) {
      const std::uint64_t at = entry + static_cast<unsigned>(std::countr_zero(bits));
      visit(at, static_cast<std::uint32_t>(at - first));
    }
  });
}

template <typename Set>
SetCells cells_of(const StoreReader& store, const Set& set) {
  const auto cells = static_cast<std::uint32_t>(store.cells().size());
  std::vector<std::uint32_t> counts(cells);
  using Range = tbb::blocked_range<std::uint32_t>;
  {
    const ParallelScope scope;
    const auto count = piece_of(scope, [&](const Range& range) {
      for (std::uint32_t cell = range.begin(); cell != range.end(); ++cell) {
        for_each_word(store, set, cell, [&](std::uint64_t, std::uint64_t bits) {
          counts[cell] += static_cast<std::uint32_t>(std::popcount(bits));
        });
      }
    });
    scope.begin();
    tbb::parallel_for(Range(0, cells, 16), count);
  }
  SetCells out;
  for (std::uint32_t cell = 0; cell < cells; ++cell) {
    if (counts[cell] == 0) continue;
    out.cells.push_back(cell);
    out.entries += counts[cell];
  }
  return out;
}

}  // namespace clearway
