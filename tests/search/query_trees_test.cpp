#include "search/query_trees.hpp"

#include <cmath>
#include <random>

#include "support/catch.hpp"

using namespace clearway;
using namespace clearway::test;

TEST_CASE("trees built with several threads are those of one") {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> unit(0, 1);
  Query query;
  for (int i = 0; i < 20'000; ++i) {
    query.model.vertices.push_back({4 * unit(random), 2 * unit(random), unit(random)});
  }
  double x = 0;
  for (int i = 0; i < 5'000; ++i) {
    const double angle = 0.001 * i;
    x += i % 700 < 100 ? 0 : 0.1 * unit(random);  // the path has stops
    query.poses.push_back(
        {{std::cos(angle), -std::sin(angle), 0, std::sin(angle), std::cos(angle), 0, 0, 0, 1},
         {x, 0, 0}});
  }
  query.between_poses = GENERATE(false, true);
  const QueryTrees one(query, 1), many(query, 4);

  REQUIRE(one.of<Vec3>().size() == many.of<Vec3>().size());
  bool same = one.of<Vec3>().spacing() == many.of<Vec3>().spacing();
  for (std::uint32_t i = 0; i < one.of<Vec3>().size(); ++i) {
    const Vec3 &a = one.of<Vec3>().element(i), &b = many.of<Vec3>().element(i);
    same &= a.x == b.x && a.y == b.y && a.z == b.z;
  }
  CHECK(same);

  const auto nodes = one.motion.nodes(), others = many.motion.nodes();
  REQUIRE(nodes.size() == others.size());
  bool alike = true;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const MotionNode &a = nodes[i], &b = others[i];
    alike &= a.first == b.first && a.count == b.count && a.mid == b.mid && a.later == b.later &&
             a.delta == b.delta;
  }
  CHECK(alike);
  CHECK(nodes.front().delta > 1);
}
