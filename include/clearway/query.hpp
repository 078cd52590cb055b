#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "clearway/body.hpp"
#include "clearway/box.hpp"
#include "clearway/model.hpp"
#include "clearway/pose.hpp"

namespace clearway {

/// What is asked of every environment point, whatever the model and the trajectory.
struct QueryParameters {
  double radius = 0;  ///< metres, > 0: a point strictly closer to the model collides
  /// Also for each colliding point the smallest index of a pose that touches it; between poses, of
  /// a pose i with the way from i to i + 1, both included, on which the model touches it.
  bool first_pose = false;
  bool between_poses = false;  ///< model points move on straight segments from pose to pose
  double clearance = 0;        ///< metres: distances below it are asked for too; 0: none
  /// Metres: of every pose the least distance below it is asked for, and the point; 0: none.
  double profile = 0;
  /// Metres: a point whose distance differs from the radius by no more may be answered wrongly; 0:
  /// none. Below the radius, and only without first poses, clearances and motion between poses.
  double tolerance = 0;
  /// Points of these classes are left out of the search, as if the scans did not have them. Only of
  /// an environment that has classes.
  std::vector<std::uint8_t> ignore_classes = {};
  /// So are points in these closed boxes, in the environment's coordinates and unit.
  std::vector<Box> ignore_boxes = {};

  bool ignores_points() const { return !ignore_classes.empty() || !ignore_boxes.empty(); }
  friend bool operator==(const QueryParameters&, const QueryParameters&) = default;
};

/// Which points of an environment lie within the search radius of the moving model?
struct Query : QueryParameters {
  Query() = default;
  Query(Model moved, std::vector<Pose> along, const QueryParameters& parameters)
      : QueryParameters(parameters), model(std::move(moved)), poses(std::move(along)) {}

  Model model;
  std::vector<Pose> poses;  ///< the path, where there are bodies
  /// Several models in the place of one, each with poses of its own; then there is no model. A
  /// first pose, a clearance's pose and a pose of the profile are of the path.
  std::vector<Body> bodies = {};
};

/// Whether the query's model has closed parts, or that of any of its bodies.
inline bool has_solids(const Query& query) {
  return query.model.is_solid() ||
         std::ranges::any_of(query.bodies, [](const Body& body) { return body.model.is_solid(); });
}

/// How many solids the model has, or all bodies together.
inline std::uint64_t solid_count(const Query& query) {
  std::uint64_t count = query.model.solid_count();
  for (const Body& body : query.bodies) count += body.model.solid_count();
  return count;
}

/// Model::spacing, or the greatest of all bodies, metres.
inline double model_spacing(const Query& query) {
  double spacing = query.model.spacing;
  for (const Body& body : query.bodies) spacing = std::max(spacing, body.model.spacing);
  return spacing;
}

}  // namespace clearway
