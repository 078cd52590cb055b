#include "cpu/range_search.hpp"

#include <algorithm>
#include <bit>
#include <limits>

#include "core/geometry/predicate.hpp"

namespace clearway {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

/// Number of environment points that are narrowed down together.
constexpr std::size_t kBatchPoints = 2048;
/// Candidates that together have at most this many points are taken apart into points.
constexpr std::uint64_t kGatherPoints = 2048;
/// A node is split while it is longer than this share of the reach.
constexpr double kNodeExtent = 0.5;
/// Depth of the deepest stack of point batches: levels of spheres and of halved runs of poses.
constexpr std::size_t kDeepest = ModelSpheres::kLevels + std::bit_width(PoseTree::kMostPoses) + 2;

double greatest_extent(const Box& box) { return box.size()[box.longest_axis()]; }

}  // namespace

RangeSearch::RangeSearch(const EnvironmentTree& environment, ResolvedPoints& resolved,
                         const ModelSpheres& model, const Query& query, PoseMarkLog& marks)
    : environment_(environment),
      resolved_(resolved),
      model_(model),
      query_(query),
      marks_(marks),
      radius_squared_(rounded_product(query.radius, query.radius)),
      cache_(environment.cloud()),
      x_(kDeepest * kBatchPoints),
      y_(x_.size()),
      z_(x_.size()),
      slots_(x_.size()),
      squared_(kBatchPoints),
      hit_(kBatchPoints),
      moved_x_(model.largest_leaf()),
      moved_y_(model.largest_leaf()),
      moved_z_(model.largest_leaf()) {
  if (!query.between_poses) return;
  next_x_.resize(model.largest_leaf());
  next_y_.resize(model.largest_leaf());
  next_z_.resize(model.largest_leaf());
}

std::uint64_t RangeSearch::allocated_bytes() const {
  const std::size_t doubles =
      4 * x_.size() + squared_.size() + 3 * moved_x_.size() + 3 * next_x_.size();
  return cache_.allocated_bytes() + doubles * sizeof(double) + hit_.size() +
         candidates_.capacity() * sizeof(Candidate);
}

RangeSearch::SearchTask RangeSearch::make_task(const PoseNode& poses,
                                               const ModelSphere& sphere) const {
  const double reach =
      (query_.radius + poses.stretch * sphere.radius + poses.spread) * (1 + 16 * kEpsilon) + 1e-150;
  return {poses, sphere, transform(query_.poses[poses.reference], sphere.centre),
          reach * reach * (1 + 4 * kEpsilon),
          !resolved_.first_pose() || poses.reference == poses.first};
}

/// Calls visit(task) for the parts of a task: the halves of its poses if they move more than the
/// sphere is wide, otherwise its smaller spheres.
template <typename Visit>
void RangeSearch::for_each_half(const SearchTask& task, Visit visit) {
  const PoseNode& poses = task.poses;
  const ModelSphere& sphere = task.sphere;
  const bool split_poses =
      poses.count > 1 && (sphere.children == 0 || !(poses.spread <= poses.stretch * sphere.radius));
  if (split_poses) {
    visit(make_task(pose_tree_->node(poses.earlier), sphere));
    visit(make_task(pose_tree_->node(poses.later), sphere));
    return;
  }
  for (std::uint32_t i = 0; i < sphere.children; ++i) {
    visit(make_task(poses, model_.node(sphere.first_child + i)));
  }
}

void RangeSearch::search(const PoseTree& poses, const ModelSphere& sphere) {
  pose_tree_ = &poses;
  candidates_.clear();
  gathered_ = 0;
  const EnvironmentNode root = environment_.root();
  candidates_.push_back({root, environment_.box(root)});
  search_nodes(make_task(poses.node(0), sphere), 0, 1);
}

/// Searches a task's share of the candidates `begin` to `end` - 1, which are those of the parent
/// task.
void RangeSearch::search_nodes(const SearchTask& task, std::size_t begin, std::size_t end) {
  const std::size_t first = candidates_.size();
  const std::uint64_t points_before = candidate_points_;
  candidate_points_ = 0;
  for (std::size_t i = begin; i < end; ++i) add_candidate(task, Candidate(candidates_[i]));
  const std::size_t last = candidates_.size();
  if (first < last) {
    if (candidate_points_ <= kGatherPoints || task.at_leaves()) {
      gather(task, first, last);
    } else {
      for_each_half(task, [&](const SearchTask& part) { search_nodes(part, first, last); });
    }
  }
  candidates_.resize(first);
  candidate_points_ = points_before;
}

/// Dismisses a node, or marks all of its points. Returns true if it holds nothing that this task
/// still has to decide.
bool RangeSearch::dismiss_or_take(const SearchTask& task, const Candidate& candidate) {
  if (resolved_.node_resolved(candidate.node, task.poses.first)) return true;
  if (least_squared_distance(candidate.box, task.centre) > task.reach_squared) return true;
  if (task.hit_is_final && !query_.floor &&
      greatest_squared_distance(candidate.box, task.centre) < radius_squared_) {
    mark_node(candidate.node, task.poses.reference);
    return true;
  }
  return false;
}

