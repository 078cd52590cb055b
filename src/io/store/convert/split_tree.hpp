#pragma once

#include <cstdint>
#include <vector>

#include "core/cloud/packed_cloud.hpp"
#include "io/store/convert/bin_counter.hpp"
#include "io/store/convert/quantum_bounds.hpp"

namespace clearway {

/// Most points of a bucket. A constant, so that the store does not depend on --memory.
inline constexpr std::uint64_t kBucketPoints = std::uint64_t{1} << 21;

/// A node of the top tree over the counting grid's bins, in preorder: the left child follows it.
struct SplitNode {
  std::uint64_t count = 0;  ///< number of points in the node's bins
  int axis = 0;             ///< axis of the plane: 0, 1, 2, or 3 for the source index
  std::uint64_t plane = 0;  ///< points with lattice coordinate < plane go left
  std::uint32_t right = 0;  ///< index of the right child; 0 for a leaf
  std::int32_t unit = -1;   ///< number of the unit whose subtree has its root here; otherwise -1
};

/// The top of the store's k-d tree. Its leaves are buckets. *Units* are the largest subtrees with
/// at most kBucketPoints points, which the conversion distributes to and loads at once (a bucket in
/// the adaptive layout, several small cubes in the regular one).
class SplitTree {
 public:
  /// scale: metres per lattice step on each axis. Sorts `bins`.
  SplitTree(std::vector<Bin>& bins, const Lattice& lattice, const double (&scale)[3]);

  const std::vector<SplitNode>& nodes() const { return nodes_; }
  /// Node index of each unit, in order.
  const std::vector<std::uint32_t>& units() const { return units_; }
  /// Bins with more than kBucketPoints points, which must be refined before the tree is used.
  const std::vector<Bin>& overfull() const { return overfull_; }
  /// The index in overfull() of the bin of a leaf; -1 for other nodes.
  std::int32_t overfull_at(std::uint32_t node) const { return overfull_at_[node]; }

  /// The leaf or unit node that holds a point.
  std::uint32_t descend(const LatticePoint& point) const {
    std::uint32_t node = 0;
    while (nodes_[node].unit < 0 && nodes_[node].right != 0) {
      const SplitNode& n = nodes_[node];
      node = point[static_cast<std::size_t>(n.axis)] < n.plane ? node + 1 : n.right;
    }
    return node;
  }

  /// The store's explicit tree for cells of `cell_points` points.
  std::vector<TopNode> top_nodes(std::uint32_t cell_points) const;

 private:
  struct Plane {
    int axis;
    std::uint64_t at;
  };

  void add(Bin* first, Bin* last, bool in_unit);
  Plane best_plane(Bin* first, Bin* last) const;
  bool within_one_cube(const Bin* first, const Bin* last) const;

  const Lattice& lattice_;
  std::array<double, 3> scale_;
  std::vector<SplitNode> nodes_;
  std::vector<std::uint32_t> units_;
  std::vector<Bin> overfull_;
  std::vector<std::int32_t> overfull_at_;
};

}  // namespace clearway
