#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/cloud/packed_cloud.hpp"
#include "core/page/page.hpp"
#include "core/sweep/clearance_search.hpp"
#include "core/sweep/sweep_filter.hpp"

namespace clearway {

/// The sweep engine's descent within one cell of a page after the other.
template <typename Element>
class CellSearchOf {
 public:
  /// Where the answer of a cell goes: see PageResult. Poses and clearances only where asked for.
  struct Output {
    std::span<std::uint64_t> hits;
    std::span<std::uint32_t> first_poses;
    std::span<Clearance> clearances;
  };

  /// Both outlive it.
  CellSearchOf(const PackedCloud& cloud, const SweepFilterOf<Element>& filter)
      : cloud_(cloud), filter_(filter) {}

  void run(const PageRef& page, std::uint32_t index, const Output& output);

  /// Of the searches since the last call.
  SweepStatistics take_statistics();

  /// The most that it allocates, bytes; most_poses: of the nodes of any cell.
  static std::uint64_t most_bytes(const PackedCloud& cloud, const Query& query,
                                  std::uint64_t most_poses);

 private:
  QuantumBox box_of(std::uint32_t first, std::uint32_t count) const;
  bool has_points(std::uint32_t first, std::uint32_t count) const;
  void search_blocks(std::uint32_t first, std::uint32_t count, std::span<const std::uint32_t> nodes,
                     std::size_t depth);
  void mark_all(std::uint32_t block);
  void search_points(std::uint32_t block, std::span<const std::uint32_t> nodes);
  bool search_hit(const Vec3& e, std::uint32_t index, std::span<const std::uint32_t> nodes);
  bool search_clearance(const Vec3& e, std::uint32_t index);

  const PackedCloud& cloud_;
  const SweepFilterOf<Element>& filter_;
  const PageCell* cell_ = nullptr;
  PageRef page_{};
  std::uint32_t index_ = 0;  ///< of the cell, in the page
  const BlockBox* blocks_ = nullptr;
  std::array<PackedChunk<std::int32_t>, 3> chunks_;
  Output output_;
  std::size_t poses_ = 0;                          ///< that the cell's nodes have together
  std::vector<std::vector<std::uint32_t>> lists_;  ///< of open motion nodes, one a depth
  std::vector<std::uint32_t> joined_;              ///< motion nodes for clearances
  std::vector<std::uint32_t> runs_;  ///< of the block, where one of its points grazes the model
  bool is_grazed_ = false;           ///< whether that is so
  std::optional<ClearanceSearchOf<Element>> clearance_search_;
  SweepStatistics statistics_;
};

using CellSearch = CellSearchOf<Vec3>;

extern template class CellSearchOf<Vec3>;
extern template class CellSearchOf<Triangle>;
extern template class CellSearchOf<SolidTriangle>;

/// How many poses motion nodes have together.
std::uint64_t pose_count(const MotionTree& motion, std::span<const std::uint32_t> nodes);

}  // namespace clearway
