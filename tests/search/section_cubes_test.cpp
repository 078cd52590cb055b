// The search of a section's cells under cubes of seen space, against every pair of a cube and a
// pose by the definitions of docs/design/section.md alone.
#include "cpu/section_cubes.hpp"

#include <array>
#include <cmath>
#include <tuple>

#include "search/found_cells.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

struct CubeScene : SectionScene {
  CubeLattice cubes{};
  std::vector<std::pair<Brick, std::array<std::uint64_t, 8>>> bricks;
  double rounding = 1e-9;
};

/// Adds a cell and pose, where no pose before it has the cell.
void block(Blocked& firsts, std::uint64_t bin, double k, double j, std::uint32_t pose) {
  firsts.try_emplace({bin, static_cast<std::int64_t>(k), static_cast<std::int64_t>(j)}, pose);
}

Blocked by_brute_force(const CubeScene& scene) {
  const SectionParameters& asked = scene.asked;
  const SectionWindow& w = *asked.window;
  const double from = asked.rear - asked.margin, to = asked.front + asked.margin, g = asked.cell;
  Vec3 side{};
  for (int k = 0; k < 3; ++k) {
    side[k] = static_cast<double>(scene.cubes.side[k]) * scene.quantisation.scale[k];
  }
  const double slack = scene.rounding + 0x1p-43 * (side.x + side.y + side.z);
  const std::vector<double> chainage = chainage_of(scene.path);
  Blocked firsts;
  for (const std::uint32_t pose : scene.path_pose) {
    Pose turn = scene.path[pose];
    std::fill_n(turn.translation, 3, 0);
    Vec3 extent{};  // half of a cube's, seen from the load
    for (int axis = 0; axis < 3; ++axis) {
      Vec3 along{};
      along[axis] = 0.5 * side[axis];
      const auto seen = place_of(turn, along);
      for (int k = 0; k < 3; ++k) extent[k] += std::abs(seen[static_cast<std::size_t>(k)]);
    }
    const auto bin = static_cast<std::uint64_t>(std::floor(chainage[pose] / asked.bin));
    for (const auto& [brick, words] : scene.bricks) {
      for (std::uint32_t entry = 0; entry < kBrickEntries; ++entry) {
        if ((words[entry / 64] >> (entry % 64) & 1) == 0) continue;
        const Cube cube = brick.cube(entry);
        Vec3 middle{};
        for (int k = 0; k < 3; ++k) {
          middle[k] = (cube.i[k] + 0.5) * side[k] + scene.quantisation.offset[k];
        }
        const auto [x, y, z] = place_of(scene.path[pose], middle);
        const Vec3 reach = extent + Vec3{slack, slack, slack};
        if (!(x - reach.x <= to && x + reach.x >= from)) continue;
        const double j_end = std::min(std::floor((y + reach.y) / g), std::ceil(w.y_to / g) - 1);
        const double k_end = std::min(std::floor((z + reach.z) / g), std::ceil(w.z_to / g) - 1);
        const double j_from = std::max(std::floor((y - reach.y) / g), std::floor(w.y_from / g));
        const double k_from = std::max(std::floor((z - reach.z) / g), std::floor(w.z_from / g));
        for (double k = k_from; k <= k_end; ++k) {
          for (double j = j_from; j <= j_end; ++j) block(firsts, bin, k, j, pose);
        }
      }
    }
  }
  return firsts;
}

/// The cells of the search. Also checks that bricks out of reach have none.
Blocked by_search(const CubeScene& scene) {
  const std::vector<Pose> poses = scene.load();
  const SectionLattice lattice = section_lattice(scene.asked, 0);
  const auto bins = section_bins(chainage_of(scene.path), scene.path_pose, scene.asked);
  const SectionPoses tree(poses, scene.path_pose, bins);
  SectionMaps maps(lattice, bins.size());
  const SectionCubes search(scene.cubes, scene.quantisation, tree, lattice, scene.rounding);
  for (const auto& [brick, words] : scene.bricks) {
    if (search.may_reach(brick)) search.search(brick, words, maps);
  }
  return found_cells(lattice, bins, maps);
}

