#include "cpu/range_search.hpp"

#include <algorithm>
#include <limits>

#include "core/geometry/predicate.hpp"
#include "core/util/lane_bits.hpp"

namespace clearway {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

/// Greatest width of a leaf of the model's spheres, in search radii.
constexpr double kLeafRadii = 2;
/// Number of environment points that are narrowed down together.
constexpr std::size_t kBatchPoints = 2048;
/// Candidates that together have at most this many points are taken apart into points.
constexpr std::uint64_t kGatherPoints = 2048;
/// A node is split while it is longer than this share of the reach.
constexpr double kNodeExtent = 0.5;

double greatest_extent(const Box& box) { return box.size()[box.longest_axis()]; }

/// Levels of the motion tree below a node. Poses may be spread so that it is not balanced.
std::size_t levels_below(std::span<const MotionNode> nodes, std::uint32_t index) {
  const MotionNode& node = nodes[index];
  if (node.count == 1) return 1;
  return 1 + std::max(levels_below(nodes, index + 1), levels_below(nodes, node.later));
}

}  // namespace

SpheresOnPath::SpheresOnPath(const Query& asked, const MotionTree& poses)
    : query(asked),
      motion(poses),
      spheres(asked.model.vertices, kLeafRadii * asked.radius),
      bounds(pose_bounds(asked.poses, spheres.box())),
      levels(ModelSpheres::kLevels + 2 +
             (poses.nodes().empty() ? 0 : levels_below(poses.nodes(), 0))) {}

RangeSearch::RangeSearch(const PackedCloud& cloud, const SpheresOnPath& path)
    : cloud_(cloud),
      environment_(cloud),
      path_(path),
      query_(path.query),
      radius_squared_(rounded_product(query_.radius, query_.radius)),
      inner_boxes_(cloud.blocks_per_cell()),
      inner_done_(cloud.blocks_per_cell()),
      decoded_(cloud.blocks_per_cell()),
      positions_(cloud.blocks_per_cell()),
      x_(path.levels * kBatchPoints),
      y_(x_.size()),
      z_(x_.size()),
      points_(x_.size()),
      squared_(kBatchPoints),
      hit_(kBatchPoints),
      moved_x_(path.spheres.largest_leaf()),
      moved_y_(path.spheres.largest_leaf()),
      moved_z_(path.spheres.largest_leaf()) {}

std::uint64_t RangeSearch::most_bytes(const PackedCloud& cloud, const SpheresOnPath& path) {
  // Each level of the descent has at most all blocks of the cell as candidates.
  const std::uint64_t of_block =
      sizeof(BlockBox) + sizeof(BlockPositions) + 2 + path.levels * sizeof(Candidate);
  const std::uint64_t of_point = 3 * sizeof(double) + sizeof(std::uint32_t);
  return sizeof(RangeSearch) + cloud.blocks_per_cell() * of_block +
         path.levels * kBatchPoints * of_point + kBatchPoints * (sizeof(double) + 1) +
         3 * sizeof(double) * path.spheres.largest_leaf();
}

void RangeSearch::search(const PageRef& page, std::uint32_t index, std::span<std::uint64_t> hits) {
  page_ = page;
  index_ = index;
  hits_ = hits;
  std::ranges::fill(hits, 0);
  std::ranges::fill(inner_done_, 0);
  std::ranges::fill(decoded_, 0);
  const PageCell& cell = page.cell(index);
  cell_ = cell.cell;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    chunks_[axis] = packed_chunk(page, cell.chunks[axis], cloud_.cell_points());
  }
  environment_.fill_inner_boxes(cell_, inner_boxes_);
  candidates_.assign(1, candidate_of(environment_.cell(cell_)));
  for (const std::uint32_t node : std::span(page.nodes(cell), cell.node_count)) {
    search_nodes(make_task(node, path_.spheres.node(0)), 0, 1);
  }
}

RangeSearch::SearchTask RangeSearch::make_task(std::uint32_t index,
                                               const ModelSphere& sphere) const {
  const MotionNode& node = path_.motion.nodes()[index];
  const PoseBound& bound = path_.bounds[node.mid];
  const double reach = (query_.radius + bound.stretch * sphere.radius + node.delta + bound.spread) *
                           (1 + 16 * kEpsilon) +
                       1e-150;
  return {index, node, sphere, transform(query_.poses[node.mid], sphere.centre),
          reach * reach * (1 + 4 * kEpsilon)};
}

