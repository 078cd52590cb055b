#include "core/geometry/model_tree.hpp"

#include <algorithm>
#include <cmath>

#include "core/geometry/point_box.hpp"
#include "core/geometry/triangle_box.hpp"

namespace clearway {
template <typename Element>
ModelTreeOf<Element>::ModelTreeOf(std::span<const Element> model, int threads)
    : elements_(model.begin(), model.end()) {
  if (elements_.empty()) return;
  box_ = box_of(std::span<const Element>(elements_));
  build(threads);
  // The 4 to 8 points of a leaf on a surface cover a square of some 2.5 spacings. For triangles the
  // same factor is used.
  spacing_ = median_leaf_diagonal() / 3.5;
}

template <typename Element>
double ModelTreeOf<Element>::median_leaf_diagonal() const {
  std::vector<double> diagonals;
  for (std::size_t node = 0; node < boxes_.size(); ++node) {
    const bool leaf = 2 * node + 1 >= boxes_.size();
    const Box& box = boxes_[node];
    const double squared = leaf ? squared_distance(box.lo, box.hi) : 0;
    // Unused nodes, and those whose elements are at the same place, do not count.
    if (squared > 0) diagonals.push_back(std::sqrt(squared));
  }
  if (diagonals.empty()) return 0;
  const auto middle = diagonals.begin() + static_cast<std::ptrdiff_t>(diagonals.size() / 2);
  std::nth_element(diagonals.begin(), middle, diagonals.end());
  return *middle;
}

/// Builds the tree level by level, because the nodes of one level are separate parts.
template <typename Element>
void ModelTreeOf<Element>::build(int threads) {
  boxes_.resize(last_node(size()) + 1);
  std::vector<Part> level{{0, size(), 0}}, next;
  while (!level.empty()) {
#pragma omp parallel for schedule(dynamic, 4) num_threads(threads)
    for (const Part& part : level) divide(part);
    next.clear();
    for (const Part& part : level) {
      if (part.end - part.begin <= kLeafElements) continue;
      next.push_back({part.begin, part.middle(), 2 * part.node + 1});
      next.push_back({part.middle(), part.end, 2 * part.node + 2});
    }
    level.swap(next);
  }
}

/// The greatest index of a node: the right half is never the smaller one.
template <typename Element>
std::size_t ModelTreeOf<Element>::last_node(std::uint32_t elements) {
  std::size_t node = 0;
  for (; elements > kLeafElements; elements -= elements / 2) node = 2 * node + 2;
  return node;
}

template <typename Element>
void ModelTreeOf<Element>::divide(const Part& part) {
  const auto begin = elements_.begin();
  const Box box =
      box_of(std::span<const Element>(elements_).subspan(part.begin, part.end - part.begin));
  boxes_[part.node] = box;
  if (part.end - part.begin <= kLeafElements) return;
  const int axis = box.longest_axis();
  std::nth_element(begin + part.begin, begin + part.middle(), begin + part.end,
                   [axis](const Element& a, const Element& b) {
                     return place_along(a, axis) < place_along(b, axis);
                   });
}

template <typename Element>
bool ModelTreeOf<Element>::within(std::uint32_t begin, std::uint32_t end, std::size_t node,
                                  const Box& box, double squared_radius, std::size_t most,
                                  std::vector<Element>& out) const {
  if (begin == end || least_squared_distance(boxes_[node], box) > squared_radius) return true;
  if (end - begin <= kLeafElements) {
    for (std::uint32_t i = begin; i < end; ++i) {
      const bool outside = least_squared_distance(box, elements_[i]) > squared_radius;
      if (!outside) out.push_back(elements_[i]);
    }
    return out.size() <= most;
  }
  const std::uint32_t middle = begin + (end - begin) / 2;
  return within(begin, middle, 2 * node + 1, box, squared_radius, most, out) &&
         within(middle, end, 2 * node + 2, box, squared_radius, most, out);
}

template class ModelTreeOf<Vec3>;
template class ModelTreeOf<Triangle>;

}  // namespace clearway
