#pragma once

#include <optional>

#include "core/cloud/packed_cloud.hpp"
#include "core/sweep/field/model_field.hpp"
#include "core/sweep/sweep_filter.hpp"
#include "search/kinds/page_engine_kind.hpp"

namespace clearway {

/// What the sweep engine's kinds for CPU and GPU share: the model field and the filter over it.
/// Element: what the model consists of, which is points, triangles or triangles of solids.
template <typename Element>
class SweepKindOf : public PageEngineKind {
 public:
  /// options.threads is not 0. fineness: the field's (core/sweep/field/model_field.hpp). All
  /// references outlive it.
  SweepKindOf(PageEngineNeeds needs, const PackedCloud& cloud, const Query& query,
              const SearchOptions& options, double fineness, const EngineSettings& settings)
      : PageEngineKind(std::move(needs)),
        cloud_(cloud),
        query_(query),
        options_(options),
        fineness_(fineness),
        settings_(settings) {}

  std::vector<IndexSize> index_sizes() const override;
  const PoseReach& build_index(const QueryTrees& trees, std::uint64_t most_bytes) override;
  std::uint64_t index_bytes() const override {
    return field_->allocated_bytes() + filter_->allocated_bytes();
  }
  void log_index(const MessageLog& log) const override;

  static void log_statistics(const SweepStatistics& statistics, const MessageLog& log);

 protected:
  const PackedCloud& cloud_;
  const Query& query_;
  const SearchOptions& options_;
  std::shared_ptr<const ModelField> field_;
  std::optional<SweepFilterOf<Element>> filter_;
  bool of_session_ = false;  ///< whether there are questions to come, as build_index() learns

 private:
  double fineness_for_query() const;
  /// How many environment points there are for each point of the model, as a share of those for
  /// which a field of full fineness pays; 1 where that does not matter.
  virtual double share_of_points() const { return 1; }

  double fineness_;
  EngineSettings settings_;
};

template <typename Element>
class CpuSweepKindOf : public SweepKindOf<Element> {
 public:
  CpuSweepKindOf(const PackedCloud& cloud, const Query& query, const SearchOptions& options,
                 const EngineSettings& settings);

  std::uint64_t host_bytes(const SlotLayout& layout, std::uint64_t most_poses) const override;
  PageEngines make(const SlotLayout& layout) override;
  void report_search(EngineList engines, SearchReport& report,
                     const MessageLog& log) const override;

 private:
  double share_of_points() const override;

  using SweepKindOf<Element>::cloud_;
  using SweepKindOf<Element>::query_;
  using SweepKindOf<Element>::options_;
  using SweepKindOf<Element>::filter_;
};

std::unique_ptr<PageEngineKind> cpu_sweep_kind(const PackedCloud& cloud, const Query& query,
                                               const SearchOptions& options,
                                               const EngineSettings& settings = {});

extern template class SweepKindOf<Vec3>;
extern template class SweepKindOf<Triangle>;
extern template class SweepKindOf<SolidTriangle>;
extern template class CpuSweepKindOf<Vec3>;
extern template class CpuSweepKindOf<Triangle>;
extern template class CpuSweepKindOf<SolidTriangle>;

}  // namespace clearway
