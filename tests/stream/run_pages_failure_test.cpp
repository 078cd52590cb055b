// When a stage of the pipeline throws, the run ends with that exception, and nothing is left under
// way.
#include <catch2/catch.hpp>
#include <new>

#include "clearway/error.hpp"
#include "run_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// A function that throws at call `n`.
template <typename Exception>
Act throwing_at(std::uint32_t n, const std::string& what) {
  return [=](std::uint32_t call) {
    if (call == n) throw Exception(what);
  };
}

}  // namespace

TEST_CASE("what any stage throws ends the run with its message") {
  const PlannedScene scene;
  for (const std::uint32_t slots : {1U, 2U, 5U}) {
    for (const std::uint32_t at : {0U, 1U, 6U}) {
      for (const int stage : {0, 1, 2, 3, 4}) {
        CAPTURE(slots, at, stage);
        Run run(scene, slots, 1);
        run.engine.alike = (slots + at) % 2 == 0;
        REQUIRE(run.pages.size() > 10);
        if (stage == 0) run.cloud.before_read = throwing_at<InputError>(at, "read failed");
        if (stage == 1) run.engine.before_start = throwing_at<ResourceError>(at, "start failed");
        if (stage == 2) run.engine.in_search = throwing_at<ResourceError>(at, "search failed");
        if (stage == 3) run.engine.after_finish = throwing_at<ResourceError>(at, "finish failed");
        if (stage == 4) run.progress.before_advance = throwing_at<Error>(at, "collect failed");
        const char* messages[] = {"read failed", "start failed", "search failed", "finish failed",
                                  "collect failed"};
        CHECK_THROWS_WITH(run.run(), messages[stage]);
      }
    }
  }
  CHECK(TestEngine::violations == 0);  // the end of every search was awaited
}

TEST_CASE("pages under way are finished before an exception leaves, however slow") {
  const PlannedScene scene;
  Run run(scene, 6, 1);
  run.cloud.before_read = throwing_at<InputError>(9, "read failed");
  run.engine.in_search = [](std::uint32_t) { sleep_ms(20); };
  CHECK_THROWS_WITH(run.run(8), "read failed");
  CHECK(run.engine.finished == run.engine.started);
  CHECK(TestEngine::violations == 0);
}

TEST_CASE("several stages that fail at once end the run with one of their messages") {
  const PlannedScene scene;
  Run run(scene, 6, 1);
  run.cloud.before_read = [](std::uint32_t read) {
    if (read >= 4) throw InputError("one of them");
  };
  run.engine.in_search = [](std::uint32_t page) {
    if (page >= 1) throw InputError("one of them");
  };
  CHECK_THROWS_WITH(run.run(8), "one of them");
  CHECK(TestEngine::violations == 0);
}

TEST_CASE("an exception that is not ours passes too") {
  const PlannedScene scene;
  Run run(scene);
  run.engine.in_search = [](std::uint32_t page) {
    if (page == 2) throw std::bad_alloc();
  };
  CHECK_THROWS_AS(run.run(), std::bad_alloc);
}

TEST_CASE("a damaged cell in the middle ends the run and is named") {
  PlannedScene scene;
  const std::uint32_t damaged = scene.cells[scene.cells.size() / 2].cell;
  scene.cloud.damage(damaged);
  Run run(scene);
  CHECK_THROWS_WITH(run.run(), Catch::Contains("cell " + std::to_string(damaged)));
  CHECK(TestEngine::violations == 0);
}

TEST_CASE(
    "what one of two engines throws ends the run, and nothing is left in flight in the other") {
  const PlannedScene scene({64, 0}, 6000);
  for (const std::uint32_t at : {0U, 3U}) {
    Run run(scene, 3, 1);
    TestEngine another(scene, run.layout);
    run.engine.in_search = throwing_at<ResourceError>(at, "search failed");
    another.in_search = [](std::uint32_t) { sleep_ms(10); };
    CHECK_THROWS_WITH(run.run_with(another, 4), "search failed");
    CHECK(run.engine.finished == run.engine.started);
    CHECK(another.finished == another.started);
  }
  CHECK(TestEngine::violations == 0);
}
