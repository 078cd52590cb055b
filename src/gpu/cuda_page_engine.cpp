#include "gpu/cuda_page_engine.hpp"

#include <algorithm>
#include <cassert>

#include "gpu/cuda_objects.hpp"
#include "gpu/cuda_page_search.hpp"
#include "gpu/cuda_slots.hpp"
#include "gpu/device_arrays.hpp"
#include "gpu/kept_on_device.hpp"

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

/// A slot. The page and what the host adds to it are one run of bytes, on the host and on the
/// device. Results of all slots lie first.
struct CudaPageEngine::Slot {
  Slot(CudaSlots& memory, const CudaSlotSize& size, std::uint64_t slots, std::uint64_t slot)
      : host_result(memory.host.data() + slot * size.found()),
        host_upload(memory.host.data() + slots * size.found() + slot * size.upload()),
        result(memory.device.data() + slot * size.found()),
        upload(memory.device.data() + slots * size.found() + slot * (size.device() - size.found())),
        work(upload + size.upload()),
        on(memory.streams[slot]) {}

  /// A place of the page on the device as the host sees it; null for one that is elsewhere.
  const std::byte* on_host(std::uintptr_t place) const {
    const std::uint64_t at = place - reinterpret_cast<std::uintptr_t>(upload);
    return at < shape.bytes() ? host_upload + at : nullptr;
  }

  std::byte *host_result, *host_upload;
  std::byte *result, *upload, *work;
  CudaSlotStream& on;
  PageShape shape;
  const Slot* first = nullptr;  ///< that of another engine, whose page has the coordinates
  std::vector<ResidentCells::Place> cells;  ///< that the page uses or brings
};

CudaPageEngine::CudaPageEngine(std::uint32_t slots, std::unique_ptr<CudaPageSearch> search)
    : memory_(std::make_unique<CudaSlots>(slots, search->slot_size(), 0)),
      search_(std::move(search)) {
  make_slots(slots);
}

CudaPageEngine::CudaPageEngine(std::uint32_t slots, std::unique_ptr<CudaPageSearch> search,
                               std::unique_ptr<CudaSlots> memory, const PackedCloud& cloud,
                               std::shared_ptr<KeptOnDevice> kept)
    : kept_(std::move(kept)),
      cloud_(&cloud),
      memory_(std::move(memory)),
      search_(std::move(search)) {
  make_slots(slots);
}

void CudaPageEngine::make_slots(std::uint32_t slots) {
  slots_.reserve(slots);
  for (std::uint32_t i = 0; i < slots; ++i) {
    slots_.emplace_back(*memory_, search_->slot_size(), slots, i);
  }
  // The slots' streams do not wait for the copies and memsets before.
  check_cuda(cudaStreamSynchronize(nullptr));
}

CudaPageEngine::~CudaPageEngine() {
  cudaSetDevice(search_->device());
  for (Slot& slot : slots_) {
    cudaStreamSynchronize(slot.on.stream.get());
    release_cells(slot, false);
  }
  // After an error of CUDA the slots may be of no use.
  if (kept_ != nullptr && cudaPeekAtLastError() == cudaSuccess) kept_->keep(std::move(memory_));
}

std::uint32_t CudaPageEngine::slots() const { return static_cast<std::uint32_t>(slots_.size()); }

std::span<std::byte> CudaPageEngine::page(std::uint32_t slot) {
  return {slots_[slot].host_upload, search_->slot_size().page};
}

std::optional<CellPayload> CudaPageEngine::kept(std::uint32_t index, std::uint32_t cell) {
  if (kept_ == nullptr) return std::nullopt;
  std::optional<ResidentCells::Place> place = kept_->cells().find(cell);
  if (!place) return std::nullopt;
  Slot& slot = slots_[index];
  CellPayload payload = place->payload;
  for (PageChunk& chunk : payload) chunk.payload -= reinterpret_cast<std::uintptr_t>(slot.upload);
  slot.cells.push_back(*place);
  return payload;
}

/// Copies the cells that the page brings to places where they stay, behind its search.
void CudaPageEngine::keep_cells(Slot& slot) const {
  const std::uint64_t page_bytes = slot.shape.bytes();
  const std::span cells(reinterpret_cast<const PageCell*>(slot.host_upload), slot.shape.cells);
  for (const PageCell& cell : cells) {
    if (cell.chunks[0].payload >= page_bytes) continue;  // it is there already
    const std::uint64_t first = cell.chunks[0].payload - kPackedHeaderBytes;
    std::optional<ResidentCells::Place> place = kept_->cells().room_for(cell.cell);
    if (!place) continue;
    slot.cells.push_back(*place);
    ResidentCells::Place& brought = slot.cells.back();
    check_cuda(cudaMemcpyAsync(brought.begin, slot.upload + first, cloud_->packed_bytes(cell.cell),
                               cudaMemcpyDeviceToDevice, slot.on.stream.get()));
    for (std::size_t axis = 0; axis < 3; ++axis) {
      brought.payload[axis] = cell.chunks[axis];
      brought.payload[axis].payload += reinterpret_cast<std::uintptr_t>(brought.begin) - first;
    }
  }
}

