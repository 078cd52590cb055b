#include "gpu/cuda_page_engine.hpp"

#include <cassert>

#include "gpu/cuda_objects.hpp"
#include "gpu/cuda_page_search.hpp"
#include "gpu/device_arrays.hpp"

namespace clearway {
namespace {

/// The layout of a page's result in one run of bytes.
struct ResultRun {
  ResultRun(const PageShape& shape, const ResultParts& parts)
      : blocks(std::uint64_t{shape.cells} * shape.blocks_per_cell), arrays(run, blocks, parts) {}

  std::uint64_t blocks;
  ArrayRun run;
  PageResultArrays arrays;
};

}  // namespace

/// The memory of all slots. It is allocated in two pieces only, because each allocation takes time.
/// Results lie first.
struct CudaPageEngine::SlotMemory {
  SlotMemory(std::uint64_t slots, const CudaSlotSize& size)
      : host(slots * size.pinned()), device(slots * size.device()) {
    // A Clearance has padding, which is copied, too, so it must be initialised.
    if (slots * size.found() > 0) check_cuda(cudaMemset(device.data(), 0, slots * size.found()));
  }

  PinnedBuffer host;
  DeviceBuffer device;
};

/// A slot. The page and what the host adds to it are one run of bytes, on the host and on the
/// device.
struct CudaPageEngine::Slot {
  Slot(const SlotMemory& memory, const CudaSlotSize& size, std::uint64_t slots, std::uint64_t slot)
      : host_result(memory.host.data() + slot * size.found()),
        host_upload(memory.host.data() + slots * size.found() + slot * size.upload()),
        result(memory.device.data() + slot * size.found()),
        upload(memory.device.data() + slots * size.found() + slot * (size.device() - size.found())),
        work(upload + size.upload()) {}

  std::byte *host_result, *host_upload;
  std::byte *result, *upload, *work;
  CudaStream stream;
  CudaEvent begun, uploaded, searched, finished;
  PageShape shape;
};

CudaPageEngine::CudaPageEngine(std::uint32_t slots, std::unique_ptr<CudaPageSearch> search)
    : search_(std::move(search)),
      memory_(std::make_unique<SlotMemory>(slots, search_->slot_size())) {
  slots_.reserve(slots);
  for (std::uint32_t i = 0; i < slots; ++i) {
    slots_.emplace_back(*memory_, search_->slot_size(), slots, i);
  }
  clock_ = std::make_unique<DeviceClock>();
  check_cuda(cudaDeviceSynchronize());  // the slots' streams do not wait for copies and memsets
}

CudaPageEngine::~CudaPageEngine() {
  cudaSetDevice(search_->device());
  for (const Slot& slot : slots_) cudaStreamSynchronize(slot.stream.get());
}

std::uint32_t CudaPageEngine::slots() const { return static_cast<std::uint32_t>(slots_.size()); }

std::span<std::byte> CudaPageEngine::page(std::uint32_t slot) {
  return {slots_[slot].host_upload, search_->slot_size().page};
}

void CudaPageEngine::start(std::uint32_t index, const PageShape& shape) {
  assert(shape.bytes() <= search_->slot_size().page);
  search_->use_device();
  Slot& slot = slots_[index];
  slot.shape = shape;
  std::byte* page = slot.host_upload;
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
  assert(slot.shape.bytes() + plan.bytes <= search_->slot_size().upload());
  assert(result.run.bytes() <= search_->slot_size().found());
  slot.begun.record(stream);
  check_cuda(cudaMemcpyAsync(slot.upload, slot.host_upload, slot.shape.bytes() + plan.bytes,
                             cudaMemcpyHostToDevice, stream));
  slot.uploaded.record(stream);
  search_->enqueue({.page = {slot.upload, slot.shape},
                    .plan = slot.upload + slot.shape.bytes(),
                    .tasks = plan.tasks,
                    .hits = result.arrays.hits.in(slot.result).data(),
                    .first_poses = result.arrays.first_poses.in(slot.result).data(),
                    .clearances = result.arrays.clearances.in(slot.result).data(),
                    .facts = result.arrays.facts.in(slot.result),
                    .fact_counts = result.arrays.fact_counts.in(slot.result).data(),
                    .work = slot.work,
                    .stream = stream});
  slot.searched.record(stream);
  check_cuda(cudaMemcpyAsync(slot.host_result, slot.result, result.run.bytes(),
                             cudaMemcpyDeviceToHost, stream));
  slot.finished.record(stream);
}

void CudaPageEngine::wait(std::uint32_t slot) {
  search_->use_device();
  slots_[slot].finished.synchronise();
}

PageResult CudaPageEngine::finish(std::uint32_t index) {
  wait(index);
  const Slot& slot = slots_[index];
  const ResultRun run(slot.shape, search_->parts());
  const std::byte* found = slot.host_result;
  PageResult result = run.arrays.in(found, run.blocks);
  if (search_->parts().profile) {
    result.profile =
        search_->profile(index, {slot.host_upload, slot.shape}, run.arrays.facts.in(found),
                         run.arrays.fact_counts.in(found).front().facts);
  }
  result.upload = {clock_->time_of(slot.begun), clock_->time_of(slot.uploaded)};
  result.compute = {clock_->time_of(slot.uploaded), clock_->time_of(slot.searched)};
  return result;
}

std::uint64_t CudaPageEngine::device_bytes() const {
  return search_->device_bytes() + memory_->device.bytes();
}

std::uint64_t CudaPageEngine::pinned_bytes() const { return memory_->host.bytes(); }

}  // namespace clearway
