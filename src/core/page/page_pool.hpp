#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "clearway/query.hpp"
#include "core/cloud/packed_cloud.hpp"
#include "core/page/page_engine.hpp"

namespace clearway {

/// How many pages an engine holds at a time, and how large they and their answers may be.
struct SlotLayout {
  std::uint32_t slots = 1;
  std::uint64_t page_bytes = 0;  ///< of a page, rounded up to kPageAlignment
  std::uint32_t cells = 1;       ///< of a page at the most
};

/// Plain memory on the host for the pages and answers of a fixed number of slots, allocated at
/// once.
class PagePool {
 public:
  PagePool(const PackedCloud& cloud, const Query& query, const SlotLayout& layout);

  const SlotLayout& layout() const { return layout_; }
  std::span<std::byte> page(std::uint32_t slot);

  /// Where the answers of the slot's page go: as PageResult describes them, for its largest number
  /// of cells; first poses and clearances are empty unless asked for.
  std::span<std::uint64_t> hits(std::uint32_t slot);
  std::span<std::uint32_t> first_poses(std::uint32_t slot);
  std::span<Clearance> clearances(std::uint32_t slot);

  /// What one slot takes, bytes.
  static std::uint64_t slot_bytes(const PackedCloud& cloud, const Query& query,
                                  const SlotLayout& layout);

 private:
  template <typename Value>
  struct Values {
    Values(std::uint32_t slots, std::size_t values_per_slot)
        : per_slot(values_per_slot),
          all(std::make_unique_for_overwrite<Value[]>(slots * values_per_slot)) {}
    std::span<Value> of(std::uint32_t slot) { return {all.get() + slot * per_slot, per_slot}; }
    std::size_t per_slot;
    std::unique_ptr<Value[]> all;
  };

  SlotLayout layout_;
  Values<std::byte> pages_;
  Values<std::uint64_t> hits_;
  Values<std::uint32_t> first_poses_;
  Values<Clearance> clearances_;
};

}  // namespace clearway
