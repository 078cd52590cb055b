#include "search/choose_engine.hpp"

#include <catch2/catch.hpp>
#include <optional>

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
