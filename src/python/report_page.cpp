#include <pybind11/stl.h>

#include <string>
#include <utility>

#include "clearway/report.hpp"
#include "python/arrays.hpp"
#include "python/findings.hpp"
#include "python/model.hpp"
#include "python/store.hpp"
#include "python/values.hpp"
#include "python/watch.hpp"

namespace clearway::python {
namespace {

using namespace py::literals;

void add_summary(py::module_& module) {
  py::class_<ReportSummary>(module, "ReportSummary", "What the page of write_report() says.")
      .def_readonly("clear", &ReportSummary::clear, "Whether the verdict is 'clear'.")
      .def_property_readonly(
          "verdict", [](const ReportSummary& s) { return text(name_of(s.verdict)); },
          "The verdict: 'clear', 'conflict' or 'undecided'.")
      .def_readonly("bytes", &ReportSummary::bytes, "How many bytes the page has.")
      .def_property_readonly(
          "conflicts", [](const ReportSummary& s) { return to_python(s.conflicts); },
          "The conflicts on the page: a Conflicts, whose conflict_of is empty.")
      .def_property_readonly(
          "facts", [](const ReportSummary& s) { return text(s.facts); },
          "What the page says, without its points: a text of JSON.")
      .def("__repr__", [](const ReportSummary& s) {
        return text("<" + std::string(name_of(s.verdict)) + ": a page of " +
                    std::to_string(s.bytes) + " bytes>");
      });
}

constexpr const char* kWriteReport =
    R"(write_report(result, store, model, poses, output, *, title='', project='', client='', author='', date='', result_name='', environment_name='', model_name='', trajectory_name='', classes=(), max_points=1000000, gap=0.0, min_points=0, split=25.0, chainage_start=0.0, forward='+x', up='+z', memory_bytes=4294967296, threads=0, labels=None, every=0.0, shifts=None, ledger=None, ledger_name='', warnings=(), bodies=(), overwrite=False, progress=None, stop=None)
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
memory_bytes, threads, progress, stop: as search() takes them.)";

void add_write_report(py::module_& module) {
  module.def(
      "write_report",
      [](const Result& result, SharedStore& store, const py::object& model, const py::object& poses,
         const py::object& output, std::string title, std::string project, std::string client,
         std::string author, std::string date, std::string result_name,
         std::string environment_name, std::string model_name, std::string trajectory_name,
         std::vector<double> classes, std::uint64_t max_points, double gap,
         std::uint64_t min_points, double split, double chainage_start, const std::string& forward,
         const std::string& up, std::uint64_t memory_bytes, int threads, const PoseLabels* labels,
         double every, const ShiftTable* shifts, const Ledger* ledger, std::string ledger_name,
         const py::object& warnings, const std::vector<PlacedBody>& bodies, bool overwrite,
         py::object progress, py::object stop) {
        ReportOptions options{{std::move(title), std::move(project), std::move(client),
                               std::move(author), std::move(date)},
                              std::move(result_name),
                              std::move(environment_name),
                              std::move(model_name),
                              std::move(trajectory_name),
                              std::move(classes),
                              max_points,
                              conflict_options(gap, min_points, split, chainage_start, forward, up,
                                               memory_bytes, threads),
                              labels == nullptr ? PoseLabels{} : *labels,
                              every,
                              messages_of(warnings),
                              overwrite};
        if (shifts != nullptr) options.shifts = *shifts;
        if (ledger != nullptr) options.ledger = *ledger;
        options.ledger_name = std::move(ledger_name);
        Watch watch(std::move(progress), py::none(), std::move(stop));
        watch.attach(options.conflicts);
        const bool has_no_model = model.is_none() && !bodies.empty();
        const Model moved = has_no_model ? Model() : model_of(model);
        const std::vector<Pose> path = poses_of(poses_array(poses, "poses"), "poses");
        options.bodies = bodies_on(bodies, path);
        for (const PlacedBody& body : bodies) {
          options.mounts.push_back(body.motion ? body.motion->mount : BodyOwnPoses{});
        }
        return watch.run([&, to = path_of(output)] {
          return in_turn(store, options.conflicts.stop, [&](const Store& own) {
            return write_report(result, own, moved, path, to, options);
          });
        });
      },
      "result"_a, "store"_a, "model"_a, "poses"_a, "output"_a, py::kw_only(), "title"_a = "",
      "project"_a = "", "client"_a = "", "author"_a = "", "date"_a = "", "result_name"_a = "",
      "environment_name"_a = "", "model_name"_a = "", "trajectory_name"_a = "",
      "classes"_a = std::vector<double>{}, "max_points"_a = ReportOptions{}.max_points,
      "gap"_a = ConflictOptions{}.gap, "min_points"_a = ConflictOptions{}.min_points,
      "split"_a = ConflictOptions{}.split, "chainage_start"_a = 0.0, "forward"_a = "+x",
      "up"_a = "+z", "memory_bytes"_a = ConflictOptions{}.memory_bytes, "threads"_a = 0,
      "labels"_a = py::none(), "every"_a = 0.0, "shifts"_a = py::none(), "ledger"_a = py::none(),
      "ledger_name"_a = "", "warnings"_a = py::tuple(), "bodies"_a = py::tuple(),
      "overwrite"_a = false, "progress"_a = py::none(), "stop"_a = py::none(), kWriteReport);
}

}  // namespace

void add_report_page(py::module_& module) {
  add_summary(module);
  add_write_report(module);
}

}  // namespace clearway::python
