#include "gpu/grid_engine.hpp"

#include <cassert>
#include <deque>

#include "clearway/error.hpp"
#include "core/grid/grid_cell.hpp"
#include "gpu/cuda_stream.hpp"
#include "gpu/device_clock.hpp"
#include "gpu/grid_kernels.hpp"
#include "gpu/grid_on_device.hpp"
#include "gpu/pinned_buffer.hpp"

namespace clearway {
namespace {

/// The two sections of what the host prepares for a page, one run of bytes: cells' grids, runs of
/// cells, runs of nodes; and of its answer: hits, first poses.
struct Layout {
  Layout(const GridScene& scene, std::uint64_t cells, std::uint64_t nodes)
      : cell_runs_at(PageShape::aligned(cells * sizeof(GridCell))),
        entry_runs_at(cell_runs_at + PageShape::aligned((cells + 1) * sizeof(std::uint64_t))),
        plan_bytes(entry_runs_at + PageShape::aligned(nodes * sizeof(std::uint32_t))),
        points(cells * scene.view().slots),
        first_poses_at(PageShape::aligned(points / 8)),
        result_bytes(first_poses_at + (scene.first_pose() ? points * sizeof(std::uint32_t) : 0)) {}

  std::uint64_t cell_runs_at, entry_runs_at, plan_bytes;
  std::uint64_t points;
  std::uint64_t first_poses_at, result_bytes;
};

/// The most that a page of these options may have.
Layout largest_layout(const GridScene& scene, const SlotLayout& options) {
  return {scene, options.cells, options.page_bytes / sizeof(std::uint32_t)};
}

std::uint32_t sorted_slots(const GridScene& scene, const SlotLayout& options) {
  return options.cells * scene.view().slots;
}

struct Slot {
  Slot(const GridScene& scene, const SlotLayout& options)
      : Slot(scene.view(), options, largest_layout(scene, options), sorted_slots(scene, options),
             scene.first_pose()) {}

  Slot(const GridSceneView& scene, const SlotLayout& options, const Layout& layout,
       std::uint32_t points, bool first_pose)
      : host_page(options.page_bytes),
        host_plan(layout.plan_bytes),
        host_result(layout.result_bytes),
        page(options.page_bytes),
        plan(layout.plan_bytes),
        answer(layout.result_bytes),
        keys(points),
        order(points),
        sorted_keys(points),
        sorted_order(points),
        grid_points(points),
        buckets(std::size_t{options.cells} * scene.bucket_count),
        occupancy(std::size_t{options.cells} * scene.word_count),
        group_occupancy(std::size_t{options.cells} * scene.word_count),
        done(first_pose ? 0 : divide_up(points, 64)),
        latest(first_pose ? std::size_t{options.cells} * scene.bucket_count : 0),
        next_task(1),
        sort_scratch(grid_sort_bytes(points)) {}

  std::uint64_t device_bytes() const {
    return page.bytes() + plan.bytes() + answer.bytes() + keys.bytes() + order.bytes() +
           sorted_keys.bytes() + sorted_order.bytes() + grid_points.bytes() + buckets.bytes() +
           occupancy.bytes() + group_occupancy.bytes() + done.bytes() + latest.bytes() +
           next_task.bytes() + sort_scratch.bytes();
  }
  std::uint64_t pinned_bytes() const {
    return host_page.bytes() + host_plan.bytes() + host_result.bytes();
  }

