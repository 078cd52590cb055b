#include "core/trajectory/corridor.hpp"

#include <algorithm>
#include <cmath>

#include "core/geometry/sweep_bounds.hpp"

namespace clearway {
namespace {

/// Segments of a leaf.
constexpr std::uint32_t kLeaf = 4;

/// Bound on the relative error of a computed squared distance, of its root and of a difference of
/// distances, with room to spare.
constexpr double kRelative = 0x1p-44;

double largest(const Vec3& p) { return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}); }

double squared_to_box(const Vec3& p, const Box& box) {
  double squared = 0;
  for (int k = 0; k < 3; ++k) {
    const double gap = std::max({box.lo[k] - p[k], p[k] - box.hi[k], 0.0});
    squared += gap * gap;
  }
  return squared;
}

}  // namespace

Corridor::Corridor(std::vector<Vec3> path, double within)
    : path_(std::move(path)), within_(within) {
  double farthest = 0;
  for (const Vec3& p : path_) farthest = std::max(farthest, largest(p));
  slack_ = 0x1p-48 * farthest;
  build(0, 0, segments());
}

Box Corridor::build(std::uint32_t node, std::uint32_t first, std::uint32_t count) {
  if (node >= boxes_.size()) boxes_.resize(std::max<std::size_t>(node + 1, 2 * boxes_.size()));
  Box box;
  if (count <= kLeaf) {
    box = box_of_segment(first);
    for (std::uint32_t i = 1; i < count; ++i) box = box.united(box_of_segment(first + i));
  } else {
    const Box earlier = build(2 * node + 1, first, count / 2);
    box = earlier.united(build(2 * node + 2, first + count / 2, count - count / 2));
  }
  return boxes_[node] = box;
}

/// A box around all computed places of a segment.
Box Corridor::box_of_segment(std::uint32_t segment) const {
  Box box{path_[segment], path_[segment]};
  if (segment + 1 < path_.size()) box.extend(path_[segment + 1]);
  return box.grown(slack_);
}

double Corridor::squared_to_segment(const Vec3& p, std::uint32_t segment) const {
  const Vec3& a = path_[segment];
  const Vec3& b = path_[std::min<std::size_t>(segment + 1, path_.size() - 1)];
  const Vec3 way = b - a, from = p - a;
  double t = 0;
  if (!(a == b)) {
    t = dot(from, way) / dot(way, way);
    t = t > 0 ? std::min(t, 1.0) : 0;  // not a number, where a square is lost: an end
  }
  const Vec3 off = p - (a + t * way);
  return dot(off, off);
}

/// Visits the segments of all leaves that is_near(box) is true for, the nearer half of a node
/// first as far as the order of the path says.
template <typename IsNear, typename Visit>
void Corridor::descend(std::uint32_t node, std::uint32_t first, std::uint32_t count,
                       const IsNear& is_near, const Visit& visit) const {
  if (!is_near(boxes_[node])) return;
  if (count <= kLeaf) {
    for (std::uint32_t i = first; i < first + count; ++i) visit(i);
    return;
  }
  descend(2 * node + 1, first, count / 2, is_near, visit);
  descend(2 * node + 2, first + count / 2, count - count / 2, is_near, visit);
}

double Corridor::squared_distance(const Vec3& p) const {
  double least = kInfinity;
  // A start that lets most of the tree be left out: the boxes from the root on that are nearest.
  std::uint32_t node = 0, first = 0, count = segments();
  while (count > kLeaf) {
    const bool later =
        squared_to_box(p, boxes_[2 * node + 2]) < squared_to_box(p, boxes_[2 * node + 1]);
    node = 2 * node + (later ? 2 : 1);
    first += later ? count / 2 : 0;
    count = later ? count - count / 2 : count / 2;
  }
  const auto visit = [&](std::uint32_t i) { least = std::min(least, squared_to_segment(p, i)); };
  for (std::uint32_t i = first; i < first + count; ++i) visit(i);
  const auto is_near = [&](const Box& box) {
    return !(squared_to_box(p, box) * (1 - kRelative) > least);
  };
  descend(0, 0, segments(), is_near, visit);
  return least;
}

bool Corridor::holds(const Vec3& p) const {
  const double limit = within_ * within_;
  bool found = false;
  const auto is_near = [&](const Box& box) {
    return !found && !(squared_to_box(p, box) * (1 - kRelative) > limit);
  };
  descend(0, 0, segments(), is_near,
          [&](std::uint32_t i) { found = found || squared_to_segment(p, i) <= limit; });
  return found;
}

double Corridor::distance_above(const Vec3& p) const {
  return std::sqrt(squared_distance(p)) * (1 + kRelative) + 2 * slack_ + 0x1p-48 * largest(p);
}

bool Corridor::may_hold(const Box& box) const {
  const double slack = 0x1p-46 * std::max(largest(box.lo), largest(box.hi));
  const double reach = (within_ + slack) * (1 + kRelative);
  bool found = false;
  const auto is_near = [&](const Box& of_run) {
    return !found && !(box.distance(of_run) * (1 - kRelative) > reach);
  };
  descend(0, 0, segments(), is_near,
          [&](std::uint32_t i) { found = found || is_near(box_of_segment(i)); });
  return found;
}

bool CorridorWalk::holds(const Vec3& p) {
  const double within = corridor_.within();
  if (distance_ >= 0) {
    // By how much the distance can differ from the anchor's, with all that rounding may add.
    const double apart = length(p - anchor_);
    const double rounding = kRelative * (distance_ + apart + within) +
                            0x1p-44 * std::max({largest(p), largest(anchor_), 1e-300}) +
                            corridor_.rounding();
    if (distance_ - apart - rounding > within) return false;
    if (distance_ + apart + rounding < within) return true;
  }
  anchor_ = p;
  const double squared = corridor_.squared_distance(p);
  distance_ = std::sqrt(squared);
  return squared <= within * within;
}

}  // namespace clearway
