#pragma once

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include "core/util/tsan_annotations.hpp"

namespace clearway {

/// Calls body(i) for all i below `count`, in parallel, from within a piece of other parallel work.
/// A thread that waits for this loop does not begin another piece of that work meanwhile, and the
/// end of another piece by an exception does not end this loop, which would be early and without
/// an exception.
template <typename Index, typename Body>
void for_each_nested(Index count, const Body& body) {
  tbb::this_task_arena::isolate([&] {
    tbb::task_group_context own(tbb::task_group_context::isolated);
    const ParallelScope scope;
    const auto piece = piece_of(scope, [&](Index i) { body(i); });
    scope.begin();
    tbb::parallel_for(Index{0}, count, piece, own);
  });
}

}  // namespace clearway
