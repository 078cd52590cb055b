#include "search/kinds/sweep_kind.hpp"

#include <algorithm>
#include <cmath>

#include "core/trajectory/chainage.hpp"
#include "core/util/format.hpp"
#include "cpu/sweep_engine.hpp"

namespace clearway {
namespace {

/// The index size of a field with this many mebibytes. While it is built, the coarse lattice adds a
/// quarter.
constexpr PageEngineKind::IndexSize size_of(std::uint64_t mebibytes) {
  const std::uint64_t bytes = mebibytes << 20;
  return {bytes, bytes + bytes / 4};
}

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

/// The least number of poses, and of environment points for each model point, for which the model
/// field gets its full fineness (docs/design/sweep.md, "Field by need").
constexpr double kPosesOfFullFineness = 1000;
constexpr double kPointsOfFullFineness = 200;
constexpr double kLeastFineness = 0.25;

}  // namespace

template <typename Element>
std::vector<PageEngineKind::IndexSize> SweepKindOf<Element>::index_sizes() const {
  constexpr std::uint64_t kMost = std::uint64_t{64} << 20, kLeast = std::uint64_t{1} << 20;
  if (settings_.field_voxel > 0) return {{kMost, 0}};
  return {size_of(64), size_of(16), size_of(4), {kLeast, 0}};
}

template <typename Element>
const PoseReach& SweepKindOf<Element>::build_index(const QueryTrees& trees,
                                                   std::uint64_t most_bytes) {
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
                        .by_need = !this->needs().on_gpu},
      options_.threads);
  return filter_.emplace(query_, trees.motion, trees.of<Element>(), *field_, cloud_,
                         QueryTrees::threads_for_poses(query_, options_.threads));
}

/// The fineness of the field, which is coarser for few poses and, on the CPU, for a small scan
/// beside a model of many points, because few exact tests are spared then by a field that costs
/// more to make. It is not coarser with clearances or a profile, which ask more of it.
template <typename Element>
double SweepKindOf<Element>::fineness_for_query() const {
  if (query_.clearance > 0 || query_.profile > 0) return fineness_;
  const auto poses = static_cast<double>(query_.poses.size());
  const double share = std::min(poses / kPosesOfFullFineness, 1.0) * share_of_points();
  return fineness_ * std::max(std::cbrt(share), kLeastFineness);
}

template <typename Element>
void SweepKindOf<Element>::log_index(const MessageLog& log) const {
  log.note("model field: voxel " + format_brief(field_->voxel()) + " m, " +
           format_count(field_->bricks()) + " bricks, " + format_size(field_->allocated_bytes()));
}

template <typename Element>
void SweepKindOf<Element>::log_statistics(const SweepStatistics& s, const MessageLog& log) {
  log.note("tests: " + format_count(s.node_tests) + " of boxes, " + format_count(s.point_tests) +
           " of points (" + format_count(s.points_tested) + " points), " +
           format_count(s.exact_tests) + " exact");
}

template <typename Element>
CpuSweepKindOf<Element>::CpuSweepKindOf(const PackedCloud& cloud, const Query& query,
                                        const SearchOptions& options,
                                        const EngineSettings& settings)
    : SweepKindOf<Element>({.most_slots = static_cast<std::uint32_t>(options.threads) + kSlotsAhead,
                            .threads = options.threads},
                           cloud, query, options, cpu_fineness<Element>(query), settings) {}

template <typename Element>
double CpuSweepKindOf<Element>::share_of_points() const {
  if constexpr (kIsTriangle<Element>) return 1;
  const auto points = static_cast<double>(cloud_.point_count());
  const auto model_points = static_cast<double>(query_.model.vertices.size());
  return std::min(points / (kPointsOfFullFineness * model_points), 1.0);
}

template <typename Element>
std::uint64_t CpuSweepKindOf<Element>::host_bytes(const SlotLayout& layout,
                                                  std::uint64_t most_poses) const {
  const auto threads = static_cast<std::uint32_t>(options_.threads);
  return layout.slots * PagePool::slot_bytes(cloud_, query_, layout) +
         std::min(layout.slots, threads) *
             (CellSearchOf<Element>::most_bytes(cloud_, query_, most_poses) +
              ProfileWalkOf<Element>::most_bytes(cloud_, query_, most_poses)) +
         SweepEngineOf<Element>::profile_bytes(cloud_, query_, layout, most_poses);
}

template <typename Element>
PageEngines CpuSweepKindOf<Element>::make(const SlotLayout& layout) {
  PageEngines engines;
  engines.push_back(
      std::make_unique<SweepEngineOf<Element>>(cloud_, *filter_, layout, this->of_session_));
  return engines;
}

template <typename Element>
void CpuSweepKindOf<Element>::report_search(EngineList engines, SearchReport&,
                                            const MessageLog& log) const {
  this->log_statistics(dynamic_cast<const SweepEngineOf<Element>&>(*engines.front()).statistics(),
                       log);
}

template class SweepKindOf<Vec3>;
template class SweepKindOf<Triangle>;
template class SweepKindOf<SolidTriangle>;

std::unique_ptr<PageEngineKind> cpu_sweep_kind(const PackedCloud& cloud, const Query& query,
                                               const SearchOptions& options,
                                               const EngineSettings& settings) {
  if (query.model.is_solid()) {
    return std::make_unique<CpuSweepKindOf<SolidTriangle>>(cloud, query, options, settings);
  }
  if (query.model.is_surface()) {
    return std::make_unique<CpuSweepKindOf<Triangle>>(cloud, query, options, settings);
  }
  return std::make_unique<CpuSweepKindOf<Vec3>>(cloud, query, options, settings);
}

template class CpuSweepKindOf<Vec3>;
template class CpuSweepKindOf<Triangle>;
template class CpuSweepKindOf<SolidTriangle>;

}  // namespace clearway
