#include <pybind11/stl.h>

#include <array>
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
#include "core/describe/trajectory.hpp"
#include "core/util/format.hpp"
#include "python/arrays.hpp"
#include "python/fields.hpp"
#include "python/inputs.hpp"
#include "python/model.hpp"
#include "python/store.hpp"
#include "python/values.hpp"

namespace clearway::python {
namespace {

using namespace py::literals;

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

BodyMount mount_of(const std::optional<double>& at,
                   const std::optional<std::pair<double, double>>& pivots) {
  if (at && pivots) {
    throw UsageError("at, pivots: a body follows at a station or on pivots, expected one of them");
  }
  if (pivots) return BodyPivots{pivots->first, pivots->second};
  return BodyStation{at.value_or(0)};
}

BodyTowed tow_of(std::optional<double> at, const std::optional<std::pair<double, double>>& pivots) {
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

/// How a body moves by the arguments of follow(). towed_by: None, "path" or a Body.
Motion motion_of(const std::string& name, std::optional<double> at,
                 const std::optional<std::pair<double, double>>& pivots, const py::object& towed_by,
                 const std::vector<Pose>& path) {
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

void add_body(py::module_& module) {
  py::class_<PlacedBody>(
      module, "Body",
      "One of the rigid parts of a vehicle, such as a tractor or its trailer.\n\n"
      "Query(poses=path, bodies=[...]) searches all bodies of a vehicle at once. follow() and\n"
      "read_vehicle() make bodies that follow the path; a body with a motion of its own is made\n"
      "of its poses.")
      .def(py::init(&make_body), "name"_a, "model"_a, "poses"_a, "path_pose"_a = py::none(),
           R"(__init__(self, name, model, poses, path_pose=None)
--

Make a body of its own poses.

name: for people, in results and reports; every body of a vehicle has another one.
model: in the body's own frame: points, n x 3, metres; or a Model.
poses: n x 4 x 4 or n x 3 x 4; where the body is.
path_pose: for each of these poses the index of the path's pose at which the body is there,
    ascending. None: the body has as many poses as the path, one for each.)")
      .def_property_readonly(
          "name", [](const PlacedBody& b) { return text(b.name); },
          "The body's name, which results and reports show.")
      .def_property_readonly(
          "model",
          [](const PlacedBody& b) -> py::object {
            if (b.model.is_surface() || b.model.spacing > 0) return py::cast(b.model);
            return to_array(b.model.vertices);
          },
          "The model in the body's own frame: points, n x 3 float64, metres; or a Model.")
      .def_property_readonly(
          "poses", [](const PlacedBody& b) { return to_array(b.poses); },
          "The poses at which the body is searched: n x 4 x 4 float64.")
      .def_property_readonly(
          "path_pose", [](const PlacedBody& b) { return to_array(b.path_pose); },
          "For each pose of the body the index of the path's pose that it belongs to: n uint32.")
      .def_readwrite("floor", &PlacedBody::floor,
                     "The body's own floor, metres in its frame, which takes the place of the "
                     "query's; None: it has the query's. May be assigned.")
      .def("__repr__", [](const PlacedBody& b) {
        return text("<Body " + b.name + ": " + std::to_string(b.model.vertices.size()) +
                    " points, " + std::to_string(b.poses.size()) + " poses>");
      });
}

void add_follow(py::module_& module) {
  module.def(
      "follow",
      [](std::string name, const py::object& model, const py::object& path,
         std::optional<double> at, std::optional<std::pair<double, double>> pivots,
         const py::object& towed_by, const py::object& messages) {
        Body body = make_body(std::move(name), model, py::tuple(), py::none());
        const auto poses =
            std::make_shared<const std::vector<Pose>>(poses_of(poses_array(path, "path"), "path"));
        const auto motion =
            std::make_shared<const Motion>(motion_of(body.name, at, pivots, towed_by, *poses));
        std::vector<Message> doubts;
        Body placed =
            without_gil([&] { return followed(std::move(body), *poses, *motion, doubts); });
        append_to(messages, doubts);
        return PlacedBody{std::move(placed), poses, false, motion};
      },
      "name"_a, "model"_a, "path"_a, py::kw_only(), "at"_a = py::none(), "pivots"_a = py::none(),
      "towed_by"_a = py::none(), "messages"_a = py::none(),
      R"(follow(name, model, path, *, at=None, pivots=None, towed_by=None, messages=None)
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
}

void add_read_vehicle(py::module_& module) {
  module.def(
      "read_vehicle",
      [](const py::object& file, const py::object& poses, const std::string& model_as,
         const EnvironmentUnitArgument& environment_unit, const py::object& messages,
         const py::kwargs& given) {
        VehicleOptions options;
        options.model = model_options(value_of("model_as", kChoices<ModelAs>, model_as), given,
                                      environment_unit);
        options.trajectory = trajectory_options(given, environment_unit);
        const FileUnit& unit = options.model.unit;
        const auto path = std::make_shared<const std::vector<Pose>>(
            poses_of(poses_array(poses, "poses"), "poses"));
        std::vector<Body> read = read_noting(messages, [&, from = path_of(file)](auto* noted) {
          std::vector<Body> bodies = read_vehicle(from, *path, options, noted);
          check_unit_is_given(from, environment_unit,
                              unit.is_known() ? unit : options.trajectory.metres_per_unit, *noted);
          return bodies;
        });
        std::vector<PlacedBody> placed;
        for (Body& body : read) placed.push_back({std::move(body), path});
        return placed;
      },
      "file"_a, "poses"_a, "model_as"_a = "auto", py::kw_only(), "environment_unit"_a = py::none(),
      "messages"_a = py::none(),
      ("read_vehicle(file, poses, model_as='auto', *, " + signature_of(kModelFields) + ", " +
       signature_of(kTrajectoryFields) + R"DOC(, environment_unit=None, messages=None)
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
  add_checks(module, "read_vehicle", kKindOfModel);
  add_checks(module, "read_vehicle", kModelFields);
  add_checks(module, "read_vehicle", kTrajectoryFields);
}

void add_unsearched(py::module_& module) {
  py::class_<UnsearchedStretch>(module, "UnsearchedStretch",
                                "A stretch of the path on which bodies of a vehicle have no pose, "
                                "so that nothing is\nknown of them there.")
      .def_readonly("first_pose", &UnsearchedStretch::first_pose, "The path's pose at its start.")
      .def_readonly("last_pose", &UnsearchedStretch::last_pose, "The path's pose at its end.")
      .def_readonly("chainage_from", &UnsearchedStretch::chainage_from, "Metres along the path.")
      .def_readonly("chainage_to", &UnsearchedStretch::chainage_to, "Metres along the path.")
      .def_readonly("bodies", &UnsearchedStretch::bodies,
                    "Indices of the bodies without a pose there, ascending.")
      .def_readonly("has_answer", &UnsearchedStretch::has_answer,
                    "Whether other bodies were searched there.")
      .def("__repr__", [](const UnsearchedStretch& s) {
        return text("<UnsearchedStretch: chainage " + format_number(s.chainage_from) + " to " +
                    format_number(s.chainage_to) + ", " +
                    counted(s.bodies.size(), "body", "bodies") + " without a pose>");
      });
  module.def(
      "unsearched_stretches",
      [](const py::object& path, const std::vector<PlacedBody>& bodies) {
        const std::vector<Pose> poses = poses_of(poses_array(path, "path"), "path");
        return unsearched_stretches(poses, bodies_on(bodies, poses));
      },
      "path"_a, "bodies"_a,
      R"(unsearched_stretches(path, bodies)
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
  add_follow(module);
  add_read_vehicle(module);
}

}  // namespace clearway::python
