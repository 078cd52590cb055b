#include "python/findings.hpp"

#include <pybind11/stl.h>

#include <string>
#include <utility>

#include "clearway/body.hpp"
#include "clearway/conflicts.hpp"
#include "clearway/stations.hpp"
#include "clearway/trajectory.hpp"
#include "python/arrays.hpp"
#include "python/model.hpp"
#include "python/store.hpp"
#include "python/values.hpp"
#include "python/watch.hpp"

namespace clearway::python {
namespace {

using namespace py::literals;

/// Conflicts, and the conflict of each row of the result.
struct GroupedConflicts : Conflicts {
  std::vector<std::uint32_t> conflict_of = {};
};

/// The stations of labels, of which there may be none.
std::vector<double> stations_of(const PoseLabels* labels) {
  return labels == nullptr ? std::vector<double>() : labels->station;
}

py::object place(const std::optional<Vec3>& point) {
  return point ? py::object(to_array(*point)) : py::none();
}

void add_conflict(py::module_& module) {
  py::class_<Conflict>(
      module, "Conflict",
      "A place where the vehicle does not fit: colliding points that hang together.")
      .def_readonly("id", &Conflict::id,
                    "The number of the conflict, from 1, in the order of the path.")
      .def_readonly("points", &Conflict::points, "How many colliding points the conflict has.")
      .def_readonly("source", &Conflict::source,
                    "The smallest source index of the conflict's points.")
      .def_readonly("box", &Conflict::box, "The box around the conflict's points, in metres.")
      .def_property_readonly(
          "centroid", [](const Conflict& c) { return to_array(c.centroid); },
          "The mean of the conflict's points: 3 float64, metres.")
      .def_readonly(
          "body", &Conflict::body,
          "The body of the vehicle that comes closest, or without clearances touches first, as an "
          "index of Result.bodies(). None where there is one model.")
      .def_readonly("first_pose", &Conflict::first_pose,
                    "The least index of a pose that touches one of its points.")
      .def_readonly("last_pose", &Conflict::last_pose,
                    "The greatest index of a pose that touches one of its points; between poses, "
                    "the start of the last way that does. See Conflicts.has_last_poses.")
      .def_readonly(
          "certain", &Conflict::certain,
          "Whether the conflict is certain by the error budget, because ten or more of its points "
          "hang together and are certainly too close; False where it is possible, None without a "
          "budget.")
      .def_readonly(
          "obstacle_chainage", &Conflict::obstacle_chainage,
          "Station of the obstacle itself: the chainage of the pose that it is seen from, "
          "plus how far ahead of it the nearest point lies, metres, or None.")
      .def_readonly("shift_left", &Conflict::shift_left,
                    "How far the vehicle has to be shifted to the left so that the conflict's own "
                    "points are free, metres. None: 2 m are too little, or no model was given.")
      .def_readonly("shift_right", &Conflict::shift_right,
                    "How far the vehicle has to be shifted to the right so that the "
                    "conflict's own points are free, metres, or None as for shift_left.")
      .def_readonly("chainage_from", &Conflict::chainage_from, "Metres along the path.")
      .def_readonly("chainage_to", &Conflict::chainage_to, "Metres along the path.")
      .def_readonly("station_from", &Conflict::station_from,
                    "Station along the alignment of the pose of chainage_from, metres; None unless "
                    "the labels have stations.")
      .def_readonly("station_to", &Conflict::station_to,
                    "Station along the alignment of the pose of chainage_to, metres, or None.")
      .def_readonly("least_distance", &Conflict::least_distance,
                    "The least distance between the conflict and the model, metres. None where the "
                    "result has no clearances.")
      .def_readonly(
          "nearest_pose", &Conflict::nearest_pose,
          "The pose at which the conflict has its least distance, or None without clearances.")
      .def_readonly(
          "nearest_source", &Conflict::nearest_source,
          "The source index of the point with the least distance, or None without clearances.")
      .def_readonly("encroachment", &Conflict::encroachment,
                    "By how much the conflict is closer than allowed: radius - least_distance, "
                    "metres, or None without clearances.")
      .def_readonly(
          "depth", &Conflict::depth,
          "How deep the conflict's deepest point is inside the model, metres; 0 where none is. "
          "None where the model has no solids, or the result no clearances.")
      .def_readonly("points_inside", &Conflict::points_inside,
                    "How many of the conflict's points are inside the model at any pose, or None "
                    "as for depth.")
      .def_property_readonly(
          "nearest_point", [](const Conflict& c) { return place(c.nearest_point); },
          "The point with the least distance: 3 float64, metres, or None without clearances.")
      .def_property_readonly(
          "side", [](const Conflict& c) { return name_of(c.side); },
          "On which side of the model the conflict is: 'left', 'right', 'above', 'below', "
          "'front', "
          "'behind' or 'unknown'.")
      .def_readonly("lateral", &Conflict::lateral,
                    "How far the conflict is to the left of the model's pose, or of its body's "
                    "with bodies=; metres, negative to the right, or None.")
      .def_readonly("height", &Conflict::height,
                    "How far the conflict is above the model's pose, or of its body's with "
                    "bodies=; metres, or None.")
      .def_readonly("group", &Conflict::group,
                    "The smallest source index of the group that the conflict was cut from; "
                    "conflicts of one group have the same.")
      .def("__repr__", [](const Conflict& c) {
        return py::str("<Conflict {}: {} points, {:.3f} to {:.3f} m, {}>")
            .format(c.id, c.points, c.chainage_from, c.chainage_to, name_of(c.side));
      });
}

void add_small_group(py::module_& module) {
  py::class_<SmallGroup>(module, "SmallGroup", "A group of too few points to be listed.")
      .def_readonly("points", &SmallGroup::points, "How many colliding points the group has.")
      .def_readonly("source", &SmallGroup::source,
                    "The smallest source index of the group's points.")
      .def_readonly("box", &SmallGroup::box, "The box around the group's points, metres.")
      .def_readonly("first_pose", &SmallGroup::first_pose,
                    "The least index of a pose that touches one of its points.")
      .def_readonly("last_pose", &SmallGroup::last_pose,
                    "The greatest index of a pose that touches one of its points.")
      .def_readonly("chainage_from", &SmallGroup::chainage_from, "Metres along the path.")
      .def_readonly("chainage_to", &SmallGroup::chainage_to, "Metres along the path.")
      .def_readonly("station_from", &SmallGroup::station_from,
                    "Station of the pose of chainage_from, metres, or None.")
      .def_readonly("station_to", &SmallGroup::station_to,
                    "Station of the pose of chainage_to, metres, or None.");
}

void add_conflicts(py::module_& module) {
  using Found = GroupedConflicts;
  py::class_<Found>(module, "Conflicts",
                    "The conflicts of a result: its colliding points, grouped place by place.")
      .def_readonly("listed", &Found::listed,
                    "The conflicts: a list of Conflict in the order of the path.")
      .def_property_readonly(
          "small", [](const Found& c) { return c.small; },
          "A list of SmallGroup along the path: the groups that are not listed.")
      .def_readonly("has_last_poses", &Found::has_last_poses,
                    "Whether the result keeps last poses. Otherwise a conflict's last pose is the "
                    "last that is known to touch it.")
      .def_property_readonly(
          "conflict_of", [](const Found& c) { return to_array(c.conflict_of); },
          "The id of the conflict of each row of the result: n uint32; 0 where its group is too "
          "small to be listed.")
      .def_readonly("colliding_points", &Found::colliding_points,
                    "How many colliding points the result has, listed or not.")
      .def_readonly("groups", &Found::groups,
                    "How many groups there are before long ones are cut, small ones included.")
      .def_readonly("small_groups", &Found::small_groups,
                    "How many groups have too few points to be listed.")
      .def_readonly("small_points", &Found::small_points,
                    "How many points the groups have that are not listed.")
      .def_readonly("path_length", &Found::path_length, "How long the path is, metres.")
      .def_readonly("longest_group", &Found::longest_group,
                    "The longest stretch of the path that one group covers, metres.")
      .def_readonly("longest_group_points", &Found::longest_group_points,
                    "How many points that longest group has.")
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
         std::optional<Box> model_box, const py::object& model,
         const std::vector<PlacedBody>& bodies, const PoseLabels* labels,
         std::uint64_t memory_bytes, int threads, py::object progress, py::object stop) {
        ConflictOptions options = conflict_options(gap, min_points, split, chainage_start, forward,
                                                   up, model_box, memory_bytes, threads);
        const std::vector<Pose> path = poses_of(poses_array(poses, "poses"), "poses");
        const std::vector<Body> placed = bodies_on(bodies, path);
        options.bodies = placed;
        const std::vector<double> station = stations_of(labels);
        options.station = station;
        std::optional<Model> shape;
        if (!model.is_none()) shape = model_of(model_object(model));
        if (shape) options.model = &*shape;
        Watch watch(std::move(progress), py::none(), std::move(stop));
        watch.attach(options);
        return watch.run([&] {
          GroupedConflicts found;
          static_cast<Conflicts&>(found) =
              find_conflicts(result, path, options, &found.conflict_of);
          return found;
        });
      },
      "result"_a, "poses"_a, py::kw_only(), "gap"_a = ConflictOptions{}.gap,
      "min_points"_a = ConflictOptions{}.min_points, "split"_a = ConflictOptions{}.split,
      "chainage_start"_a = 0.0, "forward"_a = "+x", "up"_a = "+z", "model_box"_a = py::none(),
      "model"_a = py::none(), "bodies"_a = py::tuple(), "labels"_a = py::none(),
      "memory_bytes"_a = ConflictOptions{}.memory_bytes, "threads"_a = 0, "progress"_a = py::none(),
      "stop"_a = py::none(),
      R"(find_conflicts(result, poses, *, gap=0.3, min_points=10, split=25.0, chainage_start=0.0, forward='+x', up='+z', model_box=None, model=None, bodies=(), labels=None, memory_bytes=4294967296, threads=0, progress=None, stop=None)
--

Group the colliding points of a result, place by place. Returns a Conflicts.

result: the Result of a query with first_pose=True.
poses: the poses of the search, n x 4 x 4.
gap: metres; points at most this far apart belong to the same conflict.
min_points: groups of fewer are counted, not listed.
split: metres along the path; longer groups are cut at multiples of it; 0: never.
chainage_start: the chainage of the first pose, metres.
forward, up: which axes of the model point ahead and up, such as '+x' or '-z'.
model_box: the Box around the model, where the result does not hold it.
model: the one model of the search, an n x 3 array or a Model: for shift_left, shift_right.
bodies: the bodies of the search, where it was one of a vehicle; sides and offsets are then
    seen from the body that touches.
labels: the PoseLabels that read_trajectory() filled; with stations, conflicts have theirs too.
memory_bytes, threads, progress, stop: as search() takes them.)");
}

}  // namespace

