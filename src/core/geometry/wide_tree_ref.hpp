#pragma once

#include <cmath>
#include <cstdint>
#include <type_traits>

#include "core/geometry/box.hpp"
#include "core/geometry/model_element.hpp"
#include "core/geometry/triangle_packet.hpp"
#include "core/util/device_bits.hpp"
#include "core/util/lanes.hpp"

namespace clearway {

/// Up to eight points of a wide tree.
struct PointPacket {
  static constexpr std::uint32_t kMost = 8;

  using Real = double;  ///< the type of its distances

  double at[3][kMost];  ///< coordinates by axis; places beyond `count` repeat the last point
  std::uint32_t count;

  CLEARWAY_HD Vec3 point(std::uint32_t i) const { return {at[0][i], at[1][i], at[2][i]}; }
};

/// The packet type that holds several elements of a model.
template <typename Element>
using PacketOf = std::conditional_t<kIsTriangle<Element>, FloatPacket, PointPacket>;

/// A set of places whose distances to elements are asked for: the triangle of three corners, and a
/// box around it.
struct PlaceHull {
  Box box;
  Vec3 corner[3];
};

/// Eight boxes in floats, and the squared distances to them. A box of triangles that face alike
/// also has a slab: two planes between which they lie. Beside a surface that is not parallel to an
/// axis, the slab is far closer to it than the box (docs/design/numerics.md, "Clearance", slabs).
struct WideBoxes {
  static constexpr std::uint32_t kWidth = 8;

  /// The boxes of a node's children, by axis, relative to the origin, rounded outwards.
  struct Node {
    float lo[3][kWidth], hi[3][kWidth];
  };

  /// The slabs of a node's children: relative to the origin, normal.x is between lo and hi for
  /// every place x of a child, rounded outwards. A normal is no longer than 1, and 0 if there is no
  /// slab.
  struct Slabs {
    float normal[3][kWidth];
    float lo[kWidth], hi[kWidth];
  };

  /// A box relative to the origin, rounded outwards.
  struct Target {
    float lo[3], hi[3];
  };

  /// A hull relative to the origin.
  struct HullTarget {
    Target box;
    float corner[3][3];  ///< coordinates of each corner
    float way[3];        ///< direction from the first corner to the second one, no longer than 1
    float along[3];      ///< product of the way and each corner
    float rounding;      ///< rounding of a product of a corner and a direction, metres
  };

  static constexpr float kLeastFloat = 0x1p-126F;  ///< the least float that keeps all its digits
  static constexpr float kMostFloat = 0x1.fffffep127F;

  /// Bounds on a value as floats. Beyond the range of floats they may be infinite or NaN, which
  /// makes a search visit.
  CLEARWAY_HD static float below(double value) { return -above(-value); }
  CLEARWAY_HD static float above(double value) {
    const auto near = static_cast<float>(value);
    return near + ((near < 0 ? -near : near) * 0x1p-22F + kLeastFloat);
  }

  CLEARWAY_HD static Target target(const Box& box, const Vec3& origin) {
    Target target{};
    for (int k = 0; k < 3; ++k) {
      target.lo[k] = below(box.lo[k] - origin[k]);
      target.hi[k] = above(box.hi[k] - origin[k]);
    }
    return target;
  }

  CLEARWAY_HD static HullTarget target(const PlaceHull& hull, const Vec3& origin) {
    HullTarget target{};
    target.box = WideBoxes::target(hull.box, origin);
    for (int i = 0; i < 3; ++i) {
      float size = 0;
      for (int k = 0; k < 3; ++k) {
        const auto at = static_cast<float>(hull.corner[i][k] - origin[k]);
        target.corner[i][k] = at;
        size += at < 0 ? -at : at;
      }
      const float rounding = size * 0x1p-19F + 4 * kLeastFloat;
      // NaN is taken, too, because then no comparison dismisses.
      if (!(rounding <= target.rounding)) target.rounding = rounding;
    }
    const Vec3 way = difference(hull.corner[1], hull.corner[0]);
    const double length = std::sqrt(squared_length(way.x, way.y, way.z));
    if (length > 1e-30 && length < 1e30) {
      for (int k = 0; k < 3; ++k) target.way[k] = static_cast<float>(way[k] / length * kShorter);
    }
    for (int i = 0; i < 3; ++i) target.along[i] = product(target.way, target.corner[i]);
    return target;
  }

  CLEARWAY_HD static void to_boxes(const Node& node, const Target& from, float* squared) {
#ifdef __CUDA_ARCH__
    to_boxes_one_by_one(node, from, squared);
#else
    to_boxes_in_vectors(node, from, squared);
#endif
  }

