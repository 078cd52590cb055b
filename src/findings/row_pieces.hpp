#pragma once

#include <cstddef>

#include "io/files/parallel_loop.hpp"

namespace clearway {

/// Calls visit(first, end) for pieces of `count` rows, by the threads of the caller's arena of
/// oneTBB. The pieces depend on `count` alone.
template <typename Visit>
void in_pieces(std::size_t count, const Visit& visit) {
  constexpr std::size_t kRows = 2048;
  for_each_parallel((count + kRows - 1) / kRows, [&](std::size_t i) {
    const std::size_t first = i * kRows;
    visit(first, first + kRows < count ? first + kRows : count);
  });
}

}  // namespace clearway
