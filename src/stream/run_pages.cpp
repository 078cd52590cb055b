#include "stream/run_pages.hpp"

#include <tbb/global_control.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include <deque>
#include <mutex>
#include <vector>

#include "core/hand_over.hpp"
#include "stream/collect_page.hpp"
#include "stream/stage_page.hpp"

namespace clearway {
namespace {

std::uint64_t points_of(const PackedCloud& cloud, std::span<const PlannedCell> cells) {
  std::uint64_t points = 0;
  for (const PlannedCell& cell : cells) points += cloud.cells()[cell.cell].count;
  return points;
}

/// The slots that hold no page. The one that is free longest goes first, so that a device gets the
/// next page as soon as it has room for one.
class FreeSlots {
 public:
  explicit FreeSlots(std::uint32_t slots) {
    for (std::uint32_t slot = 0; slot < slots; ++slot) free_.push_back(slot);
  }
  /// There is one: no more pages are under way than there are slots.
  std::uint32_t take() {
    const std::lock_guard lock(mutex_);
    const std::uint32_t slot = free_.front();
    free_.pop_front();
    return slot;
  }
  void give_back(std::uint32_t slot) {
    const std::lock_guard lock(mutex_);
    free_.push_back(slot);
  }

 private:
  std::mutex mutex_;
  std::deque<std::uint32_t> free_;
};

/// A page on its way through the pipeline.
struct PageInFlight {
  std::size_t page;
  std::uint32_t slot;
};

class Pipeline {
 public:
  Pipeline(const PackedCloud& cloud, std::span<const PlannedCell> cells,
           std::span<const PlannedPage> pages, PageEngine& engine, Progress& progress,
           Answer& answer, AnswerJournal* journal)
      : cloud_(cloud),
        cells_(cells),
        pages_(pages),
        engine_(engine),
        progress_(progress),
        answer_(answer),
        journal_(journal),
        free_slots_(engine.slots()),
        times_(pages.size()) {}

  void run() {
    run_stages();
    if (next_ < pages_.size()) throw Interrupted("interrupted");
  }

  StageTimes times() const { return stage_times(times_); }

 private:
  void run_stages() {
    const ParallelScope scope;
    const SerialStage input;
    const auto next =
        piece_of(scope, input, [&](tbb::flow_control& flow) { return next_page(flow); });
    const auto staged = piece_of(scope, [&](PageInFlight page) {
      stage(page);
      return page;
    });
    const auto searched = piece_of(scope, [&](PageInFlight page) { search(page); });
    using Page = Handed<PageInFlight>;
    constexpr auto parallel = tbb::filter_mode::parallel;
    scope.begin();
    tbb::parallel_pipeline(engine_.slots(),
                           tbb::make_filter<void, Page>(tbb::filter_mode::serial_in_order, next) &
                               tbb::make_filter<Page, Page>(parallel, staged) &
                               tbb::make_filter<Page, void>(parallel, searched));
  }

  PageInFlight next_page(tbb::flow_control& flow) {
    if (next_ == pages_.size() || progress_.stop_requested()) {
      flow.stop();
      return {};
    }
    return {next_++, free_slots_.take()};
  }

  std::span<const PlannedCell> cells_of(PageInFlight page) const {
    return pages_[page.page].of(cells_);
  }

  void stage(PageInFlight page) {
    Interval& time = times_[page.page].read;
    time.begin = Clock::now();
    stage_page(cloud_, cells_of(page), engine_.page(page.slot));
    time.end = Clock::now();
  }

  void search(PageInFlight page) {
    PageTimes& times = times_[page.page];
    engine_.start(page.slot, pages_[page.page].shape);
    const PageAnswer found = engine_.finish(page.slot);
    times.upload = found.upload;
    times.compute = found.compute;
    times.collect.begin = Clock::now();
    collect_page(cloud_, cells_of(page), found, answer_);
    if (journal_ != nullptr) journal_->append_page(cells_of(page), found);
    times.collect.end = Clock::now();
    free_slots_.give_back(page.slot);
    progress_.advance(points_of(cloud_, cells_of(page)));
  }

  const PackedCloud& cloud_;
  const std::span<const PlannedCell> cells_;
  const std::span<const PlannedPage> pages_;
  PageEngine& engine_;
  Progress& progress_;
  Answer& answer_;
  AnswerJournal* const journal_;
  FreeSlots free_slots_;
  std::vector<PageTimes> times_;  ///< by page
  std::size_t next_ = 0;
};

}  // namespace

Answer run_pages(const PackedCloud& cloud, std::span<const PlannedCell> cells,
                 std::span<const PlannedPage> pages, PageEngine& engine, const Question& question,
                 int threads, Progress& progress, StageTimes& times, AnswerJournal* journal) {
  Answer answer{HitSet(cloud.slot_count(), question.first_pose),
                ClearanceSet(question.clearance > 0 ? cloud.slot_count() : 0)};
  if (journal != nullptr) journal->restore(answer);
  if (threads == 0) threads = tbb::this_task_arena::max_concurrency();
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(threads));
  progress.begin("search", points_of(cloud, cells), "points");
  const Clock::time_point begin = Clock::now();
  Pipeline pipeline(cloud, cells, pages, engine, progress, answer, journal);
  tbb::task_arena(threads).execute([&] { pipeline.run(); });
  times = pipeline.times();
  times.total = std::chrono::duration<double>(Clock::now() - begin).count();
  progress.end();
  return answer;
}

std::uint64_t run_pages_bytes(std::size_t pages) {
  return pages * (sizeof(PlannedPage) + sizeof(PageTimes) + sizeof(Interval));
}

}  // namespace clearway
