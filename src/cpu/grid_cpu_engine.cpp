#include "cpu/grid_cpu_engine.hpp"

#include <algorithm>
#include <cassert>

#include "core/grid/grid_search.hpp"
#include "core/query/hit_set.hpp"

namespace clearway {

struct GridCpuEngine::Slot {
  Slot(const GridScene& scene, const SlotLayout& layout, std::uint32_t work_list)
      : page((layout.page_bytes + sizeof(Line) - 1) / sizeof(Line)),
        entry_runs(layout.page_bytes / sizeof(std::uint32_t)),
        cells(layout.cells),
        cell_runs(layout.cells + 1) {
    const GridSceneView& all = scene.view();
    const std::size_t n = layout.cells;
    sorted.resize(n * all.slots);
    keys.resize(n * all.slots);
    order.resize(n * all.slots);
    points.resize(n * all.slots);
    buckets.resize(n * all.bucket_count);
    occupancy.resize(n * all.word_count);
    group_occupancy.resize(n * all.word_count);
    hits.resize(n * all.slots / kBlockPoints);
    if (scene.first_pose()) {
      first_poses.resize(n * all.slots);
      latest.resize(n * all.bucket_count);
    } else {
      done.resize(n * all.slots / 64);
    }
    open.reserve(work_list);
  }

  void build(const GridScene& scene);
  void search(const GridScene& scene, std::uint64_t task, std::uint32_t work_list);

  struct alignas(kPageAlignment) Line {
    std::byte bytes[kPageAlignment];
  };

