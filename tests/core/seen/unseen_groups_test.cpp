#include "core/seen/unseen_groups.hpp"

#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <queue>
#include <random>
#include <vector>

#include "core/seen/cross_sections.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"

using namespace clearway;
using namespace clearway::test;

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

namespace {

using Cells = std::map<std::array<std::int32_t, 3>, std::uint64_t>;

Cells cells_of(const CrossSections& sections) {
  const SweptCells found = sections.cells();
  Cells out;
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (i > 0) CHECK(found.cell[i - 1] < found.cell[i]);
    out[found.cell[i]] = found.parts[i];
  }
  check_equal(out.size(), found.size());
  return out;
}

/// Each of the cube's 64 x 64 parts on its own.
void share(const Vec3& middle, double side, Cells& cells) {
  for (int axis = 0; axis < 3; ++axis) {
    const int a = axis == 0 ? 1 : 0, b = axis == 2 ? 1 : 2;
    for (int i = 0; i < 64; ++i) {
      for (int j = 0; j < 64; ++j) {
        const double step_a = std::floor(middle[a] / side * 64 + 0.5) - 32 + i;
        const double step_b = std::floor(middle[b] / side * 64 + 0.5) - 32 + j;
        ++cells[{axis, static_cast<std::int32_t>(std::floor(step_a / 64)),
                 static_cast<std::int32_t>(std::floor(step_b / 64))}];
      }
    }
  }
}

}  // namespace

TEST_CASE("cubes are shared among the cells that their squares cover") {
  std::mt19937 random(3);
  for (const double spread : {1.0, 30.0}) {
    const double side = 0.2;
    std::uniform_real_distribution<double> place(-spread, spread);
    CrossSections all(side), some(side);
    Cells expected;
    constexpr int kCubes = 300;
    for (int i = 0; i < kCubes; ++i) {
      Vec3 middle{place(random), place(random), place(random)};
      if (i % 3 == 0) middle = {0.2 * (i % 7) + 0.1, -0.2 * (i % 5), 0};  // flush with the cells
      (i % 2 == 0 ? all : some).add(middle);
      share(middle, side, expected);
    }
    all.add(some);
    CHECK(cells_of(all) == expected);
    std::uint64_t parts = 0;
    for (const auto& [cell, more] : expected) parts += more;
    CHECK(parts == 3 * kCubes * CrossSections::kParts);
  }
}

TEST_CASE("places that are not finite or very far away are left out") {
  CrossSections sections(0.1);
  const double most = std::numeric_limits<double>::max();
  for (const double x :
       {std::nan(""), std::numeric_limits<double>::infinity(), -most, 100'000.0, -100'000.0}) {
    for (int k = 0; k < 3; ++k) {
      Vec3 place{0, 0, 0};
      place[k] = x;
      sections.add(place);
    }
  }
  check_equal(sections.cells().size(), 0);
  sections.add({99'999, -99'999, 0});
  CHECK(sections.cells().size() > 0);
}
