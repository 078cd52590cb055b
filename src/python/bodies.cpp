#include <pybind11/stl.h>

#include <numeric>
#include <optional>
#include <string>
#include <utility>

#include "clearway/body.hpp"
#include "clearway/follow.hpp"
#include "python/arrays.hpp"
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

}  // namespace

void add_bodies(py::module_& module) {
  add_body(module);
  add_follow(module);
}

}  // namespace clearway::python
