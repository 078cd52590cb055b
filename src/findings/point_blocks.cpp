#include "findings/point_blocks.hpp"

#include <tbb/parallel_invoke.h>

#include <algorithm>

#include "core/util/tsan_annotations.hpp"

namespace clearway {
namespace {

/// Nodes of at least so many points are divided by tasks of their own.
constexpr std::uint32_t kLeastTask = 8192;

/// Orders points along an axis; points at one place are equal.
struct Along {
  int axis;
  bool operator()(const QuantumPoint& a, const QuantumPoint& b) const {
    for (int k = 0; k < 3; ++k) {
      const int at = (axis + k) % 3;
      if (a.q[at] != b.q[at]) return a.q[at] < b.q[at];
    }
    return false;
  }
};

}  // namespace

PointBlocks::PointBlocks(const Quantisation& quantisation, std::span<QuantumPoint> points)
    : quantisation_(quantisation), points_(points) {
  std::size_t blocks = 1;
  while (blocks * kBlock < points.size()) blocks *= 2;
  nodes_.resize(2 * blocks - 1);
  first_block_ = static_cast<std::uint32_t>(blocks - 1);
  build(0, 0, static_cast<std::uint32_t>(points.size()));
}

void PointBlocks::build(std::uint32_t index, std::uint32_t begin, std::uint32_t end) {
  Node& node = nodes_[index];
  node.begin = begin;
  node.end = end;
  const std::span<QuantumPoint> points = points_.subspan(begin, end - begin);
  node.box = box_of(points);
  int longest = 0;
  double most = -1;
  for (int k = 0; k < 3; ++k) {
    const double side = quantisation_.scale[k] * (double(node.box.hi[k]) - node.box.lo[k]);
    if (side > most) {
      most = side;
      longest = k;
    }
  }
  if (is_block(index)) {
    std::ranges::sort(points, Along{0});
    return;
  }
  const std::uint32_t middle = begin + (end - begin) / 2;
  std::nth_element(points.begin(), points.begin() + (middle - begin), points.end(), Along{longest});
  if (end - begin < kLeastTask) {
    build(2 * index + 1, begin, middle);
    return build(2 * index + 2, middle, end);
  }
  const ParallelScope scope;
  const auto left = piece_of(scope, [&] { build(2 * index + 1, begin, middle); });
  const auto right = piece_of(scope, [&] { build(2 * index + 2, middle, end); });
  scope.begin();
  tbb::parallel_invoke(left, right);
}

}  // namespace clearway