void RangeSearch::add_candidate(const SearchTask& task, const Candidate& candidate) {
  if (dismiss_or_take(task, candidate)) return;
  const double extent = greatest_extent(candidate.box);
  if (candidate.node.is_block() ||
      extent * extent <= kNodeExtent * kNodeExtent * task.reach_squared) {
    candidates_.push_back(candidate);
    candidate_points_ += environment_.most_points(candidate.node);
    return;
  }
  bool resolved = true;
  for (const EnvironmentNode& child : environment_.children(candidate.node)) {
    add_candidate(task, {child, environment_.box(child)});
    resolved = resolved && resolved_.node_resolved(child, task.poses.first);
  }
  if (resolved) resolved_.resolve_node(candidate.node, task.poses.first);
}

/// Takes the candidates `begin` to `end` - 1 apart into points, batch by batch.
void RangeSearch::gather(const SearchTask& task, std::size_t begin, std::size_t end) {
  for (std::size_t i = begin; i < end; ++i) gather_node(task, Candidate(candidates_[i]));
  flush(task);
}

void RangeSearch::gather_node(const SearchTask& task, const Candidate& candidate) {
  if (candidate.node.is_block()) return gather_block(task, candidate.node);
  bool resolved = true;
  for (const EnvironmentNode& child : environment_.children(candidate.node)) {
    const Candidate part{child, environment_.box(child)};
    if (!dismiss_or_take(task, part)) gather_node(task, part);
    resolved = resolved && resolved_.node_resolved(child, task.poses.first);
  }
  if (resolved) resolved_.resolve_node(candidate.node, task.poses.first);
}

void RangeSearch::gather_block(const SearchTask& task, const EnvironmentNode& node) {
  const std::uint32_t block = node.first_block;
  const std::uint64_t open = resolved_.open_points(node.cell, block, task.poses.first);
  if (open == 0) return resolved_.resolve_node(node, task.poses.first);
  if (gathered_ + kBlockPoints > kBatchPoints) flush(task);

  const std::uint32_t count = environment_.points_in_block(node.cell, block);
  const Columns from = cache_.block(node.cell, block, count);
  squared_distances(from, count, task.centre, squared_.data());
  const std::uint64_t first_entry = environment_.block_index(node.cell, block) * kBlockPoints;
  for (std::uint64_t rest = open; rest != 0; rest &= rest - 1) {
    const auto i = static_cast<std::uint32_t>(std::countr_zero(rest));
    if (squared_[i] < radius_squared_ && counts(from, i, task.poses.reference)) {
      mark(first_entry + i, task.poses.reference);
      if (task.hit_is_final) continue;
    }
    put_point(gathered_, from, i, first_entry + i);
    gathered_ += squared_[i] > task.reach_squared ? 0 : 1;
  }
}

void RangeSearch::flush(const SearchTask& task) {
  if (gathered_ > 0) refine_points(task, {0, gathered_});
  gathered_ = 0;
}

/// Searches a task's share of `points`, which are those of the parent task.
void RangeSearch::search_points(const SearchTask& task, Points points) {
  const Columns from = columns(points);
  squared_distances(from, points.count, task.centre, squared_.data());
  const std::size_t begin = points.begin + points.count;
  std::size_t to = begin;
  for (std::size_t i = 0; i < points.count; ++i) {
    const std::uint64_t slot = slots_[points.begin + i];
    if (squared_[i] > task.reach_squared) continue;
    if (resolved_.point_resolved(slot, task.poses.first)) continue;
    if (squared_[i] < radius_squared_ && counts(from, i, task.poses.reference)) {
      mark(slot, task.poses.reference);
      if (task.hit_is_final) continue;
    }
    put_point(to++, from, i, slot);
  }
  if (to > begin) refine_points(task, {begin, to - begin});
}

/// Searches `points`, which are within the task's reach.
void RangeSearch::refine_points(const SearchTask& task, Points points) {
  if (task.at_leaves()) return test_points(task, points);
  for_each_half(task, [&](const SearchTask& part) { search_points(part, points); });
}

/// Puts every pair of a point and a model point of the leaf, or its segment to the next pose, to
/// the predicate.
void RangeSearch::test_points(const SearchTask& task, Points points) {
  const ModelSphere& leaf = task.sphere;
  const MutableColumns moved{moved_x_.data(), moved_y_.data(), moved_z_.data()};
  const std::uint32_t pose = task.poses.first;
  transform_points(query_.poses[pose], model_.columns(leaf), leaf.padded, moved);
  const bool moves_on = query_.between_poses && pose + 1 < query_.poses.size();
  if (moves_on) {
    const MutableColumns next{next_x_.data(), next_y_.data(), next_z_.data()};
    transform_points(query_.poses[pose + 1], model_.columns(leaf), leaf.padded, next);
    collide_any_on_way(columns(points), points.count, moved, next, leaf.padded, query_.radius,
                       hit_.data());
  } else {
    collide_any(columns(points), points.count, moved, leaf.padded, query_.radius, hit_.data());
  }
  for (std::size_t i = 0; i < points.count; ++i) {
    if (hit_[i] == 0) continue;
    const Columns from = columns(points);
    if (counts(from, i, pose) || (moves_on && counts(from, i, pose + 1))) {
      mark(slots_[points.begin + i], pose);
    }
  }
  tested_searches_ += leaf.count;
}

}  // namespace clearway
