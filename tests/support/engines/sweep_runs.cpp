#include <algorithm>
#include <cstring>
#include <list>
#include <optional>

#include "core/geometry/solid_parts.hpp"
#include "core/geometry/triangle_box.hpp"
#include "core/sweep/tolerance.hpp"
#include "stream/plan.hpp"
#include "stream/run_pages.hpp"
#include "support/engines/answer_sets.hpp"
#include "support/engines/engines.hpp"

namespace clearway {
namespace {

template <typename Element>
std::vector<Element> elements_of(const Query& query) {
  if constexpr (kIsTriangle<Element>) {
    return triangles_of(query.model);
  } else {
    return query.model.vertices;
  }
}

/// A model with its tree and field, which many runs of a scene share.
template <typename Element>
class PreparedModel {
 public:
  /// radius: the greatest distance at which a point may be taken.
  PreparedModel(const Query& query, double radius, int threads, bool whole)
      : elements_(elements_of<Element>(query)),
        radius_(radius),
        reach_(reach_of(query)),
        threads_(threads),
        tree_(elements_),
        solids_(query.model),
        solid_of_(query.model.solid_of),
        whole_(whole),
        field_(tree_, radius_,
               {.reach = reach_,
                .by_need = !whole,
                .solids = query.model.is_solid() ? &solids_ : nullptr},
               threads) {}
  PreparedModel(const PreparedModel&) = delete;
  PreparedModel& operator=(const PreparedModel&) = delete;

  bool is_for(const Query& query, double radius, int threads, bool whole) const {
    return whole_ == whole && radius_ == radius && reach_ == reach_of(query) &&
           threads_ == threads && solid_of_ == query.model.solid_of &&
           std::ranges::equal(elements_, elements_of<Element>(query), same_bits);
  }
  const ModelTreeOf<Element>& tree() const { return tree_; }
  const ModelField& field() const { return field_; }

 private:
  static double reach_of(const Query& query) { return std::max(query.clearance, query.profile); }

  /// Whether two elements have the same bits, the sign of a zero included: only then are their
  /// fields the same.
  static bool same_bits(const Element& a, const Element& b) {
    return std::memcmp(&a, &b, sizeof a) == 0;
  }

  std::vector<Element> elements_;
  double radius_, reach_;
  int threads_;
  ModelTreeOf<Element> tree_;
  SolidParts solids_;
  std::vector<std::uint32_t> solid_of_;
  bool whole_;
  ModelField field_;
};

/// The prepared model of a query: that of one of the last four runs with another model where it is
/// the same, otherwise a new one. Valid until the next call.
template <typename Element>
const PreparedModel<Element>& prepared_model(const Query& query, double radius, int threads,
                                             bool whole) {
  static std::list<PreparedModel<Element>> last;
  for (const PreparedModel<Element>& model : last) {
    if (model.is_for(query, radius, threads, whole)) return model;
  }
  if (last.size() == 4) last.pop_back();
  return last.emplace_front(query, radius, threads, whole);
}

template <typename Element>
SearchResult run_sweep_of(const PackedCloud& cloud, const Query& asked, int threads,
                          double tolerance, const MakeSweep::Of<Element>& make, bool whole_field) {
  NoProgress progress;
  std::optional<ThinnedQuery> thinned;
  if (tolerance > 0) thinned.emplace(asked, tolerance);
  const Query& query = thinned ? thinned->query() : asked;
  if (query.model.empty()) {
    return {HitSet(cloud.entry_count(), query.first_pose), ClearanceSet(cloud.entry_count())};
  }
  using Stored = StoredElement<Element>;
  const PreparedModel<Stored>& prepared =
      prepared_model<Stored>(query, search_radius(query.radius, tolerance), threads, whole_field);
  const ModelTreeOf<Stored>& model = prepared.tree();
  const ModelField& field = prepared.field();
  const MotionTree motion(query.poses, model.box(), query.between_poses);
  const SweepFilterOf<Element> filter(query, motion, model, field, cloud, 1, tolerance);
  const std::vector<PlannedCell> cells = plan(cloud, filter);
  const bool masked = asked.ignores_points();
  const SlotLayout layout{.slots = 1 + static_cast<std::uint32_t>(cells.size() % 5),
                          .page_bytes = 2 * smallest_page_bytes(cloud, cells, masked),
                          .cells = 1 + static_cast<std::uint32_t>(cells.size() % 3)};
  const std::unique_ptr<PageEngine> engine = make(filter, cloud, layout);
  PageEngine* const engines[] = {engine.get()};
  StageTimes times;
  const auto pages = paginate(cloud, cells, layout.page_bytes, layout.cells, masked);
  return run_pages(cloud, cells, pages, engines, query, threads, progress, times);
}

}  // namespace

SearchResult run_sweep(const PackedCloud& cloud, const Query& query, int threads, double tolerance,
                       const MakeSweep& make, bool whole_field) {
  if (query.model.is_solid()) {
    return run_sweep_of<SolidTriangle>(cloud, query, threads, tolerance, make.solids, whole_field);
  }
  return query.model.is_surface()
             ? run_sweep_of<Triangle>(cloud, query, threads, tolerance, make.triangles, whole_field)
             : run_sweep_of<Vec3>(cloud, query, threads, tolerance, make.points, whole_field);
}

}  // namespace clearway
