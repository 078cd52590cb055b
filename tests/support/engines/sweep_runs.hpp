#pragma once

#include <algorithm>
#include <list>
#include <memory>
#include <optional>

#include "core/geometry/solid_parts.hpp"
#include "core/geometry/triangle_box.hpp"
#include "core/sweep/sweep_filter.hpp"
#include "stream/plan.hpp"
#include "support/engines/answer_sets.hpp"

namespace clearway {

/// A model with its tree and field, which many runs of a scene share.
template <typename Element>
struct PreparedModel {
  /// most: the greatest distance at which a point may be taken. asked: the greatest distance that
  /// is asked for. at_once: makes all of the field now.
  PreparedModel(const Model& of, double most, double asked, bool at_once, int threads)
      : model(of),
        radius(most),
        reach(asked),
        whole(at_once),
        tree(elements_of(model)),
        solids(model),
        field(tree, radius,
              {.reach = reach, .by_need = !whole, .solids = model.is_solid() ? &solids : nullptr},
              threads) {}
  PreparedModel(const PreparedModel&) = delete;
  PreparedModel& operator=(const PreparedModel&) = delete;

  static std::vector<Element> elements_of(const Model& model) {
    if constexpr (kIsTriangle<Element>) {
      return triangles_of(model);
    } else {
      return model.vertices;
    }
  }

  /// The prepared model of one of the last four runs with another model where it is the same,
  /// otherwise a new one. Valid until the next call.
  static const PreparedModel& of(const Query& query, bool at_once, int threads) {
    static std::list<PreparedModel> last;
    const double asked = std::max(query.clearance, query.profile);
    for (const PreparedModel& one : last) {
      if (one.radius == query.radius && one.reach == asked && one.whole == at_once &&
          one.model == query.model) {
        return one;
      }
    }
    if (last.size() == 4) last.pop_back();
    return last.emplace_front(query.model, query.radius, asked, at_once, threads);
  }

  Model model;
  double radius, reach;
  bool whole;
  ModelTreeOf<Element> tree;
  SolidParts solids;
  ModelField field;
};

template <typename Element, typename Make>
SearchResult run_sweep_of(const PackedCloud& cloud, const Query& query, int threads,
                          const Make& make, bool whole_field) {
  if (query.model.empty()) return empty_result(cloud, query);
  const auto& prepared = PreparedModel<StoredElement<Element>>::of(query, whole_field, threads);
  const MotionTree motion(query.poses, prepared.tree.box(), query.between_poses);
  const SweepFilterOf<Element> filter(query, motion, prepared.tree, prepared.field, cloud);
  const std::vector<PlannedCell> cells = plan(cloud, filter);
  const bool masked = query.ignores_points();
  const SlotLayout layout{.slots = 1 + static_cast<std::uint32_t>(cells.size() % 5),
                          .page_bytes = 2 * smallest_page_bytes(cloud, cells, masked),
                          .cells = 1 + static_cast<std::uint32_t>(cells.size() % 3)};
  const std::unique_ptr<PageEngine> engine = make(filter, cloud, layout);
  PageEngine* const engines[] = {engine.get()};
  NoProgress progress;
  StageTimes times;
  const auto pages = paginate(cloud, cells, layout.page_bytes, layout.cells, masked);
  return run_pages(cloud, cells, pages, engines, query, threads, progress, times);
}

/// Plans the query, and runs it in an engine whose numbers of slots and of cells a page follow from
/// the cloud's size, so that all of them occur. make: makes an engine from a filter of points, of
/// triangles or of solids, which outlives it. whole_field: for an engine that cannot make parts of
/// the field.
template <typename Make>
SearchResult run_sweep(const PackedCloud& cloud, const Query& query, int threads, const Make& make,
                       bool whole_field = false) {
  if (query.model.is_solid()) {
    return run_sweep_of<SolidTriangle>(cloud, query, threads, make, whole_field);
  }
  return query.model.is_surface() ? run_sweep_of<Triangle>(cloud, query, threads, make, whole_field)
                                  : run_sweep_of<Vec3>(cloud, query, threads, make, whole_field);
}

}  // namespace clearway
