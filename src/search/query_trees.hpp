#pragma once

#include <cstdint>

#include "clearway/query.hpp"
#include "core/geometry/model_tree.hpp"
#include "core/geometry/solid_parts.hpp"
#include "core/geometry/triangle_box.hpp"
#include "core/trajectory/motion_tree.hpp"
#include "core/util/stopwatch.hpp"

namespace clearway {

/// The trees over a model's points or triangles and over the poses, with which every plan of a
/// query starts.
struct QueryTrees {
  /// The query outlives the trees. clock: started just before, for model_seconds.
  explicit QueryTrees(const Query& query, int threads = 1, const Stopwatch& clock = {})
      : model(query.model.is_surface() ? std::span<const Vec3>() : query.model.vertices, threads),
        triangles(triangles_of(query.model), threads),
        solids(query.model, threads),
        model_seconds(clock.seconds()),
        motion(query.poses, box(), query.between_poses, threads),
        motion_seconds(clock.seconds() - model_seconds) {}

  std::uint64_t allocated_bytes() const {
    return model.allocated_bytes() + triangles.allocated_bytes() + solids.allocated_bytes() +
           motion.allocated_bytes();
  }

  /// The model's box. The model is not empty.
  const Box& box() const { return triangles.size() > 0 ? triangles.box() : model.box(); }

  /// The tree over the model's elements.
  template <typename Element>
  const ModelTreeOf<StoredElement<Element>>& of() const {
    if constexpr (kIsTriangle<Element>) {
      return triangles;
    } else {
      return model;
    }
  }

  /// The model's solids, for a field of these elements; null where the elements are not of solids.
  template <typename Element>
  const SolidParts* solids_of() const {
    return kIsSolid<Element> ? &solids : nullptr;
  }

  ModelTree model;         ///< empty for a surface
  TriangleTree triangles;  ///< empty for a model of points
  SolidParts solids;       ///< empty where the surface has no solids
  double model_seconds;    ///< wall clock of the model's trees
  MotionTree motion;
  double motion_seconds;
};

}  // namespace clearway
