#include <algorithm>
#include <atomic>
#include <vector>

#include "gpu/cuda_stream.hpp"
#include "gpu/device_array.hpp"
#include "gpu/device_clock.hpp"
#include "gpu/pinned_buffer.hpp"
#include "gpu/sweep_block.hpp"
#include "gpu/sweep_engine.hpp"

namespace clearway {
namespace {

constexpr std::uint32_t kWarpsPerBlock = 4;
constexpr unsigned kThreads = kWarpsPerBlock * kWarpLanes;
/// Registers are limited so that this many blocks of threads run on a processor at a time: latency
/// is what there is to hide.
constexpr unsigned kBlocksPerProcessor = 8;
/// Statistics are added up in several places, so that warps seldom wait for each other.
constexpr std::uint32_t kTallies = 64;
/// Places on a page's lists, a block.
constexpr std::uint64_t kNodesPerBlock = 8;
constexpr std::uint64_t kEntriesPerBlock = 3;
constexpr std::uint64_t kWalksPerBlock = 64;
constexpr std::uint64_t kItemsPerBlock = 16;

__device__ void tally(unsigned long long* total, std::uint64_t of_lane) {
  const auto sum = __reduce_add_sync(0xffffffff, static_cast<unsigned>(of_lane));
  if (threadIdx.x % kWarpLanes == 0 && sum != 0) {
    atomicAdd(total, static_cast<unsigned long long>(sum));
  }
}

/// Of SweepStatistics.
constexpr std::uint32_t kCounts = 5;

/// tallies: kTallies times kCounts.
__device__ void tally(unsigned long long* tallies, const SweepStatistics& of_lane) {
  unsigned long long* total = tallies + kCounts * (blockIdx.x % kTallies);
  tally(total, of_lane.node_tests);
  tally(total + 1, of_lane.point_tests);
  tally(total + 2, of_lane.exact_tests);
  tally(total + 3, of_lane.points_tested);
  tally(total + 4, of_lane.settled_tests);
}

/// A warp a block of the page's cells.
template <bool kClearance>
__global__ void __launch_bounds__(kThreads, kBlocksPerProcessor)
    search_blocks_kernel(const __grid_constant__ SweepPage job, unsigned long long* tallies) {
  using Block = SweepBlock<CudaWarp, kClearance>;
  __shared__ typename Block::Shared shared[kWarpsPerBlock];
  const std::uint32_t warp = threadIdx.x / kWarpLanes;
  const std::uint32_t block = blockIdx.x * kWarpsPerBlock + warp;
  if (block >= job.block_count()) return;
  CudaWarp::PerLane<SweepStatistics> statistics;
  Block(job, block, shared[warp], statistics).search();
  tally(tallies, statistics[0]);
}

/// Warps take one entry after the other, since some take far longer than others.
__global__ void __launch_bounds__(kThreads, kBlocksPerProcessor)
    search_entries_kernel(const __grid_constant__ SweepPage job, unsigned long long* tallies) {
  const std::uint32_t count = job.work.entry_count();
  CudaWarp::PerLane<SweepStatistics> statistics;
  for (;;) {
    const std::uint32_t index = CudaWarp::add(&job.work.counts->taken, 1, count);
    if (index >= count) break;
    search_entry<CudaWarp>(job, job.work.entry(index), statistics);
  }
  tally(tallies, statistics[0]);
}

/// A lane a walk.
__global__ void __launch_bounds__(kThreads, kBlocksPerProcessor)
    search_walks_kernel(const __grid_constant__ SweepPage job, unsigned long long* tallies) {
  const std::uint32_t count = job.work.walk_count();
  const std::uint32_t warp = blockIdx.x * kWarpsPerBlock + threadIdx.x / kWarpLanes;
  CudaWarp::PerLane<SweepStatistics> statistics;
  for (std::uint32_t first = warp * kWarpLanes; first < count; first += gridDim.x * kThreads) {
    SweepHits<CudaWarp>(job, statistics).search_walks(first, count);
  }
  tally(tallies, statistics[0]);
}

/// A thread an item.
__global__ void __launch_bounds__(kThreads, kBlocksPerProcessor)
    search_items_kernel(const __grid_constant__ SweepPage job, unsigned long long* tallies) {
  const std::uint32_t count = job.work.item_count();
  SweepStatistics statistics;
  for (std::uint32_t i = blockIdx.x * kThreads + threadIdx.x; i < count;
       i += gridDim.x * kThreads) {
    search_item(job, job.work.items[i], statistics);
  }
  __syncwarp();
  tally(tallies, statistics);
}

/// Everything that a SweepRef refers to, on a device.
class SweepOnDevice {
 public:
  explicit SweepOnDevice(const SweepRef& sweep)
      : ref_(sweep),
        coarse_squared_(copied_to_device(sweep.field.coarse_squared, sweep.field.coarse_nodes())),
        coarse_nearest_(copied_to_device(
            sweep.field.coarse_nearest,
            sweep.field.coarse_nearest == nullptr ? 0 : sweep.field.coarse_nodes())),
        brick_of_(copied_to_device(sweep.field.brick_of, sweep.field.coarse_nodes())),
        distances_(copied_to_device(sweep.field.distances, brick_nodes(sweep))),
        nearest_(copied_to_device(sweep.field.nearest, brick_nodes(sweep))),
        points_(copied_to_device(sweep.model.points, sweep.model.size)),
        boxes_(copied_to_device(sweep.model.boxes, sweep.model.box_count)),
        nodes_(copied_to_device(sweep.motion.nodes, motion_nodes(sweep))),
        pull_backs_(copied_to_device(sweep.motion.pull_backs, sweep.motion.pose_count)),
        poses_(copied_to_device(sweep.motion.poses, sweep.motion.pose_count)) {
    ref_.field.coarse_squared = coarse_squared_.data();
    ref_.field.coarse_nearest = coarse_nearest_.data();
    ref_.field.brick_of = brick_of_.data();
    ref_.field.distances = distances_.data();
    ref_.field.nearest = nearest_.data();
    ref_.model.points = points_.data();
    ref_.model.boxes = boxes_.data();
    ref_.motion.nodes = nodes_.data();
    ref_.motion.pull_backs = pull_backs_.data();
    ref_.motion.poses = poses_.data();
  }

