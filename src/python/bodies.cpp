#include <pybind11/stl.h>

#include <array>
#include <numeric>
#include <optional>
#include <string>
#include <utility>

#include "clearway/body.hpp"
#include "clearway/follow.hpp"
#include "clearway/vehicle.hpp"
#include "python/arrays.hpp"
#include "python/inputs.hpp"
#include "python/model.hpp"
#include "python/values.hpp"

namespace clearway::python {
namespace {

using namespace py::literals;

Body make_body(std::string name, const py::object& model, const py::object& poses,
               std::optional<std::vector<std::uint32_t>> path_pose) {
  ModelShape shape = model_of(model_object(model));
  Body body{.name = std::move(name),
            .model = std::move(shape.points),
            .poses = poses_of(poses_array(poses, "poses"), "poses"),
            .path_pose = {},
            .triangles = std::move(shape.triangles),
            .solid_of = std::move(shape.solid_of)};
  if (path_pose) {
    body.path_pose = std::move(*path_pose);
  } else {
    body.path_pose.resize(body.poses.size());
    std::iota(body.path_pose.begin(), body.path_pose.end(), 0);
  }
  return body;
}

BodyMount mount_of(const std::optional<double>& at,
                   const std::optional<std::pair<double, double>>& pivots) {
  if (at && pivots) throw UsageError("a body follows at a station or on pivots, not both");
  if (pivots) return BodyPivots{pivots->first, pivots->second};
  return BodyStation{at.value_or(0)};
}

void add_body(py::module_& module) {
  py::class_<Body>(module, "Body",
                   "One of several rigid parts of a vehicle. path_pose: of each of its poses the "
                   "index\nof the path's pose, ascending; None: it has all of them.")
      .def(py::init(&make_body), "name"_a, "model"_a, "poses"_a, "path_pose"_a = py::none())
      .def_property_readonly("name", [](const Body& b) { return text(b.name); })
      .def_property_readonly(
          "model",
          [](const Body& b) -> py::object {
            if (b.is_surface()) return py::cast(ModelShape{b.model, b.triangles, b.solid_of});
            return to_array(b.model);
          },
          "In the body's own frame: points, n x 3 float64, metres; or a ModelShape.")
      .def_property_readonly(
          "poses", [](const Body& b) { return to_array(b.poses); }, "n x 4 x 4 float64.")
      .def_property_readonly(
          "path_pose", [](const Body& b) { return to_array(b.path_pose); },
          "Of each pose the index of the path's: n uint32.")
      .def("__repr__", [](const Body& b) {
        return text("<Body " + b.name + ": " + std::to_string(b.model.size()) + " points, " +
                    std::to_string(b.poses.size()) + " poses>");
      });
}

void add_follow(py::module_& module) {
  module.def(
      "follow",
      [](std::string name, const py::object& model, const py::object& path,
         std::optional<double> at, std::optional<std::pair<double, double>> pivots,
         const py::object& messages) {
        Body body = make_body(std::move(name), model, py::tuple(), std::nullopt);
        const std::vector<Pose> poses = poses_of(poses_array(path, "path"), "path");
        const BodyMount mount = mount_of(at, pivots);
        std::vector<Message> doubts;
        Body placed = without_gil([&] { return follow(std::move(body), poses, mount, &doubts); });
        append_to(messages, doubts);
        return placed;
      },
      "name"_a, "model"_a, "path"_a, py::kw_only(), "at"_a = py::none(), "pivots"_a = py::none(),
      "messages"_a = py::none(),
      R"(follow(name, model, path, *, at=None, pivots=None, messages=None)
--

Place a body of a vehicle at the poses of a path. Returns a Body, for Query(bodies=...).

model: in the body's own frame, as Query takes it: points, n x 3, metres; or a ModelShape.
path: the poses that the vehicle follows, n x 4 x 4.
at: the body has the path's pose so many metres ahead; negative: behind.
pivots: two places of the body that lie on the path, front and rear, metres ahead: (10, -10).
messages: a list to which warnings are appended, as of poses where the body is off the path.)");
}

/// Points of a file stay points, so that one vehicle may have both.
constexpr Named<ModelAs> kBodiesAs[] = {
    {"surface", ModelAs::kSurfaceOfMesh}, {"points", ModelAs::kPoints}, {"solid", ModelAs::kSolid}};

constexpr const char* kReadVehicle =
    R"(read_vehicle(file, poses, model_as='surface', *, spacing=0.0, unit=0.0, environment_unit=1.0, vertices_only=False, above=None, format='auto', allow_non_rigid=False, angle_unit='declared', angle_frame='declared', crs='', default_crs='', datum='', metres_per_unit=0.0, lever_arm=(0.0, 0.0, 0.0), messages=None)
--

Read the JSON file of a vehicle of several bodies, and the files that it names.

Returns a list of Body, in the file's order, for Query(poses=poses, bodies=...).

file: the same as for clearway run --vehicle.
poses: the path that the vehicle follows, n x 4 x 4.
model_as: 'surface': meshes as their triangles are, and other models as points.
    'points': the surface of a mesh is sampled, which needs a spacing.
    'solid': triangles, and what closed parts enclose; each body has to be a mesh.
spacing, vertices_only, above: of all models, as read_model_shape() takes them.
unit: of models without a model_unit, metres; 0: as the file says, else as they are.
environment_unit: metres of the environment's unit, into which lengths with a unit are converted.
format, allow_non_rigid, angle_unit, angle_frame, crs, default_crs, datum, metres_per_unit,
lever_arm: of trajectories that bodies have of their own, as read_trajectory() takes them.
messages: a list to which notes and warnings are appended.)";

void add_read_vehicle(py::module_& module) {
  module.def(
      "read_vehicle",
      [](const py::object& file, const py::object& poses, const std::string& model_as,
         double spacing, double unit, double environment_unit, bool vertices_only,
         std::optional<double> above, const std::string& format, bool allow_non_rigid,
         const std::string& angle_unit, const std::string& angle_frame, const std::string& crs,
         const std::string& default_crs, const std::string& datum, double metres_per_unit,
         const std::array<double, 3>& lever_arm, const py::object& messages) {
        VehicleOptions options;
        options.model = {value_of("model_as", kBodiesAs, model_as),
                         spacing,
                         unit,
                         environment_unit,
                         vertices_only,
                         above};
        options.trajectory =
            trajectory_options(format, allow_non_rigid, angle_unit, angle_frame, crs, default_crs,
                               datum, metres_per_unit, environment_unit, lever_arm);
        return read_noting(
            messages,
            [&, from = path_of(file), path = poses_of(poses_array(poses, "poses"), "poses")](
                auto* noted) { return read_vehicle(from, path, options, noted); });
      },
      "file"_a, "poses"_a, "model_as"_a = "surface", py::kw_only(), "spacing"_a = 0.0,
      "unit"_a = 0.0, "environment_unit"_a = 1.0, "vertices_only"_a = false, "above"_a = py::none(),
      "format"_a = "auto", "allow_non_rigid"_a = false, "angle_unit"_a = "declared",
      "angle_frame"_a = "declared", "crs"_a = "", "default_crs"_a = "", "datum"_a = "",
      "metres_per_unit"_a = 0.0, "lever_arm"_a = std::array<double, 3>{0, 0, 0},
      "messages"_a = py::none(), kReadVehicle);
}

}  // namespace

void add_bodies(py::module_& module) {
  add_body(module);
  add_follow(module);
  add_read_vehicle(module);
}

}  // namespace clearway::python
