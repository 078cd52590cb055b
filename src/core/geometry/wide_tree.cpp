#include "core/geometry/wide_tree.hpp"

#include <algorithm>
#include <span>

#include "core/geometry/point_box.hpp"
#include "core/geometry/sweep_bounds.hpp"
#include "core/geometry/triangle_box.hpp"
#include "core/util/macros.hpp"

namespace clearway {
namespace {

constexpr std::uint32_t kWidth = WideBoxes::kWidth;

/// Part `part` of the 2^depth parts that halving makes of the elements.
template <typename Element>
std::span<const Element> part_of(std::span<const Element> elements, std::uint32_t part, int depth) {
  for (int bit = depth - 1; bit >= 0; --bit) {
    const std::size_t half = elements.size() / 2;
    elements = (part >> bit & 1) != 0 ? elements.subspan(half) : elements.first(half);
  }
  return elements;
}

TrianglePacket packet_of(std::span<const Triangle> triangles, const Triangle* first) {
  TrianglePacket packet{};
  for (std::uint32_t i = 0; i < triangles.size(); ++i) {
    packet.set(i, triangles[i], static_cast<std::uint32_t>(&triangles[i] - first));
  }
  packet.close(static_cast<std::uint32_t>(triangles.size()));
  return packet;
}

PointPacket packet_of(std::span<const Vec3> points, const Vec3* /*first*/) {
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
void WideBoxes::to_boxes_in_vectors(const Node& node, const Target& from, float* squared) {
  to_boxes_one_by_one(node, from, squared);
}

template <typename Element>
WideTreeOf<Element>::WideTreeOf(const ModelTreeOf<Element>& model) {
  const ModelTreeRefOf<Element> tree = model.ref();
  if (tree.size == 0) return;
  const std::span<const Element> elements(tree.elements, tree.size);
  int depth = 0;
  while ((std::uint64_t{PacketOf<Element>::kMost} << depth) < tree.size) ++depth;
  origin_ = centre_of(model.box());
  std::vector<std::vector<Box>> boxes(1);
  for (std::uint32_t part = 0; part < std::uint32_t{1} << depth; ++part) {
    const std::span<const Element> of = part_of(elements, part, depth);
    packets_.push_back(packet_of(of, tree.elements));
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

template <typename Element>
void WideTreeOf<Element>::add_level(const std::vector<Box>& children) {
  first_.push_back(static_cast<std::uint32_t>(nodes_.size()));
  for (std::size_t i = 0; i < children.size(); ++i) {
    if (i % kWidth == 0) nodes_.emplace_back();
    for (int k = 0; k < 3; ++k) {
      nodes_.back().lo[k][i % kWidth] = WideBoxes::below(children[i].lo[k] - origin_[k]);
      nodes_.back().hi[k][i % kWidth] = WideBoxes::above(children[i].hi[k] - origin_[k]);
    }
  }
}

template <typename Element>
WideTreeRefOf<Element> WideTreeOf<Element>::ref() const {
  Ref ref{};
  ref.nodes = nodes_.data();
  ref.packets = packets_.data();
  ref.origin = origin_;
  ref.node_count = static_cast<std::uint32_t>(nodes_.size());
  ref.packet_count = static_cast<std::uint32_t>(packets_.size());
  ref.levels = static_cast<std::uint32_t>(first_.size());
  std::copy(first_.begin(), first_.end(), ref.first);
  return ref;
}

template class WideTreeOf<Vec3>;
template class WideTreeOf<Triangle>;

}  // namespace clearway
