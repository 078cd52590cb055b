#include <memory>
#include <numeric>
#include <optional>
#include <string>
#include <utility>

#include "clearway/body.hpp"
#include "clearway/follow.hpp"
#include "clearway/unsearched.hpp"
#include "clearway/vehicle.hpp"
#include "core/describe/model.hpp"
#include "core/describe/reports.hpp"
#include "core/describe/trajectory.hpp"
#include "core/util/format.hpp"
#include "python/arrays.hpp"
#include "python/binding.hpp"
#include "python/objects.hpp"
#include "python/values.hpp"

namespace clearway::python {
namespace {

PlacedBody make_body(std::string name, const py::object& model, const py::object& poses,
                     const py::object& path_pose) {
  PlacedBody body{{.name = std::move(name),
                   .model = model_of(model_object(model)),
                   .poses = poses_of(poses_array(poses, "poses"), "poses"),
                   .path_pose = {}}};
  body.has_all_poses = path_pose.is_none();
  if (body.has_all_poses) {
    body.path_pose.resize(body.poses.size());
    std::iota(body.path_pose.begin(), body.path_pose.end(), 0);
    return body;
  }
  body.path_pose = indices_of(path_pose, "path_pose");
  if (body.path_pose.size() == body.poses.size()) return body;
  throw UsageError("path_pose: expected " + std::to_string(body.poses.size()) +
                   " indices, one for each pose, found " + std::to_string(body.path_pose.size()));
}

using Pivots = std::optional<std::pair<double, double>>;

BodyMount mount_of(const std::optional<double>& at, const Pivots& pivots) {
  if (at && pivots) {
    throw UsageError("at, pivots: a body follows at a station or on pivots, expected one of them");
  }
  if (pivots) return BodyPivots{pivots->first, pivots->second};
  return BodyStation{at.value_or(0)};
}

BodyTowed tow_of(std::optional<double> at, const Pivots& pivots) {
  if (!at || !pivots) {
    throw UsageError(
        "towed_by: expected at, the hitch on the tower, and pivots, the hitch and the axle on the "
        "body, for example at=-0.6, pivots=(9.2, 1.4)");
  }
  return {.by = {}, .at = *at, .hitch = pivots->first, .axle = pivots->second};
}

/// The motion of a tower. Throws UsageError where it was placed on another path.
std::shared_ptr<const Motion> motion_of(const PlacedBody& tower, const std::vector<Pose>& path) {
  bodies_on({tower}, path);
  if (tower.motion) return tower.motion;
  return std::make_shared<const Motion>(Motion{
      .name = tower.name,
      .mount = BodyOwnPoses{},
      .tower = nullptr,
      .own = {
          .name = tower.name, .model = {}, .poses = tower.poses, .path_pose = tower.path_pose}});
}

/// How a body moves by the arguments of follow().
Motion motion_of(const std::string& name, const py::kwargs& given, const std::vector<Pose>& path) {
  const auto at = argument<std::optional<double>>(given, "at");
  const auto pivots = argument<Pivots>(given, "pivots");
  const py::object towed_by = given["towed_by"];
  if (towed_by.is_none()) return {.name = name, .mount = mount_of(at, pivots), .tower = nullptr};
  BodyTowed tow = tow_of(at, pivots);
  if (py::isinstance<py::str>(towed_by) && towed_by.cast<std::string>() == "path") {
    return {.name = name, .mount = tow, .tower = nullptr};
  }
  if (!py::isinstance<PlacedBody>(towed_by)) {
    throw UsageError("towed_by: expected a Body that tows this one, or \"path\"");
  }
  auto tower = motion_of(towed_by.cast<const PlacedBody&>(), path);
  tow.by = tower->name;
  return {.name = name, .mount = tow, .tower = std::move(tower)};
}

/// Follows the path with the body and its towers, and returns the body.
Body followed(Body body, const std::vector<Pose>& path, const Motion& motion,
              std::vector<Message>& doubts) {
  std::vector<Body> bodies;
  std::vector<BodyMount> mounts{motion.mount};
  bodies.push_back(std::move(body));
  for (const Motion* tower = motion.tower.get(); tower != nullptr; tower = tower->tower.get()) {
    bodies.push_back(tower->own);
    bodies.back().name = tower->name;
    mounts.push_back(tower->mount);
  }
  std::vector<Message> all;
  body = std::move(follow(std::move(bodies), path, mounts, &all).front());
  // What is odd about the towers was reported when they were placed.
  for (Message& doubt : all) {
    if (doubt.body == motion.name) doubts.push_back(std::move(doubt));
  }
  return body;
}

py::object model_to_python(const PlacedBody& body) {
  if (body.model.is_surface() || body.model.spacing > 0) return py::cast(body.model);
  return to_array(body.model.vertices);
}

constexpr std::tuple kBodyFacts{
    fact<&PlacedBody::name>("The body's name, which results and reports show."),
    fact<&PlacedBody::poses>("The poses at which the body is searched: n x 4 x 4 float64.")};

void add_body(py::module_& module) {
  auto body = add_class<PlacedBody>(
      module, "Body",
      "One of the rigid parts of a vehicle, such as a tractor or its trailer.\n\n"
      "Query(poses=path, bodies=[...]) searches all bodies of a vehicle at once. follow() and\n"
      "read_vehicle() make bodies that follow the path; a body with a motion of its own is made\n"
      "of its poses.",
      kBodyFacts);
  body.def(py::init([](const py::kwargs& given) {
             return make_body(argument<std::string>(given, "name"), given["model"], given["poses"],
                              given["path_pose"]);
           }),
           R"(__init__(self, name: Text, model: ArrayOrModel, poses: Array, path_pose: Array = None)
--

Make a body of its own poses.

name: for people, in results and reports; every body of a vehicle has another one.
model: in the body's own frame: points, n x 3, metres; or a Model.
poses: n x 4 x 4 or n x 3 x 4; where the body is.
path_pose: for each of these poses the index of the path's pose at which the body is there,
    ascending. None: the body has as many poses as the path, one for each.)")
      .def_property_readonly(
          "model", &model_to_python,
          "The model in the body's own frame: points, n x 3 float64, metres; or a Model.")
      .def_property_readonly(
          "path_pose", member_array<&PlacedBody::path_pose, PlacedBody>,
          "For each pose of the body the index of the path's pose that it belongs to: n uint32.")
      .def_readwrite("floor", &PlacedBody::floor,
                     "The body's own floor, metres in its frame, which takes the place of the "
                     "query's; None: it has the query's. May be assigned.");
  add_repr(body, [](const PlacedBody& b) {
    return "<Body " + b.name + ": " + std::to_string(b.model.vertices.size()) + " points, " +
           std::to_string(b.poses.size()) + " poses>";
  });
}

PlacedBody follow(const py::kwargs& given) {
  Body body =
      make_body(argument<std::string>(given, "name"), given["model"], py::tuple(), py::none());
  const auto path = std::make_shared<const std::vector<Pose>>(poses_of(given, "path"));
  const auto motion = std::make_shared<const Motion>(motion_of(body.name, given, *path));
  std::vector<Message> doubts;
  Body placed = without_gil([&] { return followed(std::move(body), *path, *motion, doubts); });
  append_to(given, doubts);
  return {std::move(placed), path, false, motion};
}

std::vector<PlacedBody> read_vehicle(const py::kwargs& given) {
  VehicleOptions options;
  set_fields(kKindOfModel, given, options.model);
  set_fields(kModelFields, given, options.model);
  set_fields(kTrajectoryFields, given, options.trajectory);
  take_environment_unit(given, options.model);
  const EnvironmentUnit environment = take_environment_unit(given, options.trajectory);
  const auto path = std::make_shared<const std::vector<Pose>>(poses_of(given));
  std::vector<Body> read = read_noting(given, [&, from = path_of(given["file"])](auto* noted) {
    std::vector<Body> bodies = read_vehicle(from, *path, options, noted);
    const FileUnit& unit = options.model.unit;
    check_unit_is_given(from, environment,
                        unit.is_known() ? unit : options.trajectory.metres_per_unit, *noted);
    return bodies;
  });
  std::vector<PlacedBody> placed;
  for (Body& body : read) placed.push_back({std::move(body), path});
  return placed;
}

void add_unsearched(py::module_& module) {
  auto stretch = add_class<UnsearchedStretch>(
      module, "UnsearchedStretch",
      "A stretch of the path on which bodies of a vehicle have no pose, so that nothing is\n"
      "known of them there.");
  add_repr(stretch, [](const UnsearchedStretch& s) {
    return "<UnsearchedStretch: chainage " + format_number(s.chainage_from) + " to " +
           format_number(s.chainage_to) + ", " + counted(s.bodies.size(), "body", "bodies") +
           " without a pose>";
  });
  module.def(
      "unsearched_stretches",
      [](const py::kwargs& given) {
        const std::vector<Pose> path = poses_of(given, "path");
        return unsearched_stretches(path, bodies_on(given, path));
      },
      R"(unsearched_stretches(path: Array, bodies: Each(Body))
--

Where bodies of a vehicle have no pose, in the order of the path: a list of UnsearchedStretch.

A result without collisions does not say that the vehicle is clear there. In its profile, the
distance is infinity there too.
path: the poses that the vehicle follows, n x 4 x 4.
bodies: a list of Body, as Query(bodies=...) takes it.)");
}

}  // namespace

std::vector<Body> bodies_on(const std::vector<PlacedBody>& bodies, const std::vector<Pose>& path) {
  std::vector<Body> placed;
  for (const PlacedBody& body : bodies) {
    const std::string name = "bodies[" + std::to_string(placed.size()) + "] (" + body.name + "): ";
    if (body.has_all_poses && body.poses.size() != path.size()) {
      throw UsageError(name + "has " + counted(body.poses.size(), "pose") + ", and the path has " +
                       counted(path.size(), "pose") +
                       ": expected one for each pose of the path, or Body(..., path_pose=...), "
                       "which says which poses of the path they belong to");
    }
    if (body.path && *body.path != path) {
      throw UsageError(name + "was placed on another path, of " +
                       counted(body.path->size(), "pose") + ", than `poses`, which has " +
                       std::to_string(path.size()) +
                       ": give follow() or read_vehicle() the same poses");
    }
    placed.push_back(body);
  }
  return placed;
}

void add_bodies(py::module_& module) {
  add_body(module);
  add_unsearched(module);
  module.def(
      "follow", &follow,
      R"(follow(name: Text, model: ArrayOrModel, path: Array, *, at: Number = None, pivots: Pivots = None,
    towed_by: Tower = None, messages: Notes = None)
--

Place a body of a vehicle at the poses of a path. Returns a Body, for Query(bodies=...).

name: for people, in results and reports; every body of a vehicle has another one.
model: in the body's own frame, as Query takes it: points, n x 3, metres; or a Model.
path: the poses that the vehicle follows, n x 4 x 4: those of the query.
at: the body has the path's pose so many metres ahead; negative: behind.
pivots: two places of the body that lie on the path, front and rear, metres ahead: (10, -10).
towed_by: the Body that tows this one like a trailer, placed on the same path, or "path": then `at`
    is the x of the hitch in the tower's frame, and `pivots` are the x of the hitch and of the axle
    in the body's own frame, (9.2, 1.4). A tower that follow() did not make drives along the curve
    through its poses.
messages: a list to which warnings are appended, as of poses where the body is off the path.)");
  module.def("read_vehicle", &read_vehicle,
             ("read_vehicle(file: Path, poses: Array, model_as: OneOf('auto', 'surface', 'solid', "
              "'points') = 'auto', *, " +
              signature_of(kModelFields) + ", " + signature_of(kTrajectoryFields) +
              R"DOC(, environment_unit: EnvironmentUnit = None, messages: Notes = None)
--

Read the JSON file of a vehicle of several bodies, and the files that it names.

Returns a list of Body, in the file's order, for Query(poses=poses, bodies=...).

file: the same as for clearway run --vehicle.
poses: the path that the vehicle follows, n x 4 x 4: that of the query.
)DOC" + lines_of(kKindOfModel) +
              R"DOC(spacing, vertices_only, forward, up: of all models, as read_model() takes them.
unit: of models without a model_unit, as read_model() takes it.
environment_unit: into which lengths with a unit are converted, as read_model() takes it.
format, allow_non_rigid, angle_unit, angle_frame, crs, default_crs, datum, metres_per_unit,
    lever_arm: for trajectories that bodies have of their own, as read_trajectory() takes them.
messages: a list to which notes and warnings are appended.)DOC")
                 .c_str());
}

}  // namespace clearway::python