/// are_filled: whether the cells that the page brings have arrived.
void CudaPageEngine::release_cells(Slot& slot, bool are_filled) {
  for (ResidentCells::Place& place : slot.cells) {
    place.filled = place.filled || are_filled;
    kept_->cells().release(place);
  }
  slot.cells.clear();
}

/// The page in a slot as the host sees it, where cells that another engine's page brought are found
/// in that page, and those that are kept on the device are taken from the cloud.
PageRef CudaPageEngine::page_on_host(const Slot& slot) const {
  const std::span cells(reinterpret_cast<PageCell*>(slot.host_upload), slot.shape.cells);
  const auto begin = reinterpret_cast<std::uintptr_t>(slot.host_upload);
  for (PageCell& cell : cells) {
    if (cell.chunks[0].payload < slot.shape.bytes()) continue;
    const auto place = [&](const PageChunk& chunk) {
      return reinterpret_cast<std::uintptr_t>(slot.upload) + chunk.payload;
    };
    if (slot.first != nullptr && slot.first->on_host(place(cell.chunks[0])) != nullptr) {
      for (PageChunk& chunk : cell.chunks) {
        chunk.payload = reinterpret_cast<std::uintptr_t>(slot.first->on_host(place(chunk))) - begin;
      }
    } else {
      std::ranges::copy(payload_at(cloud_->in_place(cell.cell).value(), slot.host_upload),
                        cell.chunks);
    }
  }
  return {slot.host_upload, slot.shape};
}

void CudaPageEngine::start(std::uint32_t index, const PageShape& shape) {
  start(slots_[index], shape, nullptr);
}

void CudaPageEngine::start_beside(PageEngine& first, std::uint32_t index, const PageShape& shape) {
  Slot& slot = slots_[index];
  const Slot& other = dynamic_cast<const CudaPageEngine&>(first).slots_[index];
  move_payloads(slot.host_upload, shape.cells, slot.upload, other.upload);
  start(slot, shape, &other);
}

void CudaPageEngine::start(Slot& slot, const PageShape& shape, const Slot* first) {
  assert(shape.bytes() <= search_->slot_size().page);
  search_->use_device();
  slot.shape = shape;
  slot.first = first;
  std::byte* page = slot.host_upload;
  const CudaPagePlan plan = search_->plan({page, shape}, page + shape.bytes());
  try {
    enqueue(slot, plan);
  } catch (...) {
    cudaStreamSynchronize(slot.on.stream.get());  // nothing of the slot stays in flight
    release_cells(slot, false);
    throw;
  }
}

void CudaPageEngine::enqueue(Slot& slot, const CudaPagePlan& plan) const {
  const cudaStream_t stream = slot.on.stream.get();
  const ResultRun result(slot.shape, search_->parts());
  assert(slot.shape.bytes() + plan.bytes <= search_->slot_size().upload());
  assert(result.run.bytes() <= search_->slot_size().found());
  if (slot.first != nullptr) slot.first->on.uploaded.before(stream);
  slot.on.begun.record(stream);
  check_cuda(cudaMemcpyAsync(slot.upload, slot.host_upload, slot.shape.bytes() + plan.bytes,
                             cudaMemcpyHostToDevice, stream));
  slot.on.uploaded.record(stream);
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
  slot.on.searched.record(stream);
  check_cuda(cudaMemcpyAsync(slot.host_result, slot.result, result.run.bytes(),
                             cudaMemcpyDeviceToHost, stream));
  if (kept_ != nullptr) keep_cells(slot);
  slot.on.finished.record(stream);
}

void CudaPageEngine::wait(std::uint32_t slot) {
  search_->use_device();
  slots_[slot].on.finished.synchronise();
}

void CudaPageEngine::release(std::uint32_t slot) { release_cells(slots_[slot], true); }

PageResult CudaPageEngine::finish(std::uint32_t index) {
  Slot& slot = slots_[index];
  wait(index);
  const ResultRun run(slot.shape, search_->parts());
  const std::byte* found = slot.host_result;
  PageResult result = run.arrays.in(found, run.blocks);
  if (search_->parts().profile) {
    result.profile = search_->profile(index, page_on_host(slot), run.arrays.facts.in(found),
                                      run.arrays.fact_counts.in(found).front().facts);
  }
  const DeviceClock& clock = memory_->clock;
  result.upload = {clock.time_of(slot.on.begun), clock.time_of(slot.on.uploaded)};
  result.compute = {clock.time_of(slot.on.uploaded), clock.time_of(slot.on.searched)};
  return result;
}

std::uint64_t CudaPageEngine::device_bytes() const {
  return search_->device_bytes() + memory_->device_bytes();
}

std::uint64_t CudaPageEngine::pinned_bytes() const { return memory_->host.bytes(); }

}  // namespace clearway
