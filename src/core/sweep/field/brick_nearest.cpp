#include "core/sweep/field/brick_nearest.hpp"

#include <algorithm>
#include <cmath>

namespace clearway {
namespace {

/// Widens the test that leaves points out, far beyond what its roundings amount to: a field's voxel
/// is at least 1e-7 of the model's coordinates.
constexpr double kSlack = 1e-6;

/// A model point near a place, against which others are tested. A point p is nearer than `near` to
/// some x within `half` of `centre` only if
///     |centre - p|^2 - |centre - near|^2 < 2 sum half_k |p_k - near_k|,
/// for |x - p|^2 - |x - near|^2 is linear in x.
struct Rival {
  Vec3 centre, half, near;
  double limit;  ///< |centre - near|^2 and the slack

  Rival(const Vec3& at, const Vec3& within, const Vec3& near_point)
      : centre(at), half(within), near(near_point), limit(squared_distance(at, near_point)) {
    limit += kSlack * (limit + squared_length(half.x, half.y, half.z));
  }

  bool leaves(const Vec3& p) const {
    const double gain = half.x * std::abs(p.x - near.x) + half.y * std::abs(p.y - near.y) +
                        half.z * std::abs(p.z - near.z);
    return !(squared_distance(centre, p) - 2 * gain > limit);  // also where it is no number
  }

  /// Whether it may leave a point of the box. What leaves() adds up is least, along each axis, at
  /// the place nearest to centre + half above near, and to centre - half below it.
  bool leaves_any(const Box& box) const {
    double least = 0;
    for (int k = 0; k < 3; ++k) {
      const auto at = [&](double p) {
        return (p - centre[k]) * (p - centre[k]) - 2 * half[k] * std::abs(p - near[k]);
      };
      const double above = std::clamp(centre[k] + half[k], box.lo[k], box.hi[k]);
      const double below = std::clamp(centre[k] - half[k], box.lo[k], box.hi[k]);
      least += std::min(at(above), at(below));
    }
    return !(least > limit);
  }
};

}  // namespace

float rounded_down(double squared) {
  return std::nextafterf(static_cast<float>(squared * (1 - 1e-12)), 0.0F);
}

void BrickNearest::find(const Vec3& corner, double voxel, float* squared, std::uint32_t* nearest) {
  corner_ = corner;
  voxel_ = voxel;
  squared_ = squared;
  nearest_ = nearest;
  constexpr std::uint32_t kLast = ModelFieldRef::kBrick;
  find_in({{0, 0, 0}, {kLast, kLast, kLast}}, {}, 0);
}

/// candidates: among which all nearest points of the part are, or none, where they are not known.
void BrickNearest::find_in(const Part& part, std::span<const Candidate> candidates,
                           std::uint32_t level) {
  const Place place = place_of(part);
  if (!candidates.empty()) {
    candidates = narrowed(place, candidates, level);
  } else if (!gather(place, candidates)) {
    candidates = {};
  }
  if (level + 1 == kLevels) {
    candidates.empty() ? find_in_tree(part) : find_among(part, candidates);
    return;
  }
  for (int octant = 0; octant < 8; ++octant) {
    Part inner = part;
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t middle = (part.first[k] + part.last[k]) / 2;
      if ((octant >> k & 1) != 0) {
        inner.first[k] = middle + 1;
      } else {
        inner.last[k] = middle;
      }
    }
    find_in(inner, candidates, level + 1);
  }
}

/// From the tree; false where they are too many.
bool BrickNearest::gather(const Place& place, std::span<const Candidate>& out) {
  near_ = tree_.nearest(place.centre, near_).element;
  const Rival rival(place.centre, place.half, tree_.element(near_));
  std::array<Candidate, kMostGathered>& kept = kept_[0];
  std::size_t count = 0;
  const bool too_many = tree_.ref().any(
      [&](const Box& box) {
        return rival.leaves_any(box) ? ModelTreeRef::Step::kEnter : ModelTreeRef::Step::kSkip;
      },
      [&](const Vec3& point) {
        if (!rival.leaves(point)) return false;
        if (count == kept.size()) return true;
        kept[count++] = {point, static_cast<std::uint32_t>(&point - &tree_.element(0))};
        return false;
      });
  out = std::span(kept).first(count);
  return !too_many;
}

