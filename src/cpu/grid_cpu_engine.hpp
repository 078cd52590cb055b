#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include "core/grid/grid_cell.hpp"
#include "core/page/page_engine.hpp"
#include "core/page/page_pool.hpp"

namespace clearway {

/// The engine `grid` on the CPU: plain loops that call the functions of the GPU engine. Source:
/// Schauer et al. (the paper), section 3.2.
class GridCpuEngine final : public PageEngine {
 public:
  /// Number of pairs of group and pose that are tested before the open ones are searched.
  static constexpr std::uint32_t kWorkList = 1024;

  /// scene: must outlive the engine. All memory is allocated here.
  GridCpuEngine(const GridScene& scene, const SlotLayout& layout,
                std::uint32_t work_list = kWorkList);
  ~GridCpuEngine() override;

  std::uint32_t slots() const override;
  std::span<std::byte> page(std::uint32_t slot) override;
  void start(std::uint32_t slot, const PageShape& shape) override;
  PageResult finish(std::uint32_t slot) override;

  /// Counts of all finished pages.
  GridStatistics statistics() const;

  /// Greatest memory of one slot, bytes.
  static std::uint64_t slot_bytes(const GridScene& scene, const SlotLayout& layout);

 private:
  struct Arrays;
  struct Slot;

  const GridScene& scene_;
  SlotLayout layout_;
  std::uint32_t work_list_;
  std::unique_ptr<Arrays> arrays_;
  std::vector<std::unique_ptr<Slot>> slots_;
  mutable std::mutex mutex_;
  GridStatistics statistics_;
};

}  // namespace clearway
