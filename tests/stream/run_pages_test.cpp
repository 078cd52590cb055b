// The pipeline of pages: its answer against brute force, how its stages share the work, and how it
// ends when one of them throws.
#include "stream/run_pages.hpp"

#include <future>
#include <new>
#include <thread>

#include "clearway/error.hpp"
#include "cpu/sweep_engine.hpp"
#include "planned_scene.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

using Act = std::function<void(std::uint32_t)>;

/// An engine that searches in threads of its own, as a device does, and calls a test's function
/// before each step. It counts every use of a slot that its contract does not allow.
class TestEngine final : public PageEngine {
 public:
  TestEngine(const PlannedScene& scene, const SlotLayout& layout)
      : engine_(scene.cloud, scene.filter, layout), searches_(layout.slots) {}

  ~TestEngine() override {
    for (const auto& search : searches_) violations += search.valid();
  }

  std::uint32_t slots() const override { return engine_.slots(); }

  std::span<std::byte> page(std::uint32_t slot) override {
    violations += searches_[slot].valid();
    return engine_.page(slot);
  }

  void start(std::uint32_t slot, const PageShape& shape) override {
    const std::uint32_t page = started++;
    violations += searches_[slot].valid() || shape.bytes() > engine_.page(slot).size();
    if (before_start) before_start(page);
    searches_[slot] = std::async(std::launch::async, [this, slot, shape, page] {
      if (in_search) in_search(page);
      engine_.start(slot, shape);
      return engine_.finish(slot);
    });
  }

  void wait(std::uint32_t slot) override {
    if (searches_[slot].valid()) searches_[slot].wait();
  }

  PageResult finish(std::uint32_t slot) override {
    const std::uint32_t page = finished++;
    if (!searches_[slot].valid()) {
      ++violations;
      return {};
    }
    PageResult answer = searches_[slot].get();
    if (after_finish) after_finish(page);
    const auto now = Clock::now();
    answer.upload = {now - std::chrono::milliseconds(1), now};
    return answer;
  }

  bool pages_alike() const override { return alike; }

  bool alike = true;
  Act before_start, in_search, after_finish;
  std::atomic<std::uint32_t> started{0}, finished{0};
  static inline std::atomic<int> violations{0};

 private:
  SweepEngine engine_;
  std::vector<std::future<PageResult>> searches_;
};

class TestProgress final : public Progress {
 public:
  void begin(std::string_view, std::uint64_t points, std::string_view) override { total = points; }
  void advance(std::uint64_t points) override {
    const std::uint32_t call = calls++;
    if (before_advance) before_advance(call);
    done += points;
  }
  void end() override { ended = true; }

  Act before_advance;
  std::atomic<std::uint32_t> calls{0};
  std::atomic<std::uint64_t> total{0}, done{0};
  bool ended = false;
};

/// One run of the pipeline, with access to its parts. The scene's cloud calls what the last run
/// set.
struct Run {
  explicit Run(const PlannedScene& planned, std::uint32_t slots = 4, std::uint32_t page_cells = 3)
      : scene(planned),
        layout{slots, 2 * smallest_page_bytes(planned.cloud, planned.cells), page_cells},
        engine(planned, layout),
        pages(paginate(planned.cloud, planned.cells, layout.page_bytes, page_cells)) {
    scene.cloud.reads = 0;
    scene.cloud.before_read = {};
  }

  SearchResult run(int threads = 4, TestEngine* another = nullptr) {
    PageEngine* const engines[] = {&engine, another};
    return run_pages(scene.cloud, scene.cells, pages, {engines, another == nullptr ? 1U : 2U},
                     scene.query, threads, progress, times);
  }

  const PlannedScene& scene;
  SlotLayout layout;
  TestEngine engine;
  std::vector<PlannedPage> pages;
  TestProgress progress;
  StageTimes times;
};

void sleep_ms(int ms) { std::this_thread::sleep_for(std::chrono::milliseconds(ms)); }

/// A function that throws at call `n`.
template <typename Exception>
Act throwing_at(std::uint32_t n, const char* what) {
  return [=](std::uint32_t call) {
    if (call == n) throw Exception(what);
  };
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
          check_equal(scene->wrong(run.run(threads)), 0);
          CHECK(run.engine.finished == run.pages.size());
          CHECK(scene->cloud.reads == scene->cells.size());  // each planned cell once, no other
          CHECK(run.progress.done == run.progress.total);
          CHECK(run.progress.total > 0);
          CHECK(run.progress.ended);
        }
      }
    }
  }
  CHECK(TestEngine::violations == 0);
}

