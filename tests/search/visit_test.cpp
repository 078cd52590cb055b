// Budgets of engines that work on pages, with memory on a device that is made up.
#include "search/visit.hpp"

#include <functional>
#include <optional>

#include "clearway/error.hpp"
#include "search/kinds/sweep_kind.hpp"
#include "search/line_of_points.hpp"
#include "stream/search_journal.hpp"
#include "stream/write_result.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

constexpr std::uint64_t kMebibyte = std::uint64_t{1} << 20;

/// The sweep on the CPU, with other needs and other memory where a test sets them.
class MadeUpKind final : public CpuSweepKindOf<Vec3> {
 public:
  using Base = CpuSweepKindOf<Vec3>;
  using Base::Base;

  std::uint64_t host_bytes(const SlotLayout& layout, std::uint64_t most_poses) const override {
    return on_host ? on_host(layout) : Base::host_bytes(layout, most_poses);
  }
  std::uint64_t device_bytes(const SlotLayout& layout) const override {
    return on_device ? on_device(layout) : 0;
  }
  PageEngines make(const SlotLayout& layout) override {
    if (is_never_made) throw ResourceError("not made");
    return Base::make(layout);
  }
  PageEngineNeeds& changed_needs() { return needs_; }

  std::function<std::uint64_t(const SlotLayout&)> on_host, on_device;
  bool is_never_made = false;
};

/// A search with a model of one point that goes along a line of points.
struct Line : LineOfPoints {
  Line() : LineOfPoints(2000, {{0, 0, 0}}, 100) {
    query.first_pose = true;
    options.threads = 2;
    kind.emplace(*store, query, options, EngineSettings{});
  }

  /// Runs the search and returns the number of hits.
  std::uint64_t run() {
    NoProgress progress;
    report = {};
    MessageLog log(options.message, report.warnings);
    ProfileSet no_profile;
    CollectPage keep;
    const auto open = [&] {
      ++journals_opened;
      const std::string name = "journal " + std::to_string(journals_opened);
      journal.emplace(folder / name, JournalIdentity{}, nullptr, *store, query, 1e9);
      keep = keep_answer(*store, journal->rows(), no_profile, &*journal);
    };
    run_visit(*store,
              {.query = query,
               .memory_bytes = options.memory_bytes,
               .kind = *kind,
               .collect = [&](std::span<const PlannedCell> cells,
                              const PageResult& page) { keep(cells, page); },
               .least_write_bytes = least_write_bytes(*store, query),
               .made = open},
              progress, report, log);
    return journal->rows().points(PointQuestion::kHits);
  }

  /// The error with which the search is refused; nullopt where it runs.
  std::optional<ResourceError> refusal() {
    try {
      run();
    } catch (const ResourceError& error) {
      return error;
    }
    return std::nullopt;
  }

  /// The host bytes that a run with these numbers of threads and devices, each with one slot,
  /// needs; it ends before it begins.
  std::uint64_t needed(int threads, std::uint32_t devices) {
    kind->changed_needs().most_slots = 1;
    kind->changed_needs().threads = threads;
    kind->changed_needs().devices = devices;
    kind->is_never_made = true;
    check_equal(std::string(refusal().value().what()), "not made");
    return report.needed_host_bytes;
  }

  /// Makes host and device want opposite layouts: 100 MiB a slot on the host, and on the device 100
  /// MiB for each slot fewer than five.
  void set_at_odds(std::uint64_t most_device_bytes) {
    kind->changed_needs().most_slots = 4;
    kind->changed_needs().on_gpu = true;
    kind->changed_needs().most_device_bytes = most_device_bytes;
    kind->on_host = [](const SlotLayout& layout) { return layout.slots * 100 * kMebibyte; };
    kind->on_device = [](const SlotLayout& layout) { return (5 - layout.slots) * 100 * kMebibyte; };
  }

  std::optional<SearchJournal> journal;
  SearchOptions options;
  std::optional<MadeUpKind> kind;
  SearchReport report;
  int journals_opened = 0;
};

}  // namespace

TEST_CASE("a run opens its journal once its engine was made, with no more slots than pages") {
  Line line;
  line.kind->changed_needs().most_slots = 64;
  CHECK(line.run() > 0);
  check_equal(line.journals_opened, 1);
  CHECK(line.report.pages < 64);
  CHECK(line.report.slots == line.report.pages);
  line.kind->changed_needs().most_slots = 4;
  CHECK(line.run() > 0);
  check_equal(line.report.slots, 4);
  line.needed(1, 1);
  check_equal(line.journals_opened, 2);
}

TEST_CASE("layouts that fit either memory but not both are refused with a budget that works") {
  Line line;
  const std::uint64_t hits = line.run();
  line.set_at_odds(150 * kMebibyte);
  line.options.memory_bytes = 200 * kMebibyte;
  const ResourceError refusal = line.refusal().value();
  REQUIRE_THAT(refusal.what(), Contains("200.0 MiB of memory is too little"));
  REQUIRE(refusal.remedy() == Remedy::kMoreMemory);
  check_equal(line.journals_opened, 1);
  line.options.memory_bytes = static_cast<std::uint64_t>(refusal.amount());
  CHECK(line.options.memory_bytes > 400 * kMebibyte);
  CHECK(line.run() == hits);
  --line.options.memory_bytes;
  check_says(line.refusal().value().what(), "too little");
}

TEST_CASE("device memory that fits no layout is refused with the least, or with the GPU") {
  Line line;
  line.set_at_odds(50 * kMebibyte);
  const ResourceError refusal = line.refusal().value();
  CHECK(refusal.remedy() == Remedy::kMoreDeviceMemory);
  CHECK(refusal.amount() == 100 * kMebibyte);
  line.kind->changed_needs().short_device = "GPU 1 (Some GPU, 53 MiB free)";
  const ResourceError short_of_room = line.refusal().value();
  check_says(short_of_room.what(), "GPU 1 (Some GPU, 53 MiB free)");
  CHECK(short_of_room.remedy() == Remedy::kOtherGpu);
  line.kind->changed_needs().most_device_bytes = 100 * kMebibyte;
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
