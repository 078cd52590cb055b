#include <algorithm>
#include <map>
#include <random>
#include <set>
#include <vector>

#include "core/seen/brick_map.hpp"
#include "core/seen/cubes.hpp"
#include "support/beam_scenes.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"

using namespace clearway;
using namespace clearway::test;

TEST_CASE("what beams see in random scenes is what the definition says") {
  std::uint64_t seen = 0, unseen = 0;
  for (unsigned seed = 0; seed < 1000; ++seed) {
    BeamScene scene(seed);
    INFO("scene " << seed);
    if (scene.bricks.empty()) continue;
    BrickMap map(scene.lattice, scene.bricks, scene.words);
    std::vector<Beam> beams;
    for (int i = 0; i < 20; ++i) beams.push_back(scene.beam());
    for (const Beam& beam : beams) map.ref().see(beam);
    check_words(scene, beams, map.words(), seen, unseen);
  }
  CHECK(seen > 10000);
  CHECK(unseen > 100000);
}

TEST_CASE("the order of beams changes nothing, and fewer beams see nothing more") {
  std::uint64_t lost = 0;
  for (unsigned seed = 0; seed < 200; ++seed) {
    BeamScene scene(seed);
    std::vector<Beam> beams;
    for (int i = 0; i < 20; ++i) beams.push_back(scene.beam());
    const std::vector<std::uint64_t> all = scene.left_by(beams);
    std::shuffle(beams.begin(), beams.end(), scene.random);
    if (scene.left_by(beams) != all) FAIL("scene " << seed << ": in another order");
    beams.resize(10);
    const std::vector<std::uint64_t> fewer = scene.left_by(beams);
    for (std::size_t w = 0; w < all.size(); ++w) {
      if ((all[w] & ~fewer[w]) != 0) FAIL("scene " << seed << ": ten beams saw more than twenty");
      lost += static_cast<std::uint64_t>(std::popcount(fewer[w] & ~all[w]));
    }
  }
  CHECK(lost > 1000);
}

