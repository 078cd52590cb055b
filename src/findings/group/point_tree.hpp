#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/geometry/quantum_box.hpp"
#include "findings/group/cell_grid.hpp"
#include "findings/group/neighbourhood.hpp"

namespace clearway {

/// A k-d tree over the points of a cell, which it puts into its own order.
class PointTree {
 public:
  static constexpr std::size_t kLeafPoints = 16;
  /// The most bytes that a tree takes for each point.
  static constexpr std::uint64_t kBytesOfPoint = 10;

  /// neighbourhood: gives the scale of each axis, by which the axis to split is chosen. The points
  /// outlive the tree.
  PointTree(std::span<GridPoint> points, const Neighbourhood& neighbourhood);

  /// Whether a point of one tree has a neighbour in the other. Pairs of nodes that are surely near
  /// or surely far are not opened.
  static bool any_neighbours(const Neighbourhood& neighbourhood, const PointTree& a,
                             const PointTree& b) {
    return near(neighbourhood, a, a.nodes_.front(), b, b.nodes_.front());
  }

 private:
  struct Node {
    QuantumBox box;
    std::uint32_t first, last;
    /// The right child; the left one is the next node. 0 for a leaf.
    std::uint32_t right;
  };
  static bool near(const Neighbourhood& neighbourhood, const PointTree& a, const Node& in_a,
                   const PointTree& b, const Node& in_b);
  void build(std::uint32_t first, std::uint32_t last, const Neighbourhood& neighbourhood);
  std::span<const GridPoint> points(const Node& node) const;
  const Node& left(const Node& node) const { return *(&node + 1); }
  const Node& right(const Node& node) const { return nodes_[node.right]; }

  std::span<GridPoint> points_;
  std::vector<Node> nodes_;
};

}  // namespace clearway
