#pragma once

#include "core/sweep/sweep_page.hpp"
#include "core/util/array_run.hpp"

namespace clearway {

/// The lists of open work of a page, with room for a number of places for each block of the page.
/// Empty with clearances, which are searched without lists.
class SweepWorkArrays {
 public:
  template <typename Element>
  SweepWorkArrays(ArrayRun& run, const SweepRefOf<Element>& sweep, std::uint64_t most_blocks)
      : SweepWorkArrays(run, sweep.clearance > 0 ? 0 : most_blocks) {}

  /// The lists in a run that begins at `begin`.
  SweepWork in(std::byte* begin) const {
    return {.nodes = nodes_.in(begin).data(),
            .entries = entries_.in(begin).data(),
            .walks = walks_.in(begin).data(),
            .items = items_.in(begin).data(),
            .counts = counts_.in(begin).data(),
            .node_capacity = static_cast<std::uint32_t>(nodes_.count),
            .entry_capacity = static_cast<std::uint32_t>(entry_capacity_),
            .walk_capacity = static_cast<std::uint32_t>(walks_.count),
            .item_capacity = static_cast<std::uint32_t>(items_.count)};
  }

 private:
  /// Places of each list for each block.
  static constexpr std::uint64_t kNodes = 8;
  static constexpr std::uint64_t kEntries = 3;
  static constexpr std::uint64_t kWalks = 64;
  static constexpr std::uint64_t kItems = 16;

  /// Adds the lists to `run`, for this many thread blocks, the longest first, because in that order
  /// none needs padding.
  SweepWorkArrays(ArrayRun& run, std::uint64_t blocks)
      : entry_capacity_(kEntries * blocks),
        walks_(run.add<SweepWork::Item>(kWalks * blocks)),
        items_(run.add<SweepWork::Item>(kItems * blocks)),
        nodes_(run.add<std::uint32_t>(kNodes * blocks)),
        entries_(run.add<SweepWork::Entry>(entry_capacity_ + SweepWork::kHalves * blocks)),
        counts_(run.add<SweepWork::Counts>(1)) {}

  std::uint64_t entry_capacity_;
  ArrayPlace<SweepWork::Item> walks_, items_;
  ArrayPlace<std::uint32_t> nodes_;
  ArrayPlace<SweepWork::Entry> entries_;
  ArrayPlace<SweepWork::Counts> counts_;
};

}  // namespace clearway
