#include "gpu/section_engine.hpp"

#include <cassert>

#include "gpu/cuda_page_search.hpp"
#include "gpu/section_kernels.hpp"

namespace clearway {
namespace {

CudaSlotSize size_of_slot(const PackedCloud& cloud, const SlotLayout& layout) {
  ArrayRun result;
  PageResultArrays(result, std::uint64_t{layout.cells} * cloud.blocks_per_cell(), kNoParts);
  return {.page = PageShape::aligned(layout.page_bytes),
          .plan = 0,
          .result = result.bytes(),
          .work = 0};
}

/// Copies what a section needs into DeviceArrays, or counts it with DeviceArrayCount.
template <typename Arrays>
SectionRef put_on_device(const SectionRef& from, Arrays& arrays) {
  static_assert(kNotBlocked == 0xffffffff);
  SectionRef section = from;
  section.nodes = arrays.copy(from.nodes, from.node_count);
  section.pull_backs = arrays.copy(from.pull_backs, from.pose_count);
  section.path_pose = arrays.copy(from.path_pose, from.pose_count);
  section.entries = arrays.template ones<std::uint32_t>(from.entry_count());
  return section;
}

class SectionPageSearch final : public CudaPageSearch {
 public:
  SectionPageSearch(int device, const SectionRef& section, const PackedCloud& cloud,
                    const SlotLayout& layout)
      : CudaPageSearch(device, kNoParts),
        quantisation_(cloud.quantisation()),
        size_(size_of_slot(cloud, layout)),
        section_(put_on_device(section, arrays_)) {}

  const CudaSlotSize& slot_size() const override { return size_; }

  void enqueue(const CudaPage& page) const override {
    block_cells({.section = section_, .page = page.page, .quantisation = quantisation_},
                page.stream);
  }

  void read_entries(std::span<std::uint32_t> to) const {
    assert(to.size() == section_.entry_count());
    use_device();
    check_cuda(cudaMemcpy(to.data(), section_.entries, to.size_bytes(), cudaMemcpyDeviceToHost));
  }

 private:
  Quantisation quantisation_;
  CudaSlotSize size_;
  SectionRef section_;
};

}  // namespace

CudaSectionEngine::CudaSectionEngine(int device, const SectionRef& section,
                                     const PackedCloud& cloud, const SlotLayout& layout)
    : CudaPageEngine(layout.slots,
                     std::make_unique<SectionPageSearch>(device, section, cloud, layout)) {}

void CudaSectionEngine::read_entries(std::span<std::uint32_t> to) const {
  static_cast<const SectionPageSearch&>(search()).read_entries(to);
}

std::uint64_t cuda_section_bytes(const SectionRef& section) {
  DeviceArrayCount count;
  put_on_device(section, count);
  return count.bytes();
}

std::uint64_t cuda_section_slot_bytes(const PackedCloud& cloud, const SlotLayout& layout) {
  return size_of_slot(cloud, layout).device();
}

std::uint64_t cuda_section_pinned_bytes(const PackedCloud& cloud, const SlotLayout& layout) {
  return size_of_slot(cloud, layout).pinned();
}

}  // namespace clearway
