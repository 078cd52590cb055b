#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/cloud/packed_cloud.hpp"
#include "core/sweep/field/model_field.hpp"
#include "core/sweep/sweep_filter.hpp"
#include "core/trajectory/chainage.hpp"
#include "core/util/format.hpp"
#include "cpu/sweep_engine.hpp"
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

  std::vector<IndexSize> index_sizes() const override {
    constexpr std::uint64_t kMost = std::uint64_t{64} << 20, kLeast = std::uint64_t{1} << 20;
    if (settings_.field_voxel > 0) return {{kMost, 0}};
    // While a field is built, the coarse lattice adds a quarter.
    const auto size = [](std::uint64_t bytes) { return IndexSize{bytes, bytes + bytes / 4}; };
    return {size(kMost), size(kMost / 4), size(kMost / 16), {kLeast, 0}};
  }

  const PoseReach& build_index(const QueryTrees& trees, std::uint64_t most_bytes) override {
    of_session_ = trees.of_session;
    filter_.reset();
    field_.reset();
    field_ = trees.model->field<Element>(
        query_.radius,
        ModelFieldOptions{.voxel = settings_.field_voxel,
                          .fineness = trees.of_session ? fineness_ : fineness_for_query(),
                          .cheaply_finer = true,
                          .reach = std::max(query_.clearance, query_.profile),
                          .most_bytes = most_bytes,
                          .by_need = !needs().on_gpu},
        options_.threads);
    return filter_.emplace(query_, trees.motion, trees.of<Element>(), *field_, cloud_,
                           QueryTrees::threads_for_poses(query_, options_.threads));
  }

  std::uint64_t index_bytes() const override {
    return field_->allocated_bytes() + filter_->allocated_bytes();
  }

  void log_index(const MessageLog& log) const override {
    log.note("model field: voxel " + format_brief(field_->voxel()) + " m, " +
             format_count(field_->bricks()) + " bricks, " + format_size(field_->allocated_bytes()));
  }

  static void log_statistics(const SweepStatistics& s, const MessageLog& log) {
    log.note("tests: " + format_count(s.node_tests) + " of boxes, " + format_count(s.point_tests) +
             " of points (" + format_count(s.points_tested) + " points), " +
             format_count(s.exact_tests) + " exact");
  }

 protected:
  const PackedCloud& cloud_;
  const Query& query_;
  const SearchOptions& options_;
  std::shared_ptr<const ModelField> field_;
  std::optional<SweepFilterOf<Element>> filter_;
  bool of_session_ = false;  ///< whether there are questions to come, as build_index() learns

 private:
  /// The fineness of the field, which is coarser for few poses and, on the CPU, for a small scan
  /// beside a model of many points, because few exact tests are spared then by a field that costs
  /// more to make. It is not coarser with clearances or a profile, which ask more of it
  /// (docs/design/sweep.md, "Field by need").
  double fineness_for_query() const {
    constexpr double kPosesOfFullFineness = 1000, kLeastFineness = 0.25;
    if (query_.clearance > 0 || query_.profile > 0) return fineness_;
    const auto poses = static_cast<double>(query_.poses.size());
    const double share = std::min(poses / kPosesOfFullFineness, 1.0) * share_of_points();
    return fineness_ * std::max(std::cbrt(share), kLeastFineness);
  }

  /// How many environment points there are for each point of the model, as a share of those for
  /// which a field of full fineness pays; 1 where that does not matter.
  virtual double share_of_points() const { return 1; }

  double fineness_;
  EngineSettings settings_;
};

/// Fineness of the field on the CPU, where the field decides which points need a search of the
/// model at a pose. Clearances search the model once for many poses, so they gain nothing. A
/// profile examines all points near the model at every pose; the less the model moves from pose to
/// pose, the longer its bounds last, and a still finer field pays (measured).
template <typename Element>
double cpu_fineness(const Query& query) {
  if (kIsTriangle<Element>) return 1;
  if (query.profile > 0) {
    const auto poses = static_cast<double>(query.poses.size());
    return path_length(query.poses) <= query.profile * poses ? 3 : 2;
  }
  return query.clearance > 0 && !query.first_pose ? 1 : 2;
}

template <typename Element>
class CpuSweepKindOf : public SweepKindOf<Element> {
 public:
  CpuSweepKindOf(const PackedCloud& cloud, const Query& query, const SearchOptions& options,
                 const EngineSettings& settings)
      : SweepKindOf<Element>(cpu_needs(options), cloud, query, options,
                             cpu_fineness<Element>(query), settings) {}

  std::uint64_t host_bytes(const SlotLayout& layout, std::uint64_t most_poses) const override {
    const auto threads = static_cast<std::uint32_t>(options_.threads);
    return layout.slots * PagePool::slot_bytes(cloud_, query_, layout) +
           std::min(layout.slots, threads) *
               (CellSearchOf<Element>::most_bytes(cloud_, query_, most_poses) +
                ProfileWalkOf<Element>::most_bytes(cloud_, query_, most_poses)) +
           SweepEngineOf<Element>::profile_bytes(cloud_, query_, layout, most_poses);
  }
  PageEngines make(const SlotLayout& layout) override {
    return only(
        std::make_unique<SweepEngineOf<Element>>(cloud_, *filter_, layout, this->of_session_));
  }
  void report_search(EngineList engines, SearchReport&, const MessageLog& log) const override {
    this->log_statistics(dynamic_cast<const SweepEngineOf<Element>&>(*engines.front()).statistics(),
                         log);
  }

 private:
  double share_of_points() const override {
    constexpr double kPointsOfFullFineness = 200;
    if constexpr (kIsTriangle<Element>) return 1;
    const auto points = static_cast<double>(cloud_.point_count());
    const auto model_points = static_cast<double>(query_.model.vertices.size());
    return std::min(points / (kPointsOfFullFineness * model_points), 1.0);
  }

  using SweepKindOf<Element>::cloud_;
  using SweepKindOf<Element>::query_;
  using SweepKindOf<Element>::options_;
  using SweepKindOf<Element>::filter_;
};

}  // namespace clearway