namespace {

void add_station_rows(py::module_& module) {
  py::class_<Overthrow>(module, "Overthrow",
                        "How far the centre line of a body leaves the path in a curve.")
      .def_readonly("end", &Overthrow::end,
                    "The greatest overthrow of the body's two ends, outwards: metres, or None.")
      .def_readonly("middle", &Overthrow::middle,
                    "The greatest overthrow of the body's middle, inwards: metres, or None.");
  py::class_<StationRow>(module, "StationRow", "A stretch of the path.")
      .def_readonly("chainage_from", &StationRow::chainage_from, "Metres along the path.")
      .def_readonly("chainage_to", &StationRow::chainage_to, "Metres along the path.")
      .def_readonly("station_from", &StationRow::station_from,
                    "Station along the alignment at chainage_from, metres; None unless the labels "
                    "have stations.")
      .def_readonly("station_to", &StationRow::station_to,
                    "Station along the alignment at chainage_to, metres, or None.")
      .def_readonly("least", &StationRow::least,
                    "The point that is nearest of all whose nearest pose is on the stretch: a "
                    "FoundPlace, or None.")
      .def_readonly("left", &StationRow::left,
                    "The nearest of those to the left of their body's box, or None.")
      .def_readonly("right", &StationRow::right,
                    "The nearest of those to the right of their body's box, or None.")
      .def_readonly("above", &StationRow::above,
                    "The nearest of those above their body's box, or None.")
      .def_property_readonly(
          "verdict", [](const StationRow& row) { return name_of(row.verdict); },
          "'clear', 'conflict' or 'undecided'.")
      .def_property_readonly(
          "reasons",
          [](const StationRow& row) {
            std::vector<std::string> names;
            for (const Reason reason : row.reasons) names.emplace_back(name_of(reason));
            return names;
          },
          "Why the verdict is undecided: a list such as ['near'].")
      .def_readonly("doubts", &StationRow::doubts,
                    "The codes of the warnings for which 'question-in-doubt' is among the reasons: "
                    "a list such as ['leaves-scan'].")
      .def_readonly("searched", &StationRow::is_searched,
                    "Whether the whole vehicle was searched on all of the stretch.")
      .def_readonly("overthrow", &StationRow::overthrow,
                    "A list of Overthrow, one for each body of StationTable.bodies.")
      .def("__repr__", [](const StationRow& row) {
        return py::str("<StationRow {:.2f} to {:.2f} m: {}>")
            .format(row.chainage_from, row.chainage_to, name_of(row.verdict));
      });
}

void add_station_table(py::module_& module) {
  add_station_rows(module);
  py::class_<StationTable>(module, "StationTable", "The path of a result, stretch by stretch.")
      .def_readonly("bodies", &StationTable::bodies,
                    "The names of the bodies; for one model a single empty name.")
      .def_readonly("rows", &StationTable::rows, "A list of StationRow in the order of the path.")
      .def_readonly("warnings", &StationTable::warnings,
                    "A list of Message: what the table lacks, and why.")
      .def("__len__", [](const StationTable& table) { return table.rows.size(); })
      .def("__repr__", [](const StationTable& table) {
        return text("<a table of " + std::to_string(table.rows.size()) + " stretches>");
      });
  module.def(
      "station_table",
      [](const Result& result, const py::object& poses, double every, double chainage_start,
         const std::string& forward, const std::string& up, std::optional<Box> model_box,
         const std::vector<PlacedBody>& bodies, const PoseLabels* labels, int threads,
         py::object progress, py::object stop) {
        StationOptions options;
        options.every = every;
        options.chainage_start = chainage_start;
        options.forward = value_of("forward", kAxes, forward);
        options.up = value_of("up", kAxes, up);
        options.model_box = model_box;
        options.threads = threads;
        const std::vector<Pose> path = poses_of(poses_array(poses, "poses"), "poses");
        const std::vector<Body> placed = bodies_on(bodies, path);
        options.bodies = placed;
        const std::vector<double> station = stations_of(labels);
        options.station = station;
        Watch watch(std::move(progress), py::none(), std::move(stop));
        watch.attach(options);
        return watch.run([&] { return station_table(result, path, options); });
      },
      "result"_a, "poses"_a, py::kw_only(), "every"_a = StationOptions{}.every,
      "chainage_start"_a = 0.0, "forward"_a = "+x", "up"_a = "+z", "model_box"_a = py::none(),
      "bodies"_a = py::tuple(), "labels"_a = py::none(), "threads"_a = 0, "progress"_a = py::none(),
      "stop"_a = py::none(),
      R"(station_table(result, poses, *, every=5.0, chainage_start=0.0, forward='+x', up='+z', model_box=None, bodies=(), labels=None, threads=0, progress=None, stop=None)
--

Describe the path of a result stretch by stretch. Returns a StationTable.

result: the Result of a query with first_pose=True; with a clearance it has distances too.
poses: the poses of the search, n x 4 x 4.
every: metres; the length of a stretch. The last one may be shorter.
chainage_start, forward, up, model_box: as find_conflicts() takes them.
bodies: the bodies of the search, where it was one of a vehicle. Without them sides and overthrow
    are unknown, and no stretch is clear unless all bodies were searched on the whole path.
labels: the PoseLabels that read_trajectory() filled; with stations, rows have theirs too.
threads, progress, stop: as search() takes them.)");
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
  add_small_group(module);
  add_conflicts(module);
  add_find_conflicts(module);
  add_station_table(module);
}

}  // namespace clearway::python
