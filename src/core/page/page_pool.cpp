#include "core/page/page_pool.hpp"

namespace clearway {
namespace {

static_assert(__STDCPP_DEFAULT_NEW_ALIGNMENT__ >= kPageAlignment);

SlotLayout rounded(SlotLayout layout) {
  layout.page_bytes = PageShape::aligned(layout.page_bytes);
  return layout;
}

/// Numbers of values in the answer of one slot.
struct PageResultSize {
  PageResultSize(const PackedCloud& cloud, const Query& query, const SlotLayout& layout)
      : hits(std::size_t{layout.cells} * cloud.blocks_per_cell()),
        first_poses(query.first_pose ? hits * kBlockPoints : 0),
        clearances(query.clearance > 0 ? hits * kBlockPoints : 0) {}

  std::size_t hits, first_poses, clearances;
};

}  // namespace

PagePool::PagePool(const PackedCloud& cloud, const Query& query, const SlotLayout& layout)
    : layout_(rounded(layout)),
      pages_(layout.slots, layout_.page_bytes),
      hits_(layout.slots, PageResultSize(cloud, query, layout).hits),
      first_poses_(layout.slots, PageResultSize(cloud, query, layout).first_poses),
      clearances_(layout.slots, PageResultSize(cloud, query, layout).clearances) {}

std::span<std::byte> PagePool::page(std::uint32_t slot) { return pages_.of(slot); }

std::span<std::uint64_t> PagePool::hits(std::uint32_t slot) { return hits_.of(slot); }

std::span<std::uint32_t> PagePool::first_poses(std::uint32_t slot) { return first_poses_.of(slot); }

std::span<Clearance> PagePool::clearances(std::uint32_t slot) { return clearances_.of(slot); }

std::uint64_t PagePool::slot_bytes(const PackedCloud& cloud, const Query& query,
                                   const SlotLayout& layout) {
  const PageResultSize answer(cloud, query, layout);
  return rounded(layout).page_bytes + answer.hits * sizeof(std::uint64_t) +
         answer.first_poses * sizeof(std::uint32_t) + answer.clearances * sizeof(Clearance);
}

}  // namespace clearway