/// A random scene of sections with bricks of cubes near its poses; on a lattice cubes and cells
/// have common borders.
CubeScene random_cube_scene(Random& random) {
  CubeScene scene{random_section_scene(random), {}, {}};
  scene.asked.cell = std::max(scene.asked.cell, 0.1);
  const bool is_far = std::abs(scene.path[0].translation[0]) > 1e5;
  if (is_far) scene.rounding = 1e-6;
  for (int k = 0; k < 3; ++k) {
    const double scale = scene.quantisation.scale[k];
    const double side = scale > 0.05 ? 0.5 : uniform(random, 0.1, 0.6);
    scene.cubes.side[k] = std::max<std::int64_t>(4, std::llround(side / scale));
    scene.cubes.inset[k] = scene.cubes.side[k] / 4;
  }
  for (std::uint64_t b = below(random, 4); b > 0; --b) {
    const Vec3 at = scene.path[below(random, scene.path.size())].position() +
                    random_point(random, {{-2, -2, -2}, {2, 2, 2}});
    auto& [brick, words] = scene.bricks.emplace_back();
    for (int k = 0; k < 3; ++k) {
      const double side = static_cast<double>(scene.cubes.side[k]) * scene.quantisation.scale[k];
      const double from = at[k] - scene.quantisation.offset[k];
      brick.i[k] = static_cast<std::int32_t>(std::floor(from / side / 8)) +
                   static_cast<std::int32_t>(below(random, 2)) - 1;
    }
    for (std::uint64_t& word : words) {
      const std::uint64_t kind = below(random, 4);
      word = kind == 0 ? 0 : kind == 1 ? ~std::uint64_t{0} : random() & random() & random();
    }
  }
  return scene;
}

}  // namespace

TEST_CASE("the cells under cubes are those of every pair of a cube and a pose") {
  Random random(20260725);
  std::size_t cells = 0, empty = 0;
  for (int i = 0; i < 250; ++i) {
    const CubeScene scene = random_cube_scene(random);
    const Blocked expected = by_brute_force(scene);
    INFO("scene " << i);
    CHECK((by_search(scene) == expected));
    cells += expected.size();
    empty += expected.empty() ? 1 : 0;
  }
  CHECK(cells > 10000);
  CHECK(empty > 10);
}

TEST_CASE("a rectangle of cells is blocked as its cells are one by one") {
  Random random(3);
  const SectionLattice lattice = section_lattice(
      {.rear = 0, .front = 1, .window = SectionWindow{-3.3, 4.1, 0, 2.9}, .cell = 0.1, .bin = 5},
      0);
  SectionMaps whole(lattice, 1), single(lattice, 1);
  for (int i = 0; i < 300; ++i) {
    SectionRect rect{};
    rect.column_from = static_cast<std::uint32_t>(below(random, lattice.columns));
    rect.column_to = rect.column_from +
                     static_cast<std::uint32_t>(below(random, lattice.columns - rect.column_from));
    rect.row_from = static_cast<std::uint32_t>(below(random, lattice.rows));
    rect.row_to =
        rect.row_from + static_cast<std::uint32_t>(below(random, lattice.rows - rect.row_from));
    const auto pose = static_cast<std::uint32_t>(below(random, 50));
    whole[0].block(rect, pose);
    for (std::uint32_t row = rect.row_from; row <= rect.row_to; ++row) {
      for (std::uint32_t column = rect.column_from; column <= rect.column_to; ++column) {
        single[0].block(column, row, pose);
      }
    }
    CHECK(whole[0].is_blocked_by(rect, pose));
    const std::uint64_t entries = SectionMapShape(lattice).entries;
    CHECK(std::ranges::equal(whole.entries().first(entries), single.entries().first(entries)));
  }
}
