#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/geometry/model_tree_ref.hpp"

namespace clearway {

/// A balanced tree over the model's points or triangles, for nearest neighbours and balls in the
/// model's own frame. Source: Bentley 1975; Friedman, Bentley, Finkel 1977.
template <typename Element>
class ModelTreeOf {
 public:
  using Ref = ModelTreeRefOf<Element>;
  using Nearest = typename Ref::Nearest;

  explicit ModelTreeOf(std::span<const Element> model, int threads = 1);

  std::uint32_t size() const { return static_cast<std::uint32_t>(elements_.size()); }
  const Element& element(std::uint32_t index) const { return elements_[index]; }
  const Box& box() const { return box_; }

  /// An estimate of the distance between neighbouring elements, metres; for choosing sizes, never
  /// for answers.
  double spacing() const { return spacing_; }

  /// The tree for look-ups. Valid while the tree lives.
  Ref ref() const {
    return {elements_.data(), boxes_.data(), size(), static_cast<std::uint32_t>(boxes_.size())};
  }

  Nearest nearest(const Vec3& x, std::uint32_t guess = 0) const { return ref().nearest(x, guess); }

  /// Replaces `out` with the elements whose computed squared distance to the box is at most
  /// `squared_radius`, which must not be NaN; for triangles, the distance to their boxes counts.
  /// Returns false, with only some of the elements, if there are more than `most`.
  bool within(const Box& box, double squared_radius, std::size_t most,
              std::vector<Element>& out) const {
    out.clear();
    return within(0, size(), 0, box, squared_radius, most, out);
  }

  std::uint64_t allocated_bytes() const {
    return elements_.capacity() * sizeof(Element) + boxes_.capacity() * sizeof(Box);
  }

 private:
  static constexpr std::uint32_t kLeafElements = Ref::kLeafElements;

  /// A node with the range of its elements.
  struct Part {
    std::uint32_t begin, end;
    std::size_t node;
    std::uint32_t middle() const { return begin + (end - begin) / 2; }
  };

  void build(int threads);
  void divide(const Part& part);
  static std::size_t last_node(std::uint32_t elements);
  double median_leaf_diagonal() const;
  bool within(std::uint32_t begin, std::uint32_t end, std::size_t node, const Box& box,
              double squared_radius, std::size_t most, std::vector<Element>& out) const;

  std::vector<Element> elements_;
  std::vector<Box> boxes_;  // box of node i, whose children are 2 i + 1 and 2 i + 2
  Box box_{};
  double spacing_ = 0;
};

using ModelTree = ModelTreeOf<Vec3>;
using TriangleTree = ModelTreeOf<Triangle>;

extern template class ModelTreeOf<Vec3>;
extern template class ModelTreeOf<Triangle>;

}  // namespace clearway
