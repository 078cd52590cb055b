#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/page_engine.hpp"
#include "core/quantisation.hpp"
#include "gpu/sweep_block.hpp"

namespace clearway {

/// The CUDA sweep engine's kernel body with the lanes of a warp as a loop.
class HostSweep final : public PageEngine {
 public:
  HostSweep(const SweepRef& sweep, const Quantisation& quantisation, std::uint32_t slots,
            std::uint64_t page_bytes)
      : sweep_(sweep),
        quantisation_(quantisation),
        slots_(slots) {
    for (Slot& slot : slots_) slot.page.resize(page_bytes / sizeof(Word) + 1);
  }

  std::uint32_t slots() const override { return static_cast<std::uint32_t>(slots_.size()); }

  std::span<std::byte> page(std::uint32_t slot) override {
    return std::as_writable_bytes(std::span(slots_[slot].page));
  }

  void start(std::uint32_t slot, const PageShape& shape) override { slots_[slot].shape = shape; }

  PageAnswer finish(std::uint32_t index) override {
    Slot& slot = slots_[index];
    const PageRef page{this->page(index).data(), slot.shape};
    const std::size_t blocks = std::size_t{slot.shape.cells} * slot.shape.blocks_per_cell;
    slot.hits.assign(blocks, 0xdead);
    slot.first_poses.assign(sweep_.first_pose ? blocks * kBlockPoints : 0, 7);
    slot.clearances.assign(sweep_.clearance > 0 ? blocks * kBlockPoints : 0, Clearance{0, 7});
    const SweepAnswerRef answer{slot.hits.data(),
                                sweep_.first_pose ? slot.first_poses.data() : nullptr,
                                sweep_.clearance > 0 ? slot.clearances.data() : nullptr};
    for (std::uint32_t cell = 0; cell < slot.shape.cells; ++cell) {
      for (std::uint32_t block = 0; block < slot.shape.blocks_per_cell; ++block) {
        if (sweep_.clearance > 0) {
          search<true>(page, cell, block, answer);
        } else {
          search<false>(page, cell, block, answer);
        }
      }
    }
    return {.hits = slot.hits, .first_poses = slot.first_poses, .clearances = slot.clearances};
  }

 private:
  struct alignas(kPageAlignment) Word {
    std::byte bytes[kPageAlignment];
  };

  struct Slot {
    std::vector<Word> page;
    PageShape shape;
    std::vector<std::uint64_t> hits;
    std::vector<std::uint32_t> first_poses;
    std::vector<Clearance> clearances;
  };

  template <bool kClearance>
  void search(const PageRef& page, std::uint32_t cell, std::uint32_t block,
              const SweepAnswerRef& answer) const {
    using Block = SweepBlock<HostWarp, kClearance>;
    std::uint32_t queue[Block::kQueue];
    Block(sweep_, page, quantisation_, cell, block, answer, queue);
  }

  SweepRef sweep_;
  Quantisation quantisation_;
  std::vector<Slot> slots_;
};

}  // namespace clearway
