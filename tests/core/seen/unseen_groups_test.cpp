#include "core/seen/unseen_groups.hpp"

#include <catch2/catch.hpp>
#include <cstdlib>
#include <map>
#include <queue>
#include <random>
#include <vector>

using namespace clearway;

TEST_CASE("cubes that touch by a corner are one group, and groups are ordered by pose, then cube") {
  const std::vector<Cube> cubes{{{0, 0, 0}}, {{0, 0, 2}}, {{1, 1, 1}}, {{5, 0, 0}}, {{9, 0, 0}}};
  CHECK(group_cubes(cubes, std::vector<std::uint32_t>{7, 8, 9, 3, 7}) ==
        std::vector<std::uint32_t>{2, 2, 2, 1, 3});
  CHECK(group_cubes({}, {}).empty());
}

TEST_CASE("groups of random cubes are those of all pairs") {
  std::mt19937 random(3);
  for (unsigned scene = 0; scene < 200; ++scene) {
    std::vector<Cube> cubes;
    for (std::int32_t x = -3; x < 4; ++x) {
      for (std::int32_t y = -3; y < 4; ++y) {
        for (std::int32_t z = -3; z < 4; ++z) {
          if (random() % 100 < 6 + scene % 10) cubes.push_back({{x, y, z}});
        }
      }
    }
    std::vector<std::uint32_t> poses;
    for (std::size_t i = 0; i < cubes.size(); ++i)
      poses.push_back(static_cast<std::uint32_t>(random() % 5));
    const std::vector<std::uint32_t> groups = group_cubes(cubes, poses);
    const auto touch = [&](std::size_t a, std::size_t b) {
      for (int k = 0; k < 3; ++k) {
        if (std::abs(cubes[a].i[k] - cubes[b].i[k]) > 1) return false;
      }
      return true;
    };
    std::vector<int> label(cubes.size(), -1);
    int labels = 0;
    for (std::size_t i = 0; i < cubes.size(); ++i) {
      if (label[i] >= 0) continue;
      std::queue<std::size_t> open({i});
      label[i] = labels;
      while (!open.empty()) {
        const std::size_t at = open.front();
        open.pop();
        for (std::size_t j = 0; j < cubes.size(); ++j) {
          if (label[j] >= 0 || !touch(at, j)) continue;
          label[j] = labels;
          open.push(j);
        }
      }
      ++labels;
    }
    // The order: pairs of the least pose and the least cube, ascending.
    std::map<int, std::pair<std::uint32_t, std::size_t>> key;
    for (std::size_t i = 0; i < cubes.size(); ++i) {
      auto& [pose, cube] = key.try_emplace(label[i], 99U, i).first->second;
      pose = std::min(pose, poses[i]);
    }
    for (std::size_t i = 0; i < cubes.size(); ++i) {
      std::uint32_t before = 1;
      for (const auto& [other, k] : key) before += k < key[label[i]] ? 1 : 0;
      REQUIRE(groups[i] == before);
    }
  }
}
