#include "core/geometry/wide_tree.hpp"

#include <algorithm>
#include <span>

#include "core/geometry/point_box.hpp"
#include "core/geometry/sweep_bounds.hpp"
#include "core/util/macros.hpp"

namespace clearway {
namespace {

constexpr std::uint32_t kWidth = WideTreeRef::kWidth;

/// Part `part` of the 2^depth parts that halving makes of `count` points.
std::span<const Vec3> part_of(std::span<const Vec3> points, std::uint32_t part, int depth) {
  for (int bit = depth - 1; bit >= 0; --bit) {
    const std::size_t half = points.size() / 2;
    points = (part >> bit & 1) != 0 ? points.subspan(half) : points.first(half);
  }
  return points;
}

PointPacket packet_of(std::span<const Vec3> points) {
  PointPacket packet{};
  packet.count = static_cast<std::uint32_t>(points.size());
  for (std::uint32_t i = 0; i < PointPacket::kMost; ++i) {
    const Vec3& point = points[std::min<std::size_t>(i, points.size() - 1)];
    for (int k = 0; k < 3; ++k) packet.at[k][i] = point[k];
  }
  return packet;
}

}  // namespace

CLEARWAY_SIMD_CLONES
void WideTreeRef::to_boxes_in_vectors(const Node& node, const Target& from, float* squared) {
  to_boxes_one_by_one(node, from, squared);
}

WideTree::WideTree(const ModelTree& model) {
  const ModelTreeRef tree = model.ref();
  if (tree.size == 0) return;
  const std::span<const Vec3> points(tree.elements, tree.size);
  int depth = 0;
  while ((std::uint64_t{PointPacket::kMost} << depth) < tree.size) ++depth;
  origin_ = centre_of(model.box());
  std::vector<std::vector<Box>> boxes(1);
  for (std::uint32_t part = 0; part < std::uint32_t{1} << depth; ++part) {
    const std::span<const Vec3> of = part_of(points, part, depth);
    packets_.push_back(packet_of(of));
    boxes[0].push_back(box_of(of));
  }
  while (boxes.back().size() > 1) {
    std::vector<Box> above;
    for (std::size_t i = 0; i < boxes.back().size(); ++i) {
      const Box& box = boxes.back()[i];
      if (i % kWidth == 0) above.push_back(box);
      for (int k = 0; k < 3; ++k) {
        above.back().lo[k] = std::min(above.back().lo[k], box.lo[k]);
        above.back().hi[k] = std::max(above.back().hi[k], box.hi[k]);
      }
    }
    boxes.push_back(std::move(above));
  }
  for (std::size_t level = boxes.size(); level-- > 1;) add_level(boxes[level - 1]);
}

void WideTree::add_level(const std::vector<Box>& children) {
  first_.push_back(static_cast<std::uint32_t>(nodes_.size()));
  for (std::size_t i = 0; i < children.size(); ++i) {
    if (i % kWidth == 0) nodes_.emplace_back();
    for (int k = 0; k < 3; ++k) {
      nodes_.back().lo[k][i % kWidth] = WideTreeRef::below(children[i].lo[k] - origin_[k]);
      nodes_.back().hi[k][i % kWidth] = WideTreeRef::above(children[i].hi[k] - origin_[k]);
    }
  }
}

WideTreeRef WideTree::ref() const {
  WideTreeRef ref{};
  ref.nodes = nodes_.data();
  ref.packets = packets_.data();
  ref.origin = origin_;
  ref.node_count = static_cast<std::uint32_t>(nodes_.size());
  ref.packet_count = static_cast<std::uint32_t>(packets_.size());
  ref.levels = static_cast<std::uint32_t>(first_.size());
  std::copy(first_.begin(), first_.end(), ref.first);
  return ref;
}

}  // namespace clearway
