#include "core/page/page_pool.hpp"

namespace clearway {

static_assert(__STDCPP_DEFAULT_NEW_ALIGNMENT__ >= kPageAlignment);

PagePool::Arrays::Arrays(const PackedCloud& cloud, const Query& query, const SlotLayout& layout)
    : page_bytes(PageShape::aligned(layout.page_bytes)),
      result(run, std::uint64_t{layout.cells} * cloud.blocks_per_cell(),
             {.first_pose = query.first_pose, .clearance = query.clearance > 0}) {}

PagePool::PagePool(const PackedCloud& cloud, const Query& query, const SlotLayout& layout)
    : layout_(layout),
      blocks_per_cell_(cloud.blocks_per_cell()),
      arrays_(cloud, query, layout),
      pages_(std::make_unique_for_overwrite<std::byte[]>(layout.slots * arrays_.page_bytes)),
      results_(std::make_unique_for_overwrite<std::byte[]>(layout.slots * arrays_.run.bytes())) {}

std::span<std::byte> PagePool::page(std::uint32_t slot) {
  return {pages_.get() + slot * arrays_.page_bytes, arrays_.page_bytes};
}

std::span<std::uint64_t> PagePool::hits(std::uint32_t slot) {
  return arrays_.result.hits.in(result_at(slot));
}

std::span<std::uint32_t> PagePool::first_poses(std::uint32_t slot) {
  return arrays_.result.first_poses.in(result_at(slot));
}

std::span<Clearance> PagePool::clearances(std::uint32_t slot) {
  return arrays_.result.clearances.in(result_at(slot));
}

PageResult PagePool::result(std::uint32_t slot, std::uint32_t cells) {
  return arrays_.result.in(result_at(slot), std::size_t{cells} * blocks_per_cell_);
}

std::uint64_t PagePool::slot_bytes(const PackedCloud& cloud, const Query& query,
                                   const SlotLayout& layout) {
  const Arrays arrays(cloud, query, layout);
  return arrays.page_bytes + arrays.run.bytes();
}

}  // namespace clearway
