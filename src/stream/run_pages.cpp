#include "stream/run_pages.hpp"

#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <cassert>
#include <cstring>
#include <deque>
#include <mutex>
#include <vector>

#include "core/util/tsan_annotations.hpp"
#include "io/files/parallel_loop.hpp"
#include "io/files/thread_limit.hpp"
#include "stream/plan.hpp"

namespace clearway {

std::uint64_t entry_of(const PackedCloud& cloud, std::span<const PlannedCell> cells,
                       std::uint32_t point) {
  return std::uint64_t{cells[point / cloud.cell_entries()].cell} * cloud.cell_entries() +
         point % cloud.cell_entries();
}

void offer_profile(const PackedCloud& cloud, std::span<const PlannedCell> cells,
                   std::span<const ProfileFact> facts, ProfileSet& profile) {
  for (const ProfileFact& fact : facts) {
    profile.offer(fact.pose, fact.squared, entry_of(cloud, cells, fact.point));
  }
}

namespace {

/// Appends to a section of a page; the destructor fills what is left of the section with zeros.
class Section {
 public:
  Section(std::span<std::byte> page, std::uint64_t begin, std::uint64_t end)
      : left_(page.subspan(begin, end - begin)) {}
  ~Section() { std::fill(left_.begin(), left_.end(), std::byte{0}); }
  Section(const Section&) = delete;
  Section& operator=(const Section&) = delete;

  std::span<std::byte> take(std::uint64_t bytes) {
    const auto taken = left_.first(bytes);
    left_ = left_.subspan(bytes);
    return taken;
  }

  template <typename Value>
  void append(std::span<const Value> values) {
    if (!values.empty()) {
      std::memcpy(take(values.size_bytes()).data(), values.data(), values.size_bytes());
    }
  }

 private:
  std::span<std::byte> left_;
};

}  // namespace

PageShape stage_page(const PackedCloud& cloud, std::span<const PlannedCell> cells,
                     std::span<std::byte> page, const IgnoredPoints* masks_of,
                     const KeptPayload& kept) {
  PageShape shape = page_shape(cloud, cells, masks_of != nullptr);
  std::vector<std::optional<CellPayload>> elsewhere;
  for (const PlannedCell& planned : cells) {
    elsewhere.push_back(kept ? kept(planned.cell) : std::nullopt);
    if (elsewhere.back()) shape.payload_bytes -= cloud.packed_bytes(planned.cell);
  }
  assert(shape.bytes() <= page.size());
  Section headers(page, 0, shape.nodes_at());
  Section nodes(page, shape.nodes_at(), shape.blocks_at());
  Section blocks(page, shape.blocks_at(), shape.masks_at());
  Section masks(page, shape.masks_at(), shape.payload_at());
  Section payload(page, shape.payload_at(), shape.bytes());
  std::uint32_t first_node = 0;
  std::vector<std::uint64_t> searched(shape.masked ? shape.blocks_per_cell : 0);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const PlannedCell& planned = cells[i];
    const Cell& cell = cloud.cells()[planned.cell];
    PageCell header{.cell = planned.cell,
                    .count = cell.count,
                    .first_node = first_node,
                    .node_count = static_cast<std::uint32_t>(planned.nodes.size()),
                    .box = cell.box,
                    .chunks = {}};
    first_node += header.node_count;
    std::optional<std::array<PackedChunk<std::int32_t>, 3>> packed;
    if (elsewhere[i]) {
      std::ranges::copy(*elsewhere[i], header.chunks);
    } else {
      packed = cloud.read_packed(planned.cell, payload.take(cloud.packed_bytes(planned.cell)));
      std::ranges::copy(payload_at(*packed, page.data()), header.chunks);
    }
    headers.append(std::span<const PageCell>(&header, 1));
    nodes.append(std::span(planned.nodes));
    blocks.append(cloud.blocks(planned.cell).bytes());
    if (!shape.masked) continue;
    masks_of->mask(planned.cell, searched,
                   [&] { return packed ? *packed : cloud.coordinates(planned.cell); });
    masks.append(std::span<const std::uint64_t>(searched));
  }
  return shape;
}

namespace {

double seconds(Clock::duration duration) { return std::chrono::duration<double>(duration).count(); }

double busy_seconds(const std::vector<PageTimes>& pages, Interval PageTimes::*stage) {
  std::vector<Interval> intervals;
  intervals.reserve(pages.size());
  for (const PageTimes& page : pages) intervals.push_back(page.*stage);
  return busy_seconds(std::move(intervals));
}

}  // namespace

double busy_seconds(std::vector<Interval> intervals) {
  std::sort(intervals.begin(), intervals.end(),
            [](const Interval& a, const Interval& b) { return a.begin < b.begin; });
  Clock::duration busy{};
  Clock::time_point until = Clock::time_point::min();
  for (const Interval& interval : intervals) {
    if (interval.end <= until) continue;
    busy += std::max(interval.end - std::max(interval.begin, until), Clock::duration{});
    until = std::max(until, interval.end);
  }
  return seconds(busy);
}

StageTimes stage_times(const std::vector<PageTimes>& pages) {
  return {.read = busy_seconds(pages, &PageTimes::read),
          .upload = busy_seconds(pages, &PageTimes::upload),
          .compute = busy_seconds(pages, &PageTimes::compute),
          .collect = busy_seconds(pages, &PageTimes::collect)};
}

