#include "findings/tally_points.hpp"

#include <tbb/spin_mutex.h>

#include <memory>

#include "core/util/tsan_annotations.hpp"
#include "io/files/parallel_loop.hpp"

namespace clearway {
namespace {

using Range = tbb::blocked_range<std::uint32_t>;

/// Tallies that several threads may add to at the same time.
class SharedTallies {
 public:
  explicit SharedTallies(std::uint64_t count)
      : tallies_(count), locks_(std::make_unique<tbb::spin_mutex[]>(kLocks)) {}

  void add(std::uint64_t number, const Tally& tally) {
    tbb::spin_mutex& lock = locks_[number % kLocks];
    const tbb::spin_mutex::scoped_lock held(lock);
    acquire(&lock);
    tallies_[number].add(tally);
    release(&lock);
  }
  std::vector<Tally> take() { return std::move(tallies_); }

 private:
  static constexpr std::uint64_t kLocks = 256;
  std::vector<Tally> tallies_;
  std::unique_ptr<tbb::spin_mutex[]> locks_;
};

/// Tallies consecutive points that have the same number, and hands each such run on at its end, so
/// that locks are taken rarely.
class RunOfPoints {
 public:
  explicit RunOfPoints(SharedTallies& into) : into_(into) {}
  RunOfPoints(const RunOfPoints&) = delete;
  RunOfPoints& operator=(const RunOfPoints&) = delete;
  ~RunOfPoints() { hand_on(); }

  void add(std::uint64_t number, const GroupedPoint& p, const TouchPoses& poses) {
    if (number != number_) {
      hand_on();
      number_ = number;
    }
    tally_.add(p, poses.first[p.row], poses.last[p.row]);
  }

 private:
  void hand_on() {
    if (tally_.points > 0) into_.add(number_, tally_);
    tally_ = {};
  }

  SharedTallies& into_;
  std::uint64_t number_ = 0;
  Tally tally_;
};

/// Tallies of the points of all listed groups, or of all small ones. number_of(group, row) gives
/// the index of a point's tally.
template <typename NumberOf>
std::vector<Tally> tally_by(const CellGrid& grid, const PointGroups& groups, bool small,
                            std::uint64_t count, const TouchPoses& poses, Progress& progress,
                            NumberOf number_of) {
  SharedTallies tallies(count);
  for_each_parallel(Range(0, grid.cells(), 64), [&](const Range& range) {
    if (progress.stop_requested()) return;
    RunOfPoints run(tallies);
    for (std::uint32_t cell = range.begin(); cell != range.end(); ++cell) {
      const std::uint32_t group = groups.of_cell[cell];
      if (PointGroups::is_small(group) != small) continue;
      for (const GroupedPoint& p : grid.points(cell)) run.add(number_of(group, p.row), p, poses);
    }
  });
  throw_if_stopped(progress);
  return tallies.take();
}

}  // namespace

std::vector<Tally> tally_groups(const CellGrid& grid, const PointGroups& groups,
                                const TouchPoses& poses, Progress& progress) {
  return tally_by(grid, groups, false, groups.count, poses, progress,
                  [](std::uint32_t group, std::uint32_t) { return group; });
}

std::vector<Tally> tally_small_groups(const CellGrid& grid, const PointGroups& groups,
                                      const TouchPoses& poses, Progress& progress) {
  return tally_by(grid, groups, true, groups.small_groups, poses, progress,
                  [](std::uint32_t group, std::uint32_t) { return group & ~PointGroups::kSmall; });
}

std::vector<Tally> tally_parts(const CellGrid& grid, const PointGroups& groups,
                               const GroupParts& parts, const PathStretches& stretches,
                               const TouchPoses& poses, std::span<std::uint32_t> part_of_row,
                               Progress& progress) {
  return tally_by(grid, groups, false, parts.count(), poses, progress,
                  [&](std::uint32_t group, std::uint32_t row) {
                    std::uint64_t part = parts.first[group];
                    if (parts.is_cut[group]) {
                      part += stretches[poses.first[row]] - parts.stretch[group];
                    }
                    part_of_row[row] = static_cast<std::uint32_t>(part + 1);
                    return part;
                  });
}

}  // namespace clearway
