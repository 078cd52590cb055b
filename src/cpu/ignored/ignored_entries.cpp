#include "cpu/ignored/ignored_entries.hpp"

#include <atomic>
#include <bit>
#include <span>

#include "cpu/first_failure.hpp"

namespace clearway {

std::uint64_t IgnoredEntries::mark(HitSet& hits) {
  if (!ignored_.any()) return 0;
  const std::size_t blocks = cloud_.blocks_per_cell();
  words_.assign(cloud_.cells().size() * blocks, 0);
  std::atomic<std::uint64_t> points = 0;
  FirstFailure failure;
#pragma omp parallel for schedule(dynamic, 16) num_threads(threads_)
  for (std::size_t cell = 0; cell < cloud_.cells().size(); ++cell) {
    const auto index = static_cast<std::uint32_t>(cell);
    if (failure.happened() || (only_ && !only_(index))) continue;
    try {
      points += mark(index, hits);
    } catch (...) {
      failure.keep_current();
    }
  }
  failure.rethrow();
  return points;
}

std::uint64_t IgnoredEntries::mark(std::uint32_t cell, HitSet& hits) {
  const std::uint32_t blocks = cloud_.blocks_per_cell();
  const std::uint32_t count = cloud_.cells()[cell].count;
  const std::size_t first_word = std::size_t{cell} * blocks;
  const std::span words = std::span(words_).subspan(first_word, blocks);
  const std::uint64_t points = ignored_.mask(cell, words, [&] { return cloud_.peek(cell); });
  for (std::uint32_t block = 0; block < blocks; ++block) {
    const std::uint32_t first = block * kBlockPoints;
    const std::uint32_t left = first < count ? count - first : 0;
    const std::uint64_t all =
        left >= kBlockPoints ? ~std::uint64_t{0} : (std::uint64_t{1} << left) - 1;
    words[block] = all & ~words[block];
    if (!hits.has_first_pose()) {
      if (words[block] != 0) hits.mark_word(first_word + block, words[block]);
      continue;
    }
    for (std::uint64_t open = words[block]; open != 0; open &= open - 1) {
      hits.mark((first_word + block) * kBlockPoints + static_cast<unsigned>(std::countr_zero(open)),
                0);
    }
  }
  return points;
}

void IgnoredEntries::take_back(HitSet& hits) const {
  for (std::size_t word = 0; word < words_.size(); ++word) {
    if (words_[word] != 0) hits.forget(word, words_[word]);
  }
}

}  // namespace clearway