  const SweepRef& ref() const { return ref_; }

  static std::uint64_t bytes(const SweepRef& sweep) {
    const std::uint64_t coarse =
        sweep.field.coarse_nodes() * (sweep.field.coarse_nearest == nullptr ? 8 : 12);
    return coarse + brick_nodes(sweep) * 8 + sweep.model.size * sizeof(Vec3) +
           sweep.model.box_count * sizeof(Box) + motion_nodes(sweep) * sizeof(MotionNode) +
           sweep.motion.pose_count * (sizeof(PullBack) + sizeof(Pose));
  }

 private:
  static std::size_t brick_nodes(const SweepRef& sweep) {
    return std::size_t{sweep.field.bricks} * ModelFieldRef::kBrickNodes;
  }
  static std::size_t motion_nodes(const SweepRef& sweep) {
    const std::size_t poses = sweep.motion.pose_count;
    return poses == 0 ? 0 : 2 * poses - 1;
  }

  SweepRef ref_;
  DeviceBuffer<float> coarse_squared_;
  DeviceBuffer<std::uint32_t> coarse_nearest_, brick_of_;
  DeviceBuffer<float> distances_;
  DeviceBuffer<std::uint32_t> nearest_;
  DeviceBuffer<Vec3> points_;
  DeviceBuffer<Box> boxes_;
  DeviceBuffer<MotionNode> nodes_;
  DeviceBuffer<PullBack> pull_backs_;
  DeviceBuffer<Pose> poses_;
};

/// Words, first poses and clearances of a page, one after the other.
struct AnswerLayout {
  std::uint64_t words, first_poses, clearances;

