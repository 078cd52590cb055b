#include "core/sweep/field/brick_triangles.hpp"

#include <span>

#include "core/geometry/triangle_box.hpp"
#include "core/util/macros.hpp"

namespace clearway {
namespace {

constexpr std::uint32_t kLanes = TrianglePacket::kMost;

/// The lane of some packets whose triangle is nearest to a position.
struct NearestLane {
  double squared;
  std::uint32_t packet, lane;
};

CLEARWAY_SIMD_CLONES
NearestLane nearest_lane(const TrianglePacket* packets, std::uint32_t count, const Vec3& x) {
  double least[kLanes], of[kLanes];
  for (std::uint32_t i = 0; i < kLanes; ++i) {
    least[i] = packets[0].nearest(i, x).squared;
    of[i] = 0;
  }
  for (std::uint32_t p = 1; p < count; ++p) {
    const double here = p;
    for (std::uint32_t i = 0; i < kLanes; ++i) {
      const double squared = packets[p].nearest(i, x).squared;
      const bool closer = squared < least[i];
      least[i] = closer ? squared : least[i];
      of[i] = closer ? here : of[i];
    }
  }
  std::uint32_t best = 0;
  for (std::uint32_t i = 1; i < kLanes; ++i) {
    if (least[i] < least[best]) best = i;
  }
  return {least[best], static_cast<std::uint32_t>(of[best]), best};
}

/// The triangles of a packet whose boxes the rival leaves, as one bit for each lane.
CLEARWAY_SIMD_CLONES
std::uint32_t left_of(const TrianglePacket& packet, const BrickRival& rival) {
  double sum[kLanes] = {};
  for (int k = 0; k < 3; ++k) {
    const double centre = rival.centre[k], half = rival.half[k], near = rival.near[k];
    for (std::uint32_t i = 0; i < kLanes; ++i) {
      const double a = packet.a[k][i], b = a + packet.ab[k][i], c = a + packet.ac[k][i];
      const double low_ab = a < b ? a : b, high_ab = a < b ? b : a;
      const double low = low_ab < c ? low_ab : c, high = high_ab < c ? c : high_ab;
      const auto at = [&](double wanted) {
        const double from_low = wanted < low ? low : wanted;
        const double p = from_low < high ? from_low : high;
        const double beside = p - near;
        return (p - centre) * (p - centre) - 2 * half * (beside < 0 ? -beside : beside);
      };
      const double above = at(centre + half), below = at(centre - half);
      sum[i] += above < below ? above : below;
    }
  }
  std::uint32_t left = 0;
  for (std::uint32_t i = 0; i < kLanes; ++i) left |= std::uint32_t{!(sum[i] > rival.limit)} << i;
  return left;
}

}  // namespace

void BrickTriangles::Candidates::close() {
  if (count % kLanes != 0) packets[count / kLanes].close(count % kLanes);
}

void BrickTriangles::find(const Vec3& corner, double voxel, float* squared,
                          std::uint32_t* nearest) {
  lattice_ = {corner, voxel};
  nodes_ = {squared, nearest};
  constexpr std::uint32_t kLast = ModelFieldRef::kBrick;
  find_in({{0, 0, 0}, {kLast, kLast, kLast}}, nullptr, 0);
}

/// Finds the nearest triangles of all nodes of a part. among: triangles that hold all nearest
/// triangles of the part; null if such triangles are not known.
void BrickTriangles::find_in(const BrickPart& part, const Candidates* among, std::uint32_t level) {
  const BrickPlace place = lattice_.place_of(part);
  Candidates& candidates = kept_[level];
  if (among != nullptr) {
    narrow(place, *among, candidates);
  } else {
    gather(place, candidates);
  }
  if (level + 1 == kLevels) {
    candidates.count > 0 ? find_among(part, candidates) : find_in_tree(part);
    return;
  }
  const Candidates* const known = candidates.count > 0 ? &candidates : nullptr;
  for (int octant = 0; octant < 8; ++octant) find_in(part.octant(octant), known, level + 1);
}

/// Gathers from the tree the triangles that may be nearest to a place; none if they are too many.
void BrickTriangles::gather(const BrickPlace& place, Candidates& out) {
  near_ = tree_.nearest(place.centre, near_).element;
  TrianglePacket one;
  one.set(0, tree_.element(near_), near_);
  const BrickRival rival(place, difference(place.centre, one.nearest(0, place.centre).way));
  out.count = 0;
  const bool too_many = tree_.ref().any(
      [&](const Box& box) { return rival.leaves_any(box) ? ModelStep::kEnter : ModelStep::kSkip; },
      [&](const Triangle& t) {
        if (!rival.leaves_any(box_of(std::span<const Triangle>(&t, 1)))) return false;
        TrianglePacket* const packet = out.room();
        if (packet == nullptr) return true;
        packet->set(out.count++ % kLanes, t, static_cast<std::uint32_t>(&t - &tree_.element(0)));
        return false;
      });
  if (too_many) out.count = 0;
  out.close();
}

void BrickTriangles::narrow(const BrickPlace& place, const Candidates& among, Candidates& out) {
  const std::uint32_t packets = among.packet_count();
  const NearestLane near = nearest_lane(among.packets.data(), packets, place.centre);
  const TrianglePacket& of = among.packets[near.packet];
  const BrickRival rival(place, difference(place.centre, of.nearest(near.lane, place.centre).way));
  out.count = 0;
  for (std::uint32_t p = 0; p < packets; ++p) {
    const TrianglePacket& packet = among.packets[p];
    const std::uint32_t left = left_of(packet, rival);
    const std::uint32_t used = p + 1 < packets ? kLanes : among.count - p * kLanes;
    for (std::uint32_t i = 0; i < used; ++i) {
      if ((left >> i & 1) != 0) out.room()->copy(out.count++ % kLanes, packet, i);
    }
  }
  out.close();
}

void BrickTriangles::find_among(const BrickPart& part, const Candidates& among) {
  part.for_each_node([&](std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    const NearestLane near =
        nearest_lane(among.packets.data(), among.packet_count(), lattice_.node(x, y, z));
    nodes_.keep(x, y, z, near.squared, among.packets[near.packet].index[near.lane]);
  });
}

void BrickTriangles::find_in_tree(const BrickPart& part) {
  part.for_each_node([&](std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    const TriangleTree::Nearest nearest = tree_.nearest(lattice_.node(x, y, z), near_);
    near_ = nearest.element;
    nodes_.keep(x, y, z, nearest.squared_distance, nearest.element);
  });
}

}  // namespace clearway
