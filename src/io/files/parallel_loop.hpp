#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include <concepts>

#include "core/util/tsan_annotations.hpp"

namespace clearway {

/// Calls body(i) for all i below a number, or body(range) for the parts of a range of oneTBB, in
/// parallel, by the threads of the caller's arena. how: what tbb::parallel_for() takes besides.
template <typename Over, typename Body, typename... How>
void for_each_parallel(const Over& over, const Body& body, How&&... how) {
  const ParallelScope scope;
  const auto piece = piece_of(scope, [&body](const auto& part) { body(part); });
  scope.begin();
  if constexpr (std::integral<Over>) {
    tbb::parallel_for(Over{0}, over, piece, how...);
  } else {
    tbb::parallel_for(over, piece, how...);
  }
}

/// Does the same from within a piece of other parallel work. A thread that waits for this loop does
/// not begin another piece of that work meanwhile, and the end of another piece by an exception
/// does not end this loop, which would be early and without an exception.
template <typename Over, typename Body>
void for_each_nested(const Over& over, const Body& body) {
  tbb::this_task_arena::isolate([&] {
    tbb::task_group_context own(tbb::task_group_context::isolated);
    for_each_parallel(over, body, own);
  });
}

}  // namespace clearway