  AnswerLayout(const SweepRef& sweep, std::uint64_t blocks)
      : words(blocks),
        first_poses(sweep.first_pose ? blocks * kBlockPoints : 0),
        clearances(sweep.clearance > 0 ? blocks * kBlockPoints : 0) {}

  std::uint64_t clearances_at() const { return 8 * words; }
  std::uint64_t first_poses_at() const { return clearances_at() + sizeof(Clearance) * clearances; }
  std::uint64_t bytes() const { return first_poses_at() + 4 * first_poses; }
};

std::uint64_t page_bytes_of(const SlotLayout& layout) {
  return PageShape::aligned(layout.page_bytes);
}

/// Blocks of a page at the most.
std::uint64_t most_blocks(const PackedCloud& cloud, const SlotLayout& layout) {
  return std::uint64_t{layout.cells} * cloud.blocks_per_cell();
}

/// The lists of open work; clearances are searched without.
struct WorkBuffers {
  WorkBuffers(const SweepRef& sweep, std::uint64_t most_blocks)
      : blocks(sweep.clearance > 0 ? 0 : most_blocks),
        nodes(kNodesPerBlock * blocks),
        entries((kEntriesPerBlock + 2) * blocks),
        walks(kWalksPerBlock * blocks),
        items(kItemsPerBlock * blocks),
        counts(1) {}

  SweepWork ref() const {
    return {.nodes = nodes.data(),
            .entries = entries.data(),
            .walks = walks.data(),
            .items = items.data(),
            .counts = counts.data(),
            .node_capacity = static_cast<std::uint32_t>(nodes.size()),
            .entry_capacity = static_cast<std::uint32_t>(kEntriesPerBlock * blocks),
            .walk_capacity = static_cast<std::uint32_t>(walks.size()),
            .item_capacity = static_cast<std::uint32_t>(items.size())};
  }

  static std::uint64_t bytes(const SweepRef& sweep, std::uint64_t most_blocks) {
    const std::uint64_t a_block = kNodesPerBlock * sizeof(std::uint32_t) +
                                  (kEntriesPerBlock + 2) * sizeof(SweepWork::Entry) +
                                  (kWalksPerBlock + kItemsPerBlock) * sizeof(SweepWork::Item);
    return sizeof(SweepWork::Counts) + (sweep.clearance > 0 ? 0 : a_block * most_blocks);
  }

  std::uint64_t blocks;
  DeviceBuffer<std::uint32_t> nodes;
  DeviceBuffer<SweepWork::Entry> entries;
  DeviceBuffer<SweepWork::Item> walks, items;
  DeviceBuffer<SweepWork::Counts> counts;
};

struct Slot {
  Slot(const SweepRef& sweep, std::uint64_t most_blocks, std::uint64_t page_bytes)
      : host_page(page_bytes),
        host_answer(AnswerLayout(sweep, most_blocks).bytes()),
        page(page_bytes),
        answer(host_answer.size()),
        work(sweep, most_blocks) {
    // A Clearance has padding, which is copied too.
    check_cuda(cudaMemset(answer.data(), 0, answer.bytes()));
  }

  PinnedBuffer<std::byte> host_page, host_answer;
  DeviceBuffer<std::byte> page, answer;
  WorkBuffers work;
  CudaStream stream;
  CudaEvent begun, uploaded, searched, finished;
  PageShape shape;
};

}  // namespace

class CudaSweepEngine::Impl {
 public:
  Impl(int device, const SweepRef& sweep, const PackedCloud& cloud, const SlotLayout& layout)
      : device_(on(device)),
        resident_(resident_blocks(device)),
        quantisation_(cloud.quantisation()),
        sweep_(sweep),
        tallies_(kCounts * kTallies),
        device_bytes_(cuda_sweep_bytes(sweep)),
        pinned_bytes_(0) {
    slots_.reserve(layout.slots);
    for (std::uint32_t i = 0; i < layout.slots; ++i) {
      slots_.emplace_back(sweep, most_blocks(cloud, layout), page_bytes_of(layout));
      device_bytes_ += cuda_sweep_slot_bytes(sweep, cloud, layout);
      pinned_bytes_ += slots_.back().host_page.bytes() + slots_.back().host_answer.bytes();
    }
    check_cuda(cudaMemset(tallies_.data(), 0, tallies_.bytes()));
    check_cuda(cudaDeviceSynchronize());  // the slots' streams do not wait for copies and memsets
  }

