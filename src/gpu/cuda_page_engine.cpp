#include "gpu/cuda_page_engine.hpp"

#include <cassert>

#include "gpu/cuda_page_search.hpp"
#include "gpu/cuda_stream.hpp"
#include "gpu/device_clock.hpp"
#include "gpu/pinned_buffer.hpp"

namespace clearway {
namespace {

/// The result of a page in one run of bytes.
struct ResultRun {
  ResultRun(const PageShape& shape, const ResultParts& parts)
      : blocks(std::uint64_t{shape.cells} * shape.blocks_per_cell), arrays(run, blocks, parts) {}

  std::uint64_t blocks;
  ArrayRun run;
  PageResultArrays arrays;
};

}  // namespace

/// The page and what the host adds to it are one run of bytes, on the host and on the device.
struct CudaPageEngine::Slot {
  explicit Slot(const CudaSlotSize& size)
      : host_upload(size.upload()),
        host_result(size.result),
        upload(size.upload()),
        result(size.result),
        work(size.work) {
    // A Clearance has padding, which is copied too.
    check_cuda(cudaMemset(result.data(), 0, result.bytes()));
  }

  std::uint64_t device_bytes() const { return upload.bytes() + result.bytes() + work.bytes(); }
  std::uint64_t pinned_bytes() const { return host_upload.bytes() + host_result.bytes(); }

  PinnedBuffer host_upload, host_result;
  DeviceBuffer upload, result, work;
  CudaStream stream;
  CudaEvent begun, uploaded, searched, finished;
  PageShape shape;
};

CudaPageEngine::CudaPageEngine(std::uint32_t slots, std::unique_ptr<CudaPageSearch> search)
    : search_(std::move(search)) {
  slots_.reserve(slots);
  for (std::uint32_t i = 0; i < slots; ++i) slots_.emplace_back(search_->slot_size());
  clock_ = std::make_unique<DeviceClock>();
  check_cuda(cudaDeviceSynchronize());  // the slots' streams do not wait for copies and memsets
}

CudaPageEngine::~CudaPageEngine() {
  cudaSetDevice(search_->device());
  for (const Slot& slot : slots_) cudaStreamSynchronize(slot.stream.get());
}

std::uint32_t CudaPageEngine::slots() const { return static_cast<std::uint32_t>(slots_.size()); }

std::span<std::byte> CudaPageEngine::page(std::uint32_t slot) {
  return {slots_[slot].host_upload.data(), search_->slot_size().page};
}

void CudaPageEngine::start(std::uint32_t index, const PageShape& shape) {
  assert(shape.bytes() <= search_->slot_size().page);
  search_->use_device();
  Slot& slot = slots_[index];
  slot.shape = shape;
  std::byte* page = slot.host_upload.data();
  const CudaPagePlan plan = search_->plan({page, shape}, page + shape.bytes());
  try {
    enqueue(slot, plan);
  } catch (...) {
    cudaStreamSynchronize(slot.stream.get());  // nothing of the slot stays in flight
    throw;
  }
}

void CudaPageEngine::enqueue(const Slot& slot, const CudaPagePlan& plan) const {
  const cudaStream_t stream = slot.stream.get();
  const ResultRun result(slot.shape, search_->parts());
  assert(slot.shape.bytes() + plan.bytes <= slot.upload.bytes());
  assert(result.run.bytes() <= slot.result.bytes());
  slot.begun.record(stream);
  check_cuda(cudaMemcpyAsync(slot.upload.data(), slot.host_upload.data(),
                             slot.shape.bytes() + plan.bytes, cudaMemcpyHostToDevice, stream));
  slot.uploaded.record(stream);
  search_->enqueue({.page = {slot.upload.data(), slot.shape},
                    .plan = slot.upload.data() + slot.shape.bytes(),
                    .tasks = plan.tasks,
                    .hits = result.arrays.hits.in(slot.result.data()).data(),
                    .first_poses = result.arrays.first_poses.in(slot.result.data()).data(),
                    .clearances = result.arrays.clearances.in(slot.result.data()).data(),
                    .facts = result.arrays.facts.in(slot.result.data()),
                    .fact_counts = result.arrays.fact_counts.in(slot.result.data()).data(),
                    .work = slot.work.data(),
                    .stream = stream});
  slot.searched.record(stream);
  check_cuda(cudaMemcpyAsync(slot.host_result.data(), slot.result.data(), result.run.bytes(),
                             cudaMemcpyDeviceToHost, stream));
  slot.finished.record(stream);
}

PageResult CudaPageEngine::finish(std::uint32_t index) {
  search_->use_device();
  const Slot& slot = slots_[index];
  slot.finished.synchronise();
  const ResultRun run(slot.shape, search_->parts());
  const std::byte* found = slot.host_result.data();
  PageResult result = run.arrays.in(found, run.blocks);
  if (search_->parts().profile) {
    result.profile =
        search_->profile(index, {slot.host_upload.data(), slot.shape}, run.arrays.facts.in(found),
                         run.arrays.fact_counts.in(found).front().facts);
  }
  result.upload = {clock_->time_of(slot.begun), clock_->time_of(slot.uploaded)};
  result.compute = {clock_->time_of(slot.uploaded), clock_->time_of(slot.searched)};
  return result;
}

std::uint64_t CudaPageEngine::device_bytes() const {
  std::uint64_t bytes = search_->device_bytes();
  for (const Slot& slot : slots_) bytes += slot.device_bytes();
  return bytes;
}

std::uint64_t CudaPageEngine::pinned_bytes() const {
  std::uint64_t bytes = 0;
  for (const Slot& slot : slots_) bytes += slot.pinned_bytes();
  return bytes;
}

}  // namespace clearway