  /// Lower bounds on the squared distances to eight boxes: a difference, a square and two sums
  /// round by 2^-24 each, and by less than above() adds if a square is too small for that.
  CLEARWAY_IN_CLONE CLEARWAY_HD static void to_boxes_one_by_one(const Node& node,
                                                                const Target& from,
                                                                float* squared) {
    for (std::uint32_t i = 0; i < kWidth; ++i) {
      const float x = gap(node.lo[0][i], node.hi[0][i], from.lo[0], from.hi[0]);
      const float y = gap(node.lo[1][i], node.hi[1][i], from.lo[1], from.hi[1]);
      const float z = gap(node.lo[2][i], node.hi[2][i], from.lo[2], from.hi[2]);
      const float sum = x * x + y * y + z * z;
      squared[i] = (sum > kMostFloat ? kMostFloat : sum) * (1 - 0x1p-20F);
    }
  }

  /// Does to_boxes_one_by_one() in vectors of the processor.
  static void to_boxes_in_vectors(const Node& node, const Target& from, float* squared);

  /// Lower bounds on the squared distances to eight children, by boxes and slabs.
  CLEARWAY_HD static void to_slabs(const Node& node, const Slabs& slabs, const HullTarget& from,
                                   float* squared) {
#ifdef __CUDA_ARCH__
    to_slabs_one_by_one(node, slabs, from, squared);
#else
    to_slabs_in_vectors(node, slabs, from, squared);
#endif
  }

  CLEARWAY_IN_CLONE CLEARWAY_HD static void to_slabs_one_by_one(const Node& node,
                                                                const Slabs& slabs,
                                                                const HullTarget& from,
                                                                float* squared) {
    to_boxes_one_by_one(node, from.box, squared);
    float by_slab[kWidth];
    for (std::uint32_t i = 0; i < kWidth; ++i) by_slab[i] = to_slab(node, slabs, from, i);
    for (std::uint32_t i = 0; i < kWidth; ++i) {
      squared[i] = by_slab[i] > squared[i] ? by_slab[i] : squared[i];
    }
  }

  /// Does to_slabs_one_by_one() in vectors of the processor.
  static void to_slabs_in_vectors(const Node& node, const Slabs& slabs, const HullTarget& from,
                                  float* squared);

  /// A child's part of a product over all places of its box: bounds, and how large it can be.
  struct Range {
    float lo, hi, size;
  };

  CLEARWAY_IN_CLONE CLEARWAY_HD static Range range(float factor, float lo, float hi) {
    const float one = factor * lo, other = factor * hi;
    const float one_size = one < 0 ? -one : one, other_size = other < 0 ? -other : other;
    return {one < other ? one : other, one < other ? other : one, one_size + other_size};
  }

  /// Lower bound on the squared distance to a slab. The slab is looked at across the way: the part
  /// of its normal along the way is taken out, because a plane that is not quite parallel to the
  /// way meets its extension somewhere.
  CLEARWAY_IN_CLONE CLEARWAY_HD static float to_slab(const Node& node, const Slabs& slabs,
                                                     const HullTarget& from, std::uint32_t i) {
    const float x = slabs.normal[0][i], y = slabs.normal[1][i], z = slabs.normal[2][i];
    const float tilt = x * from.way[0] + y * from.way[1] + z * from.way[2];
    const Range of_x = range(from.way[0], node.lo[0][i], node.hi[0][i]);
    const Range of_y = range(from.way[1], node.lo[1][i], node.hi[1][i]);
    const Range of_z = range(from.way[2], node.lo[2][i], node.hi[2][i]);
    const Range box = range(tilt, of_x.lo + of_y.lo + of_z.lo, of_x.hi + of_y.hi + of_z.hi);
    const auto across = [&](const float(&corner)[3], float along) {
      return x * corner[0] + y * corner[1] + z * corner[2] - tilt * along;
    };
    const float a = across(from.corner[0], from.along[0]);
    const float b = across(from.corner[1], from.along[1]);
    const float c = across(from.corner[2], from.along[2]);
    const float low_ab = a < b ? a : b, high_ab = a < b ? b : a;
    const float lo = low_ab < c ? low_ab : c, hi = high_ab < c ? c : high_ab;
    const float tilt_size = tilt < 0 ? -tilt : tilt;
    const float rounding =
        from.rounding + tilt_size * (of_x.size + of_y.size + of_z.size) * 0x1p-20F;
    const float beside = gap(slabs.lo[i] - box.hi, slabs.hi[i] - box.lo, lo, hi) - rounding;
    const float beyond = beside > 0 ? beside : 0;
    const float square = beyond * beyond * (1 - 0x1p-20F);
    return square <= kMostFloat ? square : 0;
  }

  /// Factor that shortens a unit vector of floats to a length of at most 1.
  static constexpr double kShorter = 1 - 0x1p-20;

  CLEARWAY_HD static float product(const float (&a)[3], const float (&b)[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  }

  CLEARWAY_IN_CLONE CLEARWAY_HD static float gap(float lo, float hi, float from_lo, float from_hi) {
    const float beyond = lo - from_hi, before = from_lo - hi;
    const float larger = beyond > before ? beyond : before;
    return larger > 0 ? larger : 0;
  }
};

/// View of a WideTreeOf on the host or on a device. Does not own it.
template <typename Element>
struct WideTreeRefOf : WideBoxes {
  using Packet = PacketOf<Element>;

