#pragma once

#include <atomic>
#include <functional>
#include <future>
#include <thread>

#include "cpu/sweep_engine.hpp"
#include "planned_scene.hpp"
#include "stream/run_pages.hpp"
#include "support/engines/answer_sets.hpp"

namespace clearway::test {

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

/// A cloud that calls a test's function before each read.
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

  std::uint64_t source_of(std::uint32_t cell, std::uint32_t index) const override {
    return cloud_.source_of(cell, index);
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

/// One run of the pipeline, with access to its parts.
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

inline void sleep_ms(int ms) { std::this_thread::sleep_for(std::chrono::milliseconds(ms)); }

}  // namespace clearway::test
