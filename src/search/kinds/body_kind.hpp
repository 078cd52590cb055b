#pragma once

#include <memory>
#include <vector>

#include "search/kinds/sweep_kind.hpp"
#include "search/query_trees.hpp"

namespace clearway {

/// The sweep on the CPU of a query with bodies: a model field and trees for each of them.
class CpuBodyKind final : public PageEngineKind {
 public:
  /// options.threads is not 0. All references outlive it.
  CpuBodyKind(const StoreReader& store, const Query& query, const SearchOptions& options);

  /// The trees that it is given are those of the first body.
  const Query& whose_trees(const Query&) const override { return queries_.front(); }
  std::vector<IndexSize> index_sizes() const override;
  const PoseReach& build_index(const QueryTrees& trees, std::uint64_t most_bytes) override;
  std::vector<PlannedCell> plan_cells(const PackedCloud& cloud,
                                      const PoseReach& reach) const override;
  std::uint64_t most_poses(const MotionTree& motion,
                           std::span<const PlannedCell> cells) const override;
  std::uint64_t index_bytes() const override;
  std::uint64_t host_bytes(const SlotLayout& layout, std::uint64_t most_poses) const override;
  void report_index(SearchReport& report, const MessageLog& log) const override;
  PageEngines make(const SlotLayout& layout) override;
  void report_search(const PageEngines& engines, SearchReport& report,
                     const MessageLog& log) const override;

 private:
  const StoreReader& store_;
  const Query& query_;
  const SearchOptions& options_;
  std::vector<Query> queries_;                           ///< by body
  std::vector<std::unique_ptr<QueryTrees>> trees_;       ///< of all bodies but the first
  std::vector<std::unique_ptr<PageEngineKind>> sweeps_;  ///< by body
  std::vector<const PoseReach*> reaches_;                ///< likewise, once there is an index
  std::vector<std::uint32_t> first_nodes_;               ///< of each body's motion nodes
};

}  // namespace clearway
