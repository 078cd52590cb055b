#include "findings/group/point_tree.hpp"

#include <algorithm>

#include "findings/group/near_cells.hpp"

namespace clearway {
namespace {

QuantumBox box_of_points(std::span<const GridPoint> points) {
  QuantumBox box{{points[0].q[0], points[0].q[1], points[0].q[2]},
                 {points[0].q[0], points[0].q[1], points[0].q[2]}};
  for (const GridPoint& p : points) {
    box.extend(p.q);
  }
  return box;
}

double extent(const QuantumBox& box, const Neighbourhood& neighbourhood, int axis) {
  return (static_cast<double>(box.hi[axis]) - box.lo[axis]) * neighbourhood.step(axis);
}

double greatest_extent(const QuantumBox& box, const Neighbourhood& neighbourhood) {
  return std::max({extent(box, neighbourhood, 0), extent(box, neighbourhood, 1),
                   extent(box, neighbourhood, 2)});
}

/// The least difference on axis k between a point of one box and a point of the other.
std::uint64_t least_difference(const QuantumBox& a, const QuantumBox& b, int k) {
  if (a.hi[k] < b.lo[k]) return difference_of(a.hi[k], b.lo[k]);
  return b.hi[k] < a.lo[k] ? difference_of(b.hi[k], a.lo[k]) : 0;
}

std::uint64_t greatest_difference(const QuantumBox& a, const QuantumBox& b, int k) {
  return std::max(difference_of(a.lo[k], b.hi[k]), difference_of(a.hi[k], b.lo[k]));
}

bool is_one_place(const QuantumBox& box) { return std::equal(box.lo, box.lo + 3, box.hi); }

}  // namespace

PointTree::PointTree(std::span<GridPoint> points, const Neighbourhood& neighbourhood)
    : points_(points) {
  nodes_.reserve(points.size() * 4 / kLeafPoints + 1);
  build(0, static_cast<std::uint32_t>(points.size()), neighbourhood);
}

void PointTree::build(std::uint32_t first, std::uint32_t last, const Neighbourhood& neighbourhood) {
  const std::size_t self = nodes_.size();
  const QuantumBox box = box_of_points(points_.subspan(first, last - first));
  nodes_.push_back({box, first, last, 0});
  if (last - first <= kLeafPoints || is_one_place(box)) return;
  int axis = 0;
  for (int k = 1; k < 3; ++k) {
    if (extent(box, neighbourhood, k) > extent(box, neighbourhood, axis)) axis = k;
  }
  const std::uint32_t middle = first + (last - first) / 2;
  std::nth_element(points_.begin() + first, points_.begin() + middle, points_.begin() + last,
                   [axis](const GridPoint& a, const GridPoint& b) {
                     return a.q[axis] != b.q[axis] ? a.q[axis] < b.q[axis] : a.row < b.row;
                   });
  build(first, middle, neighbourhood);
  nodes_[self].right = static_cast<std::uint32_t>(nodes_.size());
  build(middle, last, neighbourhood);
}

/// The points of a leaf, where points that are all at one place count as one.
std::span<const GridPoint> PointTree::points(const Node& node) const {
  return points_.subspan(node.first, is_one_place(node.box) ? 1 : node.last - node.first);
}

bool PointTree::near(const Neighbourhood& neighbourhood, const PointTree& a, const Node& in_a,
                     const PointTree& b, const Node& in_b) {
  const QuantumBox &box_a = in_a.box, &box_b = in_b.box;
  if (!neighbourhood.within(least_difference(box_a, box_b, 0), least_difference(box_a, box_b, 1),
                            least_difference(box_a, box_b, 2))) {
    return false;
  }
  if (neighbourhood.within(greatest_difference(box_a, box_b, 0),
                           greatest_difference(box_a, box_b, 1),
                           greatest_difference(box_a, box_b, 2))) {
    return true;
  }
  if (in_a.right == 0 && in_b.right == 0) {
    return clearway::any_neighbours(neighbourhood, a.points(in_a), b.points(in_b));
  }
  const bool open_a =
      in_b.right == 0 || (in_a.right != 0 && greatest_extent(box_a, neighbourhood) >=
                                                 greatest_extent(box_b, neighbourhood));
  if (open_a) {
    return near(neighbourhood, a, a.left(in_a), b, in_b) ||
           near(neighbourhood, a, a.right(in_a), b, in_b);
  }
  return near(neighbourhood, a, in_a, b, b.left(in_b)) ||
         near(neighbourhood, a, in_a, b, b.right(in_b));
}

}  // namespace clearway
