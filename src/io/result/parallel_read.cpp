#include "io/result/parallel_read.hpp"

#include <tbb/parallel_for.h>

#include <atomic>

#include "core/util/tsan_annotations.hpp"

namespace clearway {

bool ParallelRead::run() const {
  std::atomic<bool> well = true;
  const ParallelScope scope;
  const auto run_piece = piece_of(scope, [&](std::size_t i) {
    if (!pieces_[i]()) well = false;
  });
  scope.begin();
  tbb::parallel_for(std::size_t{0}, pieces_.size(), run_piece);
  return well;
}

}  // namespace clearway
