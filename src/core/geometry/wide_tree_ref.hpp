#pragma once

#include <cmath>
#include <cstdint>
#include <type_traits>

#include "core/geometry/box.hpp"
#include "core/geometry/model_element.hpp"
#include "core/geometry/triangle_packet.hpp"

namespace clearway {

/// Up to eight points of a wide tree.
struct PointPacket {
  static constexpr std::uint32_t kMost = 8;

  double at[3][kMost];  ///< by axis; behind `count` the last point again
  std::uint32_t count;

  CLEARWAY_HD Vec3 point(std::uint32_t i) const { return {at[0][i], at[1][i], at[2][i]}; }
};

/// What holds several elements of a model.
template <typename Element>
using PacketOf = std::conditional_t<kIsTriangle<Element>, TrianglePacket, PointPacket>;

/// Eight boxes in floats, and the squared distances to them.
struct WideBoxes {
  static constexpr std::uint32_t kWidth = 8;

  /// The boxes of a node's children, by axis, relative to the origin, rounded outwards.
  struct Node {
    float lo[3][kWidth], hi[3][kWidth];
  };

  /// A box relative to the origin, rounded outwards.
  struct Target {
    float lo[3], hi[3];
  };

  static constexpr float kLeastFloat = 0x1p-126F;  ///< that keeps all its digits
  static constexpr float kMostFloat = 0x1.fffffep127F;

  /// Bounds of a value that are floats. Beyond the range of floats they may be infinite or no
  /// number, which visits.
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

  CLEARWAY_HD static void to_boxes(const Node& node, const Target& from, float* squared) {
#ifdef __CUDA_ARCH__
    to_boxes_one_by_one(node, from, squared);
#else
    to_boxes_in_vectors(node, from, squared);
#endif
  }

  /// Squared distances, at most the true ones: a difference, a square and two sums round by 2^-24
  /// each, and by less than above() adds where a square is too small for that.
  CLEARWAY_HD static void to_boxes_one_by_one(const Node& node, const Target& from,
                                              float* squared) {
    for (std::uint32_t i = 0; i < kWidth; ++i) {
      const float x = gap(node.lo[0][i], node.hi[0][i], from.lo[0], from.hi[0]);
      const float y = gap(node.lo[1][i], node.hi[1][i], from.lo[1], from.hi[1]);
      const float z = gap(node.lo[2][i], node.hi[2][i], from.lo[2], from.hi[2]);
      const float sum = x * x + y * y + z * z;
      squared[i] = (sum > kMostFloat ? kMostFloat : sum) * (1 - 0x1p-20F);
    }
  }

  /// The same in vectors of the processor.
  static void to_boxes_in_vectors(const Node& node, const Target& from, float* squared);

  CLEARWAY_HD static float gap(float lo, float hi, float from_lo, float from_hi) {
    const float beyond = lo - from_hi, before = from_lo - hi;
    const float larger = beyond > before ? beyond : before;
    return larger > 0 ? larger : 0;
  }
};

/// A WideTreeOf where it lies, on the host or on a device. Does not own it.
template <typename Element>
struct WideTreeRefOf : WideBoxes {
  using Packet = PacketOf<Element>;

  static constexpr std::uint32_t kMostLevels = 10;  ///< 2^32 elements are 2^29 packets at most
  static constexpr std::uint32_t kMostOpen = kMostLevels * (kWidth - 1) + 2;

  const Node* nodes;  ///< level after level, the root first
  const Packet* packets;
  Vec3 origin;
  std::uint32_t node_count;
  std::uint32_t packet_count;        ///< a power of 2, or 0
  std::uint32_t levels;              ///< of nodes; 0 where there is one packet
  std::uint32_t first[kMostLevels];  ///< node of a level

  /// Visits every element whose squared distance is at most within(), and perhaps others, nearer
  /// boxes first, until visit(packet, number in it) is true; whether it was. box: no place that
  /// distances are measured from is outside. to_elements(packet, out): a squared distance for each
  /// element of a packet. A comparison that is not possible visits.
  template <typename Within, typename ToElements, typename Visit>
  CLEARWAY_HD bool any_nearest_first(const Box& box, Within within, ToElements to_elements,
                                     Visit visit) const {
    if (packet_count == 0) return false;
    const Target from = target(box, origin);
    Open open[kMostOpen];
    std::uint32_t count = 0;
    open[count++] = {0, 0, 0};
    while (count > 0) {
      const Open next = open[--count];
      const float limit = above(within());
      if (next.squared > limit) continue;
      if (next.level == levels) {
        const Packet& packet = packets[next.index];
        double squared[Packet::kMost];
        to_elements(packet, squared);
        for (std::uint32_t i = 0; i < packet.count; ++i) {
          if (!(squared[i] > within()) && visit(packet, i)) return true;
        }
        continue;
      }
      float squared[kWidth];
      to_boxes(nodes[first[next.level] + next.index], from, squared);
      const std::uint32_t width = children(next.level);
      const std::uint32_t begin = count;
      for (std::uint32_t i = 0; i < width; ++i) {
        if (squared[i] > limit) continue;
        std::uint32_t at = count++;
        for (; at > begin && open[at - 1].squared < squared[i]; --at) open[at] = open[at - 1];
        open[at] = {squared[i], next.index * kWidth + i, next.level + 1};
      }
    }
    return false;
  }

 private:
  struct Open {
    float squared;        ///< distance to its box, rounded down
    std::uint32_t index;  ///< within the level
    std::uint32_t level;
  };

  /// Only the root may have fewer.
  CLEARWAY_HD std::uint32_t children(std::uint32_t level) const {
    return level == 0 ? packet_count >> (3 * (levels - 1)) : kWidth;
  }
};

using WideTreeRef = WideTreeRefOf<Vec3>;

}  // namespace clearway