TEST_CASE("an empty cloud, and a plan of no cells, have an empty answer") {
  for (const std::size_t points : {0, 1000}) {
    const PlannedScene scene({256, 0}, points, 0);
    REQUIRE(scene.cells.empty());
    Run run(scene);
    check_equal(run.run().hits.count(), 0);
    CHECK(run.engine.started == 0);
    check_equal(run.times.compute, 0);
    CHECK(run.progress.ended);
  }
}

TEST_CASE("slow stages change nothing and are measured") {
  const PlannedScene scene({256, 0}, 4000);
  Run run(scene, 3, 2);
  scene.cloud.before_read = [](std::uint32_t read) { sleep_ms(read % 3 == 0 ? 4 : 1); };
  run.engine.before_start = [](std::uint32_t page) { sleep_ms(page % 2); };
  run.engine.in_search = [](std::uint32_t page) { sleep_ms(page % 4); };
  run.progress.before_advance = [](std::uint32_t call) { sleep_ms(call % 3); };
  check_equal(scene.wrong(run.run()), 0);
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
  check_equal(scene.wrong(run.run(8)), 0);
  CHECK(before_slow > run.pages.size() / 2);
}

TEST_CASE("of two engines the faster one gets more pages, and the answer is the same") {
  const PlannedScene scene({64, 0}, 6000);
  for (const int threads : {1, 2, 8}) {
    Run run(scene, 2, 1);
    TestEngine slow(scene, run.layout);
    REQUIRE(run.pages.size() > 40);
    slow.in_search = [](std::uint32_t) { sleep_ms(100); };
    check_equal(scene.wrong(run.run(threads, &slow)), 0);
    CHECK(run.engine.finished + slow.finished == run.pages.size());
    if (threads > 2) CHECK(4U * slow.finished < run.engine.finished);
  }
  CHECK(TestEngine::violations == 0);
}

TEST_CASE("what any stage throws ends the run with its message, and no search is left under way") {
  struct Stage {
    const char* message;
    void (*fail)(Run& run, std::uint32_t at, const char* message);
  };
  const Stage stages[] = {{"read failed",
                           [](Run& run, std::uint32_t at, const char* message) {
                             run.scene.cloud.before_read = throwing_at<InputError>(at, message);
                           }},
                          {"start failed",
                           [](Run& run, std::uint32_t at, const char* message) {
                             run.engine.before_start = throwing_at<ResourceError>(at, message);
                           }},
                          {"search failed",
                           [](Run& run, std::uint32_t at, const char* message) {
                             run.engine.in_search = throwing_at<std::runtime_error>(at, message);
                           }},
                          {"finish failed",
                           [](Run& run, std::uint32_t at, const char* message) {
                             run.engine.after_finish = throwing_at<ResourceError>(at, message);
                           }},
                          {"collect failed", [](Run& run, std::uint32_t at, const char* message) {
                             run.progress.before_advance = throwing_at<Error>(at, message);
                           }}};
  const PlannedScene scene;
  for (const std::uint32_t slots : {1U, 2U, 5U}) {
    for (const std::uint32_t at : {0U, 1U, 6U}) {
      for (const auto& [message, fail] : stages) {
        CAPTURE(slots, at);
        Run run(scene, slots, 1);
        run.engine.alike = (slots + at) % 2 == 0;
        REQUIRE(run.pages.size() > 10);
        fail(run, at, message);
        CHECK_THROWS_WITH(run.run(), message);
      }
    }
  }
  CHECK(TestEngine::violations == 0);
}

TEST_CASE(
    "several stages of two engines that fail at once end the run with one of their messages") {
  const PlannedScene scene({64, 0}, 6000);
  for (const std::uint32_t at : {0U, 3U, 9U}) {
    Run run(scene, 3, 1);
    TestEngine another(scene, run.layout);
    const auto fail = [at](std::uint32_t call) {
      if (call >= at) throw InputError("one of them");
    };
    scene.cloud.before_read = at == 9 ? Act(fail) : Act();
    run.engine.in_search = fail;
    another.in_search = [](std::uint32_t) { sleep_ms(20); };
    CHECK_THROWS_WITH(run.run(8, &another), "one of them");
    CHECK(run.engine.finished == run.engine.started);
    CHECK(another.finished == another.started);
  }
  CHECK(TestEngine::violations == 0);
}
