#include "cpu/grid_cpu_engine.hpp"

#include <algorithm>
#include <cassert>

#include "core/grid/grid_arrays.hpp"
#include "core/grid/grid_search.hpp"
#include "core/page/page_pool.hpp"
#include "core/query/search_result.hpp"

namespace clearway {

namespace {

struct alignas(kPageAlignment) Line {
  std::byte bytes[kPageAlignment];
};

}  // namespace

/// The layout of a slot's memory, for its largest page.
struct GridCpuEngine::Arrays {
  Arrays(const GridScene& scene, const SlotLayout& layout)
      : page(run.add<Line>(divide_up(layout.page_bytes, sizeof(Line)))),
        plan(run, layout.cells, layout.page_bytes / sizeof(std::uint32_t)),
        work(run, scene, layout.cells),
        sorted(run.add<std::uint64_t>(work.keys.count)),
        result(run, work.keys.count / kBlockPoints, {.first_pose = false, .clearance = false}) {}

  std::uint64_t lines() const { return divide_up(run.bytes(), sizeof(Line)); }

  ArrayRun run;
  ArrayPlace<Line> page;
  GridPlanArrays plan;
  GridWorkArrays work;
  ArrayPlace<std::uint64_t> sorted;  ///< key and slot of each point in one word
  PageResultArrays result;
};

struct GridCpuEngine::Slot {
  Slot(const Arrays& arrays, std::uint32_t work_list)
      : memory(std::make_unique_for_overwrite<Line[]>(arrays.lines())) {
    open.reserve(work_list);
  }

  std::byte* begin() const { return reinterpret_cast<std::byte*>(memory.get()); }
  void build(const GridScene& scene, const Arrays& arrays);
  void search(const GridScene& scene, std::uint64_t task, std::uint32_t work_list);

  std::unique_ptr<Line[]> memory;
  std::vector<std::uint32_t> open;  ///< open pairs of group and pose
  GridPageView view{};
  PageResult result;
  GridStatistics statistics;
};

/// Sorts the page's points into their grids.
void GridCpuEngine::Slot::build(const GridScene& scene, const Arrays& arrays) {
  const GridWorkArrays& work = arrays.work;
  std::ranges::fill(work.buckets.in(begin()), BucketRange{0, 0});
  std::ranges::fill(work.occupancy.in(begin()), 0);
  std::ranges::fill(work.group_occupancy.in(begin()), 0);
  std::ranges::fill(work.done.in(begin()), 0);
  std::ranges::fill(arrays.result.hits.in(begin()), 0);
  const std::uint32_t count = view.page.shape.cells * scene.view().slots;
  const std::span sorted = arrays.sorted.in(begin()).first(count);
  const std::span keys = work.keys.in(begin()), order = work.order.in(begin());
  for (std::uint32_t slot = 0; slot < count; ++slot) {
    sorted[slot] = std::uint64_t{sort_key(scene.view(), view, slot)} << 32 | slot;
  }
  std::ranges::sort(sorted);
  for (std::uint32_t i = 0; i < count; ++i) {
    keys[i] = static_cast<std::uint32_t>(sorted[i] >> 32);
    order[i] = static_cast<std::uint32_t>(sorted[i]);
  }
  for (std::uint32_t i = 0; i < count; ++i) {
    place_point(scene.view(), view, keys.data(), order.data(), i, count);
  }
}

/// Searches a task. Tests as many pairs as the work list holds, then searches the open ones, and so
/// on.
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
    : scene_(scene),
      layout_(layout),
      work_list_(std::max(1U, work_list)),
      arrays_(std::make_unique<Arrays>(scene, layout)) {
  for (std::uint32_t i = 0; i < layout.slots; ++i) {
    slots_.push_back(std::make_unique<Slot>(*arrays_, work_list_));
  }
}

GridCpuEngine::~GridCpuEngine() = default;

std::uint32_t GridCpuEngine::slots() const { return static_cast<std::uint32_t>(slots_.size()); }

std::span<std::byte> GridCpuEngine::page(std::uint32_t slot) {
  return {slots_[slot]->begin(), layout_.page_bytes};
}

void GridCpuEngine::start(std::uint32_t index, const PageShape& shape) {
  assert(shape.bytes() <= layout_.page_bytes && shape.cells <= layout_.cells);
  const Clock::time_point begin = Clock::now();
  Slot& slot = *slots_[index];
  std::byte* memory = slot.begin();
  slot.statistics = {};
  slot.view.page = {memory, shape};
  arrays_->plan.put_into(slot.view, memory);
  arrays_->work.put_into(slot.view, memory);
  slot.view.hits = arrays_->result.hits.in(memory).data();
  const GridPlanArrays& plan = arrays_->plan;
  const std::uint64_t tasks = plan_page(scene_, slot.view.page, plan.cells.in(memory),
                                        plan.cell_runs.in(memory), plan.entry_runs.in(memory));
  slot.build(scene_, *arrays_);
  for (std::uint64_t task = 0; task < tasks; ++task) {
    slot.search(scene_, task, work_list_);
  }
  slot.result = arrays_->result.in(memory, std::size_t{shape.cells} * shape.blocks_per_cell);
  slot.result.compute = {begin, Clock::now()};
  const std::lock_guard lock(mutex_);
  statistics_.add(slot.statistics);
}

PageResult GridCpuEngine::finish(std::uint32_t slot) { return slots_[slot]->result; }

GridStatistics GridCpuEngine::statistics() const {
  const std::lock_guard lock(mutex_);
  return statistics_;
}

std::uint64_t GridCpuEngine::slot_bytes(const GridScene& scene, const SlotLayout& layout) {
  return sizeof(Slot) + Arrays(scene, layout).lines() * sizeof(Line) +
         kWorkList * sizeof(std::uint32_t);
}

}  // namespace clearway
