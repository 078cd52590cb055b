#include "python/findings.hpp"

#include <pybind11/stl.h>

#include <string>
#include <utility>

#include "clearway/body.hpp"
#include "clearway/conflicts.hpp"
#include "clearway/error.hpp"
#include "clearway/ledger.hpp"
#include "clearway/stations.hpp"
#include "clearway/trajectory.hpp"
#include "core/describe/conflict.hpp"
#include "core/describe/stations.hpp"
#include "python/arrays.hpp"
#include "python/fields.hpp"
#include "python/model.hpp"
#include "python/store.hpp"
#include "python/values.hpp"
#include "python/watch.hpp"

namespace clearway::python {
namespace {

using namespace py::literals;

/// Conflicts, the conflict of each row of the result, and what a ledger says of them.
struct GroupedConflicts : Conflicts {
  std::vector<std::uint32_t> conflict_of = {};
  std::optional<Ledger> ledger = {};
};

/// The ledger that conflicts are compared with; without a table none.
struct LedgerArguments {
  LedgerOptions options;
  SharedStore* store = nullptr;  ///< null: not given
};

/// Groups a result, and compares its conflicts with a ledger. Called without the GIL.
GroupedConflicts grouped(const Result& result, const std::vector<Pose>& path,
                         const ConflictOptions& find, const LedgerArguments& ledger) {
  GroupedConflicts found;
  std::vector<std::uint32_t> near;
  static_cast<Conflicts&>(found) = find_conflicts(result, path, find, &found.conflict_of, &near);
  if (ledger.options.table.empty()) return found;
  LedgerOptions options = ledger.options;
  options.memory_bytes = find.memory_bytes;
  options.threads = find.threads;
  options.progress = find.progress;
  options.stop = find.stop;
  const GroupedResult of{result, found, found.conflict_of, near, path};
  if (ledger.store == nullptr) {
    found.ledger = apply_ledger(of, find, options);
    return found;
  }
  found.ledger = in_turn(*ledger.store, find.stop, [&](const Store& own) {
    options.store = &own;
    return apply_ledger(of, find, options);
  });
  return found;
}

/// The stations of labels, of which there may be none.
std::vector<double> stations_of(const PoseLabels* labels) {
  return labels == nullptr ? std::vector<double>() : labels->station;
}

void add_conflict(py::module_& module) {
  py::class_<Conflict> conflict(
      module, "Conflict",
      "A place where the vehicle does not fit: colliding points that hang together. What has no "
      "value is None.");
  add_properties(conflict, kConflictColumns);
  conflict.def("__repr__", [](const Conflict& c) {
    return py::str("<Conflict {}: {} points, {:.3f} to {:.3f} m, {}>")
        .format(c.id, c.points, c.chainage_from, c.chainage_to, name_of(c.side));
  });
  py::class_<SmallGroup> group(module, "SmallGroup", "A group of too few points to be listed.");
  add_properties(group, kSmallGroupColumns);
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
      .def_property_readonly(
          "conflict_of", [](const Found& c) { return to_array(c.conflict_of); },
          "The id of the conflict of each row of the result: n uint32; 0 where its group is too "
          "small to be listed.")
      .def_readonly("ledger", &Found::ledger,
                    "What the ledger says of them: a Ledger; None where none was given.")
      .def_readonly("gap", &Found::gap,
                    "How far apart points of one conflict are at most: the gap that was used.")
      .def_readonly("min_points", &Found::min_points,
                    "How many points a conflict has at least: the number that was used.")
      .def_readonly("spacing", &Found::spacing,
                    "How far apart colliding points are, as the lower median of the distances to "
                    "the nearest one at another place; None with fewer than 10 places.")
      .def_readonly("colliding_points", &Found::colliding_points,
                    "How many colliding points the result has, listed or not.")
      .def_readonly("classes", &Found::classes,
                    "How many colliding and near points have each class: a dict of numbers by "
                    "class, which is empty unless the scans have classes.")
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
      .def_readonly("longest_group_height_from", &Found::longest_group_height_from,
                    "How far the lowest point of that group lies above the lowest point of the "
                    "model, metres. None unless the group spans half of the path or more.")
      .def_readonly("longest_group_height_to", &Found::longest_group_height_to,
                    "How far its highest point lies above the lowest point of the model, metres.")
      .def_property_readonly(
          "longest_group_is", [](const Found& c) { return name_of(c.longest_group_is); },
          "What that group probably is: 'ground' where most of it lies in the lowest 0.5 m, "
          "'inside' where all of it lies within the model's width and height, as the vehicle does "
          "that carried the scanner, otherwise 'other'.")
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
         const py::object& model, const std::vector<PlacedBody>& bodies, const PoseLabels* labels,
         const py::object& ledger, bool update, std::optional<double> worse_by, std::string date,
         SharedStore* store, std::uint64_t memory_bytes, int threads, py::object progress,
         py::object stop) {
        LedgerArguments compared;
        if (!ledger.is_none()) compared.options.table = path_of(ledger);
        compared.options.update = update;
        compared.options.worse_by = worse_by;
        compared.options.date = std::move(date);
        compared.store = store;
        if (ledger.is_none() && (update || worse_by || store != nullptr)) {
          throw UsageError(
              "ledger: expected the table, because update, worse_by and store are "
              "about it");
        }
        ConflictOptions options = conflict_options(gap, min_points, split, chainage_start, forward,
                                                   up, memory_bytes, threads);
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
        return watch.run([&] { return grouped(result, path, options, compared); });
      },
      "result"_a, "poses"_a, py::kw_only(), "gap"_a = ConflictOptions{}.gap,
      "min_points"_a = ConflictOptions{}.min_points, "split"_a = ConflictOptions{}.split,
      "chainage_start"_a = 0.0, "forward"_a = "+x", "up"_a = "+z", "model"_a = py::none(),
      "bodies"_a = py::tuple(), "labels"_a = py::none(), "ledger"_a = py::none(),
      "update"_a = false, "worse_by"_a = py::none(), "date"_a = "", "store"_a = py::none(),
      "memory_bytes"_a = ConflictOptions{}.memory_bytes, "threads"_a = 0, "progress"_a = py::none(),
      "stop"_a = py::none(),
      R"(find_conflicts(result, poses, *, gap=0.0, min_points=0, split=25.0, chainage_start=0.0, forward='+x', up='+z', model=None, bodies=(), labels=None, ledger=None, update=False, worse_by=None, date='', store=None, memory_bytes=4294967296, threads=0, progress=None, stop=None)
--

Group the colliding points of a result, place by place. Returns a Conflicts.

result: the Result of a query with first_pose=True.
poses: the poses of the search, n x 4 x 4.
gap: metres; points at most this far apart belong to the same conflict; 0: 0.3 m, or three times
    the spacing of the colliding points where that is more.
min_points: groups of fewer are counted, not listed; 0: as many as lie on a square of 10 cm, at
    least 1 and at most 10.
split: metres along the path; longer groups are cut at multiples of it; 0: never.
chainage_start: the chainage of the first pose, metres.
forward, up: which axes of the model point ahead and up, such as '+x' or '-z'.
model: the one model of the search, an n x 3 array or a Model: for own_shift_left and
    own_shift_right.
bodies: the bodies of the search, where it was one of a vehicle; sides and offsets are then
    seen from the body that touches.
labels: the PoseLabels that read_trajectory() filled; with stations, conflicts have theirs too.
ledger: the table of a ledger, a CSV file, which the conflicts are compared with. Its places are in
    a file beside it.
update: whether to write into the ledger what was found; the files are made if they do not exist.
worse_by: an accepted conflict is worse where it comes nearer, or needs a larger shift or trim, by
    more than this, in metres; None stands for 0.02.
date: the day of the run, such as '2026-06-30'; empty: today in UTC.
store: the Store that was searched. Without it, or without the model or the bodies, no row of the
    ledger is gone.
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
  py::class_<StationRow> row(module, "StationRow",
                             "A stretch of the path. What has no value is None.");
  add_properties(row, kStationColumns);
  row.def("__repr__", [](const StationRow& stretch) {
    return py::str("<StationRow {:.2f} to {:.2f} m: {}>")
        .format(stretch.chainage_from, stretch.chainage_to, name_of(stretch.verdict));
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
         const std::string& forward, const std::string& up, const std::vector<PlacedBody>& bodies,
         const PoseLabels* labels, int threads, py::object progress, py::object stop) {
        StationOptions options;
        options.every = every;
        options.chainage_start = chainage_start;
        options.forward = value_of("forward", kChoices<Axis>, forward);
        options.up = value_of("up", kChoices<Axis>, up);
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
      "chainage_start"_a = 0.0, "forward"_a = "+x", "up"_a = "+z", "bodies"_a = py::tuple(),
      "labels"_a = py::none(), "threads"_a = 0, "progress"_a = py::none(), "stop"_a = py::none(),
      R"(station_table(result, poses, *, every=5.0, chainage_start=0.0, forward='+x', up='+z', bodies=(), labels=None, threads=0, progress=None, stop=None)
--

Describe the path of a result stretch by stretch. Returns a StationTable.

result: the Result of a query with first_pose=True; with a clearance it has distances too.
poses: the poses of the search, n x 4 x 4.
every: metres; the length of a stretch. The last one may be shorter.
chainage_start, forward, up: as find_conflicts() takes them.
bodies: the bodies of the search, where it was one of a vehicle. Without them sides and overthrow
    are unknown, and no stretch is clear unless all bodies were searched on the whole path.
labels: the PoseLabels that read_trajectory() filled; with stations, rows have theirs too.
threads, progress, stop: as search() takes them.)");
}

}  // namespace

ConflictOptions conflict_options(double gap, std::uint64_t min_points, double split,
                                 double chainage_start, const std::string& forward,
                                 const std::string& up, std::uint64_t memory_bytes, int threads) {
  ConflictOptions options;
  options.gap = gap;
  options.min_points = min_points;
  options.split = split;
  options.chainage_start = chainage_start;
  options.forward = value_of("forward", kChoices<Axis>, forward);
  options.up = value_of("up", kChoices<Axis>, up);
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
  add_station_table(module);
}

}  // namespace clearway::python
