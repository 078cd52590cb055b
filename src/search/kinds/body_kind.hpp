#pragma once

#include <memory>
#include <vector>

#include "search/kinds/cuda_kind.hpp"
#include "search/kinds/page_engine_kind.hpp"
#include "search/query_trees.hpp"

namespace clearway {

/// The sweep of a query with bodies: one engine with its own index for each body, on any device.
class BodyKind final : public PageEngineKind {
 public:
  using Kinds = std::vector<std::unique_ptr<PageEngineKind>>;

  /// query: the query with all bodies. queries, kinds: the query and the engine kind of each body
  /// by itself, all on the same devices. What is referred to outlives this object.
  BodyKind(const PackedCloud& cloud, const Query& query, std::vector<Query> queries, Kinds kinds);

  /// The query of the first body, because build_index() gets that body's trees.
  const Query& whose_trees(const Query&) const override { return queries_.front(); }
  std::vector<IndexSize> index_sizes() const override;
  const PoseReach& build_index(const QueryTrees& trees, std::uint64_t most_bytes) override;
  std::vector<PlannedCell> plan_cells(const PackedCloud& cloud,
                                      const PoseReach& reach) const override;
  std::uint64_t most_poses(const MotionTree& motion,
                           std::span<const PlannedCell> cells) const override;
  void resolve_devices() override;
  std::uint64_t index_bytes() const override;
  std::uint64_t host_bytes(const SlotLayout& layout, std::uint64_t most_poses) const override;
  std::uint64_t device_bytes(const SlotLayout& layout) const override;
  void log_index(const MessageLog& log) const override;
  PageEngines make(const SlotLayout& layout) override;
  void report_search(EngineList engines, SearchReport& report,
                     const MessageLog& log) const override;
  EngineEnd end(PageEngines engines) const override {
    return kinds_.front()->end(std::move(engines));
  }

 private:
  const PackedCloud& cloud_;
  const Query& query_;
  const std::vector<Query> queries_;
  const Kinds kinds_;
  std::vector<std::unique_ptr<QueryTrees>> trees_;  ///< trees of all bodies except the first
  /// The reach of each body, once there is an index.
  std::vector<const PoseReach*> reaches_;
  /// The number of each body's first motion node, where nodes are numbered over all bodies.
  std::vector<std::uint32_t> first_nodes_;
};

/// The sweep of a query with bodies on the CPU. options.threads is not 0. All references outlive
/// it.
std::unique_ptr<PageEngineKind> cpu_body_kind(const PackedCloud& cloud, const Query& query,
                                              const SearchOptions& options);

/// The CUDA engines of a query with bodies, made as by cuda_kind(). `open` is called for every
/// body, and always chooses the same GPUs.
std::unique_ptr<PageEngineKind> cuda_body_kind(const PackedCloud& cloud, const Query& query,
                                               const SearchOptions& options, const OpenGpus& open,
                                               KeptOnGpus* kept = nullptr);

}  // namespace clearway
