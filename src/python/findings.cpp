#include "python/findings.hpp"

#include <pybind11/stl.h>

#include <string>
#include <utility>

#include "clearway/body.hpp"
#include "clearway/conflicts.hpp"
#include "python/arrays.hpp"
#include "python/values.hpp"
#include "python/watch.hpp"

namespace clearway::python {
namespace {

using namespace py::literals;

constexpr Named<Axis> kAxes[] = {{"+x", Axis::kPlusX}, {"x", Axis::kPlusX}, {"-x", Axis::kMinusX},
                                 {"+y", Axis::kPlusY}, {"y", Axis::kPlusY}, {"-y", Axis::kMinusY},
                                 {"+z", Axis::kPlusZ}, {"z", Axis::kPlusZ}, {"-z", Axis::kMinusZ}};

/// Conflicts, and the conflict of each row of the result.
struct GroupedConflicts : Conflicts {
  std::vector<std::uint32_t> conflict_of = {};
};

py::object place(const std::optional<Vec3>& point) {
  return point ? py::object(to_array(*point)) : py::none();
}

void add_conflict(py::module_& module) {
  py::class_<Conflict>(module, "Conflict", "Colliding points that hang together.")
      .def_readonly("id", &Conflict::id, "1, 2, ... along the path.")
      .def_readonly("points", &Conflict::points, "Colliding ones.")
      .def_readonly("source", &Conflict::source, "The smallest index of its points.")
      .def_readonly("box", &Conflict::box, "Of its points, metres.")
      .def_property_readonly(
          "centroid", [](const Conflict& c) { return to_array(c.centroid); }, "3 float64, metres.")
      .def_readonly("body", &Conflict::body,
                    "Of a vehicle's result, as an index of Result.bodies(): the one that has the "
                    "least distance, or else touches first. None where there is one model.")
      .def_readonly("first_pose", &Conflict::first_pose, "The smallest first pose of its points.")
      .def_readonly("last_pose", &Conflict::last_pose, "The greatest first pose of its points.")
      .def_readonly("chainage_from", &Conflict::chainage_from, "Metres along the path.")
      .def_readonly("chainage_to", &Conflict::chainage_to, "Metres along the path.")
      .def_readonly("least_distance", &Conflict::least_distance,
                    "Metres; None: the result has no clearances.")
      .def_readonly("nearest_pose", &Conflict::nearest_pose, "The pose that has it, or None.")
      .def_readonly("nearest_source", &Conflict::nearest_source, "The point, or None.")
      .def_readonly("encroachment", &Conflict::encroachment,
                    "Radius - least_distance, metres, or None.")
      .def_readonly("depth", &Conflict::depth,
                    "Of a model with solids: how deep its deepest point is inside, metres; 0: "
                    "none is. None: no solids, or no clearances.")
      .def_readonly("points_inside", &Conflict::points_inside,
                    "How many of its points are inside at any pose, or None.")
      .def_property_readonly(
          "nearest_point", [](const Conflict& c) { return place(c.nearest_point); },
          "3 float64, metres, or None.")
      .def_property_readonly(
          "side", [](const Conflict& c) { return name_of(c.side); },
          "'left', 'right', 'above', 'below', 'front', 'behind' or 'unknown'.")
      .def_readonly("lateral", &Conflict::lateral,
                    "To the left of the pose, metres, or None. With bodies=, of the body's pose.")
      .def_readonly("height", &Conflict::height, "Above the pose, metres, or None. Likewise.")
      .def_readonly("group", &Conflict::group,
                    "The smallest index of the whole group, before it was cut.")
      .def("__repr__", [](const Conflict& c) {
        return py::str("<Conflict {}: {} points, {:.3f} to {:.3f} m, {}>")
            .format(c.id, c.points, c.chainage_from, c.chainage_to, name_of(c.side));
      });
}

void add_conflicts(py::module_& module) {
  using Found = GroupedConflicts;
  py::class_<Found>(module, "Conflicts", "The colliding points of a result, group by group.")
      .def_readonly("listed", &Found::listed, "A list of Conflict, by id.")
      .def_property_readonly(
          "conflict_of", [](const Found& c) { return to_array(c.conflict_of); },
          "The id of each row of the result, uint32; 0: a group too small to be listed.")
      .def_readonly("colliding_points", &Found::colliding_points)
      .def_readonly("groups", &Found::groups, "Before cutting, small ones too.")
      .def_readonly("small_groups", &Found::small_groups, "Not listed.")
      .def_readonly("small_points", &Found::small_points, "Points of these.")
      .def_readonly("path_length", &Found::path_length, "Metres.")
      .def_readonly("longest_group", &Found::longest_group,
                    "The longest stretch of the path that one group has, metres.")
      .def_readonly("longest_group_points", &Found::longest_group_points)
      .def("__len__", [](const Found& c) { return c.listed.size(); })
      .def("__repr__", [](const Found& c) {
        return text("<" + std::to_string(c.listed.size()) + " conflicts of " +
                    std::to_string(c.colliding_points) + " points>");
      });
}

void add_find_conflicts(py::module_& module) {
  module.def(
      "find_conflicts",
      [](const Result& result, const py::object& poses, double gap, std::uint64_t min_points,
         double split, double chainage_start, const std::string& forward, const std::string& up,
         std::optional<Box> model_box, const std::vector<Body>& bodies, std::uint64_t memory_bytes,
         int threads, py::object progress, py::object stop) {
        ConflictOptions options = conflict_options(gap, min_points, split, chainage_start, forward,
                                                   up, model_box, memory_bytes, threads);
        options.bodies = bodies;
        Watch watch(std::move(progress), py::none(), std::move(stop));
        watch.attach(options);
        return watch.run([&, path = poses_of(poses_array(poses, "poses"), "poses")] {
          GroupedConflicts found;
          static_cast<Conflicts&>(found) =
              find_conflicts(result, path, options, &found.conflict_of);
          return found;
        });
      },
      "result"_a, "poses"_a, py::kw_only(), "gap"_a = ConflictOptions{}.gap,
      "min_points"_a = ConflictOptions{}.min_points, "split"_a = ConflictOptions{}.split,
      "chainage_start"_a = 0.0, "forward"_a = "+x", "up"_a = "+z", "model_box"_a = py::none(),
      "bodies"_a = py::tuple(), "memory_bytes"_a = ConflictOptions{}.memory_bytes, "threads"_a = 0,
      "progress"_a = py::none(), "stop"_a = py::none(),
      R"(find_conflicts(result, poses, *, gap=0.3, min_points=10, split=25.0, chainage_start=0.0, forward='+x', up='+z', model_box=None, bodies=(), memory_bytes=4294967296, threads=0, progress=None, stop=None)
--

Group the colliding points of a result, place by place. Returns Conflicts.

result: of a query with first_pose=True.
poses: those of the search.
gap: metres; points at most this far apart belong to the same conflict.
min_points: groups of fewer are counted, not listed.
split: metres along the path; longer groups are cut at multiples of it; 0: never.
chainage_start: metres, of the first pose.
forward, up: axes of the model, such as '+x' or '-z'.
model_box: of the model, where the result does not hold it.
bodies: of a vehicle, those of the search; each conflict is seen from its body then.
memory_bytes, threads, progress, stop: as search() takes them.)");
}

}  // namespace

ConflictOptions conflict_options(double gap, std::uint64_t min_points, double split,
                                 double chainage_start, const std::string& forward,
                                 const std::string& up, std::optional<Box> model_box,
                                 std::uint64_t memory_bytes, int threads) {
  ConflictOptions options;
  options.gap = gap;
  options.min_points = min_points;
  options.split = split;
  options.chainage_start = chainage_start;
  options.forward = value_of("forward", kAxes, forward);
  options.up = value_of("up", kAxes, up);
  options.model_box = model_box;
  options.memory_bytes = memory_bytes;
  options.threads = threads;
  return options;
}

py::object to_python(Conflicts conflicts) {
  return py::cast(GroupedConflicts{{std::move(conflicts)}});
}

void add_findings(py::module_& module) {
  add_conflict(module);
  add_conflicts(module);
  add_find_conflicts(module);
}

}  // namespace clearway::python
