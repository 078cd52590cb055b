#include "cpu/section_cubes.hpp"

#include <bit>
#include <cmath>
#include <vector>

#include "core/geometry/sweep_bounds.hpp"

namespace clearway {

/// Up to a word of cubes by their middles, and the box around these.
struct SectionCubes::Cubes {
  std::uint32_t count = 0;
  Vec3 middle[64];
  Box around{};

  void add(const Vec3& at) {
    around = count == 0 ? Box{at, at} : around.united({at, at});
    middle[count++] = at;
  }
};

SectionCubes::SectionCubes(const CubeLattice& cubes, const Quantisation& quantisation,
                           const SectionPoses& poses, const SectionLattice& lattice,
                           double rounding)
    : cubes_(cubes), quantisation_(quantisation), poses_(poses), lattice_(lattice) {
  for (int k = 0; k < 3; ++k) {
    half_[k] = rounded_product(0.5 * static_cast<double>(cubes.side[k]), quantisation.scale[k]);
  }
  slack_ = rounding + 2048 * kUnitRoundoff * (half_.x + half_.y + half_.z);
}

/// The cells under the bound of a box. The slack is taken three times: for the cube, for the
/// rounding of its place and for that of the bound.
bool SectionCubes::covers(const SectionPoseNode& node, const Vec3& centre, const Vec3& half,
                          SectionRect& rect) const {
  const PlaceBounds bounds = node.bounds(centre, &half, lattice_, 3 * slack_);
  if (bounds.to[0] < lattice_.x_from || bounds.from[0] > lattice_.x_to) return false;
  return lattice_.cover(bounds.from[1], bounds.to[1], bounds.from[2], bounds.to[2], rect);
}

bool SectionCubes::may_reach(const Brick& brick) const {
  const Vec3 first = middle_of(cubes_, quantisation_, brick.cube(0));
  const Vec3 last = middle_of(cubes_, quantisation_, brick.cube(kBrickEntries - 1));
  const Box box{first, last};
  const Vec3 half = 0.5 * box.size() + half_;
  const std::span nodes = poses_.nodes();
  std::vector<std::uint32_t> open{0};
  while (!open.empty()) {
    const std::uint32_t at = open.back();
    open.pop_back();
    SectionRect rect{};
    if (!covers(nodes[at], box.centre(), half, rect)) continue;
    if (nodes[at].is_leaf()) return true;
    open.push_back(nodes[at].right);
    open.push_back(at + 1);
  }
  return false;
}

bool SectionCubes::may_block(const SectionPoseNode& node, const Box& middles,
                             SectionMaps& maps) const {
  SectionRect rect{};
  return covers(node, middles.centre(), 0.5 * middles.size() + half_, rect) &&
         (node.bin == SectionPoseNode::kManyBins ||
          !maps[node.bin].is_blocked_by(rect, node.first_pose));
}

void SectionCubes::search(const Brick& brick, std::span<const std::uint64_t> words,
                          SectionMaps& maps) const {
  std::vector<Cubes> lists;
  Box around{};
  for (std::uint32_t word = 0; word < kBrickWords; ++word) {
    Cubes cubes;
    for (std::uint64_t open = words[word]; open != 0; open &= open - 1) {
      const auto bit = static_cast<std::uint32_t>(std::countr_zero(open));
      cubes.add(middle_of(cubes_, quantisation_, brick.cube(64 * word + bit)));
    }
    if (cubes.count == 0) continue;
    around = lists.empty() ? cubes.around : around.united(cubes.around);
    lists.push_back(cubes);
  }
  if (lists.empty()) return;
  // Bin by bin, so that a brick whose cells are all blocked there is dismissed as a whole.
  const std::span nodes = poses_.nodes();
  std::vector<std::uint32_t> open{0};
  while (!open.empty()) {
    const std::uint32_t at = open.back();
    open.pop_back();
    if (!may_block(nodes[at], around, maps)) continue;
    if (nodes[at].bin == SectionPoseNode::kManyBins) {
      open.push_back(nodes[at].right);
      open.push_back(at + 1);
      continue;
    }
    for (const Cubes& cubes : lists) visit(at, cubes, maps);
  }
}

void SectionCubes::visit(std::uint32_t at, const Cubes& cubes, SectionMaps& maps) const {
  const SectionPoseNode& node = poses_.nodes()[at];
  if (!may_block(node, cubes.around, maps)) return;
  Cubes left;
  for (std::uint32_t i = 0; i < cubes.count; ++i) {
    const Vec3& middle = cubes.middle[i];
    if (may_block(node, {middle, middle}, maps)) left.add(middle);
  }
  if (left.count == 0) return;
  if (node.is_leaf()) return visit_poses(node, left, maps);
  visit(at + 1, left, maps);
  visit(node.right, left, maps);
}

void SectionCubes::visit_poses(const SectionPoseNode& node, const Cubes& cubes,
                               SectionMaps& maps) const {
  const SectionMapRef map = maps[node.bin];
  for (std::uint32_t pose = node.first; pose < node.first + node.count; ++pose) {
    const PullBack& frame = poses_.pull_backs()[pose];
    const std::uint32_t path_pose = poses_.path_pose()[pose];
    double extent[3];
    for (int a = 0; a < 3; ++a) {
      const Vec3& row = frame.rows[a];
      const Vec3 size{std::fabs(row.x), std::fabs(row.y), std::fabs(row.z)};
      extent[a] = rounded_quotient(rounded_dot(size, half_), std::fabs(frame.determinant));
    }
    for (std::uint32_t i = 0; i < cubes.count; ++i) {
      const Vec3 place = frame.apply(cubes.middle[i]);
      double from[3], to[3];
      for (int a = 0; a < 3; ++a) {
        from[a] = (place[a] - extent[a]) - slack_;
        to[a] = (place[a] + extent[a]) + slack_;
      }
      SectionRect rect{};
      if (!(from[0] <= lattice_.x_to && to[0] >= lattice_.x_from) ||
          !lattice_.cover(from[1], to[1], from[2], to[2], rect) ||
          map.is_blocked_by(rect, path_pose)) {
        continue;
      }
      map.block(rect, path_pose);
    }
  }
}

}  // namespace clearway