/// Calls visit(task) for the parts of a task: the halves of its poses if they move more than the
/// sphere is wide, otherwise its smaller spheres.
template <typename Visit>
void RangeSearch::for_each_half(const SearchTask& task, Visit visit) {
  const MotionNode& poses = task.poses;
  const ModelSphere& sphere = task.sphere;
  const bool split_poses =
      poses.count > 1 &&
      (sphere.children == 0 || !(poses.delta <= path_.bounds[poses.mid].stretch * sphere.radius));
  if (split_poses) {
    visit(make_task(task.node + 1, sphere));
    visit(make_task(poses.later, sphere));
    return;
  }
  for (std::uint32_t i = 0; i < sphere.children; ++i) {
    visit(make_task(task.node, path_.spheres.node(sphere.first_child + i)));
  }
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
  if (is_done(candidate.node)) return true;
  if (least_squared_distance(candidate.box, task.centre) > task.reach_squared) return true;
  if (greatest_squared_distance(candidate.box, task.centre) < radius_squared_) {
    take_all(candidate.node);
    return true;
  }
  return false;
}

void RangeSearch::take_all(const EnvironmentNode& node) {
  for (std::uint32_t i = 0; i < node.block_count; ++i) {
    const std::uint32_t block = node.first_block + i;
    hits_[block] = page_.searched(index_, block);
  }
  if (!node.is_block()) inner_done_[EnvironmentTree::inner_in_cell(node)] = 1;
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
  for_each_child(candidate.node, [&](const Candidate& child) { add_candidate(task, child); });
}

/// Takes the candidates `begin` to `end` - 1 apart into points, batch by batch.
void RangeSearch::gather(const SearchTask& task, std::size_t begin, std::size_t end) {
  for (std::size_t i = begin; i < end; ++i) gather_node(task, Candidate(candidates_[i]));
  flush(task);
}

void RangeSearch::gather_node(const SearchTask& task, const Candidate& candidate) {
  if (candidate.node.is_block()) return gather_block(task, candidate.node.first_block);
  for_each_child(candidate.node, [&](const Candidate& child) {
    if (!dismiss_or_take(task, child)) gather_node(task, child);
  });
}

void RangeSearch::gather_block(const SearchTask& task, std::uint32_t block) {
  const std::uint64_t open = open_points(block);
  if (open == 0) return;
  if (gathered_ + kBlockPoints > kBatchPoints) flush(task);
  const Columns from = positions_of(block);
  squared_distances(from, environment_.points_in_block(cell_, block), task.centre, squared_.data());
  for_each_bit(open, [&](std::uint32_t i) {
    const std::uint32_t point = block * kBlockPoints + i;
    if (squared_[i] < radius_squared_) return mark(point);
    put_point(gathered_, from, i, point);
    gathered_ += squared_[i] > task.reach_squared ? 0 : 1;
  });
}

Columns RangeSearch::positions_of(std::uint32_t block) {
  BlockPositions& positions = positions_[block];
  if (decoded_[block] == 0) {
    positions.decode(chunks_, cloud_.quantisation(), block * kBlockPoints,
                     environment_.points_in_block(cell_, block));
    decoded_[block] = 1;
  }
  return {positions.at[0], positions.at[1], positions.at[2]};
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
    const std::uint32_t point = points_[points.begin + i];
    if (squared_[i] > task.reach_squared || is_done(point)) continue;
    if (squared_[i] < radius_squared_) {
      mark(point);
    } else {
      put_point(to++, from, i, point);
    }
  }
  if (to > begin) refine_points(task, {begin, to - begin});
}

/// Searches `points`, which are within the task's reach.
void RangeSearch::refine_points(const SearchTask& task, Points points) {
  if (task.at_leaves()) return test_points(task, points);
  for_each_half(task, [&](const SearchTask& part) { search_points(part, points); });
}

/// Puts every pair of a point and a model point of the leaf to the predicate.
void RangeSearch::test_points(const SearchTask& task, Points points) {
  const ModelSphere& leaf = task.sphere;
  const MutableColumns moved{moved_x_.data(), moved_y_.data(), moved_z_.data()};
  transform_points(query_.poses[task.poses.first], path_.spheres.columns(leaf), leaf.padded, moved);
  collide_any(columns(points), points.count, moved, leaf.padded, query_.radius, hit_.data());
  for (std::size_t i = 0; i < points.count; ++i) {
    if (hit_[i] != 0) mark(points_[points.begin + i]);
  }
  tested_searches_ += leaf.count;
}

}  // namespace clearway
