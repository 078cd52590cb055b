// The search of a section's cells under cubes of seen space, against every pair of a cube and a
// pose by the definitions of docs/design/section.md alone.
#include "cpu/section_cubes.hpp"

#include <array>
#include <cmath>
#include <map>
#include <tuple>

#include "core/trajectory/chainage.hpp"
#include "search/section.hpp"
#include "support/catch.hpp"
#include "support/scenes.hpp"

using namespace clearway;

namespace {

/// (bin, k, j) to the first pose.
using Firsts = std::map<std::tuple<std::uint64_t, std::int64_t, std::int64_t>, std::uint32_t>;

struct CubeScene {
  CubeLattice cubes{};
  Quantisation quantisation{{0.001, 0.001, 0.001}, {0, 0, 0}};
  std::vector<std::pair<Brick, std::array<std::uint64_t, 8>>> bricks;
  std::vector<Pose> path;
  std::vector<std::uint32_t> path_pose;  ///< poses of the path that the load has
  SectionParameters asked;
  double rounding = 1e-9;

  std::vector<Pose> load() const {
    std::vector<Pose> poses;
    for (const std::uint32_t i : path_pose) poses.push_back(path[i]);
    return poses;
  }
};

Firsts by_brute_force(const CubeScene& scene) {
  const SectionParameters& asked = scene.asked;
  const SectionWindow& w = *asked.window;
  const double from = asked.rear - asked.margin, to = asked.front + asked.margin, g = asked.cell;
  std::array<double, 3> half{};
  for (std::size_t k = 0; k < 3; ++k) {
    half[k] = 0.5 * static_cast<double>(scene.cubes.side[k]) * scene.quantisation.scale[k];
  }
  const double slack = scene.rounding + 0x1p-42 * (half[0] + half[1] + half[2]);
  const std::vector<double> chainage = chainage_of(scene.path);
  Firsts firsts;
  for (const std::uint32_t pose : scene.path_pose) {
    const double* r = scene.path[pose].rotation;
    const double c[3][3] = {
        {r[4] * r[8] - r[5] * r[7], r[2] * r[7] - r[1] * r[8], r[1] * r[5] - r[2] * r[4]},
        {r[5] * r[6] - r[3] * r[8], r[0] * r[8] - r[2] * r[6], r[2] * r[3] - r[0] * r[5]},
        {r[3] * r[7] - r[4] * r[6], r[1] * r[6] - r[0] * r[7], r[0] * r[4] - r[1] * r[3]}};
    const double determinant = c[0][0] * r[0] + c[0][1] * r[3] + c[0][2] * r[6];
    const auto bin = static_cast<std::uint64_t>(std::floor(chainage[pose] / asked.bin));
    for (const auto& [brick, words] : scene.bricks) {
      for (std::uint32_t entry = 0; entry < kBrickEntries; ++entry) {
        if ((words[entry / 64] >> (entry % 64) & 1) == 0) continue;
        const Cube cube = brick.cube(entry);
        double low[3], high[3], d[3];
        for (int k = 0; k < 3; ++k) {
          const double side = static_cast<double>(scene.cubes.side[k]);
          const double middle =
              (static_cast<double>(cube.i[k]) * side + 0.5 * side) * scene.quantisation.scale[k] +
              scene.quantisation.offset[k];
          d[k] = middle - scene.path[pose].translation[k];
        }
        for (int k = 0; k < 3; ++k) {
          const double place = (c[k][0] * d[0] + c[k][1] * d[1] + c[k][2] * d[2]) / determinant;
          const double extent = (std::abs(c[k][0]) * half[0] + std::abs(c[k][1]) * half[1] +
                                 std::abs(c[k][2]) * half[2]) /
                                std::abs(determinant);
          low[k] = (place - extent) - slack;
          high[k] = (place + extent) + slack;
        }
        if (!(low[0] <= to && high[0] >= from)) continue;
        const double j_end = std::min(std::floor(high[1] / g), std::ceil(w.y_to / g) - 1);
        const double k_end = std::min(std::floor(high[2] / g), std::ceil(w.z_to / g) - 1);
        for (double k = std::max(std::floor(low[2] / g), std::floor(w.z_from / g)); k <= k_end;
             ++k) {
          for (double j = std::max(std::floor(low[1] / g), std::floor(w.y_from / g)); j <= j_end;
               ++j) {
            const auto at =
                std::tuple(bin, static_cast<std::int64_t>(k), static_cast<std::int64_t>(j));
            const auto cell = firsts.try_emplace(at, pose).first;
            cell->second = std::min(cell->second, pose);
          }
        }
      }
    }
  }
  return firsts;
}

/// The cells of the search. Also checks that bricks out of reach have none.
Firsts by_search(const CubeScene& scene) {
  const std::vector<Pose> poses = scene.load();
  const SectionLattice lattice = section_lattice(scene.asked, 0);
  const auto bins = section_bins(chainage_of(scene.path), scene.path_pose, scene.asked);
  const SectionPoses tree(poses, scene.path_pose, bins);
  SectionMaps maps(lattice, bins.size());
  const SectionCubes search(scene.cubes, scene.quantisation, tree, lattice, scene.rounding);
  for (const auto& [brick, words] : scene.bricks) {
    if (search.may_reach(brick)) search.search(brick, words, maps);
  }
  Firsts firsts;
  for (std::size_t bin = 0; bin < bins.size(); ++bin) {
    SectionCells cells;
    add_cells_of_bin(lattice, maps.firsts(bin), static_cast<std::uint32_t>(bins[bin].number),
                     cells);
    for (std::size_t i = 0; i < cells.size(); ++i) {
      firsts.emplace(std::tuple(bins[bin].number, cells.k[i], cells.j[i]), cells.first_pose[i]);
    }
  }
  return firsts;
}

CubeScene random_cube_scene(Random& random) {
  CubeScene scene;
  const bool lattice = below(random, 3) == 0;  // with cubes and cells of common borders
  const double scales[] = {0.001, 0.01, 0.1};
  for (int k = 0; k < 3; ++k) {
    scene.quantisation.scale[k] = lattice ? 0.125 : scales[below(random, 3)];
    const double side = lattice ? 0.5 : uniform(random, 0.1, 0.6);
    scene.cubes.side[k] =
        std::max<std::int64_t>(4, std::llround(side / scene.quantisation.scale[k]));
    scene.cubes.inset[k] = scene.cubes.side[k] / 4;
  }
  const Box box{{-4, -3, -1}, {4, 3, 2}};
  const std::size_t poses = 1 + below(random, 24);
  scene.path = smooth_path(random, box, poses);
  if (lattice) {
    for (Pose& pose : scene.path) {
      pose = translation(
          {std::round(4 * pose.translation[0]) / 4, std::round(4 * pose.translation[1]) / 4, 0.25});
    }
  } else if (below(random, 3) == 0) {
    for (Pose& pose : scene.path) pose = printed_with_six_digits(pose);
  } else if (below(random, 3) == 0) {
    for (Pose& pose : scene.path) pose = random_rotation(random, pose.position());
  }
  for (std::uint32_t i = 0; i < poses; ++i) {
    if (poses == 1 || below(random, 8) > 0) scene.path_pose.push_back(i);
  }
  if (scene.path_pose.empty()) scene.path_pose.push_back(0);
  const std::uint64_t bricks = below(random, 4);
  for (std::uint64_t b = 0; b < bricks; ++b) {
    const Vec3 at = scene.path[below(random, poses)].position() +
                    Vec3{uniform(random, -2, 2), uniform(random, -2, 2), uniform(random, -2, 2)};
    Brick brick{};
    for (int k = 0; k < 3; ++k) {
      const double side = static_cast<double>(scene.cubes.side[k]) * scene.quantisation.scale[k];
      brick.i[k] = static_cast<std::int32_t>(std::floor(at[k] / side / 8)) +
                   static_cast<std::int32_t>(below(random, 2)) - 1;
    }
    std::array<std::uint64_t, 8> words{};
    for (std::uint64_t& word : words) {
      const std::uint64_t kind = below(random, 4);
      word = kind == 0 ? 0 : kind == 1 ? ~std::uint64_t{0} : random() & random() & random();
    }
    scene.bricks.emplace_back(brick, words);
  }
  SectionParameters& asked = scene.asked;
  asked.rear = lattice ? -0.5 : uniform(random, -2, 0.5);
  asked.front = asked.rear + (below(random, 4) == 0 ? 0 : lattice ? 1 : uniform(random, 0, 2));
  asked.window = lattice ? SectionWindow{-1, 1.5, -0.5, 1}
                         : SectionWindow{uniform(random, -2, 0), uniform(random, 0.01, 2),
                                         uniform(random, -1, 0), uniform(random, 0.01, 2)};
  asked.cell = lattice ? 0.25 : uniform(random, 0.08, 0.5);
  asked.bin = below(random, 4) == 0 ? 1e6 : uniform(random, 0.3, 4);
  asked.margin = below(random, 2) == 0 ? 0 : 0.25;
  if (below(random, 3) == 0) {
    const Vec3 utm{521234.25, 5412345.5, 312.75};
    for (int k = 0; k < 3; ++k) scene.quantisation.offset[k] += utm[k];
    for (Pose& pose : scene.path) {
      for (int k = 0; k < 3; ++k) pose.translation[k] += utm[k];
    }
    scene.rounding = 1e-6;
  }
  return scene;
}

}  // namespace

TEST_CASE("the cells under cubes are those of every pair of a cube and a pose") {
  Random random(20260725);
  std::size_t cells = 0, empty = 0;
  for (int i = 0; i < 600; ++i) {
    const CubeScene scene = random_cube_scene(random);
    const Firsts expected = by_brute_force(scene);
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
    CHECK(std::equal(whole.firsts(0), whole.firsts(0) + entries, single.firsts(0)));
  }
}
