#include "cpu/kdtree_engine.hpp"

#include <omp.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstdint>
#include <exception>
#include <functional>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "clearway/error.hpp"
#include "core/cloud/packed_cloud.hpp"
#include "core/geometry/predicate.hpp"
#include "core/geometry/rigid.hpp"
#include "core/query/ignored_points.hpp"
#include "core/query/search_result.hpp"
#include "cpu/range_search.hpp"

namespace clearway {

namespace {

/// Keeps the first exception of a parallel region until the region is over.
class FirstFailure {
 public:
  bool happened() const { return happened_.load(std::memory_order_relaxed); }

  void keep_current() {
    const std::lock_guard lock(mutex_);
    if (!failure_) failure_ = std::current_exception();
    happened_.store(true, std::memory_order_relaxed);
  }

  void rethrow() const {
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  std::mutex mutex_;
  std::exception_ptr failure_;
  std::atomic<bool> happened_ = false;
};

}  // namespace

PoseTree::PoseTree(std::span<const Pose> poses, std::uint32_t first, std::uint32_t count,
                   const Box& model, bool between_poses) {
  nodes_.reserve(std::size_t{2} * count);
  add(poses, first, count, model, between_poses);
}

std::uint32_t PoseTree::add(std::span<const Pose> poses, std::uint32_t first, std::uint32_t count,
                            const Box& model, bool between_poses) {
  const std::uint32_t reference = first + count / 2;
  double motion = 0;
  const bool moves_on = between_poses && first + count < poses.size();
  for (std::uint32_t i = first; i < first + count + (moves_on ? 1 : 0); ++i) {
    if (i != reference) {
      motion = std::max(motion, displacement_bound(model, poses[reference], poses[i]));
    }
  }
  // Each coordinate of either of two points moved by the reference pose errs by at most `rounding`.
  const double rounding =
      2 * std::sqrt(3.0) * 1.01 * transform_rounding(reach_of(model), poses[reference]);
  const auto self = static_cast<std::uint32_t>(nodes_.size());
  nodes_.push_back(
      {first, count, reference, 0, 0, motion + rounding, greatest_stretch_bound(poses[reference])});
  if (count > 1) {
    const std::uint32_t earlier = add(poses, first, count / 2, model, between_poses);
    const std::uint32_t later =
        add(poses, first + count / 2, count - count / 2, model, between_poses);
    nodes_[self].earlier = earlier;
    nodes_[self].later = later;
  }
  return self;
}

namespace {

/// The ignored points of a search without pages. During the search they count as hit at the first
/// pose, so that nothing looks for them; afterwards they are removed from the answer.
class IgnoredEntries {
 public:
  /// only: says which cells are searched; null for all. All arguments must outlive this object.
  IgnoredEntries(const PackedCloud& cloud, const QueryParameters& query,
                 const std::function<bool(std::uint32_t)>& only, int threads)
      : cloud_(cloud), ignored_(cloud, query), only_(only), threads_(threads) {}

  /// Marks the ignored points and returns their number. Throws InputError for a damaged cell.
  std::uint64_t mark(HitSet& hits);
  void take_back(HitSet& hits) const;

  static std::uint64_t most_bytes(const PackedCloud& cloud, const QueryParameters& query) {
    return query.ignores_points() ? cloud.entry_count() / kBlockPoints * sizeof(std::uint64_t) : 0;
  }

 private:
  std::uint64_t mark(std::uint32_t cell, HitSet& hits);

  const PackedCloud& cloud_;
  IgnoredPoints ignored_;
  const std::function<bool(std::uint32_t)>& only_;
  int threads_;
  /// For each 64 entries a word with a bit for each ignored one, once marked
  std::vector<std::uint64_t> words_;
};

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

/// Greatest width of a leaf of the model's spheres, in search radii.
constexpr double kLeafRadii = 2;

/// The query divided into tasks, in the order of the poses; each is a run of poses and a part of
/// the model.
class Tasks {
 public:
  Tasks(const Query& query, const ModelSpheres& model, int threads)
      : pose_count_(static_cast<std::uint32_t>(query.poses.size())) {
    // Few poses are spread over the threads by dividing the model.
    const auto wanted = static_cast<std::uint64_t>(threads) * kTasksPerThread;
    run_poses_ = static_cast<std::uint32_t>(
        std::clamp<std::uint64_t>(pose_count_ / wanted, 1, PoseTree::kMostPoses));
    spheres_ = {0};
    for (std::size_t next = 0; next < spheres_.size() && count() < wanted;) {
      const ModelSphere& sphere = model.node(spheres_[next]);
      if (sphere.children == 0) {
        ++next;
        continue;
      }
      spheres_[next] = sphere.first_child;
      for (std::uint32_t i = 1; i < sphere.children; ++i) {
        spheres_.push_back(sphere.first_child + i);
      }
    }
    parts_left_ = std::vector<std::atomic<std::uint32_t>>(divide_up(pose_count_, run_poses_));
    for (auto& left : parts_left_) left = static_cast<std::uint32_t>(spheres_.size());
  }

  std::uint64_t count() const { return divide_up(pose_count_, run_poses_) * spheres_.size(); }

  std::uint32_t first_pose(std::uint64_t task) const {
    return static_cast<std::uint32_t>(task / spheres_.size()) * run_poses_;
  }
  std::uint32_t poses(std::uint64_t task) const {
    return std::min(run_poses_, pose_count_ - first_pose(task));
  }
  std::uint32_t sphere(std::uint64_t task) const { return spheres_[task % spheres_.size()]; }

