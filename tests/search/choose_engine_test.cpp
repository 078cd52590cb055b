#include "search/choose_engine.hpp"

#include <cmath>
#include <optional>
#include <random>

#include "search/query_trees.hpp"
#include "support/catch.hpp"
#include "support/store_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// A query of a model of two points that goes along a line of points.
class Asked {
 public:
  explicit Asked(int poses) {
    std::vector<Quantum> points;
    for (std::int32_t i = 0; i < 2000; ++i) points.push_back({10 * i, 0, 0});
    write_las(folder_ / "line.las", points, {{0.001, 0.001, 0.001}, {0, 0, 0}});
    convert_quietly(conversion_of({folder_ / "line.las"}, folder_ / "line.h5"));
    store.emplace(folder_ / "line.h5");
    for (int i = 0; i < poses; ++i) {
      query.poses.push_back({{1, 0, 0, 0, 1, 0, 0, 0, 1}, {20.0 * i / poses, 0, 0}});
    }
    options.threads = 2;
  }

  Engine chosen(Engine earlier = Engine::kAuto, bool on_gpu = false) {
    return choose_engine(*store, query, earlier, on_gpu, options);
  }

 private:
  ScratchFolder folder_;

 public:
  std::optional<StoreReader> store;
  Query query{{{0, 0, 0}, {0.1, 0.1, 0.1}}, {}, {.radius = 0.1}};
  SearchOptions options;
};

}  // namespace

TEST_CASE("auto takes kdtree for few poses and a small radius") {
  CHECK(Asked(200).chosen() == Engine::kKdtree);
  CHECK(Asked(201).chosen() == Engine::kSweep);
  Asked asked(3);
  asked.query.radius = 0.3;
  CHECK(asked.chosen() == Engine::kKdtree);
  asked.query.radius = 0.31;
  CHECK(asked.chosen() == Engine::kSweep);
}

TEST_CASE("auto leaves to the sweep what the k-d tree cannot do") {
  Asked asked(3);
  REQUIRE(asked.chosen() == Engine::kKdtree);
  SECTION("clearances") { asked.query.clearance = 0.2; }
  SECTION("a profile") { asked.query.profile = 1; }
  SECTION("motion between poses") { asked.query.between_poses = true; }
  SECTION("little memory") { asked.options.memory_bytes = 1 << 20; }
  CHECK(asked.chosen() == Engine::kSweep);
}

TEST_CASE("auto goes on with the engine of the run that is resumed") {
  Asked asked(3);
  CHECK(asked.chosen(Engine::kSweep) == Engine::kSweep);
  CHECK(asked.chosen(Engine::kKdtree) == Engine::kKdtree);
  asked.options.memory_bytes = 1 << 20;  // too little, which is reported without another engine
  CHECK(asked.chosen(Engine::kKdtree) == Engine::kKdtree);
  asked.options.engine = Engine::kGrid;
  CHECK(asked.chosen() == Engine::kGrid);
}

TEST_CASE("a GPU takes the sweep") {
  CHECK(Asked(3).chosen(Engine::kAuto, true) == Engine::kSweep);
}

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
