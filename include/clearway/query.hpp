#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "clearway/body.hpp"
#include "clearway/box.hpp"
#include "clearway/model.hpp"
#include "clearway/pose.hpp"

namespace clearway {

/// The question about every environment point, whatever the model and the trajectory.
struct QueryParameters {
  double radius = 0;  ///< metres, > 0: points strictly closer than this to the model collide
  /// Whether to find for each colliding point the smallest index of a pose that touches it. Between
  /// poses, index i stands for the way from pose i to i + 1, both included, on which the model
  /// touches it.
  bool first_pose = false;
  bool between_poses = false;  ///< whether model points move on straight segments from pose to pose
  double clearance = 0;        ///< metres: distances of points below it are asked for too; 0: none
  /// Metres: asks for the least distance of every pose, and the point that has it, if the distance
  /// is below this; 0: no profile.
  double profile = 0;
  /// Height in each body's frame, metres: a point counts at a pose only if it lies at this height
  /// or above, seen from the body there. What is lower, such as the ground that the wheels stand
  /// on, is counted but not judged. Between poses it has to lie so at either end of the way.
  std::optional<double> floor = {};
  /// Whether to find for each colliding point the nearest point of the environment that is free:
  /// one that neither collides, with or without a floor, nor is ignored. Needs all cells of an
  /// environment that holds the whole scans, so it cannot be asked of a shard.
  bool depth = false;
  /// Classes whose points are left out of the search, as if the scans did not have them. Only for
  /// an environment that has classes.
  std::vector<std::uint8_t> ignore_classes = {};
  /// Closed boxes, in the environment's coordinates and unit, whose points are left out of the
  /// search.
  std::vector<Box> ignore_boxes = {};

  /// Whether to find which places that the model sweeps no beam of the scanner passed through. Only
  /// for an environment that knows where its scanner stood.
  bool seen = false;
  /// Side of the cubes in which seen space is judged, metres; 0: 0.2 m.
  double seen_cube = 0;
  /// Groups of fewer unseen cubes than this are counted, but make no verdict undecided.
  std::uint32_t seen_min = 8;

  // The error budget, by which a verdict says how sure it is. It applies where any of the five
  // errors is given, be it 0.
  /// Standard deviation per axis of single points of the scan, metres
  std::optional<double> error_scan = {};
  /// Standard deviation per axis of where whole scans lie, metres
  std::optional<double> error_registration = {};
  std::optional<double> error_pose = {};   ///< standard deviation per axis of each pose, metres
  std::optional<double> error_angle = {};  ///< standard deviation per axis of each pose, radians
  /// Metres: no place of the true vehicle is farther than this from its model.
  std::optional<double> error_model = {};
  double sigmas = 3;  ///< how many standard deviations a budget counts
  /// Metres: points at most this far apart hang together when a budget decides about a conflict; 0:
  /// 0.3 m. A result with a budget has the length that was used, in the environment's unit.
  double gap = 0;

  /// Whether any error is given, so that the verdict is decided with a budget.
  bool has_budget() const {
    return error_scan || error_registration || error_pose || error_angle || error_model;
  }
  bool ignores_points() const { return !ignore_classes.empty() || !ignore_boxes.empty(); }
  friend bool operator==(const QueryParameters&, const QueryParameters&) = default;
};

/// A whole question: which points of an environment lie within the search radius of this moving
/// model?
struct Query : QueryParameters {
  Query() = default;
  Query(Model moved, std::vector<Pose> along, const QueryParameters& parameters)
      : QueryParameters(parameters), model(std::move(moved)), poses(std::move(along)) {}

  Model model;
  std::vector<Pose> poses;  ///< poses of the model, or of the path if there are bodies
  /// Several models in the place of one, each with poses of its own; then `model` is empty. First
  /// poses, poses of clearances and poses of the profile are indices of the path.
  std::vector<Body> bodies = {};
};

/// A rigid part of what a query moves: its model, or one of its bodies. What it refers to must
/// outlive it.
struct MovingBody {
  std::string_view name;  ///< empty for the model of a query without bodies
  const Model& model;
  std::span<const Pose> poses;
  /// For each of `poses`, the index of the pose of the path that it belongs to, ascending; empty if
  /// the poses are those of the path.
  std::span<const std::uint32_t> path_pose = {};
  std::optional<double> floor = {};  ///< its own, or that of the query

  /// Its pose at a pose of the path; nullptr if it has none there.
  const Pose* pose_at(std::uint32_t pose) const {
    if (path_pose.empty()) return pose < poses.size() ? &poses[pose] : nullptr;
    const auto at = std::ranges::lower_bound(path_pose, pose);
    if (at == path_pose.end() || *at != pose) return nullptr;
    return &poses[static_cast<std::size_t>(at - path_pose.begin())];
  }
};

/// What moves along a path: the bodies, or the model as the only one if there are none.
inline std::vector<MovingBody> moving_bodies(const Model& model, std::span<const Pose> path,
                                             std::span<const Body> bodies,
                                             std::optional<double> floor = {}) {
  std::vector<MovingBody> out;
  for (const Body& body : bodies) {
    out.push_back(
        {body.name, body.model, body.poses, body.path_pose, body.floor ? body.floor : floor});
  }
  if (out.empty()) out.push_back({{}, model, path, {}, floor});
  return out;
}

inline std::vector<MovingBody> moving_bodies(const Query& query) {
  return moving_bodies(query.model, query.poses, query.bodies, query.floor);
}

/// Whether any body of the query has a floor.
inline bool has_floor(const Query& query) {
  return std::ranges::any_of(moving_bodies(query),
                             [](const MovingBody& body) { return body.floor.has_value(); });
}

/// Moves the floors of a query and of its bodies up by `metres`.
inline void raise_floors(Query& query, double metres) {
  if (query.floor) *query.floor += metres;
  for (Body& body : query.bodies) {
    if (body.floor) *body.floor += metres;
  }
}

/// Whether any body of the query has closed parts.
inline bool has_solids(const Query& query) {
  return query.model.is_solid() ||
         std::ranges::any_of(query.bodies, [](const Body& body) { return body.model.is_solid(); });
}

/// How many solids all bodies of the query have together.
inline std::uint64_t solid_count(const Query& query) {
  std::uint64_t count = 0;
  for (const MovingBody& body : moving_bodies(query)) count += body.model.solid_count();
  return count;
}

/// Largest gap between the samples of a mesh, metres: the greatest Model::spacing of all bodies.
inline double model_spacing(const Query& query) {
  double spacing = 0;
  for (const MovingBody& body : moving_bodies(query)) {
    spacing = std::max(spacing, body.model.spacing);
  }
  return spacing;
}

/// The axes of the models' files that pointed ahead and up before the models were turned. Those of
/// a frame that needs no turn where the bodies differ in them.
inline ModelAxes file_axes(const Query& query) {
  const std::vector<MovingBody> bodies = moving_bodies(query);
  const ModelAxes axes = bodies.front().model.file_axes;
  const bool same = std::ranges::all_of(
      bodies, [&](const MovingBody& body) { return body.model.file_axes == axes; });
  return same ? axes : ModelAxes{};
}

}  // namespace clearway
