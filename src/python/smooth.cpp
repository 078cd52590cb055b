#include "clearway/smooth.hpp"

#include <optional>
#include <string>

#include "core/describe/smooth.hpp"
#include "core/geometry/point_box.hpp"
#include "core/util/format.hpp"
#include "python/arrays.hpp"
#include "python/fields.hpp"
#include "python/model.hpp"
#include "python/values.hpp"
#include "python/watch.hpp"

namespace clearway::python {
namespace {

using namespace py::literals;

struct Watched {
  ProgressCallback progress;
  StopFlag stop = nullptr;
};

void add_smooth_path(py::module_& module) {
  py::class_<SmoothPath>(module, "SmoothPath",
                         "A path on a smooth curve, and how far it is from the given one. "
                         "Distances are upper bounds, between poses as well.")
      .def_property_readonly(
          "poses", [](const SmoothPath& p) { return to_array(p.poses); },
          "The new poses: n x 4 x 4 float64.")
      .def_property_readonly(
          "place", [](const SmoothPath& p) { return to_array(p.place); },
          "For each of them the place of the given path, as the index of a pose and a part of the "
          "way to the next one: n float64.")
      .def_readonly("control_points", &SmoothPath::control_points,
                    "How many control points the curve has.")
      .def_readonly("largest_deviation", &SmoothPath::largest_deviation,
                    "The farthest that a model point is from where the given path has it.")
      .def_readonly("mean_deviation", &SmoothPath::mean_deviation,
                    "The mean of the greatest deviation at each of the given poses.")
      .def_readonly("largest_step", &SmoothPath::largest_step,
                    "The most that a model point moves from one new pose to the next.")
      .def_property_readonly(
          "error_between_poses", [](const SmoothPath& p) { return p.error_between_poses(); },
          "The error_model of a query with between_poses that covers the given path.")
      .def_property_readonly(
          "error_at_poses", [](const SmoothPath& p) { return p.error_at_poses(); },
          "The error_model of a query without between_poses that covers the given path.")
      .def("__repr__", [](const SmoothPath& p) {
        return text("<SmoothPath: " + counted(p.poses.size(), "pose") + ", " +
                    counted(p.control_points, "control point") + ", largest deviation " +
                    format_brief(p.largest_deviation) + ">");
      });
}

}  // namespace

void add_smooth(py::module_& module) {
  add_smooth_path(module);
  module.def(
      "smooth_trajectory",
      [](const py::object& poses, double within, const py::object& model, py::object progress,
         py::object stop, const py::kwargs& given) {
        SmoothParameters asked{.within = within};
        set_fields(kSmoothFields, given, asked);
        const std::vector<Pose> path = poses_of(poses_array(poses, "poses"), "poses");
        std::optional<Box> box;
        if (!model.is_none()) box = box_of(model_of(model).vertices);
        Watch watch(std::move(progress), py::none(), std::move(stop));
        Watched options;
        watch.attach(options);
        return watch.run(
            [&] { return smooth_trajectory(path, asked, box, options.progress, options.stop); });
      },
      "poses"_a, "within"_a, py::kw_only(), "model"_a = py::none(), "progress"_a = py::none(),
      "stop"_a = py::none(),
      ("smooth_trajectory(poses, within, *, model=None, " + signature_of(kSmoothFields) +
       R"DOC(, progress=None, stop=None)
--

Put a smooth curve to a noisy path, and poses on it. Returns a SmoothPath.

Lengths are in the unit of the poses. A path with a jump raises InputError.

poses: the path, n x 4 x 4 or n x 3 x 4.
within: the farthest that a model point may be from where the given path has it.
model: points, n x 3, or a Model; required where rotations change. Without it lengths are those of
    the positions.
)DOC" + lines_of(kSmoothFields) +
       R"DOC(progress, stop: as search() takes them.)DOC")
          .c_str());
  add_checks(module, "smooth_trajectory", kSmoothFields);
}

}  // namespace clearway::python
