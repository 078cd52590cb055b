#include "gpu/beam_engine.hpp"

#include "gpu/beam_kernels.hpp"
#include "gpu/cuda_page_search.hpp"

namespace clearway {
namespace {

CudaSlotSize size_of_slot(const Beams& beams, const PackedCloud& cloud, const SlotLayout& layout) {
  ArrayRun result;
  PageResultArrays(result, std::uint64_t{layout.cells} * cloud.blocks_per_cell(), kNoParts);
  return {.page = PageShape::aligned(layout.page_bytes),
          .plan = origin_bytes(layout.cells, cloud.cell_points(), beams.origin_minbits),
          .result = result.bytes(),
          .work = 0};
}

/// What the kernel needs besides a page.
struct BeamsOnDevice {
  BeamsRef beams;
  unsigned long long* counts;  ///< as in a BeamCounts, initially zero
};

/// Copies brick map and origins into DeviceArrays, or counts them with DeviceArrayCount.
template <typename Arrays>
BeamsOnDevice put_on_device(const Beams& from, Arrays& arrays) {
  BeamsRef beams = from.ref;
  beams.map.slots = arrays.copy(from.map.slots().data(), from.map.slots().size());
  beams.map.words =
      const_cast<std::uint64_t*>(arrays.copy(from.map.words().data(), from.map.words().size()));
  beams.origins = arrays.copy(from.ref.origins, 3 * std::size_t{beams.origin_count});
  return {beams, arrays.template zeros<unsigned long long>(2)};
}

class BeamSearch final : public CudaPageSearch {
 public:
  BeamSearch(int device, const Beams& beams, const PackedCloud& cloud, const SlotLayout& layout)
      : CudaPageSearch(device, kNoParts),
        beams_(beams),
        size_(size_of_slot(beams, cloud, layout)),
        on_device_(put_on_device(beams, arrays_)) {}

  const CudaSlotSize& slot_size() const override { return size_; }

  CudaPagePlan plan(const PageRef& page, std::byte* begin) const override {
    return {.bytes = stage_origins(page, beams_.origins_of, begin)};
  }

  void enqueue(const CudaPage& page) const override {
    follow_beams(on_device_.beams, {page.page, {page.plan, {}}}, on_device_.counts, page.stream);
  }

  std::vector<std::uint64_t> words() const {
    use_device();
    std::vector<std::uint64_t> words(beams_.map.words().size());
    check_cuda(cudaMemcpy(words.data(), on_device_.beams.map.words, words.size() * sizeof(words[0]),
                          cudaMemcpyDeviceToHost));
    return words;
  }

  BeamCounts counts() const {
    use_device();
    unsigned long long values[2];
    check_cuda(cudaMemcpy(values, on_device_.counts, sizeof(values), cudaMemcpyDeviceToHost));
    return {.without_origin = values[0], .too_long = values[1]};
  }

 private:
  const Beams& beams_;
  CudaSlotSize size_;
  BeamsOnDevice on_device_;
};

}  // namespace

CudaBeamEngine::CudaBeamEngine(int device, const Beams& beams, const PackedCloud& cloud,
                               const SlotLayout& layout)
    : CudaPageEngine(layout.slots, std::make_unique<BeamSearch>(device, beams, cloud, layout)) {}

std::vector<std::uint64_t> CudaBeamEngine::words() const {
  return static_cast<const BeamSearch&>(search()).words();
}

BeamCounts CudaBeamEngine::counts() const {
  return static_cast<const BeamSearch&>(search()).counts();
}

std::uint64_t cuda_beam_bytes(const Beams& beams) {
  DeviceArrayCount count;
  put_on_device(beams, count);
  return count.bytes();
}

std::uint64_t cuda_beam_slot_bytes(const Beams& beams, const PackedCloud& cloud,
                                   const SlotLayout& layout) {
  return size_of_slot(beams, cloud, layout).device();
}

std::uint64_t cuda_beam_pinned_bytes(const Beams& beams, const PackedCloud& cloud,
                                     const SlotLayout& layout) {
  return size_of_slot(beams, cloud, layout).pinned();
}

}  // namespace clearway
