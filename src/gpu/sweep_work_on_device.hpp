#pragma once

#include <cstdint>

#include "core/sweep/sweep_page.hpp"
#include "core/sweep/sweep_ref.hpp"
#include "gpu/device_buffer.hpp"

namespace clearway {

/// The lists of open work of a page on the current device, with room for so many places a block of
/// the page; clearances are searched without.
class SweepWorkOnDevice {
 public:
  SweepWorkOnDevice(const SweepRef& sweep, std::uint64_t most_blocks)
      : entry_capacity_(kEntries * blocks(sweep, most_blocks)),
        nodes_(kNodes * blocks(sweep, most_blocks)),
        entries_((kEntries + SweepWork::kHalves) * blocks(sweep, most_blocks)),
        walks_(kWalks * blocks(sweep, most_blocks)),
        items_(kItems * blocks(sweep, most_blocks)),
        counts_(1) {}

  SweepWork ref() const {
    return {.nodes = nodes_.data(),
            .entries = entries_.data(),
            .walks = walks_.data(),
            .items = items_.data(),
            .counts = counts_.data(),
            .node_capacity = static_cast<std::uint32_t>(nodes_.size()),
            .entry_capacity = static_cast<std::uint32_t>(entry_capacity_),
            .walk_capacity = static_cast<std::uint32_t>(walks_.size()),
            .item_capacity = static_cast<std::uint32_t>(items_.size())};
  }

  std::uint64_t allocated_bytes() const {
    return nodes_.bytes() + entries_.bytes() + walks_.bytes() + items_.bytes() + counts_.bytes();
  }

  /// That, before it is made.
  static std::uint64_t bytes(const SweepRef& sweep, std::uint64_t most_blocks) {
    constexpr std::uint64_t kBlockBytes =
        kNodes * sizeof(std::uint32_t) +
        (kEntries + SweepWork::kHalves) * sizeof(SweepWork::Entry) +
        (kWalks + kItems) * sizeof(SweepWork::Item);
    return sizeof(SweepWork::Counts) + kBlockBytes * blocks(sweep, most_blocks);
  }

 private:
  /// Places a block.
  static constexpr std::uint64_t kNodes = 8;
  static constexpr std::uint64_t kEntries = 3;
  static constexpr std::uint64_t kWalks = 64;
  static constexpr std::uint64_t kItems = 16;

  static std::uint64_t blocks(const SweepRef& sweep, std::uint64_t most_blocks) {
    return sweep.clearance > 0 ? 0 : most_blocks;
  }

  std::uint64_t entry_capacity_;
  DeviceBuffer<std::uint32_t> nodes_;
  DeviceBuffer<SweepWork::Entry> entries_;
  DeviceBuffer<SweepWork::Item> walks_, items_;
  DeviceBuffer<SweepWork::Counts> counts_;
};

}  // namespace clearway
