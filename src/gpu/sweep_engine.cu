#include <algorithm>
#include <atomic>
#include <vector>

#include "gpu/cuda_event.hpp"
#include "gpu/cuda_stream.hpp"
#include "gpu/device_array.hpp"
#include "gpu/pinned_buffer.hpp"
#include "gpu/sweep_block.hpp"
#include "gpu/sweep_engine.hpp"

namespace clearway {
namespace {

constexpr std::uint32_t kWarpsPerBlock = 4;
/// Statistics are added up in several places, so that warps seldom wait for each other.
constexpr std::uint32_t kTallies = 64;

__device__ void tally(unsigned long long* total, std::uint64_t of_lane) {
  const auto sum = __reduce_add_sync(0xffffffff, static_cast<unsigned>(of_lane));
  if (threadIdx.x % kWarpLanes == 0 && sum != 0) {
    atomicAdd(total, static_cast<unsigned long long>(sum));
  }
}

template <bool kClearance>
using Block = SweepBlock<CudaWarp, kClearance>;

/// A warp a block of the page's cells. tallies: kTallies times the four of SweepStatistics.
template <bool kClearance>
__global__ void __launch_bounds__(kWarpsPerBlock* kWarpLanes)
    search_blocks_kernel(const __grid_constant__ SweepRef sweep,
                         const __grid_constant__ PageRef page,
                         const __grid_constant__ Quantisation quantisation,
                         const __grid_constant__ SweepAnswerRef answer,
                         unsigned long long* tallies) {
  __shared__ std::uint32_t queues[kWarpsPerBlock][Block<kClearance>::kQueue];
  const std::uint32_t warp = threadIdx.x / kWarpLanes;
  const std::uint64_t word = std::uint64_t{blockIdx.x} * kWarpsPerBlock + warp;
  const std::uint32_t per_cell = page.shape.blocks_per_cell;
  if (word >= std::uint64_t{page.shape.cells} * per_cell) return;
  Block<kClearance> block(sweep, page, quantisation, static_cast<std::uint32_t>(word / per_cell),
                          static_cast<std::uint32_t>(word % per_cell), answer, queues[warp]);
  const SweepStatistics& found = block.statistics(0);
  unsigned long long* total = tallies + 4 * (blockIdx.x % kTallies);
  tally(total, found.node_tests);
  tally(total + 1, found.point_tests);
  tally(total + 2, found.exact_tests);
  tally(total + 3, found.points_tested);
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

std::uint64_t answer_bytes(const SweepRef& sweep, const SlotOptions& options) {
  return AnswerLayout(sweep, std::uint64_t{options.page_cells} * options.blocks_per_cell).bytes();
}

struct Slot {
  Slot(const SweepRef& sweep, const SlotOptions& options)
      : host_page(options.page_bytes),
        host_answer(answer_bytes(sweep, options)),
        page(options.page_bytes),
        answer(answer_bytes(sweep, options)) {}

  PinnedBuffer<std::byte> host_page, host_answer;
  DeviceBuffer<std::byte> page, answer;
  CudaStream stream;
  CudaEvent begun, uploaded, searched, finished;
  PageShape shape;
};

}  // namespace

class CudaSweepEngine::Impl {
 public:
  Impl(int device, const SweepRef& sweep, const Quantisation& quantisation,
       const SlotOptions& options)
      : device_(on(device)),
        quantisation_(quantisation),
        sweep_(sweep),
        tallies_(4 * kTallies),
        device_bytes_(cuda_sweep_bytes(sweep)),
        pinned_bytes_(0) {
    for (std::uint32_t i = 0; i < options.slots; ++i) {
      slots_.emplace_back(sweep, options);
      device_bytes_ += cuda_sweep_slot_bytes(sweep, options);
      pinned_bytes_ += slots_.back().host_page.bytes() + slots_.back().host_answer.bytes();
    }
    check_cuda(cudaMemset(tallies_.data(), 0, tallies_.bytes()));
    base_.record(nullptr);
    base_.synchronise();
    base_time_ = Clock::now();
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
    const SweepAnswerRef to{
        reinterpret_cast<std::uint64_t*>(answer),
        layout.first_poses > 0 ? reinterpret_cast<std::uint32_t*>(answer + layout.first_poses_at())
                               : nullptr,
        layout.clearances > 0 ? reinterpret_cast<Clearance*>(answer + layout.clearances_at())
                              : nullptr};
    slot.begun.record(stream);
    check_cuda(cudaMemcpyAsync(slot.page.data(), slot.host_page.data(), shape.bytes(),
                               cudaMemcpyHostToDevice, stream));
    slot.uploaded.record(stream);
    const auto grid = static_cast<unsigned>(divide_up(blocks, kWarpsPerBlock));
    const auto search =
        layout.clearances > 0 ? search_blocks_kernel<true> : search_blocks_kernel<false>;
    search<<<grid, kWarpsPerBlock * kWarpLanes, 0, stream>>>(
        sweep_.ref(), PageRef{slot.page.data(), shape}, quantisation_, to, tallies_.data());
    check_cuda(cudaGetLastError());
    slot.searched.record(stream);
    check_cuda(cudaMemcpyAsync(slot.host_answer.data(), answer, layout.bytes(),
                               cudaMemcpyDeviceToHost, stream));
    slot.finished.record(stream);
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
        .upload = {time_of(slot.begun), time_of(slot.uploaded)},
        .compute = {time_of(slot.uploaded), time_of(slot.searched)}};
  }

  SweepStatistics statistics() const {
    on(device_);
    std::vector<unsigned long long> values(tallies_.size());
    check_cuda(
        cudaMemcpy(values.data(), tallies_.data(), tallies_.bytes(), cudaMemcpyDeviceToHost));
    SweepStatistics total;
    for (std::size_t i = 0; i < values.size(); i += 4) {
      total.add({values[i], values[i + 1], values[i + 2], values[i + 3]});
    }
    return total;
  }

  std::uint64_t device_bytes() const { return device_bytes_ + tallies_.bytes(); }
  std::uint64_t pinned_bytes() const { return pinned_bytes_; }

 private:
  static int on(int device) {
    check_cuda(cudaSetDevice(device));
    return device;
  }

  Clock::time_point time_of(const CudaEvent& event) const {
    return base_time_ + std::chrono::duration_cast<Clock::duration>(
                            std::chrono::duration<double>(event.seconds_since(base_)));
  }

  int device_;
  Quantisation quantisation_;
  SweepOnDevice sweep_;
  DeviceBuffer<unsigned long long> tallies_;
  std::vector<Slot> slots_;
  CudaEvent base_;  ///< happened at base_time_
  Clock::time_point base_time_;
  std::uint64_t device_bytes_, pinned_bytes_;
};

CudaSweepEngine::CudaSweepEngine(int device, const SweepRef& sweep,
                                 const Quantisation& quantisation, const SlotOptions& options)
    : impl_(std::make_unique<Impl>(device, sweep, quantisation, options)) {}
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

std::uint64_t cuda_sweep_slot_bytes(const SweepRef& sweep, const SlotOptions& options) {
  return options.page_bytes + answer_bytes(sweep, options);
}

}  // namespace clearway
