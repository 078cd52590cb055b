// The bodies of the section's kernel against every pair of a point and a pose: on the host, and in
// the suite of the CUDA engines on a device.
#include <catch2/catch.hpp>

#include "support/engines/section_runs.hpp"
#include "support/section_scene.hpp"

using namespace clearway;

TEST_CASE("pages block in random scenes what every pair of a point and a pose blocks") {
  Random random(20261124);
  std::size_t blocked = 0, empty = 0, ignoring = 0;
  for (int i = 0; i < 400; ++i) {
    INFO("scene " << i);
    const SectionScene scene = random_section_scene(random);
    double along = 0;
    if (below(random, 3) == 0) along = section_motion(scene.load(), scene.asked).along;
    SectionOfScene search(scene, along);
    block_pages(search.cloud, IgnoredPoints(search.cloud, search.query), search.section);
    const Blocked expected = by_brute_force(scene, along);
    CHECK((search.blocked() == expected));
    blocked += expected.size();
    empty += expected.empty() ? 1 : 0;
    ignoring += scene.ignored.empty() ? 0 : 1;
  }
  CHECK(blocked > 50000);
  CHECK(empty > 5);
  CHECK(ignoring > 50);
}
