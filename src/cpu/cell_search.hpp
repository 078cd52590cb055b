#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/cloud/block_positions.hpp"
#include "core/cloud/packed_cloud.hpp"
#include "core/page/page.hpp"
#include "core/sweep/block_descent.hpp"
#include "core/sweep/clearance_search.hpp"
#include "core/sweep/sweep_filter.hpp"

namespace clearway {

/// The sweep engine's descent within the cells of a page, one cell after another.
template <typename Element>
class CellSearchOf {
 public:
  /// The arrays that the answer of a cell goes to, as in PageResult. First poses and clearances are
  /// empty if not asked for.
  struct Output {
    std::span<std::uint64_t> hits;
    std::span<std::uint32_t> first_poses;
    std::span<Clearance> clearances;
  };

  /// Cloud and filter must outlive this object.
  CellSearchOf(const PackedCloud& cloud, const SweepFilterOf<Element>& filter)
      : cloud_(cloud), filter_(filter), descent_(filter) {}

  void run(const PageRef& page, std::uint32_t index, const Output& output);

  /// Counts of the searches since the last call.
  SweepStatistics take_statistics();

  /// Greatest memory that it allocates, bytes. most_poses: greatest number of poses that the nodes
  /// of a cell have together.
  static std::uint64_t most_bytes(const PackedCloud& cloud, const Query& query,
                                  std::uint64_t most_poses);

 private:
  QuantumBox box_of(std::uint32_t first, std::uint32_t count) const;
  bool has_points(std::uint32_t first, std::uint32_t count) const;
  void search_blocks(std::uint32_t first, std::uint32_t count, std::span<const std::uint32_t> nodes,
                     std::size_t depth);
  void mark_all(std::uint32_t block);
  void search_points(std::uint32_t block, std::span<const std::uint32_t> nodes);
  bool search_clearance(const Vec3& e, std::uint32_t index);

  const PackedCloud& cloud_;
  const SweepFilterOf<Element>& filter_;
  const PageCell* cell_ = nullptr;
  PageRef page_{};
  std::uint32_t index_ = 0;  ///< index of the cell in the page
  const BlockBox* blocks_ = nullptr;
  std::array<PackedChunk<std::int32_t>, 3> chunks_;
  Output output_;
  std::size_t poses_ = 0;  ///< number of poses that the cell's nodes have together
  std::vector<std::vector<std::uint32_t>> lists_;  ///< open motion nodes, one list for each depth
  std::vector<std::uint32_t> joined_;              ///< motion nodes for clearances
  BlockDescentOf<Element> descent_;
  std::optional<ClearanceSearchOf<Element>> clearance_search_;
  SweepStatistics statistics_;
};

using CellSearch = CellSearchOf<Vec3>;

extern template class CellSearchOf<Vec3>;
extern template class CellSearchOf<Triangle>;
extern template class CellSearchOf<SolidTriangle>;

/// Number of poses that motion nodes have together.
std::uint64_t pose_count(const MotionTree& motion, std::span<const std::uint32_t> nodes);

}  // namespace clearway
