#include "cpu/ignored/ignored_entries.hpp"

#include <atomic>
#include <bit>
#include <vector>

#include "cpu/first_failure.hpp"

namespace clearway {

/// visit(word, bits): of each block with ignored points, from several threads.
template <typename Visit>
std::uint64_t IgnoredEntries::for_each_word(const Visit& visit) const {
  if (!ignored_.any()) return 0;
  const std::uint32_t blocks = cloud_.blocks_per_cell();
  std::atomic<std::uint64_t> points = 0;
  FirstFailure failure;
#pragma omp parallel for schedule(dynamic, 16) num_threads(threads_)
  for (std::size_t cell = 0; cell < cloud_.cells().size(); ++cell) {
    const auto index = static_cast<std::uint32_t>(cell);
    if (failure.happened() || (only_ && !only_(index))) continue;
    try {
      std::vector<std::uint64_t> searched(blocks);
      points += ignored_.mask(index, searched, [&] { return cloud_.peek(index); });
      for (std::uint32_t block = 0; block * kBlockPoints < cloud_.cells()[cell].count; ++block) {
        const std::uint32_t left = cloud_.cells()[cell].count - block * kBlockPoints;
        const std::uint64_t all =
            ~std::uint64_t{0} >> (left < kBlockPoints ? kBlockPoints - left : 0);
        const std::uint64_t bits = all & ~searched[block];
        if (bits != 0) visit(cell * blocks + block, bits);
      }
    } catch (...) {
      failure.keep_current();
    }
  }
  failure.rethrow();
  return points;
}

std::uint64_t IgnoredEntries::mark(HitSet& hits) const {
  return for_each_word([&](std::uint64_t word, std::uint64_t bits) {
    if (!hits.has_first_pose()) return hits.mark_word(word, bits);
    for (std::uint64_t left = bits; left != 0; left &= left - 1) {
      hits.mark(word * kBlockPoints + static_cast<unsigned>(std::countr_zero(left)), 0);
    }
  });
}

void IgnoredEntries::take_back(HitSet& hits) const {
  for_each_word([&](std::uint64_t word, std::uint64_t bits) { hits.forget(word, bits); });
}

}  // namespace clearway
