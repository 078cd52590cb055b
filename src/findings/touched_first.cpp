#include "findings/touched_first.hpp"

#include <tbb/parallel_for.h>
#include <tbb/spin_mutex.h>

#include <algorithm>
#include <array>

#include "core/util/tsan_annotations.hpp"
#include "findings/side.hpp"

namespace clearway {

void find_touched_first(const CellGrid& grid, const PointGroups& groups,
                        const CollidingPoints& points, std::span<const std::uint32_t> part_of_row,
                        const Quantisation& quantisation, const AheadLeftUp& axes,
                        std::vector<TouchedFirst>& parts, Progress& progress) {
  using Range = tbb::blocked_range<std::uint32_t>;
  std::array<tbb::spin_mutex, 64> locks;
  const auto add = [&](const GridPoint& p) {
    const std::uint32_t number = part_of_row[p.row] - 1;
    TouchedFirst& part = parts[number];
    if (points.first_pose[p.row] != part.first_pose) return;
    if (part.body && !points.body.empty() && points.body[p.row] != *part.body) return;
    const Vec3 place = position(quantisation, p.q[0], p.q[1], p.q[2]);
    const Vec3 there =
        part.pose != nullptr ? ahead_left_up(place, *part.pose, axes.forward, axes.up) : Vec3{};
    tbb::spin_mutex& lock = locks[number % locks.size()];
    const tbb::spin_mutex::scoped_lock held(lock);
    acquire(&lock);
    if (p.row == part.row) part.place = place;
    part.seen.extend(there);
    release(&lock);
  };
  const ParallelScope scope;
  const auto add_cells = piece_of(scope, [&](const Range& range) {
    if (progress.stop_requested()) return;
    for (std::uint32_t cell = range.begin(); cell != range.end(); ++cell) {
      if (PointGroups::is_small(groups.of_cell[cell])) continue;
      for (const GridPoint& p : grid.points(cell)) add(p);
    }
  });
  scope.begin();
  tbb::parallel_for(Range(0, grid.cells(), 64), add_cells);
  throw_if_stopped(progress);
}

}  // namespace clearway
