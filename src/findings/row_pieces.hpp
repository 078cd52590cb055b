#pragma once

#include <tbb/spin_mutex.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include "core/util/tsan_annotations.hpp"
#include "findings/point_blocks.hpp"
#include "io/files/parallel_loop.hpp"
#include "io/result/result.hpp"

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

/// Calls visit(rows, the number of their first one) for all colliding points of a result, some rows
/// at a time, and then for its near points, whose numbers follow those of the colliding ones.
template <typename Visit>
void for_each_rows(const ResultReader& result, const Visit& visit) {
  std::size_t first = 0;
  const auto all = [&]<typename Rows>(RowStream<Rows> stream) {
    for (Rows rows; stream.read(rows); first += rows.size()) visit(std::as_const(rows), first);
  };
  all(RowStream<Collisions>(result));
  all(RowStream<Nearby>(result));
}

/// The last pose that touches a point; for a near point its first one, because no search looks for
/// another.
template <typename Rows>
std::uint32_t last_pose_of(const Rows& rows, std::size_t i) {
  if constexpr (requires { rows.last_pose; }) return rows.last_pose[i];
  return rows.first_pose[i];
}

/// Computes the stored integers of the points of some rows, by the threads of the caller's arena.
/// Throws InputError for coordinates that are not those of stored integers.
template <typename Rows>
void requantize(const ResultReader& result, const Rows& rows, std::span<QuantumPoint> out);

/// Guards values that several threads change at the same time, each by its number.
class SharedLocks {
 public:
  /// Calls act() while no other thread does so for the same number.
  template <typename Act>
  void hold(std::size_t number, const Act& act) {
    tbb::spin_mutex& lock = locks_[number % locks_.size()];
    const tbb::spin_mutex::scoped_lock held(lock);
    acquire(&lock);
    act();
    release(&lock);
  }

 private:
  std::array<tbb::spin_mutex, 256> locks_;
};

}  // namespace clearway
