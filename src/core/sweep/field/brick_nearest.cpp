#include "core/sweep/field/brick_nearest.hpp"

namespace clearway {

void BrickNearest::find(const Vec3& corner, double voxel, float* squared, std::uint32_t* nearest) {
  lattice_ = {corner, voxel};
  nodes_ = {squared, nearest};
  constexpr std::uint32_t kLast = ModelFieldRef::kBrick;
  find_in({{0, 0, 0}, {kLast, kLast, kLast}}, {}, 0);
}

/// Finds the nearest points of all nodes of a part. candidates: points that hold all nearest points
/// of the part; empty if such points are not known.
void BrickNearest::find_in(const Part& part, std::span<const Candidate> candidates,
                           std::uint32_t level) {
  const Place place = lattice_.place_of(part);
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
    find_in(part.octant(octant), candidates, level + 1);
  }
}

/// Gathers from the tree the points that may be nearest to a place. Returns false if they are too
/// many.
bool BrickNearest::gather(const Place& place, std::span<const Candidate>& out) {
  near_ = tree_.nearest(place.centre, near_).element;
  const BrickRival rival(place, tree_.element(near_));
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
  const BrickRival rival(place, near->point);
  std::array<Candidate, kMostGathered>& kept = kept_[level];
  std::size_t count = 0;
  for (const Candidate& candidate : candidates) {
    kept[count] = candidate;
    count += rival.leaves(candidate.point) ? 1 : 0;
  }
  return std::span(kept).first(count);
}

void BrickNearest::find_among(const Part& part, std::span<const Candidate> candidates) {
  part.for_each_node([&](std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    const Vec3 at = lattice_.node(x, y, z);
    std::size_t best = 0;
    double least = squared_distance(candidates[0].point, at);
    for (std::size_t i = 1; i < candidates.size(); ++i) {
      const double here = squared_distance(candidates[i].point, at);
      if (here < least) {
        least = here;
        best = i;
      }
    }
    nodes_.keep(x, y, z, least, candidates[best].index);
  });
}

void BrickNearest::find_in_tree(const Part& part) {
  part.for_each_node([&](std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    const ModelTree::Nearest nearest = tree_.nearest(lattice_.node(x, y, z), near_);
    near_ = nearest.element;
    nodes_.keep(x, y, z, nearest.squared_distance, nearest.element);
  });
}

}  // namespace clearway
