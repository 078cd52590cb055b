#include "core/seen/brick_cloud.hpp"

#include <algorithm>
#include <random>
#include <set>
#include <vector>

#include "clearway/error.hpp"
#include "support/catch.hpp"
#include "support/scenes.hpp"

using namespace clearway;

namespace {

constexpr Quantisation kMillimetres{{0.001, 0.001, 0.002}, {500000.1, -7.3, 12}};
constexpr CubeLattice kOddCubes{{201, 100, 77}, {50, 25, 19}};

Vec3 middle_by_definition(const Cube& cube) {
  Vec3 out{};
  for (int k = 0; k < 3; ++k) {
    const double quanta = static_cast<double>(kOddCubes.side[k]) * cube.i[k] +
                          static_cast<double>(kOddCubes.side[k]) / 2;
    const double scaled = quanta * kMillimetres.scale[k];
    out[k] = scaled + kMillimetres.offset[k];
  }
  return out;
}

}  // namespace

TEST_CASE("the middles of cubes are those of the definition, bit for bit") {
  std::vector<Brick> bricks;
  for (std::int32_t i = -3; i < 4; ++i) bricks.push_back({{i, 40 * i, -i}});
  const BrickCloud cloud(bricks, kOddCubes, kMillimetres);
  REQUIRE(cloud.point_count() == 512 * bricks.size());
  CHECK(cloud.tree().front().cell_count == bricks.size());
  for (std::uint32_t cell = 0; cell < bricks.size(); ++cell) {
    const auto chunks = cloud.coordinates(cell);
    std::vector<std::byte> bytes(cloud.packed_bytes(cell));
    const auto read = cloud.read_packed(cell, bytes);
    for (std::uint32_t entry = 0; entry < kBrickEntries; ++entry) {
      const Cube cube = cloud.bricks()[cell].cube(entry);
      const Vec3 middle =
          position(cloud.quantisation(), chunks[0][entry], chunks[1][entry], chunks[2][entry]);
      REQUIRE(middle == middle_by_definition(cube));
      for (std::size_t k = 0; k < 3; ++k) {
        REQUIRE(read[k][entry] == chunks[k][entry]);
        const QuantumBox block =
            decode_block_box(cloud.cells()[cell].box, cloud.blocks(cell)[entry / 64]);
        REQUIRE((block.lo[k] <= chunks[k][entry] && chunks[k][entry] <= block.hi[k]));
      }
    }
  }
}

TEST_CASE("no cube that the model sweeps is outside the bricks along its path") {
  Random random(11);
  for (int scene = 0; scene < 20; ++scene) {
    Query query;
    query.model = Model(random_points(random, {{-2, -1, 0}, {3, 1, 2}}, 40));
    query.between_poses = scene % 2 == 1;
    const auto unit = [&] { return uniform(random, -1, 1); };
    for (int i = 0; i < 6; ++i) {
      query.poses.push_back(rotation({0, 0, 1}, 3 * unit(), {500000 + 4 * i + unit(), unit(), 12}));
    }
    const std::vector<Brick> bricks =
        bricks_along(query, 0.3, kOddCubes, kMillimetres, std::uint64_t{1} << 30);
    REQUIRE(std::is_sorted(bricks.begin(), bricks.end()));
    const std::set<Brick> known(bricks.begin(), bricks.end());
    for (std::size_t i = 0; i < query.poses.size(); ++i) {
      for (const Vec3& p : query.model.vertices) {
        Vec3 at = transform(query.poses[i], p);
        if (query.between_poses && i > 0) {
          const Vec3 before = transform(query.poses[i - 1], p);
          for (int k = 0; k < 3; ++k) at[k] = (at[k] + before[k]) / 2;
        }
        for (int k = 0; k < 3; ++k) at[k] += 0.17 * unit();
        Cube cube{};
        for (int k = 0; k < 3; ++k) {
          const double q = std::floor((at[k] - kMillimetres.offset[k]) / kMillimetres.scale[k]);
          cube.i[k] = kOddCubes.cube_of(k, static_cast<std::int64_t>(q));
        }
        REQUIRE(known.contains(Brick::of(cube)));
      }
    }
  }
}

TEST_CASE("cubes beyond 32-bit integers, and more bricks than memory holds, are refused") {
  Query query;
  query.model = Model({{0, 0, 0}, {1, 1, 1}});
  query.poses.push_back(translation({1e9, 0, 0}));
  CHECK_THROWS_AS(bricks_along(query, 0.1, kOddCubes, kMillimetres, 1 << 20), InputError);
  CHECK_THROWS_AS(BrickCloud({{{1 << 24, 0, 0}}}, kOddCubes, kMillimetres), InputError);
  query.model = Model({{0, 0, 0}, {100, 100, 100}});
  query.poses[0].translation[0] = 500000;
  CHECK_THROWS_AS(bricks_along(query, 0.1, kOddCubes, kMillimetres, 1 << 20), ResourceError);
}
