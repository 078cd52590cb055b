#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include "core/page_engine.hpp"
#include "grid/grid_cell.hpp"

namespace clearway {

struct GridCpuOptions {
  std::uint32_t slots = 1;       ///< pages searched at once, each by the thread that finishes it
  std::uint64_t page_bytes = 0;  ///< of a slot
  std::uint32_t page_cells = 1;  ///< most cells of a page
  std::uint32_t work_list =
      1024;  ///< pairs of group and pose tested before the open ones are searched
};

/// The engine `grid` on the CPU: the bodies of the GPU engine, called by plain loops. Source:
/// Schauer et al. (the paper), section 3.2.
class GridCpuEngine final : public PageEngine {
 public:
  /// `scene` outlives it. All memory is made here.
  GridCpuEngine(const GridScene& scene, const GridCpuOptions& options);
  ~GridCpuEngine() override;

  std::uint32_t slots() const override;
  std::span<std::byte> page(std::uint32_t slot) override;
  void start(std::uint32_t slot, const PageShape& shape) override;
  PageAnswer finish(std::uint32_t slot) override;

  /// Of all pages finished.
  GridStatistics statistics() const;
  std::uint64_t allocated_bytes() const;

 private:
  struct Slot;

  const GridScene& scene_;
  GridCpuOptions options_;
  std::vector<std::unique_ptr<Slot>> slots_;
  mutable std::mutex mutex_;
  GridStatistics statistics_;
};

}  // namespace clearway
