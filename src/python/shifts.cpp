#include <pybind11/stl.h>

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "clearway/session.hpp"
#include "clearway/shift.hpp"
#include "clearway/trajectory.hpp"
#include "core/describe/shift.hpp"
#include "python/arrays.hpp"
#include "python/fields.hpp"
#include "python/findings.hpp"
#include "python/model.hpp"
#include "python/store.hpp"
#include "python/values.hpp"
#include "python/watch.hpp"

namespace clearway::python {
namespace {

using namespace py::literals;

std::string words_of(const StretchShift& row) {
  const std::string what =
      row.conflict == 0 ? "the whole path" : "conflict " + std::to_string(row.conflict);
  if (!row.shift) return what + ": no shift frees it";
  return what + ": " + std::string(py::str("{:+g} m").format(*row.shift)) + " frees it";
}

void add_tables(py::module_& module) {
  py::class_<StretchShift> stretch(
      module, "StretchShift",
      "The least shift that frees a stretch of the path. What has no value "
      "is None.");
  add_properties(stretch, kShiftColumns);
  stretch.def("__repr__", [](const StretchShift& row) { return text("<" + words_of(row) + ">"); });
  py::class_<ShiftTable>(module, "ShiftTable", "The shifts of a path and of its conflicts.")
      .def_readonly("path", &ShiftTable::path, "The StretchShift of the whole path.")
      .def_readonly("conflicts", &ShiftTable::conflicts,
                    "A list of StretchShift, one for each conflict, in their order.")
      .def_readonly("lateral_from", &ShiftTable::lateral_from,
                    "The shift farthest to the right that was tried, metres, 0 or below it.")
      .def_readonly("lateral_to", &ShiftTable::lateral_to,
                    "The shift farthest to the left that was tried, metres.")
      .def_readonly("step", &ShiftTable::step, "The shifts were multiples of it, metres.")
      .def_readonly("searches", &ShiftTable::searches, "How many searches it took for all.")
      .def_readonly("seconds", &ShiftTable::seconds, "How many seconds it took.")
      .def("__len__", [](const ShiftTable& table) { return table.conflicts.size(); })
      .def("__repr__", [](const ShiftTable& table) {
        return text("<" + words_of(table.path) + "; " + std::to_string(table.conflicts.size()) +
                    " conflicts>");
      });
}

/// Finds the conflicts of a result, and their shifts.
ShiftTable shifts_of(const Result& result, const std::filesystem::path& store, const Query& query,
                     ConflictOptions find, ShiftOptions options) {
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

constexpr const char* kFindShifts =
    R"(find_shifts(result, store, model, poses, *, lateral=(-2.0, 2.0), step=0.01, gap=0.0, min_points=0, split=25.0, chainage_start=0.0, forward='+x', up='+z', bodies=(), labels=None, memory_bytes=4294967296, threads=0, progress=None, stop=None)
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
memory_bytes, threads, progress, stop: as search() takes them.)";

void add_find_shifts(py::module_& module) {
  module.def(
      "find_shifts",
      [](const Result& result, SharedStore& store, const py::object& model, const py::object& poses,
         const std::array<double, 2>& lateral, double step, double gap, std::uint64_t min_points,
         double split, double chainage_start, const std::string& forward, const std::string& up,
         const std::vector<PlacedBody>& bodies, const PoseLabels* labels,
         std::uint64_t memory_bytes, int threads, py::object progress, py::object stop) {
        const ConflictOptions find = conflict_options(gap, min_points, split, chainage_start,
                                                      forward, up, memory_bytes, threads);
        ShiftOptions options;
        options.lateral_from = lateral[0];
        options.lateral_to = lateral[1];
        options.step = step;
        options.forward = find.forward;
        options.up = find.up;
        options.chainage_start = chainage_start;
        const std::vector<double> station =
            labels == nullptr ? std::vector<double>() : labels->station;
        options.station = station;
        Query query;
        if (!model.is_none() || bodies.empty()) query.model = model_of(model);
        query.poses = poses_of(poses_array(poses, "poses"), "poses");
        query.bodies = bodies_on(bodies, query.poses);
        Watch watch(std::move(progress), py::none(), std::move(stop));
        watch.attach(options);
        return watch.run([&, path = store.store.path()] {
          return shifts_of(result, path, query, find, options);
        });
      },
      "result"_a, "store"_a, "model"_a, "poses"_a, py::kw_only(),
      "lateral"_a = std::array<double, 2>{-2, 2}, "step"_a = ShiftOptions{}.step,
      "gap"_a = ConflictOptions{}.gap, "min_points"_a = ConflictOptions{}.min_points,
      "split"_a = ConflictOptions{}.split, "chainage_start"_a = 0.0, "forward"_a = "+x",
      "up"_a = "+z", "bodies"_a = py::tuple(), "labels"_a = py::none(),
      "memory_bytes"_a = ConflictOptions{}.memory_bytes, "threads"_a = 0, "progress"_a = py::none(),
      "stop"_a = py::none(), kFindShifts);
}

}  // namespace

void add_shifts(py::module_& module) {
  add_tables(module);
  add_find_shifts(module);
}

}  // namespace clearway::python
