#pragma once

#include <array>
#include <cstdlib>
#include <memory>
#include <new>
#include <vector>

#include "core/page/page.hpp"
#include "memory_file.hpp"
#include "stream/plan.hpp"
#include "stream/run_pages.hpp"

namespace clearway::test {

/// Stages a page of one cell, in memory of exactly its size, and requires these values in it.
inline void check_staged_cell(const PackedCloud& cloud, std::uint32_t cell,
                              const std::array<std::vector<std::int32_t>, 3>& values) {
  const std::array<PlannedCell, 1> planned{PlannedCell{cell, {0}}};
  const std::uint64_t bytes = page_shape(cloud, planned).bytes();
  constexpr std::align_val_t kAlignment{kPageAlignment};
  const auto free = [=](std::byte* page) { ::operator delete[](page, kAlignment); };
  const std::unique_ptr<std::byte[], decltype(free)> page(
      static_cast<std::byte*>(::operator new[](bytes, kAlignment)), free);
  const PageRef staged{page.get(), stage_page(cloud, planned, {page.get(), bytes})};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::uint32_t i = 0; i < cloud.cell_points(); ++i) {
      if (staged.value(staged.cell(0).chunks[axis], i) != values[axis][i]) std::abort();
    }
  }
}

}  // namespace clearway::test
