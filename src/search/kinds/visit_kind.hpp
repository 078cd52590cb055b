#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "core/query/ignored_points.hpp"
#include "search/kinds/page_engine_kind.hpp"
#include "search/query_trees.hpp"

namespace clearway {

/// A question that a visit asks of points.
struct VisitQuestion {
  /// The points that a question is asked of are those that are searched, those that are ignored, or
  /// those that collide by the first question of the visit.
  enum class Of { kSearched, kIgnored, kHits };

  const Query& query;
  Of of = Of::kSearched;
};

/// Makes the engine kind of a query with one model.
using MakeKind = std::function<std::unique_ptr<PageEngineKind>(const Query&)>;

/// The engines of a visit that asks several questions, or of a vehicle with bodies, on any device:
/// one engine with its own index for each question and body. The coordinates of a page are read
/// once, and lie in the page of the first engine.
class VisitKind final : public PageEngineKind {
 public:
  /// make: is called for every question and body, all of them on the same devices. What is referred
  /// to outlives this object.
  VisitKind(const PackedCloud& cloud, std::vector<VisitQuestion> questions, const MakeKind& make);

  /// The query of the first engine, because build_index() gets its trees.
  const Query& whose_trees(const Query&) const override { return lanes_.front()->query; }
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
    return lanes_.front()->kind->end(std::move(engines));
  }

 private:
  /// A body of a question, with the kind of its engine.
  struct Lane {
    std::size_t question, body;
    const Query& query;
    std::unique_ptr<PageEngineKind> kind;
    std::unique_ptr<QueryTrees> trees = {};  ///< none for the first lane
    const PoseReach* reach = nullptr;        ///< once there is an index
    /// The number of its first motion node, where nodes are numbered over all lanes
    std::uint32_t first_node = 0;
  };

  const Lane& lane_of(std::uint32_t node) const;
  PageEngineNeeds needs_of_lanes() const;
  SlotLayout layout_of(const Lane& lane, SlotLayout layout) const;
  bool depends(const Lane& lane) const {
    return lane.question > 0 && questions_[lane.question].of == VisitQuestion::Of::kHits;
  }

  const PackedCloud& cloud_;
  const std::vector<VisitQuestion> questions_;
  std::vector<std::vector<Query>> bodies_;  ///< of each question
  std::vector<std::unique_ptr<Lane>> lanes_;
};

/// The kind for these questions: that of the query itself where there is one of one model.
std::unique_ptr<PageEngineKind> visit_kind(const PackedCloud& cloud,
                                           std::vector<VisitQuestion> questions,
                                           const MakeKind& make);

}  // namespace clearway