  /// Marks a task as finished. Returns whether all of its poses are complete now.
  bool finish(std::uint64_t task) { return --parts_left_[task / spheres_.size()] == 0; }

 private:
  static constexpr std::uint64_t kTasksPerThread = 16;

  std::uint32_t pose_count_;
  std::uint32_t run_poses_;
  std::vector<std::uint32_t> spheres_;
  std::vector<std::atomic<std::uint32_t>> parts_left_;
};

void check(const Query& query) {
  if (query.poses.size() >= HitSet::kNever) {
    throw InputError("a trajectory of " + std::to_string(query.poses.size()) +
                     " poses, expected fewer than " + std::to_string(HitSet::kNever));
  }
}

/// The state that the threads of one run share.
struct Shared {
  const Query& query;
  const ModelSpheres& model;
  const EnvironmentTree& environment;
  ResolvedPoints& resolved;
  Tasks& tasks;
  Progress& progress;
  KdTreeStatistics& statistics;
  PoseJournal* journal;
  std::atomic<std::uint64_t> next_task = 0;
  std::mutex mutex{};
  FirstFailure failure{};
};

/// Takes tasks until none is left, a thread has failed, or the run has to stop.
void search_tasks(Shared& shared) {
  PoseMarkLog marks(shared.journal);
  RangeSearch search(shared.environment, shared.resolved, shared.model, shared.query, marks);
  while (!shared.failure.happened() && !shared.progress.stop_requested()) {
    const std::uint64_t task = shared.next_task++;
    if (task >= shared.tasks.count()) break;
    const std::uint32_t first = shared.tasks.first_pose(task);
    const std::uint32_t count = shared.tasks.poses(task);
    const bool known = shared.journal != nullptr && shared.journal->poses_finished(first, count);
    if (!known) {
      const PoseTree poses(shared.query.poses, first, count, shared.model.box(),
                           shared.query.between_poses);
      search.search(poses, shared.model.node(shared.tasks.sphere(task)));
      marks.flush();
    }
    if (!shared.tasks.finish(task)) continue;
    if (shared.journal != nullptr && !known) shared.journal->append_finished_poses(first, count);
    shared.progress.advance(count);
  }
  const std::lock_guard lock(shared.mutex);
  shared.statistics.tested_searches += search.tested_searches();
  shared.statistics.cache_bytes += search.allocated_bytes();
}

/// Removes what was found in cells that were not asked for, as happens in cells of a single block.
void clear_others(const PackedCloud& cloud, const std::function<bool(std::uint32_t)>& only,
                  HitSet& hits) {
  const std::uint64_t words = cloud.blocks_per_cell();
  for (std::uint32_t cell = 0; cell < cloud.cells().size(); ++cell) {
    if (!only(cell)) hits.clear_words(cell * words, words);
  }
}

}  // namespace

std::uint64_t kdtree_memory_bytes(const PackedCloud& cloud, const Query& query, int threads) {
  constexpr std::uint64_t kThreadBytes = std::uint64_t{4} << 20;
  constexpr std::uint64_t kModelPointBytes = 96;  // ordered columns and spheres
  const std::uint64_t blocks = cloud.entry_count() / kBlockPoints;
  const std::uint64_t block_bytes =
      sizeof(std::uint64_t) + sizeof(BlockBox) +
      (query.first_pose ? (kBlockPoints + 2) * sizeof(std::uint32_t) : 1);
  return blocks * block_bytes + IgnoredEntries::most_bytes(cloud, query) +
         cloud.tree().size() * sizeof(std::uint32_t) +
         query.model.vertices.size() * kModelPointBytes +
         static_cast<unsigned>(threads) * kThreadBytes;
}

HitSet run_kdtree(const PackedCloud& cloud, const Query& query, const KdTreeOptions& options,
                  Progress& progress, KdTreeStatistics* statistics) {
  check(query);
  KdTreeStatistics counted;
  counted.searches = std::uint64_t{query.poses.size()} * query.model.vertices.size();
  HitSet hits(cloud.entry_count(), query.first_pose);
  progress.begin("search", query.poses.size(), "poses");
  const bool nothing = counted.searches == 0 || cloud.tree().empty() ||
                       !(rounded_product(query.radius, query.radius) > 0);
  if (!nothing) {
    const int threads = options.threads > 0 ? options.threads : omp_get_max_threads();
    const ModelSpheres model(query.model.vertices, kLeafRadii * query.radius);
    const EnvironmentTree environment(cloud, threads);
    ResolvedPoints resolved(environment, hits);
    Tasks tasks(query, model, threads);
    if (options.only) resolved.leave_out([&](std::uint32_t cell) { return !options.only(cell); });
    IgnoredEntries ignored(cloud, query, options.only, threads);
    counted.ignored_points = ignored.mark(hits);
    if (options.journal != nullptr) options.journal->restore(hits);
    Shared shared{query, model, environment, resolved, tasks, progress, counted, options.journal};
#pragma omp parallel num_threads(threads)
    {
      try {
        search_tasks(shared);
      } catch (...) {
        shared.failure.keep_current();
      }
    }
    shared.failure.rethrow();
    if (shared.next_task < tasks.count()) throw Interrupted("interrupted");
    ignored.take_back(hits);
    if (options.only) clear_others(cloud, options.only, hits);
    counted.allocated_bytes =
        hits.allocated_bytes() + environment.allocated_bytes() + resolved.allocated_bytes();
  }
  progress.end();
  if (statistics != nullptr) *statistics = counted;
  return hits;
}

}  // namespace clearway
