#include "core/seen/cross_sections.hpp"

#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <vector>

using namespace clearway;

namespace {

using Cells = std::map<std::array<std::int32_t, 3>, std::uint64_t>;

Cells cells_of(const CrossSections& sections) {
  const SweptCells found = sections.cells();
  Cells out;
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (i > 0) CHECK(found.cell[i - 1] < found.cell[i]);
    out[found.cell[i]] = found.parts[i];
  }
  CHECK(out.size() == found.size());
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
  CHECK(sections.cells().size() == 0);
  sections.add({99'999, -99'999, 0});
  CHECK(sections.cells().size() > 0);
}
