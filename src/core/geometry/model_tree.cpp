#include "core/geometry/model_tree.hpp"

#include <algorithm>
#include <cmath>

#include "core/geometry/point_box.hpp"

namespace clearway {
ModelTree::ModelTree(std::span<const Vec3> model) : points_(model.begin(), model.end()) {
  if (points_.empty()) return;
  box_ = box_of(points_);
  build(0, size(), 0);
  // A leaf's 4 to 8 points of a surface cover a square of some 2.5 spacings.
  spacing_ = median_leaf_diagonal() / 3.5;
}

double ModelTree::median_leaf_diagonal() const {
  std::vector<double> diagonals;
  for (std::size_t node = 0; node < boxes_.size(); ++node) {
    const bool leaf = 2 * node + 1 >= boxes_.size();
    const Box& box = boxes_[node];
    const double squared = leaf ? squared_distance(box.lo, box.hi) : 0;
    if (squared > 0) diagonals.push_back(std::sqrt(squared));  // not: unused, or one place
  }
  if (diagonals.empty()) return 0;
  const auto middle = diagonals.begin() + static_cast<std::ptrdiff_t>(diagonals.size() / 2);
  std::nth_element(diagonals.begin(), middle, diagonals.end());
  return *middle;
}

void ModelTree::build(std::uint32_t begin, std::uint32_t end, std::size_t node) {
  const std::span<const Vec3> part(points_.data() + begin, end - begin);
  if (node >= boxes_.size()) boxes_.resize(node + 1);
  boxes_[node] = box_of(part);
  if (end - begin <= kLeafPoints) return;
  const std::uint32_t middle = begin + (end - begin) / 2;
  const int axis = longest_side(boxes_[node]);
  std::nth_element(points_.begin() + begin, points_.begin() + middle, points_.begin() + end,
                   [axis](const Vec3& a, const Vec3& b) { return a[axis] < b[axis]; });
  build(begin, middle, 2 * node + 1);
  build(middle, end, 2 * node + 2);
}

bool ModelTree::within(std::uint32_t begin, std::uint32_t end, std::size_t node, const Box& box,
                       double squared_radius, std::size_t most, std::vector<Vec3>& out) const {
  if (begin == end || least_squared_distance(boxes_[node], box) > squared_radius) return true;
  if (end - begin <= kLeafPoints) {
    for (std::uint32_t i = begin; i < end; ++i) {
      const bool outside = least_squared_distance(box, points_[i]) > squared_radius;
      if (!outside) out.push_back(points_[i]);
    }
    return out.size() <= most;
  }
  const std::uint32_t middle = begin + (end - begin) / 2;
  return within(begin, middle, 2 * node + 1, box, squared_radius, most, out) &&
         within(middle, end, 2 * node + 2, box, squared_radius, most, out);
}

}  // namespace clearway
