#include "core/seen/unseen_groups.hpp"

#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <numeric>
#include <random>
#include <set>
#include <vector>

#include "core/seen/cross_sections.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"

using namespace clearway;
using namespace clearway::test;

TEST_CASE("groups of random cubes are those of all pairs") {
  std::mt19937 random(3);
  for (unsigned scene = 0; scene < 200; ++scene) {
    std::vector<Cube> cubes;
    for (std::int32_t i = 0; i < 7 * 7 * 7; ++i) {
      if (random() % 100 < 6 + scene % 10)
        cubes.push_back({{i / 49 - 3, i / 7 % 7 - 3, i % 7 - 3}});
    }
    std::vector<std::uint32_t> poses(cubes.size());
    for (auto& pose : poses) pose = static_cast<std::uint32_t>(random() % 5);
    const auto touch = [&](std::size_t a, std::size_t b) {
      for (int k = 0; k < 3; ++k) {
        if (std::abs(cubes[a].i[k] - cubes[b].i[k]) > 1) return false;
      }
      return true;
    };
    // Every cube takes the least pose and the least cube of those it touches, until all have.
    std::vector<std::size_t> first(cubes.size());
    std::iota(first.begin(), first.end(), std::size_t{0});
    std::vector<std::uint32_t> least = poses;
    for (bool changes = true; changes;) {
      changes = false;
      for (std::size_t a = 0; a < cubes.size(); ++a) {
        for (std::size_t b = 0; b < cubes.size(); ++b) {
          if (!touch(a, b) || (first[a] <= first[b] && least[a] <= least[b])) continue;
          first[a] = std::min(first[a], first[b]);
          least[a] = std::min(least[a], least[b]);
          changes = true;
        }
      }
    }
    std::set<std::pair<std::uint32_t, std::size_t>> keys;
    for (std::size_t i = 0; i < cubes.size(); ++i) keys.emplace(least[i], first[i]);
    std::vector<std::uint32_t> expected;
    for (std::size_t i = 0; i < cubes.size(); ++i) {
      const auto before = std::distance(keys.begin(), keys.find({least[i], first[i]}));
      expected.push_back(static_cast<std::uint32_t>(1 + before));
    }
    REQUIRE(group_cubes(cubes, poses) == expected);
  }
  CHECK(group_cubes({}, {}).empty());
}

namespace {

using Cells = std::map<std::array<std::int32_t, 3>, std::uint64_t>;

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
    for (int i = 0; i < 300; ++i) {
      Vec3 middle{place(random), place(random), place(random)};
      if (i % 3 == 0) middle = {0.2 * (i % 7) + 0.1, -0.2 * (i % 5), 0};  // flush with the cells
      (i % 2 == 0 ? all : some).add(middle);
      share(middle, side, expected);
    }
    all.add(some);
    const SweptCells found = all.cells();
    std::vector<std::array<std::int32_t, 3>> cells;  // in their order
    std::vector<std::uint64_t> parts;
    for (const auto& [cell, count] : expected) {
      cells.push_back(cell);
      parts.push_back(count);
    }
    CHECK(std::ranges::equal(found.cell, cells));
    CHECK(std::ranges::equal(found.parts, parts));
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
