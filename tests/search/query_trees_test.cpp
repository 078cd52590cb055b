#include "search/query_trees.hpp"

#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/scenes.hpp"

using namespace clearway;
using namespace clearway::test;

TEST_CASE("trees built with several threads are those of one") {
  Random random(7);
  Query query(random_points(random, {{0, 0, 0}, {4, 2, 1}}, 20'000), {}, {});
  double x = 0;
  for (int i = 0; i < 5'000; ++i) {
    x += i % 700 < 100 ? 0 : uniform(random, 0, 0.1);  // the path has stops
    query.poses.push_back(rotation({0, 0, 1}, 0.001 * i, {x, 0, 0}));
  }
  query.between_poses = GENERATE(false, true);
  const QueryTrees one(query, 1), many(query, 4);

  REQUIRE(one.of<Vec3>().size() == many.of<Vec3>().size());
  CHECK(one.of<Vec3>().spacing() == many.of<Vec3>().spacing());
  std::vector<Vec3> elements, others;
  for (std::uint32_t i = 0; i < one.of<Vec3>().size(); ++i) {
    elements.push_back(one.of<Vec3>().element(i));
    others.push_back(many.of<Vec3>().element(i));
  }
  CHECK(elements == others);

  const auto alike = [](const MotionNode& a, const MotionNode& b) {
    return a.first == b.first && a.count == b.count && a.mid == b.mid && a.later == b.later &&
           a.delta == b.delta;
  };
  CHECK(std::ranges::equal(one.motion.nodes(), many.motion.nodes(), alike));
  CHECK(one.motion.nodes().front().delta > 1);
}
