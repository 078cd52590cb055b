#include "cpu/range_search.hpp"

#include <algorithm>
#include <bit>
#include <limits>

#include "core/predicate.hpp"

namespace clearway {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

/// Points of the environment that are narrowed down together.
constexpr std::size_t kBatchPoints = 2048;
/// Candidates with fewer points than this together are taken apart into points.
constexpr std::uint64_t kGatherPoints = 2048;
/// A node is split while it is longer than this part of the reach.
constexpr double kNodeExtent = 0.5;
/// Levels of spheres and of halved runs of poses: the deepest stack of point batches.
constexpr std::size_t kDeepest = ModelSpheres::kLevels + std::bit_width(PoseTree::kMostPoses) + 2;

double longest_side(const Box& box) {
  return std::max({box.hi.x - box.lo.x, box.hi.y - box.lo.y, box.hi.z - box.lo.z});
}

}  // namespace

RangeSearch::RangeSearch(const EnvironmentTree& environment, SettledPoints& settled,
                         const ModelSpheres& model, const Question& question, PoseMarkLog& marks)
    : environment_(environment),
      settled_(settled),
      model_(model),
      question_(question),
      marks_(marks),
      radius_squared_(rounded_product(question.radius, question.radius)),
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
  if (!question.between_poses) return;
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

RangeSearch::Query RangeSearch::make_query(const PoseNode& poses, const ModelSphere& sphere) const {
  const double reach =
      (question_.radius + poses.stretch * sphere.radius + poses.spread) * (1 + 16 * kEpsilon) +
      1e-150;
  return {poses, sphere, transform(question_.poses[poses.reference], sphere.centre),
          reach * reach * (1 + 4 * kEpsilon),
          !settled_.first_pose() || poses.reference == poses.first};
}

/// Calls visit(query) for the parts of the query: the halves of its poses where they move more than
/// the sphere is wide, else its smaller spheres.
template <typename Visit>
void RangeSearch::for_each_half(const Query& query, Visit visit) {
  const PoseNode& poses = query.poses;
  const ModelSphere& sphere = query.sphere;
  const bool split_poses =
      poses.count > 1 && (sphere.children == 0 || !(poses.spread <= poses.stretch * sphere.radius));
  if (split_poses) {
    visit(make_query(pose_tree_->node(poses.earlier), sphere));
    visit(make_query(pose_tree_->node(poses.later), sphere));
    return;
  }
  for (std::uint32_t i = 0; i < sphere.children; ++i) {
    visit(make_query(poses, model_.node(sphere.first_child + i)));
  }
}

void RangeSearch::search(const PoseTree& poses, const ModelSphere& sphere) {
  pose_tree_ = &poses;
  candidates_.clear();
  gathered_ = 0;
  const EnvironmentNode root = environment_.root();
  candidates_.push_back({root, environment_.box(root)});
  search_nodes(make_query(poses.node(0), sphere), 0, 1);
}

/// Candidates begin .. end are those of the parent query.
void RangeSearch::search_nodes(const Query& query, std::size_t begin, std::size_t end) {
  const std::size_t first = candidates_.size();
  const std::uint64_t points_before = candidate_points_;
  candidate_points_ = 0;
  for (std::size_t i = begin; i < end; ++i) add_candidate(query, Candidate(candidates_[i]));
  const std::size_t last = candidates_.size();
  if (first < last) {
    if (candidate_points_ <= kGatherPoints || query.at_leaves()) {
      gather(query, first, last);
    } else {
      for_each_half(query, [&](const Query& part) { search_nodes(part, first, last); });
    }
  }
  candidates_.resize(first);
  candidate_points_ = points_before;
}

/// True when the node holds nothing that this query is still to decide.
bool RangeSearch::dismiss_or_take(const Query& query, const Candidate& candidate) {
  if (settled_.node_settled(candidate.node, query.poses.first)) return true;
  if (least_squared_distance(candidate.box, query.centre) > query.reach_squared) return true;
  if (query.hit_is_final &&
      greatest_squared_distance(candidate.box, query.centre) < radius_squared_) {
    mark_node(candidate.node, query.poses.reference);
    return true;
  }
  return false;
}

void RangeSearch::add_candidate(const Query& query, const Candidate& candidate) {
  if (dismiss_or_take(query, candidate)) return;
  const double extent = longest_side(candidate.box);
  if (candidate.node.is_block() ||
      extent * extent <= kNodeExtent * kNodeExtent * query.reach_squared) {
    candidates_.push_back(candidate);
    candidate_points_ += environment_.most_points(candidate.node);
    return;
  }
  bool settled = true;
  for (const EnvironmentNode& child : environment_.children(candidate.node)) {
    add_candidate(query, {child, environment_.box(child)});
    settled = settled && settled_.node_settled(child, query.poses.first);
  }
  if (settled) settled_.settle_node(candidate.node, query.poses.first);
}