namespace {

std::uint64_t points_of(const PackedCloud& cloud, std::span<const PlannedCell> cells) {
  std::uint64_t points = 0;
  for (const PlannedCell& cell : cells) points += cloud.cells()[cell.cell].count;
  return points;
}

/// The slots of an engine that hold no page.
class FreeSlots {
 public:
  explicit FreeSlots(std::uint32_t slots) {
    for (std::uint32_t slot = 0; slot < slots; ++slot) free_.push_back(slot);
  }
  /// Takes a slot. There always is one, because no more pages are under way than there are slots.
  std::uint32_t take() {
    const std::lock_guard lock(mutex_);
    const std::uint32_t slot = free_.back();
    free_.pop_back();
    return slot;
  }
  void give_back(std::uint32_t slot) {
    const std::lock_guard lock(mutex_);
    free_.push_back(slot);
  }

 private:
  std::mutex mutex_;
  std::vector<std::uint32_t> free_;
};

/// The state that all lanes share. Pages are taken in their order, each by whichever lane has a
/// slot for it.
struct Pages {
  const PackedCloud& cloud;
  const IgnoredPoints* masks;
  const std::span<const PlannedCell> cells;
  const std::span<const PlannedPage> pages;
  Progress& progress;
  const CollectPage& keep;
  std::vector<PageTimes> times = std::vector<PageTimes>(pages.size());
  std::atomic<std::size_t> next = 0;

  std::span<const PlannedCell> cells_of(std::size_t page) const { return pages[page].of(cells); }
};

struct PageInFlight {
  std::size_t page;
  std::uint32_t slot;
};

/// Takes pages through one engine.
class Lane {
 public:
  Lane(Pages& pages, PageEngine& engine)
      : pages_(pages),
        engine_(engine),
        free_slots_(engine.slots()),
        started_(engine.slots(), false) {}

  /// Waits for what a failed run has left in flight.
  ~Lane() {
    for (std::uint32_t slot = 0; slot < started_.size(); ++slot) {
      if (!started_[slot]) continue;
      try {
        engine_.finish(slot);
      } catch (...) {  // Another exception is ending the run already.
      }
    }
  }
  Lane(const Lane&) = delete;
  Lane& operator=(const Lane&) = delete;

  void run() {
    const ParallelScope scope;
    const SerialStage taking, waiting;
    const auto taken =
        piece_of(scope, taking, [this](tbb::flow_control& flow) { return next_page(flow); });
    const auto started = piece_of(scope, [this](PageInFlight page) {
      start(page);
      return page;
    });
    const auto waited = piece_of(scope, waiting, [this](PageInFlight page) {
      engine_.wait(page.slot);
      return page;
    });
    const auto collected = piece_of(scope, [this](PageInFlight page) { collect(page); });
    using Page = Handed<PageInFlight>;
    using Mode = tbb::filter_mode;
    const Mode by_turns = engine_.pages_alike() ? Mode::serial_out_of_order : Mode::parallel;
    scope.begin();
    tbb::parallel_pipeline(engine_.slots(),
                           tbb::make_filter<void, Page>(Mode::serial_in_order, taken) &
                               tbb::make_filter<Page, Page>(Mode::parallel, started) &
                               tbb::make_filter<Page, Page>(by_turns, waited) &
                               tbb::make_filter<Page, void>(Mode::parallel, collected));
  }

 private:
  PageInFlight next_page(tbb::flow_control& flow) {
    if (!pages_.progress.stop_requested()) {
      const std::size_t page = pages_.next++;
      if (page < pages_.pages.size()) return {page, free_slots_.take()};
    }
    flow.stop();
    return {};
  }

  void start(PageInFlight page) {
    Interval& time = pages_.times[page.page].read;
    time.begin = Clock::now();
    const PageShape shape =
        stage_page(pages_.cloud, pages_.cells_of(page.page), engine_.page(page.slot), pages_.masks,
                   [&](std::uint32_t cell) { return engine_.kept(page.slot, cell); });
    time.end = Clock::now();
    engine_.start(page.slot, shape);
    started_[page.slot] = true;
  }

  void collect(PageInFlight in_flight) {
    const auto [page, slot] = in_flight;
    started_[slot] = false;
    const PageResult found = engine_.finish(slot);
    const auto cells = pages_.cells_of(page);
    PageTimes& times = pages_.times[page];
    times.upload = found.upload;
    times.compute = found.compute;
    times.collect.begin = Clock::now();
    pages_.keep(cells, found);
    times.collect.end = Clock::now();
    engine_.release(slot);
    free_slots_.give_back(slot);
    pages_.progress.advance(points_of(pages_.cloud, cells));
  }

  Pages& pages_;
  PageEngine& engine_;
  FreeSlots free_slots_;
  std::vector<char> started_;  ///< for each slot, whether the engine has a page to finish
};

void run_lanes(Pages& pages, std::span<PageEngine* const> engines) {
  std::deque<Lane> lanes;
  for (PageEngine* engine : engines) lanes.emplace_back(pages, *engine);
  for_each_parallel(lanes.size(), [&](std::size_t lane) { lanes[lane].run(); });
  if (pages.next < pages.pages.size()) throw Interrupted("interrupted");
}

}  // namespace

void run_pages(const PackedCloud& cloud, std::span<const PlannedCell> cells,
               std::span<const PlannedPage> pages, std::span<PageEngine* const> engines,
               const PageRun& run, const CollectPage& collect, Progress& progress,
               StageTimes& times) {
  const ThreadLimit limit(run.threads == 0 ? tbb::this_task_arena::max_concurrency() : run.threads);
  progress.begin(run.stage, points_of(cloud, cells), "points");
  const Clock::time_point begin = Clock::now();
  Pages shared{cloud, run.masks, cells, pages, progress, collect};
  limit.run([&] { run_lanes(shared, engines); });
  times = stage_times(shared.times);
  times.total = std::chrono::duration<double>(Clock::now() - begin).count();
  progress.end();
}

std::uint64_t run_pages_bytes(std::size_t pages) {
  return pages * (sizeof(PlannedPage) + sizeof(PageTimes) + sizeof(Interval));
}

}  // namespace clearway