std::span<const BrickNearest::Candidate> BrickNearest::narrowed(
    const Place& place, std::span<const Candidate> candidates, std::uint32_t level) {
  const Candidate* near = candidates.data();
  double least = squared_distance(place.centre, near->point);
  for (const Candidate& candidate : candidates) {
    const double here = squared_distance(place.centre, candidate.point);
    if (here < least) {
      least = here;
      near = &candidate;
    }
  }
  const Rival rival(place.centre, place.half, near->point);
  std::array<Candidate, kMostGathered>& kept = kept_[level];
  std::size_t count = 0;
  for (const Candidate& candidate : candidates) {
    kept[count] = candidate;
    count += rival.leaves(candidate.point) ? 1 : 0;
  }
  return std::span(kept).first(count);
}

void BrickNearest::find_among(const Part& part, std::span<const Candidate> candidates) {
  for (std::uint32_t z = part.first[2]; z <= part.last[2]; ++z) {
    for (std::uint32_t y = part.first[1]; y <= part.last[1]; ++y) {
      for (std::uint32_t x = part.first[0]; x <= part.last[0]; ++x) {
        const Vec3 at = node(x, y, z);
        std::size_t best = 0;
        double least = squared_distance(candidates[0].point, at);
        for (std::size_t i = 1; i < candidates.size(); ++i) {
          const double here = squared_distance(candidates[i].point, at);
          if (here < least) {
            least = here;
            best = i;
          }
        }
        keep(x, y, z, least, candidates[best].index);
      }
    }
  }
}

void BrickNearest::find_in_tree(const Part& part) {
  for (std::uint32_t z = part.first[2]; z <= part.last[2]; ++z) {
    for (std::uint32_t y = part.first[1]; y <= part.last[1]; ++y) {
      for (std::uint32_t x = part.first[0]; x <= part.last[0]; ++x) {
        const ModelTree::Nearest nearest = tree_.nearest(node(x, y, z), near_);
        near_ = nearest.element;
        keep(x, y, z, nearest.squared_distance, nearest.element);
      }
    }
  }
}

Vec3 BrickNearest::node(std::uint32_t x, std::uint32_t y, std::uint32_t z) const {
  return {corner_.x + x * voxel_, corner_.y + y * voxel_, corner_.z + z * voxel_};
}

BrickNearest::Place BrickNearest::place_of(const Part& part) const {
  const Vec3 lo = node(part.first[0], part.first[1], part.first[2]);
  const Vec3 hi = node(part.last[0], part.last[1], part.last[2]);
  return {{(lo.x + hi.x) / 2, (lo.y + hi.y) / 2, (lo.z + hi.z) / 2},
          {(hi.x - lo.x) / 2, (hi.y - lo.y) / 2, (hi.z - lo.z) / 2}};
}

void BrickNearest::keep(std::uint32_t x, std::uint32_t y, std::uint32_t z, double squared,
                        std::uint32_t nearest) {
  const std::size_t at = (z * ModelFieldRef::kRow + y) * ModelFieldRef::kRow + x;
  squared_[at] = rounded_down(squared);
  nearest_[at] = nearest;
}

void find_nearest_triangles(const TriangleTree& tree, const Vec3& corner, double voxel,
                            float* squared, std::uint32_t* nearest) {
  std::uint32_t near = 0;
  for (std::uint32_t at = 0; at < ModelFieldRef::kBrickNodes; ++at) {
    constexpr std::uint32_t kRow = ModelFieldRef::kRow;
    const std::uint32_t x = at % kRow, y = at / kRow % kRow, z = at / (kRow * kRow);
    const Vec3 node{corner.x + x * voxel, corner.y + y * voxel, corner.z + z * voxel};
    const TriangleTree::Nearest found = tree.nearest(node, near);
    near = found.element;
    squared[at] = rounded_down(found.squared_distance);
    nearest[at] = near;
  }
}

}  // namespace clearway