/// Takes candidates begin .. end apart into points, batch by batch.
void RangeSearch::gather(const Query& query, std::size_t begin, std::size_t end) {
  for (std::size_t i = begin; i < end; ++i) gather_node(query, Candidate(candidates_[i]));
  flush(query);
}

void RangeSearch::gather_node(const Query& query, const Candidate& candidate) {
  if (candidate.node.is_block()) return gather_block(query, candidate.node);
  bool settled = true;
  for (const EnvironmentNode& child : environment_.children(candidate.node)) {
    const Candidate part{child, environment_.box(child)};
    if (!dismiss_or_take(query, part)) gather_node(query, part);
    settled = settled && settled_.node_settled(child, query.poses.first);
  }
  if (settled) settled_.settle_node(candidate.node, query.poses.first);
}

void RangeSearch::gather_block(const Query& query, const EnvironmentNode& node) {
  const std::uint32_t block = node.first_block;
  const std::uint64_t open = settled_.open_points(node.cell, block, query.poses.first);
  if (open == 0) return settled_.settle_node(node, query.poses.first);
  if (gathered_ + kBlockPoints > kBatchPoints) flush(query);

  const std::uint32_t count = environment_.points_in_block(node.cell, block);
  const Columns from = cache_.block(node.cell, block, count);
  squared_distances(from, count, query.centre, squared_.data());
  const std::uint64_t first_slot = environment_.block_index(node.cell, block) * kBlockPoints;
  for (std::uint64_t rest = open; rest != 0; rest &= rest - 1) {
    const auto i = static_cast<std::uint32_t>(std::countr_zero(rest));
    if (squared_[i] < radius_squared_) {
      mark(first_slot + i, query.poses.reference);
      if (query.hit_is_final) continue;
    }
    put_point(gathered_, from, i, first_slot + i);
    gathered_ += squared_[i] > query.reach_squared ? 0 : 1;
  }
}

void RangeSearch::flush(const Query& query) {
  if (gathered_ > 0) refine_points(query, {0, gathered_});
  gathered_ = 0;
}

/// `points` are those of the parent query.
void RangeSearch::search_points(const Query& query, Points points) {
  const Columns from = columns(points);
  squared_distances(from, points.count, query.centre, squared_.data());
  const std::size_t begin = points.begin + points.count;
  std::size_t to = begin;
  for (std::size_t i = 0; i < points.count; ++i) {
    const std::uint64_t slot = slots_[points.begin + i];
    if (squared_[i] > query.reach_squared) continue;
    if (settled_.point_settled(slot, query.poses.first)) continue;
    if (squared_[i] < radius_squared_) {
      mark(slot, query.poses.reference);
      if (query.hit_is_final) continue;
    }
    put_point(to++, from, i, slot);
  }
  if (to > begin) refine_points(query, {begin, to - begin});
}

/// `points` are within the query's reach.
void RangeSearch::refine_points(const Query& query, Points points) {
  if (query.at_leaves()) return test_points(query, points);
  for_each_half(query, [&](const Query& part) { search_points(part, points); });
}

/// Puts every pair of a point and a model point of the leaf, or its segment to the next pose, to
/// the predicate.
void RangeSearch::test_points(const Query& query, Points points) {
  const ModelSphere& leaf = query.sphere;
  const MutableColumns moved{moved_x_.data(), moved_y_.data(), moved_z_.data()};
  const std::uint32_t pose = query.poses.first;
  transform_points(question_.poses[pose], model_.columns(leaf), leaf.padded, moved);
  if (question_.between_poses && pose + 1 < question_.poses.size()) {
    const MutableColumns next{next_x_.data(), next_y_.data(), next_z_.data()};
    transform_points(question_.poses[pose + 1], model_.columns(leaf), leaf.padded, next);
    collide_any_on_step(columns(points), points.count, moved, next, leaf.padded, question_.radius,
                        hit_.data());
  } else {
    collide_any(columns(points), points.count, moved, leaf.padded, question_.radius, hit_.data());
  }
  for (std::size_t i = 0; i < points.count; ++i) {
    if (hit_[i] != 0) mark(slots_[points.begin + i], pose);
  }
  tested_searches_ += leaf.count;
}

}  // namespace clearway
