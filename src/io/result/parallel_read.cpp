#include "io/result/parallel_read.hpp"

#include <tbb/parallel_for.h>

#include <atomic>

#include "core/util/tsan_annotations.hpp"

namespace clearway {
namespace {

template <typename Visit>
void for_each_index(std::size_t count, Visit visit) {
  const ParallelScope scope;
  const auto piece = piece_of(scope, visit);
  scope.begin();
  tbb::parallel_for(std::size_t{0}, count, piece);
}

}  // namespace

bool ParallelRead::run() const {
  std::atomic<bool> well = true;
  for_each_index(pieces_.size(), [&](std::size_t i) {
    if (!pieces_[i]()) well = false;
  });
  if (!well) return false;
  for_each_index(columns_.size(), [&](std::size_t i) { columns_[i](); });
  return true;
}

}  // namespace clearway
