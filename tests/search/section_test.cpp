// The search of a section against every pair of a point and a pose, by the definitions of
// docs/design/section.md alone.
#include <cmath>

#include "search/block_cells.hpp"
#include "search/found_cells.hpp"
#include "support/compare.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

Blocked by_search(const SectionScene& scene, int threads, double along) {
  SectionOfScene search(scene, along);
  NoProgress progress;
  block_cells(search.cloud, IgnoredPoints(search.cloud, search.query), search.section, threads,
              progress);
  return found_cells(search.lattice, search.bins, search.maps);
}

}  // namespace

TEST_CASE("a section is that of every pair of a point and a pose") {
  Random random(20260724);
  std::size_t blocked = 0, empty = 0;
  for (int i = 0; i < 800; ++i) {
    const SectionScene scene = random_section_scene(random);
    double along = 0;
    if (below(random, 3) == 0) along = section_motion(scene.load(), scene.asked).along;
    const Blocked expected = by_brute_force(scene, along);
    INFO("scene " << i);
    CHECK((by_search(scene, 1, along) == expected));
    if (i % 8 == 0) CHECK((by_search(scene, 3, along) == expected));
    blocked += expected.size();
    empty += expected.empty() ? 1 : 0;
  }
  CHECK(blocked > 100000);
  CHECK(empty > 10);
}

TEST_CASE("points on the border of cells, range and window count as the definition says") {
  SectionScene scene;
  scene.quantisation = {{0.25, 0.25, 0.25}, {0, 0, 0}};
  scene.path = {translation({0, 0, 0})};
  scene.path_pose = {0};
  scene.asked = {
      .rear = -1, .front = 1, .window = SectionWindow{-1, 1, 0, 1}, .cell = 0.5, .bin = 5};
  scene.quanta = {{4, 0, 0}, {-4, -4, 1}, {5, 1, 1}, {0, 4, 0}, {0, -5, 0}, {0, 0, 4}, {0, 3, 3}};
  const Blocked expected{{{0, 0, 0}, 0}, {{0, 0, -2}, 0}, {{0, 1, 1}, 0}};
  CHECK(by_brute_force(scene, 0) == expected);
  CHECK(by_search(scene, 1, 0) == expected);
}

TEST_CASE("a bin is a stretch of the chainage, and only at poses some are left out") {
  SectionScene scene;
  scene.path = {translation({0, 0, 0}), translation({4, 0, 0}), translation({1000, 0, 0})};
  const std::vector<std::uint32_t> all{0, 1, 2};
  const auto bins_of = [&](double bin, bool between_poses) {
    return section_bins(chainage_of(scene.path), all, {.bin = bin, .between_poses = between_poses});
  };
  CHECK(bins_of(5, false) == std::vector<SectionBin>{{0, 0, 2}, {200, 2, 1}});
  check_refused([&] { return bins_of(1e-7, false); }, "too short");
  // Between poses, pose 1 stands for 2 m to 502 m, and pose 2 for the rest.
  std::vector<SectionBin> on_the_way{{0, 0, 2}};
  for (std::uint64_t bin = 1; bin < 100; ++bin) on_the_way.push_back({bin, 1, 1});
  on_the_way.push_back({100, 1, 2});
  for (std::uint64_t bin = 101; bin <= 200; ++bin) on_the_way.push_back({bin, 2, 1});
  CHECK(bins_of(5, true) == on_the_way);
  check_refused([&] { return bins_of(1e-6, true); }, "too short");
}

TEST_CASE("what has no section is refused") {
  const auto refused = [](double rear, double front, SectionWindow window, double cell,
                          const char* words) {
    check_refused(
        [&] {
          section_lattice({.rear = rear, .front = front, .window = window, .cell = cell, .bin = 5},
                          0);
        },
        words);
  };
  const SectionWindow window{-1, 1, 0, 1};
  refused(1.5, 1, window, 0.5, "its rear, and then its front");
  refused(-1, NAN, window, 0.5, "its rear, and then its front");
  refused(-1, 1, {1, 1, 0, 1}, 0.5, "is empty");
  refused(-1, 1, {-1, 1, 0, INFINITY}, 0.5, "is empty");
  refused(-1, 1, window, 1e-9, "too small for the window");
  refused(-1, 1, window, 0, "above 0");
}

TEST_CASE("the motion of a load is that of the corners of its range and window") {
  const SectionParameters asked{
      .rear = -10, .front = 10, .window = SectionWindow{-2, 2, 0, 4}, .cell = 0.5, .bin = 5};
  const std::vector<Pose> straight{translation({0, 0, 0}), translation({0.5, 0.1, 0})};
  const SectionMotion shifted = section_motion(straight, asked);
  CHECK(shifted.along == Approx(0.5).margin(1e-12));
  CHECK(shifted.across == Approx(0.1).margin(1e-12));
  const double turn = 0.01;
  const std::vector<Pose> turned{translation({7, 3, 1}), rotation({0, 0, 1}, turn, {7, 3, 1})};
  const SectionMotion motion = section_motion(turned, asked);
  CHECK(motion.along == Approx(2 * std::sin(turn) + 10 * (1 - std::cos(turn))).margin(1e-12));
  CHECK(motion.across == Approx(10 * std::sin(turn) + 2 * (1 - std::cos(turn))).margin(1e-12));
}