  PinnedBuffer<std::byte> host_page, host_plan, host_result;
  DeviceBuffer<std::byte> page, plan, answer;
  DeviceBuffer<std::uint32_t> keys, order, sorted_keys, sorted_order;
  DeviceBuffer<GridPoint> grid_points;
  DeviceBuffer<BucketRange> buckets;
  DeviceBuffer<std::uint64_t> occupancy, group_occupancy, done;
  DeviceBuffer<std::uint32_t> latest;
  DeviceBuffer<std::uint64_t> next_task;
  DeviceBuffer<std::byte> sort_scratch;
  CudaStream stream;
  CudaEvent begun, uploaded, searched, finished;
  PageShape shape;
};

}  // namespace

class CudaGridEngine::Impl {
 public:
  Impl(int device, const GridScene& scene, const SlotLayout& options)
      : device_(on(device)), options_(options), scene_(scene), on_device_(scene), statistics_(1) {
    device_bytes_ = on_device_.allocated_bytes() + statistics_.bytes();
    for (std::uint32_t i = 0; i < options.slots; ++i) {
      slots_.emplace_back(scene, options);
      device_bytes_ += slots_.back().device_bytes();
      pinned_bytes_ += slots_.back().pinned_bytes();
    }
    check_cuda(cudaMemset(statistics_.data(), 0, statistics_.bytes()));
    check_cuda(cudaDeviceSynchronize());  // the slots' streams do not wait for copies and memsets
  }

  ~Impl() {
    cudaSetDevice(device_);
    for (Slot& slot : slots_) cudaStreamSynchronize(slot.stream.get());
  }

  std::uint32_t slots() const { return static_cast<std::uint32_t>(slots_.size()); }
  std::span<std::byte> page(std::uint32_t slot) { return slots_[slot].host_page.span(); }

  void start(std::uint32_t index, const PageShape& shape) {
    assert(shape.bytes() <= options_.page_bytes && shape.cells <= options_.cells);
    on(device_);
    Slot& slot = slots_[index];
    slot.shape = shape;
    const Layout layout(scene_, shape.cells, shape.nodes);
    const std::uint64_t tasks = plan(slot, layout);
    try {
      enqueue(slot, layout, tasks);
    } catch (...) {
      cudaStreamSynchronize(slot.stream.get());  // nothing of the slot stays in flight
      throw;
    }
  }

  PageResult finish(std::uint32_t index) {
    on(device_);
    const Slot& slot = slots_[index];
    slot.finished.synchronise();
    const Layout layout(scene_, slot.shape.cells, slot.shape.nodes);
    const std::byte* answer = slot.host_result.data();
    return {.hits = {reinterpret_cast<const std::uint64_t*>(answer), layout.points / kBlockPoints},
            .first_poses = {reinterpret_cast<const std::uint32_t*>(answer + layout.first_poses_at),
                            scene_.first_pose() ? layout.points : 0},
            .clearances = {},
            .upload = {clock_.time_of(slot.begun), clock_.time_of(slot.uploaded)},
            .compute = {clock_.time_of(slot.uploaded), clock_.time_of(slot.searched)}};
  }

  GridStatistics statistics() const {
    on(device_);
    GridStatistics total;
    check_cuda(cudaMemcpy(&total, statistics_.data(), sizeof(total), cudaMemcpyDeviceToHost));
    return total;
  }

  std::uint64_t device_bytes() const { return device_bytes_; }
  std::uint64_t pinned_bytes() const { return pinned_bytes_; }

 private:
  static int on(int device) {
    check_cuda(cudaSetDevice(device));
    return device;
  }

  std::uint64_t plan(Slot& slot, const Layout& layout) const {
    std::byte* to = slot.host_plan.data();
    const PageShape& shape = slot.shape;
    return plan_page(
        scene_, PageRef{slot.host_page.data(), shape},
        {reinterpret_cast<GridCell*>(to), shape.cells},
        {reinterpret_cast<std::uint64_t*>(to + layout.cell_runs_at), shape.cells + std::size_t{1}},
        {reinterpret_cast<std::uint32_t*>(to + layout.entry_runs_at), shape.nodes});
  }

  void enqueue(Slot& slot, const Layout& layout, std::uint64_t tasks) {
    const cudaStream_t stream = slot.stream.get();
    slot.begun.record(stream);
    check_cuda(cudaMemcpyAsync(slot.page.data(), slot.host_page.data(), slot.shape.bytes(),
                               cudaMemcpyHostToDevice, stream));
    check_cuda(cudaMemcpyAsync(slot.plan.data(), slot.host_plan.data(), layout.plan_bytes,
                               cudaMemcpyHostToDevice, stream));
    slot.uploaded.record(stream);
    const GridPageView view = view_of(slot, layout);
    const GridSortRef sort{slot.keys.data(),         slot.order.data(),
                           slot.sorted_keys.data(),  slot.sorted_order.data(),
                           slot.sort_scratch.data(), slot.sort_scratch.bytes()};
    build_grids(on_device_.view(), view, sort, stream);
    search_grids(on_device_.view(), view, tasks, slot.next_task.data(), statistics_.data(), stream);
    slot.searched.record(stream);
    check_cuda(cudaMemcpyAsync(slot.host_result.data(), slot.answer.data(), layout.result_bytes,
                               cudaMemcpyDeviceToHost, stream));
    slot.finished.record(stream);
  }

