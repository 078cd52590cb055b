#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/geometry/quantisation.hpp"

namespace clearway {

/// The stored integers of a point, one on each axis.
struct QuantumPoint {
  std::int32_t q[3];
};

/// The absolute difference of two stored integers.
inline std::uint64_t difference_of(const std::int32_t a, const std::int32_t b) {
  return static_cast<std::uint64_t>(a < b ? std::int64_t{b} - a : std::int64_t{a} - b);
}

/// The box around some points, of which there must be at least one.
inline QuantumBox box_of(std::span<const QuantumPoint> points) {
  QuantumBox box{};
  std::ranges::copy(points[0].q, box.lo);
  std::ranges::copy(points[0].q, box.hi);
  for (const QuantumPoint& p : points) box.extend(p.q);
  return box;
}

/// A balanced tree of boxes over points, whose leaves are blocks of a few neighbouring points. It
/// is the same for any order of the points and any number of threads.
class PointBlocks {
 public:
  /// The most points of a block.
  static constexpr std::size_t kBlock = 32;

  struct Node {
    QuantumBox box;
    std::uint32_t begin, end;  ///< range of its points
  };
  /// The most bytes that the nodes take for a point, and for one tree more.
  static constexpr std::uint64_t kBytesOfPoint = 2 * sizeof(Node) / (kBlock / 2);
  static constexpr std::uint64_t kBytesOfTree = 2 * sizeof(Node);

  /// Sorts the points, of which there must be at least one, and refers to them. Runs in the
  /// caller's arena of oneTBB.
  PointBlocks(const Quantisation& quantisation, std::span<QuantumPoint> points);

  std::size_t size() const { return points_.size(); }
  const Node& node(std::uint32_t index) const { return nodes_[index]; }
  std::span<const QuantumPoint> points(std::uint32_t index) const {
    return points_.subspan(nodes_[index].begin, nodes_[index].end - nodes_[index].begin);
  }
  /// Whether a node is a block. The children of any other node i are 2 i + 1 and 2 i + 2.
  bool is_block(std::uint32_t index) const { return index >= first_block_; }
  Vec3 place(std::uint32_t point) const {
    const std::int32_t* q = points_[point].q;
    return position(quantisation_, q[0], q[1], q[2]);
  }
  /// The box of the points of a node.
  Box box(std::uint32_t index) const { return position_box(quantisation_, nodes_[index].box); }

 private:
  void build(std::uint32_t index, std::uint32_t begin, std::uint32_t end);

  const Quantisation& quantisation_;
  std::span<QuantumPoint> points_;
  std::uint32_t first_block_ = 0;
  std::vector<Node> nodes_;
};

}  // namespace clearway