  ~Impl() {
    cudaSetDevice(device_);
    for (Slot& slot : slots_) cudaStreamSynchronize(slot.stream.get());
  }

  std::uint32_t slots() const { return static_cast<std::uint32_t>(slots_.size()); }
  std::span<std::byte> page(std::uint32_t slot) { return slots_[slot].host_page.span(); }

  void start(std::uint32_t index, const PageShape& shape) {
    on(device_);
    Slot& slot = slots_[index];
    slot.shape = shape;
    const cudaStream_t stream = slot.stream.get();
    const std::uint64_t blocks = std::uint64_t{shape.cells} * shape.blocks_per_cell;
    const AnswerLayout layout(sweep_.ref(), blocks);
    std::byte* answer = slot.answer.data();
    const SweepPage job{
        .sweep = sweep_.ref(),
        .page = {slot.page.data(), shape},
        .quantisation = quantisation_,
        .hits = reinterpret_cast<std::uint64_t*>(answer),
        .first_poses = layout.first_poses > 0
                           ? reinterpret_cast<std::uint32_t*>(answer + layout.first_poses_at())
                           : nullptr,
        .clearances = layout.clearances > 0
                          ? reinterpret_cast<Clearance*>(answer + layout.clearances_at())
                          : nullptr,
        .work = slot.work.ref()};
    try {
      enqueue(slot, job, layout.bytes());
    } catch (...) {
      cudaStreamSynchronize(stream);  // nothing of the slot stays in flight
      throw;
    }
  }

  PageAnswer finish(std::uint32_t index) {
    on(device_);
    const Slot& slot = slots_[index];
    slot.finished.synchronise();
    const AnswerLayout layout(sweep_.ref(),
                              std::uint64_t{slot.shape.cells} * slot.shape.blocks_per_cell);
    const std::byte* answer = slot.host_answer.data();
    return {
        .hits = {reinterpret_cast<const std::uint64_t*>(answer), layout.words},
        .first_poses = {reinterpret_cast<const std::uint32_t*>(answer + layout.first_poses_at()),
                        layout.first_poses},
        .clearances = {reinterpret_cast<const Clearance*>(answer + layout.clearances_at()),
                       layout.clearances},
        .upload = {clock_.time_of(slot.begun), clock_.time_of(slot.uploaded)},
        .compute = {clock_.time_of(slot.uploaded), clock_.time_of(slot.searched)}};
  }

  SweepStatistics statistics() const {
    on(device_);
    std::vector<unsigned long long> values(tallies_.size());
    check_cuda(
        cudaMemcpy(values.data(), tallies_.data(), tallies_.bytes(), cudaMemcpyDeviceToHost));
    SweepStatistics total;
    for (std::size_t i = 0; i < values.size(); i += kCounts) {
      total.add({values[i], values[i + 1], values[i + 2], values[i + 3], values[i + 4]});
    }
    return total;
  }

  std::uint64_t device_bytes() const { return device_bytes_ + tallies_.bytes(); }
  std::uint64_t pinned_bytes() const { return pinned_bytes_; }

 private:
  /// Not synchronised.
  void enqueue(const Slot& slot, const SweepPage& job, std::uint64_t answer_bytes) const {
    const cudaStream_t stream = slot.stream.get();
    slot.begun.record(stream);
    check_cuda(cudaMemcpyAsync(slot.page.data(), slot.host_page.data(), slot.shape.bytes(),
                               cudaMemcpyHostToDevice, stream));
    slot.uploaded.record(stream);
    search(job, stream);
    slot.searched.record(stream);
    check_cuda(cudaMemcpyAsync(slot.host_answer.data(), slot.answer.data(), answer_bytes,
                               cudaMemcpyDeviceToHost, stream));
    slot.finished.record(stream);
  }

