#include "gpu/sweep_engine.hpp"

#include <vector>

#include "gpu/cuda_stream.hpp"
#include "gpu/device_clock.hpp"
#include "gpu/pinned_buffer.hpp"
#include "gpu/sweep_kernels.hpp"
#include "gpu/sweep_on_device.hpp"
#include "gpu/sweep_work_on_device.hpp"

namespace clearway {
namespace {

constexpr std::uint64_t kTallies = kSweepCounts * kSweepTallies;

/// Words, first poses and clearances of a page, one after the other.
struct PageResultLayout {
  std::uint64_t words, first_poses, clearances;

  PageResultLayout(const SweepRef& sweep, std::uint64_t blocks)
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

struct Slot {
  Slot(const SweepRef& sweep, std::uint64_t most_blocks, std::uint64_t page_bytes)
      : host_page(page_bytes),
        host_result(PageResultLayout(sweep, most_blocks).bytes()),
        page(page_bytes),
        answer(host_result.size()),
        work(sweep, most_blocks) {
    // A Clearance has padding, which is copied too.
    check_cuda(cudaMemset(answer.data(), 0, answer.bytes()));
  }

  std::uint64_t device_bytes() const {
    return page.bytes() + answer.bytes() + work.allocated_bytes();
  }
  std::uint64_t pinned_bytes() const { return host_page.bytes() + host_result.bytes(); }

  PinnedBuffer<std::byte> host_page, host_result;
  DeviceBuffer<std::byte> page, answer;
  SweepWorkOnDevice work;
  CudaStream stream;
  CudaEvent begun, uploaded, searched, finished;
  PageShape shape;
};

}  // namespace

class CudaSweepEngine::Impl {
 public:
  Impl(int device, const SweepRef& sweep, const PackedCloud& cloud, const SlotLayout& layout)
      : device_(on(device)),
        resident_(resident_sweep_blocks(device)),
        quantisation_(cloud.quantisation()),
        sweep_(sweep),
        tallies_(kTallies),
        device_bytes_(sweep_.allocated_bytes() + tallies_.bytes()),
        pinned_bytes_(0) {
    slots_.reserve(layout.slots);
    for (std::uint32_t i = 0; i < layout.slots; ++i) {
      slots_.emplace_back(sweep, most_blocks(cloud, layout), page_bytes_of(layout));
      device_bytes_ += slots_.back().device_bytes();
      pinned_bytes_ += slots_.back().pinned_bytes();
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
    const PageResultLayout layout(sweep_.ref(), blocks);
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

  PageResult finish(std::uint32_t index) {
    on(device_);
    const Slot& slot = slots_[index];
    slot.finished.synchronise();
    const PageResultLayout layout(sweep_.ref(),
                                  std::uint64_t{slot.shape.cells} * slot.shape.blocks_per_cell);
    const std::byte* answer = slot.host_result.data();
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
    for (std::size_t i = 0; i < values.size(); i += kSweepCounts) {
      total.add({values[i], values[i + 1], values[i + 2], values[i + 3], values[i + 4]});
    }
    return total;
  }

  std::uint64_t device_bytes() const { return device_bytes_; }
  std::uint64_t pinned_bytes() const { return pinned_bytes_; }

 private:
  /// Not synchronised.
  void enqueue(const Slot& slot, const SweepPage& job, std::uint64_t result_bytes) const {
    const cudaStream_t stream = slot.stream.get();
    slot.begun.record(stream);
    check_cuda(cudaMemcpyAsync(slot.page.data(), slot.host_page.data(), slot.shape.bytes(),
                               cudaMemcpyHostToDevice, stream));
    slot.uploaded.record(stream);
    search_sweep(job, tallies_.data(), resident_, stream);
    slot.searched.record(stream);
    check_cuda(cudaMemcpyAsync(slot.host_result.data(), slot.answer.data(), result_bytes,
                               cudaMemcpyDeviceToHost, stream));
    slot.finished.record(stream);
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
PageResult CudaSweepEngine::finish(std::uint32_t slot) { return impl_->finish(slot); }
SweepStatistics CudaSweepEngine::statistics() const { return impl_->statistics(); }
std::uint64_t CudaSweepEngine::device_bytes() const { return impl_->device_bytes(); }
std::uint64_t CudaSweepEngine::pinned_bytes() const { return impl_->pinned_bytes(); }

std::uint64_t cuda_sweep_bytes(const SweepRef& sweep) {
  return SweepOnDevice::bytes(sweep) + kTallies * sizeof(unsigned long long);
}

std::uint64_t cuda_sweep_slot_bytes(const SweepRef& sweep, const PackedCloud& cloud,
                                    const SlotLayout& layout) {
  const std::uint64_t blocks = most_blocks(cloud, layout);
  return page_bytes_of(layout) + PageResultLayout(sweep, blocks).bytes() +
         SweepWorkOnDevice::bytes(sweep, blocks);
}

std::uint64_t cuda_sweep_pinned_bytes(const SweepRef& sweep, const PackedCloud& cloud,
                                      const SlotLayout& layout) {
  return page_bytes_of(layout) + PageResultLayout(sweep, most_blocks(cloud, layout)).bytes();
}

}  // namespace clearway
