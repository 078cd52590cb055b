#include "stream/run_pages.hpp"

#include <atomic>
#include <catch2/catch.hpp>
#include <functional>
#include <future>
#include <thread>

#include "clearway/error.hpp"
#include "cpu/brute_force.hpp"
#include "cpu/sweep_engine.hpp"
#include "planned_scene.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

using Act = std::function<void(std::uint32_t)>;

/// An engine that searches in threads of its own, as a device does, with something to do before
/// each step. Notes every use of a slot that its contract does not allow.
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

/// A cloud with something to do before each read.
class TestCloud final : public PackedCloud {
 public:
  explicit TestCloud(const PackedCloud& cloud) : cloud_(cloud) {}

  std::uint64_t point_count() const override { return cloud_.point_count(); }
  std::uint32_t cell_points() const override { return cloud_.cell_points(); }
  const Quantisation& quantisation() const override { return cloud_.quantisation(); }
  std::span<const Cell> cells() const override { return cloud_.cells(); }
  std::span<const TreeNode> tree() const override { return cloud_.tree(); }
  std::span<const BlockBox> blocks() const override { return cloud_.blocks(); }
  std::array<PackedChunk<std::int32_t>, 3> coordinates(std::uint32_t cell) const override {
    return cloud_.coordinates(cell);
  }
  std::uint64_t packed_bytes(std::uint32_t cell) const override {
    return cloud_.packed_bytes(cell);
  }
  std::array<PackedChunk<std::int32_t>, 3> read_packed(std::uint32_t cell,
                                                       std::span<std::byte> to) const override {
    const std::uint32_t read = reads++;
    if (before_read) before_read(read);
    return cloud_.read_packed(cell, to);
  }

  Act before_read;
  mutable std::atomic<std::uint32_t> reads{0};

 private:
  const PackedCloud& cloud_;
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

/// One run of the pipeline with its parts at hand.
struct Run {
  explicit Run(const PlannedScene& planned, std::uint32_t slots = 4, std::uint32_t page_cells = 3)
      : scene(planned),
        cloud(planned.cloud),
        layout{slots, 2 * smallest_page_bytes(planned.cloud, planned.cells), page_cells},
        engine(planned, layout),
        pages(paginate(planned.cloud, planned.cells, layout.page_bytes, page_cells)) {}

  SearchResult run(int threads = 4) {
    PageEngine* const engines[] = {&engine};
    return run_pages(cloud, scene.cells, pages, engines, scene.query, threads, progress, times);
  }

  SearchResult run_with(TestEngine& another, int threads) {
    PageEngine* const engines[] = {&engine, &another};
    return run_pages(cloud, scene.cells, pages, engines, scene.query, threads, progress, times);
  }

  const PlannedScene& scene;
  TestCloud cloud;
  SlotLayout layout;
  TestEngine engine;
  std::vector<PlannedPage> pages;
  TestProgress progress;
  StageTimes times;
};

/// Slots whose first pose or clearance is not that of brute force.
std::uint64_t wrong_slots(const PlannedScene& scene, const SearchResult& answer) {
  const auto points = positions_of(scene.cloud_points, kTenths);
  const auto first_poses = brute_force_first_poses(points, scene.query);
  const auto clearances = scene.query.clearance > 0 ? brute_force_clearances(points, scene.query)
                                                    : std::vector<Clearance>(points.size());
  const double limit = scene.query.clearance * scene.query.clearance;
  std::uint64_t wrong = 0;
  for (std::uint64_t slot = 0; slot < scene.cloud.entry_count(); ++slot) {
    const bool used = scene.cloud.is_used(slot);
    const std::uint32_t pose = used ? first_poses[scene.cloud.source(slot)] : HitSet::kNever;
    wrong += answer.hits.contains(slot) != (pose != HitSet::kNever);
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

void sleep_ms(int ms) { std::this_thread::sleep_for(std::chrono::milliseconds(ms)); }

/// Throws at call `n`.
template <typename Exception>
Act throwing_at(std::uint32_t n, const std::string& what) {
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
          const SearchResult answer = run.run(threads);
          CHECK(wrong_slots(*scene, answer) == 0);
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
    CHECK(answer.hits.count() == 0);
    CHECK(run.engine.started == 0);
    CHECK(run.times.compute == 0);
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
  CHECK(wrong_slots(scene, answer) == 0);
  CHECK(run.times.read > 0.003);
  CHECK(run.times.read <= run.times.total);
  CHECK(run.times.upload > 0.0009);
  CHECK(run.times.compute > 0);
  CHECK(run.times.compute <= run.times.total);
  CHECK(TestEngine::violations == 0);
}

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
  CHECK(TestEngine::violations == 0);  // no search was left alone
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

TEST_CASE("pages that are not alike do not wait behind a slow one") {
  const PlannedScene scene({64, 0}, 6000);
  Run run(scene, 4, 1);
  REQUIRE(run.pages.size() > 40);
  run.engine.alike = false;
  std::atomic<std::uint32_t> before_slow = 0;
  run.engine.in_search = [&](std::uint32_t page) {
    if (page != 1) return;
    sleep_ms(400);
    before_slow = run.progress.calls.load();
  };
  CHECK(wrong_slots(scene, run.run(8)) == 0);
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
    CHECK(wrong_slots(scene, answer) == 0);
    CHECK(run.engine.finished + slow.finished == run.pages.size());
    if (threads > 2) CHECK(4U * slow.finished < run.engine.finished);
  }
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
