#include "core/geometry/wide_tree.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "core/geometry/point_box.hpp"
#include "core/geometry/sweep_bounds.hpp"
#include "core/geometry/triangle_box.hpp"
#include "core/util/macros.hpp"

namespace clearway {
namespace {

constexpr std::uint32_t kWidth = WideBoxes::kWidth;

/// Part number `part` of the 2^depth parts into which the elements are halved.
template <typename Element>
std::span<const Element> part_of(std::span<const Element> elements, std::uint32_t part, int depth) {
  for (int bit = depth - 1; bit >= 0; --bit) {
    const std::size_t half = elements.size() / 2;
    elements = (part >> bit & 1) != 0 ? elements.subspan(half) : elements.first(half);
  }
  return elements;
}

FloatPacket packet_of(std::span<const Triangle> triangles, const Triangle* first) {
  return FloatPacket::of(triangles.data(), static_cast<std::uint32_t>(triangles.size()),
                         static_cast<std::uint32_t>(triangles.data() - first));
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

/// The sum of the area vectors of triangles, each turned to the side of the sum of the others: the
/// direction in which a piece of a surface faces, whatever the order of its corners.
struct Facing {
  Vec3 sum{};
  double area = 0;

  void add(const Facing& other) {
    const double side = rounded_dot(sum, other.sum) < 0 ? -1 : 1;
    for (int k = 0; k < 3; ++k) sum[k] += side * other.sum[k];
    area += other.area;
  }
};

Facing facing_of(const Triangle& t) {
  const Vec3 ab = difference(t.b, t.a), ac = difference(t.c, t.a);
  const Vec3 sum{ab.y * ac.z - ab.z * ac.y, ab.z * ac.x - ab.x * ac.z, ab.x * ac.y - ab.y * ac.x};
  return {sum, std::sqrt(squared_length(sum.x, sum.y, sum.z))};
}

Facing facing_of(std::span<const Triangle> triangles) {
  Facing facing;
  for (const Triangle& t : triangles) facing.add(facing_of(t));
  return facing;
}

Facing facing_of(std::span<const Vec3> /*points*/) { return {}; }

double sum_of(const Vec3& v) { return std::abs(v.x) + std::abs(v.y) + std::abs(v.z); }

/// Least share of the triangles' areas that their area vectors add up to if they share a direction.
/// For others a slab says no more than the box.
constexpr double kLeastShared = 0.5;

}  // namespace

/// The elements that a node's child holds, with their box and facing.
template <typename Element>
struct WideTreeOf<Element>::Part {
  std::span<const Element> elements;
  Box box;
  Facing facing;

  explicit Part(std::span<const Element> of)
      : elements(of), box(box_of(of)), facing(facing_of(of)) {}

  /// Appends the part that follows this one.
  void add(const Part& next) {
    elements = {elements.data(), elements.size() + next.elements.size()};
    facing.add(next.facing);
    box = box.united(next.box);
  }
};

FloatPacket FloatPacket::of(const Triangle* triangles, std::uint32_t used, std::uint32_t first) {
  FloatPacket packet{};
  packet.origin = box_of(std::span(triangles, used)).centre();
  double size = 0, edge = 0;
  for (std::uint32_t i = 0; i < used; ++i) {
    const Triangle& t = triangles[i];
    const Triangle seen{difference(t.a, packet.origin), difference(t.b, packet.origin),
                        difference(t.c, packet.origin)};
    packet.set(i, seen, first + i);
    const Vec3 ab = difference(t.b, t.a), ac = difference(t.c, t.a), bc = difference(t.c, t.b);
    size = std::max(size, sum_of(seen.a) + std::max(sum_of(ab), sum_of(ac)));
    edge = std::max({edge, length(ab), length(ac), length(bc)});
  }
  packet.size = WideBoxes::above(size);
  packet.edge = WideBoxes::above(edge);
  packet.close(used);
  return packet;
}

CLEARWAY_SIMD_CLONES
void WideBoxes::to_slabs_in_vectors(const Node& node, const Slabs& slabs, const HullTarget& from,
                                    float* squared) {
  const HullTarget hull = from;
  float out[kWidth];
  to_slabs_one_by_one(node, slabs, hull, out);
  std::copy(out, out + kWidth, squared);
}

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
  origin_ = model.box().centre();
  std::vector<std::vector<Part>> levels(1);
  for (std::uint32_t part = 0; part < std::uint32_t{1} << depth; ++part) {
    const std::span<const Element> of = part_of(elements, part, depth);
    packets_.push_back(packet_of(of, tree.elements));
    levels[0].emplace_back(of);
  }
  while (levels.back().size() > 1) {
    std::vector<Part> above;
    for (std::size_t i = 0; i < levels.back().size(); ++i) {
      const Part& part = levels.back()[i];
      i % kWidth == 0 ? above.push_back(part) : above.back().add(part);
    }
    levels.push_back(std::move(above));
  }
  for (std::size_t level = levels.size(); level-- > 1;) add_level(levels[level - 1]);
}

template <typename Element>
void WideTreeOf<Element>::add_level(const std::vector<Part>& children) {
  first_.push_back(static_cast<std::uint32_t>(nodes_.size()));
  for (std::size_t i = 0; i < children.size(); ++i) {
    const std::size_t child = i % kWidth;
    if (child == 0) nodes_.emplace_back();
    for (int k = 0; k < 3; ++k) {
      nodes_.back().lo[k][child] = WideBoxes::below(children[i].box.lo[k] - origin_[k]);
      nodes_.back().hi[k][child] = WideBoxes::above(children[i].box.hi[k] - origin_[k]);
    }
    if constexpr (kIsTriangle<Element>) {
      if (child == 0) slabs_.emplace_back();
      add_slab(child, children[i]);
    }
  }
}

/// Adds a slab across the mean direction of the triangles, if they share one.
template <typename Element>
void WideTreeOf<Element>::add_slab(std::size_t child, const Part& part) {
  WideBoxes::Slabs& slabs = slabs_.back();
  const Vec3& sum = part.facing.sum;
  const double length = std::sqrt(squared_length(sum.x, sum.y, sum.z));
  if (!(length > 0 && length >= kLeastShared * part.facing.area && length < kInfinity)) return;
  for (int k = 0; k < 3; ++k) {
    slabs.normal[k][child] = static_cast<float>(sum[k] / length * WideBoxes::kShorter);
  }
  if constexpr (kIsTriangle<Element>) {
    double lo = kInfinity, hi = -kInfinity;
    for (const Element& t : part.elements) {
      for (const Vec3* corner : {&t.a, &t.b, &t.c}) {
        double along = 0, size = 0;
        for (int k = 0; k < 3; ++k) {
          const double at = (*corner)[k] - origin_[k];
          along += static_cast<double>(slabs.normal[k][child]) * at;
          size += std::abs(at);
        }
        const double rounding = 16 * kUnitRoundoff * size;
        lo = std::min(lo, along - rounding);
        hi = std::max(hi, along + rounding);
      }
    }
    slabs.lo[child] = WideBoxes::below(lo);
    slabs.hi[child] = WideBoxes::above(hi);
  }
}

template <typename Element>
WideTreeRefOf<Element> WideTreeOf<Element>::ref() const {
  Ref ref{};
  ref.nodes = nodes_.data();
  ref.slabs = slabs_.data();
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
