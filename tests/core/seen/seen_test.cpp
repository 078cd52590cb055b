#include <random>
#include <vector>

#include "core/seen/brick_map.hpp"
#include "core/seen/cubes.hpp"
#include "support/beam_scenes.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"

using namespace clearway;
using namespace clearway::test;

TEST_CASE("what beams see in random scenes is what the definition says") {
  // 5,000 km in quanta of a millimetre, which are up to 1.2 billion cubes
  constexpr std::int64_t kFarAway = 5'000'000'000;
  std::uint64_t seen = 0, unseen = 0;
  for (unsigned seed = 0; seed < 1000; ++seed) {
    BeamScene scene(seed, seed % 2 == 0 ? 3'000'000 : kFarAway);
    INFO("scene " << seed);
    const BrickMap map(scene.lattice, scene.bricks, scene.words);
    std::vector<Beam> beams;
    for (int i = 0; i < 20; ++i) map.ref().see(beams.emplace_back(scene.beam()));
    check_words(scene, beams, map.words(), seen, unseen);
  }
  CHECK(seen > 10000);
  CHECK(unseen > 100000);
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

TEST_CASE("a beam that touches an inner cube in one point sees it, one quantum beside it not") {
  struct Row {
    const char* name;
    Beam beam;
    bool sees;
  };
  const CubeLattice lattice{{100, 100, 100}, {25, 25, 25}};
  const Cube cube{{0, 0, 0}};  // its inner cube reaches from 25 to 75
  for (const Row& row : {Row{"along an edge", {{-50, 25, 75}, {200, 0, 0}}, true},
                         Row{"beside it in y", {{-50, 24, 75}, {200, 0, 0}}, false},
                         Row{"beside it in z", {{-50, 25, 76}, {200, 0, 0}}, false},
                         Row{"ends in a face", {{0, 50, 25}, {25, 0, 0}}, true},
                         Row{"ends before it", {{0, 50, 25}, {24, 0, 0}}, false},
                         Row{"touches an edge", {{0, 50, 50}, {50, -50, 0}}, true},
                         Row{"passes it", {{0, 49, 50}, {49, -49, 0}}, false},
                         Row{"inside", {{40, 40, 40}, {1, 0, 0}}, true},
                         Row{"in the outer part", {{10, 10, 10}, {5, 5, 5}}, false}}) {
    const RowName name(row.name);
    CHECK(sees(lattice, row.beam, cube) == row.sees);
  }
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