  /// Enough for 2^32 elements, which are at most 2^29 packets
  static constexpr std::uint32_t kMostLevels = 10;
  static constexpr std::uint32_t kMostOpen = kMostLevels * (kWidth - 1) + 2;

  /// Places to measure from: for points their box is enough; triangles make use of the hull.
  using Places = std::conditional_t<kIsTriangle<Element>, PlaceHull, Box>;

  const Node* nodes;   ///< nodes, one level after another, the root first
  const Slabs* slabs;  ///< slabs of the nodes; only for triangles on the host
  const Packet* packets;
  Vec3 origin;
  std::uint32_t node_count;
  std::uint32_t packet_count;        ///< number of packets, a power of 2 or 0
  std::uint32_t levels;              ///< levels of nodes; 0 if there is only one packet
  std::uint32_t first[kMostLevels];  ///< first node of each level

  /// Visits every element whose squared distance is at most within(), and perhaps others, nodes
  /// with nearer boxes first, until visit(packet, number in it) returns true; returns whether it
  /// did. places: hold every place that distances are measured from. to_elements(packet, out): a
  /// squared distance for each element of a packet. A comparison with NaN visits.
  template <typename Within, typename ToElements, typename Visit>
  CLEARWAY_HD bool any_nearest_first(const Places& places, Within within, ToElements to_elements,
                                     Visit visit) const {
    if (packet_count == 0) return false;
    const auto visit_packet = [&](std::uint32_t index) {
      const Packet& packet = packets[index];
      typename Packet::Real squared[Packet::kMost];
      to_elements(packet, squared);
      const auto limit = static_cast<typename Packet::Real>(above(within()));
      std::uint32_t near = lanes_within(squared, limit) & (0xffffffffU >> (32 - packet.count));
      for (; near != 0; near &= near - 1) {
        const std::uint32_t i = lowest_bit(near);
        if (!(static_cast<double>(squared[i]) > within()) && visit(packet, i)) return true;
      }
      return false;
    };
    if (levels == 0) return visit_packet(0);
    const auto from = target_of(places);
    Open open[kMostOpen];
    std::uint32_t count = 0;
    open[count++] = {0, 0};
    while (count > 0) {
      const Open next = open[--count];
      const float limit = above(within());
      if (next.squared > limit) continue;
      const auto level = static_cast<std::uint32_t>(next.place >> 32);
      const auto index = static_cast<std::uint32_t>(next.place);
      float squared[kWidth];
      const std::uint32_t node = first[level] + index;
      to_children(node, from, squared);
      const std::uint32_t width = children(level);
      std::uint32_t near = lanes_within(squared, limit) & ((1U << width) - 1);
      if (level + 1 == levels) {
        // The packets of one node are as good as equally near, so that to sort them gains nothing.
        for (; near != 0; near &= near - 1) {
          const std::uint32_t i = lowest_bit(near);
          if (!(squared[i] > above(within())) && visit_packet(index * kWidth + i)) return true;
        }
        continue;
      }
      const std::uint64_t deeper = std::uint64_t{level + 1} << 32;
      const std::uint32_t begin = count;
      for (; near != 0; near &= near - 1) {
        const std::uint32_t i = lowest_bit(near);
        std::uint32_t at = count++;
        for (; at > begin && open[at - 1].squared < squared[i]; --at) open[at] = open[at - 1];
        open[at] = {deeper + index * kWidth + i, squared[i]};
      }
    }
    return false;
  }

 private:
  struct Open {
    /// Its level, and in the lower half its index within the level: one word, because a word is
    /// slow to read where it was just written in parts.
    std::uint64_t place;
    float squared;  ///< squared distance to its box, rounded down
  };

  // A lane of a GPU works through a node's children one by one. Slabs cost it more than they save
  // (measured), so there only the boxes are used.
#ifdef __CUDA_ARCH__
  CLEARWAY_HD Target target_of(const Box& box) const { return target(box, origin); }
  CLEARWAY_HD Target target_of(const PlaceHull& hull) const { return target(hull.box, origin); }
#else
  CLEARWAY_HD auto target_of(const Places& places) const { return target(places, origin); }
#endif

  CLEARWAY_HD void to_children(std::uint32_t node, const Target& from, float* squared) const {
    to_boxes(nodes[node], from, squared);
  }
  CLEARWAY_HD void to_children(std::uint32_t node, const HullTarget& from, float* squared) const {
    to_slabs(nodes[node], slabs[node], from, squared);
  }

  /// Number of children of a node: only the root may have fewer than kWidth.
  CLEARWAY_HD std::uint32_t children(std::uint32_t level) const {
    return level == 0 ? packet_count >> (3 * (levels - 1)) : kWidth;
  }
};

using WideTreeRef = WideTreeRefOf<Vec3>;

}  // namespace clearway