  /// Enqueued on `stream`, not synchronised.
  void search(const SweepPage& job, cudaStream_t stream) const {
    const auto grid = static_cast<unsigned>(divide_up(job.block_count(), kWarpsPerBlock));
    check_cuda(cudaMemsetAsync(job.work.counts, 0, sizeof(SweepWork::Counts), stream));
    if (job.clearances != nullptr) {
      search_blocks_kernel<true><<<grid, kThreads, 0, stream>>>(job, tallies_.data());
      check_cuda(cudaGetLastError());
      return;
    }
    search_blocks_kernel<false><<<grid, kThreads, 0, stream>>>(job, tallies_.data());
    check_cuda(cudaGetLastError());
    search_entries_kernel<<<resident_, kThreads, 0, stream>>>(job, tallies_.data());
    check_cuda(cudaGetLastError());
    search_walks_kernel<<<resident_, kThreads, 0, stream>>>(job, tallies_.data());
    check_cuda(cudaGetLastError());
    search_items_kernel<<<resident_, kThreads, 0, stream>>>(job, tallies_.data());
    check_cuda(cudaGetLastError());
  }

  /// Blocks of threads that the device can hold at a time, with room for other slots' beside them.
  static unsigned resident_blocks(int device) {
    int processors = 0;
    check_cuda(cudaDeviceGetAttribute(&processors, cudaDevAttrMultiProcessorCount, device));
    return kBlocksPerProcessor * static_cast<unsigned>(processors);
  }

  static int on(int device) {
    check_cuda(cudaSetDevice(device));
    return device;
  }

  int device_;
  unsigned resident_;
  Quantisation quantisation_;
  SweepOnDevice sweep_;
  DeviceBuffer<unsigned long long> tallies_;
  std::vector<Slot> slots_;
  DeviceClock clock_;
  std::uint64_t device_bytes_, pinned_bytes_;
};

CudaSweepEngine::CudaSweepEngine(int device, const SweepRef& sweep, const PackedCloud& cloud,
                                 const SlotLayout& layout)
    : impl_(std::make_unique<Impl>(device, sweep, cloud, layout)) {}
CudaSweepEngine::~CudaSweepEngine() = default;
std::uint32_t CudaSweepEngine::slots() const { return impl_->slots(); }
std::span<std::byte> CudaSweepEngine::page(std::uint32_t slot) { return impl_->page(slot); }
void CudaSweepEngine::start(std::uint32_t slot, const PageShape& shape) {
  impl_->start(slot, shape);
}
PageAnswer CudaSweepEngine::finish(std::uint32_t slot) { return impl_->finish(slot); }
SweepStatistics CudaSweepEngine::statistics() const { return impl_->statistics(); }
std::uint64_t CudaSweepEngine::device_bytes() const { return impl_->device_bytes(); }
std::uint64_t CudaSweepEngine::pinned_bytes() const { return impl_->pinned_bytes(); }

std::uint64_t cuda_sweep_bytes(const SweepRef& sweep) { return SweepOnDevice::bytes(sweep); }

std::uint64_t cuda_sweep_slot_bytes(const SweepRef& sweep, const PackedCloud& cloud,
                                    const SlotLayout& layout) {
  const std::uint64_t blocks = most_blocks(cloud, layout);
  return page_bytes_of(layout) + AnswerLayout(sweep, blocks).bytes() +
         WorkBuffers::bytes(sweep, blocks);
}

std::uint64_t cuda_sweep_pinned_bytes(const SweepRef& sweep, const PackedCloud& cloud,
                                      const SlotLayout& layout) {
  return page_bytes_of(layout) + AnswerLayout(sweep, most_blocks(cloud, layout)).bytes();
}

}  // namespace clearway
