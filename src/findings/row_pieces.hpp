#pragma once

#include <tbb/parallel_for.h>

#include <cstddef>

#include "core/util/tsan_annotations.hpp"

namespace clearway {

/// Calls visit(first, end) for pieces of `count` rows, by the threads of the caller's arena of
/// oneTBB. The pieces depend on `count` alone.
template <typename Visit>
void in_pieces(std::size_t count, const Visit& visit) {
  constexpr std::size_t kRows = 2048;
  const ParallelScope scope;
  const auto piece = piece_of(scope, [&](std::size_t i) {
    const std::size_t first = i * kRows;
    visit(first, first + kRows < count ? first + kRows : count);
  });
  scope.begin();
  tbb::parallel_for(std::size_t{0}, (count + kRows - 1) / kRows, piece);
}

}  // namespace clearway
