// The pipeline of pages: its answer against brute force, and how its stages share the work.
#include <new>

#include "clearway/error.hpp"
#include "run_fixture.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/engines/brute_force.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// The number of entries whose first pose or clearance is not that of brute force.
std::uint64_t wrong_slots(const PlannedScene& scene, const SearchResult& answer) {
  const auto points = positions_of(scene.cloud_points, kTenths);
  const auto first_poses = brute_force_first_poses(points, scene.query);
  const auto clearances = scene.query.clearance > 0 ? brute_force_clearances(points, scene.query)
                                                    : std::vector<Clearance>(points.size());
  const double limit = scene.query.clearance * scene.query.clearance;
  std::uint64_t wrong = 0;
  for (std::uint64_t slot = 0; slot < scene.cloud.entry_count(); ++slot) {
    const bool used = scene.cloud.is_used(slot);
    const std::uint32_t pose = used ? first_poses[scene.cloud.source(slot)] : kNoPose;
    wrong += answer.hits.contains(slot) != (pose != kNoPose);
    if (scene.query.first_pose) wrong += answer.hits.first_pose(slot) != pose;
    if (scene.query.clearance > 0) {
      Clearance expected;
      if (used && clearances[scene.cloud.source(slot)].squared < limit) {
        expected = clearances[scene.cloud.source(slot)];
      }
      wrong += answer.clearances.at(slot) != expected;
    }
  }
  return wrong;
}

}  // namespace

TEST_CASE("the answer does not depend on slots, cells a page or threads") {
  const PlannedScene with_poses;
  const PlannedScene set({128, 700}, 6000, 80, false);
  const PlannedScene with_clearances({256, 0}, 6000, 60, true, 0.3);
  for (const PlannedScene* scene : {&with_poses, &set, &with_clearances}) {
    for (const std::uint32_t slots : {1U, 2U, 7U, 64U}) {
      for (const std::uint32_t page_cells : {1U, 4U}) {
        for (const int threads : {0, 1, 2, 9}) {
          CAPTURE(slots, page_cells, threads);
          Run run(*scene, slots, page_cells);
          run.engine.alike = threads % 2 == 0;
          const SearchResult answer = run.run(threads);
          check_equal(wrong_slots(*scene, answer), 0);
          CHECK(run.engine.finished == run.pages.size());
          CHECK(run.progress.done == run.progress.total);
          CHECK(run.progress.total > 0);
          CHECK(run.progress.ended);
        }
      }
    }
  }
  CHECK(TestEngine::violations == 0);
}

TEST_CASE("every planned cell is read once and no other") {
  const PlannedScene scene;
  Run run(scene);
  run.run();
  CHECK(run.cloud.reads == scene.cells.size());
}

TEST_CASE("an empty cloud, and a plan of no cells, have an empty answer") {
  for (const std::size_t points : {0, 1000}) {
    const PlannedScene scene({256, 0}, points, 0);
    REQUIRE(scene.cells.empty());
    Run run(scene);
    const SearchResult answer = run.run();
    check_equal(answer.hits.count(), 0);
    CHECK(run.engine.started == 0);
    check_equal(run.times.compute, 0);
    CHECK(run.progress.ended);
  }
}

TEST_CASE("slow stages change nothing and are measured") {
  const PlannedScene scene({256, 0}, 4000);
  Run run(scene, 3, 2);
  run.cloud.before_read = [](std::uint32_t read) { sleep_ms(read % 3 == 0 ? 4 : 1); };
  run.engine.before_start = [](std::uint32_t page) { sleep_ms(page % 2); };
  run.engine.in_search = [](std::uint32_t page) { sleep_ms(page % 4); };
  run.progress.before_advance = [](std::uint32_t call) { sleep_ms(call % 3); };
  const SearchResult answer = run.run();
  check_equal(wrong_slots(scene, answer), 0);
  CHECK(run.times.read > 0.003);
  CHECK(run.times.read <= run.times.total);
  CHECK(run.times.upload > 0.0009);
  CHECK(run.times.compute > 0);
  CHECK(run.times.compute <= run.times.total);
  CHECK(TestEngine::violations == 0);
}

TEST_CASE("pages that are not alike do not wait behind a slow one") {
  const PlannedScene scene({64, 0}, 6000);
  Run run(scene, 4, 1);
  REQUIRE(run.pages.size() > 40);
  run.engine.alike = false;
  std::atomic<std::uint32_t> before_slow = 0;
  run.engine.in_search = [&](std::uint32_t page) {
    if (page != 1) return;
    // Ends when others have overtaken it, or after ten seconds in which they have not.
    for (int waited = 0; waited < 5000 && before_slow <= run.pages.size() / 2; ++waited) {
      sleep_ms(2);
      before_slow = run.progress.calls.load();
    }
  };
  check_equal(wrong_slots(scene, run.run(8)), 0);
  CHECK(before_slow > run.pages.size() / 2);
}

TEST_CASE("of two engines the faster one gets more pages, and the answer is the same") {
  const PlannedScene scene({64, 0}, 6000);
  for (const int threads : {1, 2, 8}) {
    Run run(scene, 2, 1);
    TestEngine slow(scene, run.layout);
    REQUIRE(run.pages.size() > 40);
    slow.in_search = [](std::uint32_t) { sleep_ms(100); };
    const SearchResult answer = run.run_with(slow, threads);
    check_equal(wrong_slots(scene, answer), 0);
    CHECK(run.engine.finished + slow.finished == run.pages.size());
    if (threads > 2) CHECK(4U * slow.finished < run.engine.finished);
  }
  CHECK(TestEngine::violations == 0);
}

// When a stage of the pipeline throws, the run ends with that exception, and nothing is left under
// way.
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
  check_refused([&] { return run.run(); }, "cell " + std::to_string(damaged));
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
