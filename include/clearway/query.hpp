#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "clearway/body.hpp"
#include "clearway/box.hpp"
#include "clearway/pose.hpp"
#include "clearway/vec3.hpp"

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
  Query(std::vector<Vec3> moved, std::vector<Pose> along, const QueryParameters& parameters)
      : QueryParameters(parameters), model(std::move(moved)), poses(std::move(along)) {}

  bool is_surface() const { return !triangles.empty(); }
  bool is_solid() const { return !solid_of.empty(); }  ///< then it is a surface too
  /// Itself, or any of its bodies.
  bool has_solids() const {
    return is_solid() || std::ranges::any_of(bodies, [](const Body& b) { return b.is_solid(); });
  }

  std::vector<Vec3> model;  ///< points, or corners of triangles; in the model's own frame, metres
  std::vector<Pose> poses;  ///< the path, where there are bodies
  /// Three indices into `model` each: the model is their surface. None: it is its points.
  std::vector<std::array<std::uint32_t, 3>> triangles;
  /// The number of each triangle's solid, from 0, or kNoSolid: what is inside collides too. The
  /// triangles of a solid are closed: each edge is used as often in one direction as in the other,
  /// by vertices of the same values. None: nothing has an inside.
  std::vector<std::uint32_t> solid_of = {};
  /// Metres. The model's points are samples of a mesh, and no place of its surface is farther than
  /// this from one of them; so the surface may come closer than the radius, by as much, to a point
  /// that does not collide. The answer says so. 0: the model is no sampled mesh.
  double model_spacing = 0;
  /// Several models in the place of one, each with poses of its own; then there is no model. A
  /// first pose, a clearance's pose and a pose of the profile are of the path.
  std::vector<Body> bodies = {};
};

/// Of a surface its triangles, otherwise the model's points.
inline std::uint64_t element_count(const Query& query) {
  return query.is_surface() ? query.triangles.size() : query.model.size();
}

inline std::uint64_t element_count(const Body& body) {
  return body.is_surface() ? body.triangles.size() : body.model.size();
}

/// How many solids the model has, or all bodies together.
inline std::uint64_t solid_count(const Query& query) {
  std::uint64_t count = solid_count(query.solid_of);
  for (const Body& body : query.bodies) count += solid_count(body.solid_of);
  return count;
}

/// Query::model_spacing, or the greatest of all bodies.
inline double model_spacing(const Query& query) {
  double spacing = query.model_spacing;
  for (const Body& body : query.bodies) spacing = std::max(spacing, body.model_spacing);
  return spacing;
}

}  // namespace clearway
