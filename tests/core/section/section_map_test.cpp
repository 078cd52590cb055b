// The map of first poses and its pyramid against all cells of a rectangle.
#include "core/section/section_map.hpp"

#include <algorithm>
#include <catch2/catch.hpp>

#include "support/scenes.hpp"

using namespace clearway;

TEST_CASE("a pyramid over first poses says whether all cells of a rectangle are blocked early") {
  Random random(7);
  const auto number = [&](std::uint32_t most) {
    return static_cast<std::uint32_t>(below(random, most));
  };
  std::size_t yes = 0, no = 0;
  for (int i = 0; i < 60; ++i) {
    const double columns = 1 + number(90), rows = 1 + number(90);
    const SectionLattice lattice = section_lattice(
        {.rear = 0, .front = 1, .window = SectionWindow{0, columns, 0, rows}, .cell = 1, .bin = 1},
        0);
    SectionMaps maps(lattice, 2);
    const SectionMapRef map = maps[1];
    std::vector<std::uint32_t> firsts(lattice.cells(), kNotBlocked);
    const std::uint32_t poses = 1 + number(6);
    const std::uint32_t updates = number(3 * static_cast<std::uint32_t>(lattice.cells()));
    for (std::uint32_t update = 0; update < updates; ++update) {
      const std::uint32_t column = number(lattice.columns), row = number(lattice.rows);
      const std::uint32_t pose = number(poses);
      map.block(column, row, pose);
      std::uint32_t& first = firsts[row * lattice.columns + column];
      first = std::min(first, pose);
    }
    CHECK(std::equal(firsts.begin(), firsts.end(), maps.firsts(1)));
    CHECK(std::all_of(maps.firsts(0), maps.firsts(0) + maps.shape().entries,
                      [](std::uint32_t entry) { return entry == kNotBlocked; }));
    for (int question = 0; question < 300; ++question) {
      const std::uint32_t side = 1 + number(question % 3 == 0 ? 90 : 5);
      SectionRect rect{number(lattice.columns), 0, number(lattice.rows), 0};
      rect.column_to = std::min(rect.column_from + number(side), lattice.columns - 1);
      rect.row_to = std::min(rect.row_from + number(side), lattice.rows - 1);
      const std::uint32_t pose = number(poses);
      bool expected = true;
      for (std::uint32_t row = rect.row_from; row <= rect.row_to; ++row) {
        for (std::uint32_t column = rect.column_from; column <= rect.column_to; ++column) {
          expected = expected && firsts[row * lattice.columns + column] <= pose;
        }
      }
      CHECK(map.is_blocked_by(rect, pose) == expected);
      CHECK(map.is_blocked_inside(rect, pose) == expected);
      ++(expected ? yes : no);
    }
  }
  CHECK(yes > 2000);
  CHECK(no > 2000);
}
