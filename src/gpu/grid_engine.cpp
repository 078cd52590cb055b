#include "gpu/grid_engine.hpp"

#include "core/grid/grid_arrays.hpp"
#include "core/grid/grid_cell.hpp"
#include "gpu/cuda_page_search.hpp"
#include "gpu/grid_kernels.hpp"
#include "gpu/grid_on_device.hpp"

namespace clearway {
namespace {

constexpr ResultParts kParts{.first_pose = false, .clearance = false};

/// The layout of a page's work memory, including what the device sorts with. Asks the current
/// device.
struct Work {
  Work(const GridScene& scene, const SlotLayout& layout)
      : Work(scene, layout.cells, layout.cells * scene.view().slots) {}

  GridSortRef sort_in(std::byte* begin) const {
    return {grid.keys.in(begin).data(),   grid.order.in(begin).data(),
            sorted_keys.in(begin).data(), sorted_order.in(begin).data(),
            scratch.in(begin).data(),     scratch.count};
  }

  ArrayRun run;
  GridWorkArrays grid;
  ArrayPlace<std::uint32_t> sorted_keys, sorted_order;
  ArrayPlace<std::uint64_t> next_task;
  ArrayPlace<std::byte> scratch;

 private:
  Work(const GridScene& scene, std::uint32_t cells, std::uint32_t points)
      : grid(run, scene, cells),
        sorted_keys(run.add<std::uint32_t>(points)),
        sorted_order(run.add<std::uint32_t>(points)),
        next_task(run.add<std::uint64_t>(1)),
        scratch(run.add<std::byte>(grid_sort_bytes(points))) {}
};

/// The sizes of a slot without its work memory, for which a device would have to be asked.
CudaSlotSize pinned_size(const GridScene& scene, const SlotLayout& layout) {
  const std::uint64_t blocks = std::uint64_t{layout.cells} * scene.view().slots / kBlockPoints;
  ArrayRun plan, result;
  GridPlanArrays(plan, layout.cells, layout.page_bytes / sizeof(std::uint32_t));
  PageResultArrays(result, blocks, kParts);
  return {.page = PageShape::aligned(layout.page_bytes),
          .plan = plan.bytes(),
          .result = result.bytes(),
          .work = 0};
}

CudaSlotSize size_of_slot(const GridScene& scene, const SlotLayout& layout) {
  CudaSlotSize size = pinned_size(scene, layout);
  size.work = Work(scene, layout).run.bytes();
  return size;
}

class GridSearch final : public CudaPageSearch {
 public:
  GridSearch(int device, const GridScene& scene, const SlotLayout& layout)
      : CudaPageSearch(device, kParts),
        scene_(scene),
        on_device_(put_on_device(scene, arrays_)),
        size_(size_of_slot(scene, layout)),
        work_(scene, layout) {}

  const CudaSlotSize& slot_size() const override { return size_; }

  CudaPagePlan plan(const PageRef& page, std::byte* begin) const override {
    ArrayRun run;
    const GridPlanArrays plan(run, page.shape.cells, page.shape.nodes);
    const std::uint64_t tasks = plan_page(scene_, page, plan.cells.in(begin),
                                          plan.cell_runs.in(begin), plan.entry_runs.in(begin));
    return {run.bytes(), tasks};
  }

  void enqueue(const CudaPage& page) const override {
    GridPageView view{};
    view.page = page.page;
    ArrayRun run;
    GridPlanArrays(run, page.page.shape.cells, page.page.shape.nodes).put_into(view, page.plan);
    work_.grid.put_into(view, page.work);
    view.hits = page.hits;
    build_grids(on_device_.scene, view, work_.sort_in(page.work), page.stream);
    search_grids(on_device_.scene, view, page.tasks, work_.next_task.in(page.work).data(),
                 on_device_.statistics, page.stream);
  }

  GridStatistics statistics() const {
    use_device();
    GridStatistics total;
    check_cuda(cudaMemcpy(&total, on_device_.statistics, sizeof(total), cudaMemcpyDeviceToHost));
    return total;
  }

 private:
  const GridScene& scene_;
  GridOnDevice on_device_;
  CudaSlotSize size_;
  Work work_;
};

}  // namespace

CudaGridEngine::CudaGridEngine(int device, const GridScene& scene, const SlotLayout& layout)
    : CudaPageEngine(layout.slots, std::make_unique<GridSearch>(device, scene, layout)) {}

GridStatistics CudaGridEngine::statistics() const {
  return static_cast<const GridSearch&>(search()).statistics();
}

std::uint64_t cuda_grid_bytes(const GridScene& scene) {
  DeviceArrayCount count;
  put_on_device(scene, count);
  return count.bytes();
}

std::uint64_t cuda_grid_slot_bytes(const GridScene& scene, const SlotLayout& layout) {
  return size_of_slot(scene, layout).device();
}

std::uint64_t cuda_grid_pinned_bytes(const GridScene& scene, const SlotLayout& layout) {
  return pinned_size(scene, layout).pinned();
}

}  // namespace clearway
