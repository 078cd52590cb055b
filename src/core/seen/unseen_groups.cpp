#include "core/seen/unseen_groups.hpp"

#include <algorithm>

#include "core/util/disjoint_sets.hpp"

namespace clearway {
std::vector<std::uint32_t> group_cubes(std::span<const Cube> cubes,
                                       std::span<const std::uint32_t> first_poses) {
  DisjointSets sets(cubes.size());
  // Each cube is joined with those of its 26 neighbours that come after it, because the others join
  // it themselves. The neighbours in one column along z follow each other, so one search finds
  // them.
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