  std::vector<Line> page;
  std::vector<std::uint32_t> entry_runs;
  std::vector<GridCell> cells;
  std::vector<std::uint64_t> cell_runs;
  std::vector<std::uint64_t> sorted;  ///< key and slot in one word
  std::vector<std::uint32_t> keys, order;
  std::vector<GridPoint> points;
  std::vector<BucketRange> buckets;
  std::vector<std::uint64_t> occupancy, group_occupancy;
  std::vector<std::uint64_t> hits;
  std::vector<std::uint64_t> done;
  std::vector<std::uint32_t> first_poses, latest;
  std::vector<std::uint32_t> open;  ///< pairs
  PageShape shape;
  GridPageView view{};
  PageResult answer;
  GridStatistics statistics;
};

/// Sorts the page's points into their grids.
void GridCpuEngine::Slot::build(const GridScene& scene) {
  const GridSceneView& all = scene.view();
  std::fill(buckets.begin(), buckets.end(), BucketRange{0, 0});
  std::fill(occupancy.begin(), occupancy.end(), 0);
  std::fill(group_occupancy.begin(), group_occupancy.end(), 0);
  std::fill(hits.begin(), hits.end(), 0);
  std::fill(done.begin(), done.end(), 0);
  std::fill(first_poses.begin(), first_poses.end(), HitSet::kNever);
  std::fill(latest.begin(), latest.end(), HitSet::kNever);
  const std::uint32_t count = shape.cells * all.slots;
  for (std::uint32_t slot = 0; slot < count; ++slot) {
    sorted[slot] = std::uint64_t{sort_key(all, view, slot)} << 32 | slot;
  }
  std::sort(sorted.begin(), sorted.begin() + count);
  for (std::uint32_t i = 0; i < count; ++i) {
    keys[i] = static_cast<std::uint32_t>(sorted[i] >> 32);
    order[i] = static_cast<std::uint32_t>(sorted[i]);
  }
  for (std::uint32_t i = 0; i < count; ++i) {
    place_point(all, view, keys.data(), order.data(), i, count);
  }
}

/// Tests as many pairs as the work list holds, then searches the open ones, and so on.
void GridCpuEngine::Slot::search(const GridScene& scene, std::uint64_t index,
                                 std::uint32_t work_list) {
  const GridSceneView& all = scene.view();
  const GridTask task = task_of(all, view, index);
  const std::uint32_t pairs = kPartGroups * all.nodes[task.node].count;
  const auto search_open = [&] {
    for (const std::uint32_t pair : open) {
      for (std::uint32_t lane = 0; lane < kGroupPoints; ++lane) {
        search_lane(all, view, task, pair, lane, statistics);
      }
    }
    open.clear();
  };
  const std::uint32_t end = std::min(task.first_part + kTaskParts, all.part_count);
  for (std::uint32_t part = task.first_part; part < end; ++part) {
    ++statistics.sphere_tests;
    if (!part_is_open(all, view, task, part)) continue;
    for (std::uint32_t i = 0; i < pairs; ++i) {
      std::uint32_t pair = 0;
      if (open_pair(all, view, task, part, i, pair, statistics)) open.push_back(pair);
      if (open.size() == work_list) search_open();
    }
  }
  search_open();
}

GridCpuEngine::GridCpuEngine(const GridScene& scene, const SlotLayout& layout,
                             std::uint32_t work_list)
    : scene_(scene), layout_(layout), work_list_(std::max(1U, work_list)) {
  for (std::uint32_t i = 0; i < layout.slots; ++i) {
    slots_.push_back(std::make_unique<Slot>(scene, layout, work_list_));
  }
}

GridCpuEngine::~GridCpuEngine() = default;

std::uint32_t GridCpuEngine::slots() const { return static_cast<std::uint32_t>(slots_.size()); }

std::span<std::byte> GridCpuEngine::page(std::uint32_t slot) {
  return {reinterpret_cast<std::byte*>(slots_[slot]->page.data()), layout_.page_bytes};
}

void GridCpuEngine::start(std::uint32_t index, const PageShape& shape) {
  assert(shape.bytes() <= layout_.page_bytes && shape.cells <= layout_.cells);
  Slot& slot = *slots_[index];
  slot.shape = shape;
  PageResult& answer = slot.answer;
  answer = {};
  answer.compute.begin = Clock::now();
  slot.statistics = {};
  slot.view = {.page = {page(index).data(), slot.shape},
               .cells = slot.cells.data(),
               .cell_runs = slot.cell_runs.data(),
               .entry_runs = slot.entry_runs.data(),
               .points = slot.points.data(),
               .buckets = slot.buckets.data(),
               .occupancy = slot.occupancy.data(),
               .group_occupancy = slot.group_occupancy.data(),
               .done = scene_.first_pose() ? nullptr : slot.done.data(),
               .latest = scene_.first_pose() ? slot.latest.data() : nullptr,
               .hits = slot.hits.data(),
               .first_poses = scene_.first_pose() ? slot.first_poses.data() : nullptr};
  const std::uint64_t tasks =
      plan_page(scene_, slot.view.page, slot.cells, slot.cell_runs, slot.entry_runs);
  slot.build(scene_);
  for (std::uint64_t task = 0; task < tasks; ++task) {
    slot.search(scene_, task, work_list_);
  }
  const std::size_t slots = std::size_t{slot.shape.cells} * scene_.view().slots;
  answer.hits = std::span(slot.hits).first(slots / kBlockPoints);
  if (scene_.first_pose()) answer.first_poses = std::span(slot.first_poses).first(slots);
  answer.compute.end = Clock::now();
  const std::lock_guard lock(mutex_);
  statistics_.add(slot.statistics);
}

PageResult GridCpuEngine::finish(std::uint32_t slot) { return slots_[slot]->answer; }

GridStatistics GridCpuEngine::statistics() const {
  const std::lock_guard lock(mutex_);
  return statistics_;
}

std::uint64_t GridCpuEngine::slot_bytes(const GridScene& scene, const SlotLayout& layout) {
  const GridSceneView& all = scene.view();
  const std::uint64_t of_point = 2 * sizeof(std::uint64_t) + sizeof(GridPoint);
  const std::uint64_t of_bucket = sizeof(BucketRange);
  const std::uint64_t of_result =
      scene.first_pose() ? 4 * (all.slots + std::uint64_t{all.bucket_count}) : all.slots / 8;
  const std::uint64_t a_cell = all.slots * of_point + all.slots / 8 + all.bucket_count * of_bucket +
                               std::uint64_t{2} * all.word_count * sizeof(std::uint64_t) +
                               of_result + sizeof(GridCell) + sizeof(std::uint64_t);
  return sizeof(Slot) + sizeof(Slot::Line) + 2 * layout.page_bytes + layout.cells * a_cell +
         sizeof(std::uint64_t) + kWorkList * sizeof(std::uint32_t);
}

}  // namespace clearway
