#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "clearway/body.hpp"
#include "clearway/conflicts.hpp"
#include "clearway/error.hpp"
#include "clearway/ledger.hpp"
#include "clearway/report.hpp"
#include "clearway/session.hpp"
#include "clearway/shift.hpp"
#include "clearway/stations.hpp"
#include "clearway/trajectory.hpp"
#include "core/describe/conflict.hpp"
#include "core/describe/ledger.hpp"
#include "core/describe/model.hpp"
#include "core/describe/reports.hpp"
#include "core/describe/shift.hpp"
#include "core/describe/stations.hpp"
#include "python/arrays.hpp"
#include "python/binding.hpp"
#include "python/objects.hpp"
#include "python/watch.hpp"

/// What is made of a result: conflicts, their ledger, stations, shifts and the page.
namespace clearway::python {
namespace {

py::dict counts_of(const Ledger& ledger) {
  py::dict out;
  const LedgerCounts counts = ledger.counts();
  for (std::size_t i = 0; i < counts.size(); ++i) {
    out[name_of(static_cast<LedgerStatus>(i))] = counts[i];
  }
  return out;
}

/// The rows column by column: texts as lists, and the middle and the size of the box as arrays, in
/// which a row without places has NaN.
py::dict columns_of(const Ledger& ledger) {
  py::dict out;
  for_each_field(kLedgerRowColumns, [&](const auto& column) {
    using Value = typename std::decay_t<decltype(column)>::Value;
    if constexpr (std::is_same_v<Value, std::optional<Box>>) {
      for (const bool is_size : {false, true}) {
        for (int k = 0; k < 3; ++k) {
          std::vector<double> values;
          for (const LedgerRow& row : ledger.rows) {
            const auto& box = column.of(row);
            values.push_back(!box      ? std::numeric_limits<double>::quiet_NaN()
                             : is_size ? box->size()[k]
                                       : box->centre()[k]);
          }
          const std::string axis(1, "xyz"[k]);
          out[py::str(is_size ? "size_" + axis : axis)] = to_array(std::move(values));
        }
      }
    } else {
      py::list values;
      for (const LedgerRow& row : ledger.rows) {
        if constexpr (requires { shown(column.of(row)); }) {
          values.append(shown(column.of(row)));
        } else {
          values.append(column.of(row));
        }
      }
      out[column.key] = values;
    }
  });
  return out;
}

void add_ledger(py::module_& module) {
  auto row = add_class<LedgerRow>(module, "LedgerRow", "A row of a ledger.", kLedgerRowColumns);
  add_repr(row, [](const LedgerRow& r) { return "<row " + r.key + ": " + name_of(r.shown) + ">"; });
  auto entry = add_class<LedgerEntry>(module, "LedgerEntry", "What a ledger says of a conflict.",
                                      kLedgerEntryColumns);
  add_repr(entry, [](const LedgerEntry& e) {
    return "<conflict " + std::to_string(e.conflict) + ": " + name_of(e.status) + ">";
  });
  add_class<OutsideOfAccepted>(module, "OutsideOfAccepted",
                               "What is left of an answer without the accepted conflicts.");
  auto ledger = add_class<Ledger>(module, "Ledger",
                                  "A ledger of conflicts after it was compared with a result.");
  ledger
      .def("counts", &counts_of, R"(counts(self)
--

The number of rows, and of conflicts without a row, by status: a dict.)")
      .def("columns", &columns_of, R"(columns(self)
--

The rows as a dict of columns, which pandas.DataFrame() takes.

Texts are lists of str, and `conflicts` a list of lists; `x` to `z` and `size_x` to `size_z` are
arrays of float64, NaN where the ledger does not have the places of a row.)")
      .def("__len__", [](const Ledger& l) { return l.rows.size(); });
  add_repr(ledger, [](const Ledger& l) {
    return "<a ledger of " + std::to_string(l.rows.size()) + " rows>";
  });
}

/// Conflicts, the conflict of each row of the result, and what a ledger says of them.
struct GroupedConflicts : Conflicts {
  std::vector<std::uint32_t> conflict_of = {};
  std::optional<Ledger> ledger = {};
};

/// Groups a result, and compares its conflicts with the table of a ledger where there is one.
/// store: that of the ledger, or null. Called without the GIL.
GroupedConflicts grouped(const Result& result, const std::vector<Pose>& path,
                         const ConflictOptions& find, LedgerOptions options, SharedStore* store) {
  GroupedConflicts found;
  std::vector<std::uint32_t> near;
  static_cast<Conflicts&>(found) = find_conflicts(result, path, find, &found.conflict_of, &near);
  if (options.table.empty()) return found;
  options.memory_bytes = find.memory_bytes;
  options.threads = find.threads;
  options.progress = find.progress;
  options.stop = find.stop;
  const GroupedResult of{result, found, found.conflict_of, near, path};
  if (store == nullptr) {
    found.ledger = apply_ledger(of, find, options);
    return found;
  }
  found.ledger = in_turn(*store, find.stop, [&](const Store& own) {
    options.store = &own;
    return apply_ledger(of, find, options);
  });
  return found;
}

/// The options that find_conflicts(), write_report() and find_shifts() have in common.
ConflictOptions conflict_options(const py::kwargs& given) {
  using Options = ConflictOptions;
  Options options;
  take<&Options::gap, &Options::min_points, &Options::split, &Options::chainage_start,
       &Options::forward, &Options::up, &Options::memory_bytes, &Options::threads>(given, options);
  return options;
}

/// The stations of the argument `labels`, of which there may be none.
std::vector<double> stations_of(const py::kwargs& given) {
  const auto* const labels = argument<const PoseLabels*>(given, "labels");
  return labels == nullptr ? std::vector<double>() : labels->station;
}

constexpr std::tuple kLedgerOfConflicts{fact<&GroupedConflicts::ledger>(
    "What the ledger says of them: a Ledger; None where none was given.")};

void add_conflicts(py::module_& module) {
  auto conflict = add_class<Conflict>(
      module, "Conflict",
      "A place where the vehicle does not fit: colliding points that hang together. What has no "
      "value is None.",
      kConflictColumns);
  add_repr(conflict, [](const Conflict& c) {
    return py::str("<Conflict {}: {} points, {:.3f} to {:.3f} m, {}>")
        .format(c.id, c.points, c.chainage_from, c.chainage_to, name_of(c.side));
  });
  add_class<SmallGroup>(module, "SmallGroup", "A group of too few points to be listed.",
                        kSmallGroupColumns);
  auto found = add_class<GroupedConflicts>(
      module, "Conflicts",
      "The conflicts of a result: its colliding points, grouped place by place.",
      kFactsOf<Conflicts>, kLedgerOfConflicts);
  found
      .def_property_readonly(
          "conflict_of", member_array<&GroupedConflicts::conflict_of, GroupedConflicts>,
          "The id of the conflict of each row of the result: n uint32; 0 where its group is too "
          "small to be listed.")
      .def("__len__", [](const GroupedConflicts& c) { return c.listed.size(); });
  add_repr(found, [](const GroupedConflicts& c) {
    return "<" + std::to_string(c.listed.size()) + " conflicts of " +
           std::to_string(c.colliding_points) + " points>";
  });
}

GroupedConflicts find_conflicts(const py::kwargs& given) {
  auto* const store = argument<SharedStore*>(given, "store");
  LedgerOptions ledger;
  take<&LedgerOptions::update, &LedgerOptions::worse_by, &LedgerOptions::date>(given, ledger);
  if (!given["ledger"].is_none()) {
    ledger.table = path_of(given["ledger"]);
  } else if (ledger.update || ledger.worse_by || store != nullptr) {
    throw UsageError("ledger: expected the table, because update, worse_by and store are about it");
  }
  ConflictOptions options = conflict_options(given);
  const std::vector<Pose> path = poses_of(given);
  const std::vector<Body> bodies = bodies_on(given, path);
  options.bodies = bodies;
  const std::vector<double> station = stations_of(given);
  options.station = station;
  std::optional<Model> shape;
  if (!given["model"].is_none()) shape = model_of(model_object(given["model"]));
  if (shape) options.model = &*shape;
  Watch watch(given, options);
  return watch.run([&, &result = argument<const Result&>(given, "result")] {
    return grouped(result, path, options, ledger, store);
  });
}

void add_station_table(py::module_& module) {
  add_class<Overthrow>(module, "Overthrow",
                       "How far the centre line of a body leaves the path in a curve.");
  auto row = add_class<StationRow>(
      module, "StationRow", "A stretch of the path. What has no value is None.", kStationColumns);
  add_repr(row, [](const StationRow& stretch) {
    return py::str("<StationRow {:.2f} to {:.2f} m: {}>")
        .format(stretch.chainage_from, stretch.chainage_to, name_of(stretch.verdict));
  });
  auto table =
      add_class<StationTable>(module, "StationTable", "The path of a result, stretch by stretch.");
  table.def("__len__", [](const StationTable& t) { return t.rows.size(); });
  add_repr(table, [](const StationTable& t) {
    return "<a table of " + std::to_string(t.rows.size()) + " stretches>";
  });
}

StationTable station_table(const py::kwargs& given) {
  using Options = StationOptions;
  Options options;
  take<&Options::every, &Options::chainage_start, &Options::forward, &Options::up,
       &Options::threads>(given, options);
  const std::vector<Pose> path = poses_of(given);
  const std::vector<Body> bodies = bodies_on(given, path);
  options.bodies = bodies;
  const std::vector<double> station = stations_of(given);
  options.station = station;
  Watch watch(given, options);
  return watch.run([&, &result = argument<const Result&>(given, "result")] {
    return station_table(result, path, options);
  });
}

std::string words_of(const StretchShift& row) {
  const std::string what =
      row.conflict == 0 ? "the whole path" : "conflict " + std::to_string(row.conflict);
  if (!row.shift) return what + ": no shift frees it";
  return what + ": " + std::string(py::str("{:+g} m").format(*row.shift)) + " frees it";
}

void add_shift_table(py::module_& module) {
  auto stretch = add_class<StretchShift>(
      module, "StretchShift",
      "The least shift that frees a stretch of the path. What has no value is None.",
      kShiftColumns);
  add_repr(stretch, [](const StretchShift& row) { return "<" + words_of(row) + ">"; });
  auto table =
      add_class<ShiftTable>(module, "ShiftTable", "The shifts of a path and of its conflicts.");
  table.def("__len__", [](const ShiftTable& t) { return t.conflicts.size(); });
  add_repr(table, [](const ShiftTable& t) {
    return "<" + words_of(t.path) + "; " + std::to_string(t.conflicts.size()) + " conflicts>";
  });
}

/// Finds the conflicts of a result, and their shifts.
ShiftTable shifts_of(const Result& result, const std::filesystem::path& store, const Query& query,
                     ConflictOptions find, const ShiftOptions& options) {
  find.bodies = query.bodies;
  find.station = options.station;
  find.progress = options.progress;
  find.stop = options.stop;
  const Conflicts conflicts = find_conflicts(result, query.poses, find);
  SessionOptions machine;
  machine.threads = find.threads;
  machine.memory_bytes = find.memory_bytes;
  return find_shifts(Session(store, machine), result, query, conflicts.listed, options);
}

ShiftTable find_shifts(const py::kwargs& given) {
  using Options = ShiftOptions;
  const ConflictOptions find = conflict_options(given);
  Options options;
  take<&Options::step, &Options::forward, &Options::up, &Options::chainage_start>(given, options);
  std::tie(options.lateral_from, options.lateral_to) =
      argument<std::pair<double, double>>(given, "lateral");
  const std::vector<double> station = stations_of(given);
  options.station = station;
  Query query;
  const auto bodies = argument<std::vector<PlacedBody>>(given, "bodies");
  const py::object model = given["model"];
  if (!model.is_none() || bodies.empty()) query.model = model_of(model);
  query.poses = poses_of(given);
  query.bodies = bodies_on(bodies, query.poses);
  Watch watch(given, options);
  return watch.run([&, &result = argument<const Result&>(given, "result"),
                    path = argument<SharedStore&>(given, "store").store.path()] {
    return shifts_of(result, path, query, find, options);
  });
}

void add_page(py::module_& module) {
  auto summary =
      add_class<ReportSummary>(module, "ReportSummary", "What the page of write_report() says.");
  summary.def_property_readonly(
      "conflicts", [](const ReportSummary& s) { return py::cast(GroupedConflicts{{s.conflicts}}); },
      "The conflicts on the page: a Conflicts, whose conflict_of is empty.");
  add_repr(summary, [](const ReportSummary& s) {
    return "<" + std::string(name_of(s.verdict)) + ": a page of " + std::to_string(s.bytes) +
           " bytes>";
  });
}

ReportSummary write_report(const py::kwargs& given) {
  using Options = ReportOptions;
  Options options;
  take<&Options::title, &Options::project, &Options::client, &Options::author, &Options::date,
       &Options::result_name, &Options::environment_name, &Options::model_name,
       &Options::trajectory_name, &Options::classes, &Options::max_points, &Options::labels,
       &Options::every, &Options::warnings, &Options::overwrite, &Options::shifts, &Options::ledger,
       &Options::ledger_name>(given, options);
  options.conflicts = conflict_options(given);
  Watch watch(given, options.conflicts);
  const auto bodies = argument<std::vector<PlacedBody>>(given, "bodies");
  const py::object model = given["model"];
  const bool has_no_model = model.is_none() && !bodies.empty();
  const Model moved = has_no_model ? Model() : model_of(model);
  const std::vector<Pose> path = poses_of(given);
  options.bodies = bodies_on(bodies, path);
  for (const PlacedBody& body : bodies) {
    options.mounts.push_back(body.motion ? body.motion->mount : BodyOwnPoses{});
  }
  return watch.run([&, &result = argument<const Result&>(given, "result"),
                    &store = argument<SharedStore&>(given, "store"),
                    to = path_of(given["output"])] {
    return in_turn(store, options.conflicts.stop, [&](const Store& own) {
      return write_report(result, own, moved, path, to, options);
    });
  });
}

}  // namespace

void add_findings(py::module_& module) {
  add_ledger(module);
  add_conflicts(module);
  add_station_table(module);
  add_shift_table(module);
  add_page(module);
  module.def(
      "find_conflicts", &find_conflicts,
      R"(find_conflicts(result: Result, poses: Array, *, gap: From0 = 0.0, min_points: Count = 0,
    split: From0 = 25.0, chainage_start: Number = 0.0, forward: AxisName = '+x',
    up: AxisName = '+z', model: ArrayOrModel = None, bodies: Each(Body) = (),
    labels: PoseLabels = None, ledger: Path = None, update: Flag = False, worse_by: From0 = None,
    date: Text = '', store: Store = None, memory_bytes: Count = 4294967296,
    threads: Int = 0, progress: Progress = None, stop: Stop = None)
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
  module.def(
      "station_table", &station_table,
      R"(station_table(result: Result, poses: Array, *, every: From0 = 5.0, chainage_start: Number = 0.0,
    forward: AxisName = '+x', up: AxisName = '+z', bodies: Each(Body) = (),
    labels: PoseLabels = None, threads: Int = 0, progress: Progress = None,
    stop: Stop = None)
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
  module.def("find_shifts", &find_shifts,
             R"(find_shifts(result: Result, store: Store, model: ArrayOrModel, poses: Array, *,
    lateral: Lateral = (-2.0, 2.0), step: Above0 = 0.01, gap: From0 = 0.0, min_points: Count = 0,
    split: From0 = 25.0, chainage_start: Number = 0.0, forward: AxisName = '+x',
    up: AxisName = '+z', bodies: Each(Body) = (), labels: PoseLabels = None,
    memory_bytes: Count = 4294967296, threads: Int = 0, progress: Progress = None,
    stop: Stop = None)
--

Find the least lateral shift that frees the whole path, and that of each conflict's stretch.

A shift moves the vehicle along the y axis of the path's poses. It frees a conflict where nothing
at all collides at the shifted poses from its first to its last touch; a search confirms each.
Returns a ShiftTable, which write_report(shifts=) takes.

result: the Result of a query with first_pose=True.
store, model, poses: those of the search; what does not fit the result is refused.
lateral: two numbers of metres, the shifts that are tried: from the right, below 0, to the left.
step: metres; shifts are multiples of it.
gap, min_points, split, chainage_start, forward, up, labels: as find_conflicts() takes them.
bodies: the bodies of the search, where it was one of a vehicle; then model is () or None.
memory_bytes, threads, progress, stop: as search() takes them.)");
  module.def(
      "write_report", &write_report,
      R"(write_report(result: Result, store: Store, model: ArrayOrModel, poses: Array, output: Path, *,
    title: Text = '', project: Text = '', client: Text = '', author: Text = '', date: Text = '',
    result_name: Text = '', environment_name: Text = '', model_name: Text = '',
    trajectory_name: Text = '', classes: Each(Number) = (), max_points: Count = 1000000,
    gap: From0 = 0.0, min_points: Count = 0, split: From0 = 25.0, chainage_start: Number = 0.0,
    forward: AxisName = '+x', up: AxisName = '+z', memory_bytes: Count = 4294967296,
    threads: Int = 0, labels: PoseLabels = None, every: From0 = 0.0,
    shifts: ShiftTable = None, ledger: Ledger = None, ledger_name: Text = '',
    warnings: Messages = (), bodies: Each(Body) = (), overwrite: Flag = False,
    progress: Progress = None, stop: Stop = None)
--

Write one HTML file that needs nothing else: verdict, profile, plan, conflicts, 3-D view.

Returns a ReportSummary.

result, store, model, poses: those of the search; what does not fit the result is refused.
output: the HTML file to write.
title, project, client, author, date: texts for the head of the page, where nothing else depends
    on the time.
result_name, environment_name, model_name, trajectory_name: names of the files, for the page to
    show.
classes: one to three distances, metres, ascending: below these a point is hit, near, or to watch.
max_points: how many environment points the page shows at the most.
gap, min_points, split, chainage_start, forward, up: as find_conflicts() takes them.
labels: the PoseLabels that read_trajectory() filled.
every: metres; the length of a stretch in the table of stations. 0: 5, or so long that there are
    at most 200.
shifts: the ShiftTable of find_shifts() for conflicts that were found in the same way: the page
    shows what frees each of them.
ledger: the Ledger of the conflicts, which find_conflicts(ledger=) gives with the same options.
ledger_name: the name of its table, for the page to show.
warnings: messages of reading the inputs, which the page shows. Warnings of the search are in the
    result and shown in any case; they may be among these.
bodies: the bodies of the search, where it was one of a vehicle; then model is () or None, and
    poses are those of the path.
overwrite: replaces an existing page.
memory_bytes, threads, progress, stop: as search() takes them.)");
}

}  // namespace clearway::python