TEST_CASE("a scene that is mirrored, turned or moved by whole cubes has the same unseen cubes") {
  // Each image says which axis and sign takes the place of x, y and z, and by how many cubes the
  // scene moves: 5,000 km in cubes of 300 quanta of a millimetre are 17 million.
  struct Image {
    const char* name;
    int axis[3];
    int sign[3];
    std::int32_t cubes[3];
  };
  const auto image = GENERATE(Image{"mirrored in x", {0, 1, 2}, {-1, 1, 1}, {0, 0, 0}},
                              Image{"mirrored in all", {0, 1, 2}, {-1, -1, -1}, {0, 0, 0}},
                              Image{"turned", {1, 2, 0}, {1, 1, 1}, {0, 0, 0}},
                              Image{"moved", {0, 1, 2}, {1, 1, 1}, {1'600'000, 17'000'000, -8}},
                              Image{"all of it", {2, 0, 1}, {1, -1, 1}, {-1'600'000, 3, 900'001}});
  INFO(image.name);
  std::uint64_t seen = 0;
  for (unsigned seed = 0; seed < 200; ++seed) {
    BeamScene scene(seed);
    BeamScene other(seed);
    const auto imaged = [&](const Cube& cube) {
      Cube out{};
      for (int k = 0; k < 3; ++k) {
        const std::int32_t from = cube.i[image.axis[k]];
        out.i[k] = (image.sign[k] < 0 ? -1 - from : from) + image.cubes[k];
      }
      return out;
    };
    for (int k = 0; k < 3; ++k) {
      other.lattice.side[k] = scene.lattice.side[image.axis[k]];
      other.lattice.inset[k] = scene.lattice.inset[image.axis[k]];
    }
    std::map<Brick, std::vector<std::uint64_t>> open;  // what is swept, by brick
    scene.each_cube(scene.words, [&](const Cube& cube) {
      const Cube at = imaged(cube);
      auto& words = open.try_emplace(Brick::of(at), kBrickWords, 0).first->second;
      words[entry_of(at) / 64] |= std::uint64_t{1} << entry_of(at) % 64;
    });
    other.bricks.clear();
    other.words.clear();
    for (const auto& [brick, words] : open) {
      other.bricks.push_back(brick);
      other.words.insert(other.words.end(), words.begin(), words.end());
    }
    std::vector<Beam> beams, images;
    for (int i = 0; i < 20; ++i) {
      const Beam beam = scene.beam();
      Beam out{};
      for (int k = 0; k < 3; ++k) {
        out.origin[k] = image.sign[k] * beam.origin[image.axis[k]] +
                        std::int64_t{image.cubes[k]} * other.lattice.side[k];
        out.way[k] = image.sign[k] * beam.way[image.axis[k]];
      }
      beams.push_back(beam);
      images.push_back(out);
    }
    std::set<Cube> expected, found;
    scene.each_cube(scene.left_by(beams), [&](const Cube& cube) { expected.insert(imaged(cube)); });
    other.each_cube(other.left_by(images), [&](const Cube& cube) { found.insert(cube); });
    if (found != expected) FAIL("scene " << seed);
    scene.each_cube(scene.words,
                    [&](const Cube& cube) { seen += !expected.contains(imaged(cube)); });
  }
  CHECK(seen > 2000);
}

TEST_CASE("the exact test holds at the greatest lengths that beams and cubes may have") {
  const std::int64_t side = (std::int64_t{1} << 29) - 1, most = Beam::kMostQuanta - 1;
  const CubeLattice lattice{{side, side, side}, {side / 4, side / 4, side / 4}};
  std::mt19937_64 random(7);
  std::uniform_int_distribution<std::int64_t> far(-most, most), way(-most, most);
  int seen = 0;
  for (int i = 0; i < 100000; ++i) {
    Beam beam{{far(random), far(random), far(random)}, {way(random), way(random), way(random)}};
    if (i % 3 == 0) beam.way[i % 9 / 3] = i % 2 == 0 ? most : -most;
    const Cube cube{
        {static_cast<std::int32_t>(i % 5 - 2), static_cast<std::int32_t>(i % 7 - 3), 0}};
    const bool expected = sees_by_definition(lattice, beam, cube);
    if (sees(lattice, beam, cube) != expected) FAIL("beam " << i);
    seen += expected;
  }
  CHECK(seen > 500);
}

TEST_CASE(
    "a beam that touches an inner cube in one point sees it, and one quantum beside it does not") {
  const CubeLattice lattice{{100, 100, 100}, {25, 25, 25}};
  const Cube cube{{0, 0, 0}};  // its inner cube reaches from 25 to 75
  const auto along_x = [](std::int64_t y, std::int64_t z) {
    return Beam{{-50, y, z}, {200, 0, 0}};
  };
  CHECK(sees(lattice, along_x(25, 75), cube));  // along an edge
  CHECK_FALSE(sees(lattice, along_x(24, 75), cube));
  CHECK_FALSE(sees(lattice, along_x(25, 76), cube));
  CHECK(sees(lattice, {{0, 50, 25}, {25, 0, 0}}, cube));  // ends in a face
  CHECK_FALSE(sees(lattice, {{0, 50, 25}, {24, 0, 0}}, cube));
  CHECK(sees(lattice, {{0, 50, 50}, {50, -50, 0}}, cube));  // touches the edge x = y = 25
  CHECK_FALSE(sees(lattice, {{0, 49, 50}, {49, -49, 0}}, cube));
  CHECK(sees(lattice, {{40, 40, 40}, {1, 0, 0}}, cube));  // inside
  CHECK_FALSE(
      sees(lattice, {{10, 10, 10}, {5, 5, 5}}, cube));  // in the cube, not in its inner part
}

TEST_CASE("cubes are numbered within their bricks, also below 0") {
  const Brick brick{{-1, 0, 2}};
  for (std::uint32_t entry = 0; entry < kBrickEntries; ++entry) {
    const Cube cube = brick.cube(entry);
    REQUIRE(entry_of(cube) == entry);
    REQUIRE(Brick::of(cube) == brick);
  }
  const CubeLattice lattice{{10, 10, 10}, {2, 2, 2}};
  check_equal(lattice.cube_of(0, 9), 0);
  check_equal(lattice.cube_of(0, 10), 1);
  check_equal(lattice.cube_of(0, -1), -1);
  check_equal(lattice.cube_of(0, -10), -1);
  check_equal(lattice.cube_of(0, -11), -2);
}
