// Budgets of engines that work on pages, with memory on a device that is made up.
#include "search/page_run.hpp"

#include <catch2/catch.hpp>
#include <optional>

#include "clearway/error.hpp"
#include "search/sweep_run.hpp"
#include "support/result_fixture.hpp"
#include "support/store_fixture.hpp"

using namespace clearway;
using namespace clearway::test;
using namespace clearway;
using Catch::Contains;

namespace {

constexpr std::uint64_t kMiB = std::uint64_t{1} << 20;

/// A line of points, and a model of one point that goes along it.
class Line {
 public:
  Line() {
    std::vector<Quantum> points;
    for (std::int32_t i = 0; i < 2000; ++i) points.push_back({10 * i, 0, 0});
    write_las(folder_ / "line.las", points, {{0.001, 0.001, 0.001}, {0, 0, 0}});
    convert_quietly(conversion_of({folder_ / "line.las"}, folder_ / "line.h5"));
    store.emplace(folder_ / "line.h5");
    for (int i = 0; i < 100; ++i) {
      poses.push_back({{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0.1 * i, 0, 0}});
    }
    query.poses = poses;
    options.engine = "sweep";
    options.threads = 2;
    kind = cpu_sweep(*store, query, options);
  }

  /// Returns the number of hits.
  std::uint64_t run() {
    const auto open = [&]() -> SearchJournal& {
      ++journals_opened;
      const std::string name = "journal " + std::to_string(journals_opened);
      return journal_.emplace(folder_ / name, JournalIdentity{}, nullptr, *store, query, 1e9);
    };
    NoProgress progress;
    report = {};
    return run_page_engine(*store, query, options, kind, open, progress, report).hits.count();
  }

  std::string refusal() {
    try {
      run();
    } catch (const ResourceError& error) {
      return error.what();
    }
    return {};
  }

  /// What a run with so many threads and devices of one slot needs; it ends before it begins.
  std::uint64_t needed(int threads, std::uint32_t devices) {
    kind.most_slots = 1;
    kind.threads = threads;
    kind.devices = devices;
    kind.make = [](const SearchPlan&, const SlotLayout&) -> PageEngines {
      throw ResourceError("not made");
    };
    CHECK(refusal() == "not made");
    return report.needed_bytes;
  }

 private:
  ScratchFolder folder_;
  std::optional<SearchJournal> journal_;

 public:
  std::optional<StoreReader> store;
  std::vector<Vec3> model{{0, 0, 0}};
  std::vector<Pose> poses;
  Query query{model, {}, {.radius = 0.1, .first_pose = true}};
  EngineOptions options;
  PageEngineKind kind;
  EngineReport report;
  int journals_opened = 0;
};

/// Host and device want opposite layouts: 100 MiB a slot, and 100 MiB a slot less than four.
void set_at_odds(PageEngineKind& kind) {
  kind.most_slots = 4;
  kind.host_bytes = [](const SearchPlan&, const SlotLayout& layout) {
    return layout.slots * 100 * kMiB;
  };
  kind.device_bytes = [](const SearchPlan&, const SlotLayout& layout) {
    return (5 - layout.slots) * 100 * kMiB;
  };
}

}  // namespace

TEST_CASE("a run asks for its journal once, after its engine was made") {
  Line line;
  CHECK(line.run() > 0);
  CHECK(line.journals_opened == 1);
  line.needed(1, 1);
  CHECK(line.journals_opened == 1);
}

TEST_CASE("layouts that fit either memory but not both are refused with a budget that works") {
  Line line;
  const std::uint64_t hits = line.run();
  set_at_odds(line.kind);
  line.kind.most_device_bytes = 150 * kMiB;
  line.options.memory_bytes = 200 * kMiB;
  const std::string refusal = line.refusal();
  REQUIRE_THAT(refusal, Contains("--memory 200") && Contains("too little"));
  CHECK(line.journals_opened == 1);
  const std::string before = "(--memory ";
  line.options.memory_bytes = std::stoull(refusal.substr(refusal.find(before) + before.size()));
  CHECK(line.options.memory_bytes > 400 * kMiB);
  CHECK(line.run() == hits);
  --line.options.memory_bytes;
  CHECK_THAT(line.refusal(), Contains("too little"));
}

TEST_CASE("device memory that fits no layout is refused with the least, or with the GPU") {
  Line line;
  set_at_odds(line.kind);
  line.kind.most_device_bytes = 50 * kMiB;
  CHECK_THAT(line.refusal(), Contains("(--device-memory " + std::to_string(100 * kMiB) + ")"));
  line.kind.short_device = "GPU 1 (Some GPU, 53 MiB free)";
  CHECK_THAT(line.refusal(), Contains("GPU 1 (Some GPU, 53 MiB free)") && Contains("--gpus") &&
                                 !Contains("--device-memory"));
  line.kind.most_device_bytes = 100 * kMiB;
  CHECK(line.run() > 0);
}

TEST_CASE("records of the journal are counted for pages under way, stacks for every thread") {
  constexpr std::uint64_t kStack = std::uint64_t{256} << 10;
  Line line;
  const auto record = SearchJournal::most_bytes(*line.store, line.query, 2) -
                      SearchJournal::most_bytes(*line.store, line.query, 1);
  const std::uint64_t one = line.needed(1, 1);
  CHECK(line.needed(1, 4) == one);
  CHECK(line.needed(4, 1) == one + 3 * kStack);
  CHECK(line.needed(260, 4) == one + 259 * kStack + 3 * record);
}