  GridPageView view_of(const Slot& slot, const Layout& layout) const {
    const std::byte* plan = slot.plan.data();
    std::byte* answer = slot.answer.data();
    auto* first_poses = reinterpret_cast<std::uint32_t*>(answer + layout.first_poses_at);
    return {.page = {slot.page.data(), slot.shape},
            .cells = reinterpret_cast<const GridCell*>(plan),
            .cell_runs = reinterpret_cast<const std::uint64_t*>(plan + layout.cell_runs_at),
            .entry_runs = reinterpret_cast<const std::uint32_t*>(plan + layout.entry_runs_at),
            .points = slot.grid_points.data(),
            .buckets = slot.buckets.data(),
            .occupancy = slot.occupancy.data(),
            .group_occupancy = slot.group_occupancy.data(),
            .done = slot.done.data(),
            .latest = slot.latest.data(),
            .hits = reinterpret_cast<std::uint64_t*>(answer),
            .first_poses = scene_.first_pose() ? first_poses : nullptr};
  }

  int device_;
  SlotLayout options_;
  const GridScene& scene_;
  GridOnDevice on_device_;
  DeviceBuffer<GridStatistics> statistics_;
  std::deque<Slot> slots_;
  DeviceClock clock_;
  std::uint64_t device_bytes_ = 0, pinned_bytes_ = 0;
};

CudaGridEngine::CudaGridEngine(int device, const GridScene& scene, const SlotLayout& options)
    : impl_(std::make_unique<Impl>(device, scene, options)) {}
CudaGridEngine::~CudaGridEngine() = default;
std::uint32_t CudaGridEngine::slots() const { return impl_->slots(); }
std::span<std::byte> CudaGridEngine::page(std::uint32_t slot) { return impl_->page(slot); }
void CudaGridEngine::start(std::uint32_t slot, const PageShape& shape) {
  impl_->start(slot, shape);
}
PageResult CudaGridEngine::finish(std::uint32_t slot) { return impl_->finish(slot); }
GridStatistics CudaGridEngine::statistics() const { return impl_->statistics(); }
std::uint64_t CudaGridEngine::device_bytes() const { return impl_->device_bytes(); }
std::uint64_t CudaGridEngine::pinned_bytes() const { return impl_->pinned_bytes(); }

std::uint64_t cuda_grid_bytes(const GridScene& scene) {
  return scene.size_bytes() + sizeof(GridStatistics);
}

std::uint64_t cuda_grid_slot_bytes(const GridScene& scene, const SlotLayout& options) {
  const Layout layout = largest_layout(scene, options);
  const GridSceneView& view = scene.view();
  const std::uint64_t a_point = 4 * sizeof(std::uint32_t) + sizeof(GridPoint);
  const std::uint64_t a_cell =
      view.bucket_count * sizeof(BucketRange) + 2 * view.word_count * sizeof(std::uint64_t) +
      (scene.first_pose() ? view.bucket_count * sizeof(std::uint32_t) : view.slots / 8);
  return options.page_bytes + layout.plan_bytes + layout.result_bytes + layout.points * a_point +
         options.cells * a_cell + sizeof(std::uint64_t) +
         grid_sort_bytes(sorted_slots(scene, options));
}

std::uint64_t cuda_grid_pinned_bytes(const GridScene& scene, const SlotLayout& layout) {
  const Layout sections = largest_layout(scene, layout);
  return layout.page_bytes + sections.plan_bytes + sections.result_bytes;
}

}  // namespace clearway
