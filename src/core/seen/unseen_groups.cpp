#include "core/seen/unseen_groups.hpp"

#include <algorithm>
#include <numeric>

namespace clearway {
namespace {

/// Sets of indices that are joined pair by pair. The root of a set is its least index.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), 0U);
  }

  std::uint32_t root(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }

  void join(std::uint32_t a, std::uint32_t b) {
    a = root(a);
    b = root(b);
    if (a != b) parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

}  // namespace

std::vector<std::uint32_t> group_cubes(std::span<const Cube> cubes,
                                       std::span<const std::uint32_t> first_poses) {
  DisjointSets sets(cubes.size());
  // Of the 26 neighbours, the 13 that come later join the others too. Those of one column along z
  // follow each other, so a search finds three at once.
  constexpr int kColumns[5][2] = {{0, 0}, {0, 1}, {1, -1}, {1, 0}, {1, 1}};
  for (std::uint32_t c = 0; c < cubes.size(); ++c) {
    for (const auto& [dx, dy] : kColumns) {
      const std::int32_t x = cubes[c].i[0] + dx, y = cubes[c].i[1] + dy, z = cubes[c].i[2];
      const bool own = dx == 0 && dy == 0;
      const Cube first{{x, y, own ? z + 1 : z - 1}}, last{{x, y, z + 1}};
      auto at = std::lower_bound(cubes.begin() + c, cubes.end(), first);
      for (; at != cubes.end() && !(last < *at); ++at) {
        sets.join(c, static_cast<std::uint32_t>(at - cubes.begin()));
      }
    }
  }
  // As roots are least indices, each group is named by its least cube.
  std::vector<std::uint32_t> least_pose(cubes.size(), 0xFFFFFFFF), roots;
  for (std::uint32_t c = 0; c < cubes.size(); ++c) {
    const std::uint32_t root = sets.root(c);
    if (root == c) roots.push_back(c);
    least_pose[root] = std::min(least_pose[root], first_poses[c]);
  }
  std::stable_sort(roots.begin(), roots.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return least_pose[a] < least_pose[b]; });
  std::vector<std::uint32_t> number(cubes.size()), out(cubes.size());
  for (std::uint32_t g = 0; g < roots.size(); ++g) number[roots[g]] = g + 1;
  for (std::uint32_t c = 0; c < cubes.size(); ++c) out[c] = number[sets.root(c)];
  return out;
}

}  // namespace clearway
