#include "clearway/merge.hpp"

#include <pybind11/stl.h>

#include <string>
#include <utility>

#include "python/python.hpp"
#include "python/watch.hpp"

namespace clearway::python {
namespace {

using namespace py::literals;

void add_merge_report(py::module_& module) {
  using Report = MergeReport;
  py::class_<Report>(module, "MergeReport", "What a merged result says.")
      .def_readonly("was_finished", &Report::was_finished,
                    "The result was there already: it has the places.")
      .def_readonly("parameters", &Report::parameters, "QueryParameters.")
      .def_readonly("parts", &Report::parts)
      .def_readonly("environment_points", &Report::environment_points)
      .def_readonly("model_points", &Report::model_points)
      .def_readonly("poses", &Report::poses)
      .def_readonly("colliding_points", &Report::colliding_points)
      .def_readonly("clearance_points", &Report::clearance_points)
      .def_readonly("profile_poses", &Report::profile_poses)
      .def_readonly("ignored", &Report::ignored, "IgnoredPointCounts.")
      .def_readonly("first_place", &Report::first_place, "A FoundPlace, or None.")
      .def_readonly("least_clearance", &Report::least_clearance, "A FoundPlace, or None.")
      .def_readonly("least_profile", &Report::least_profile, "A FoundPlace, or None.")
      .def("__repr__", [](const Report& r) {
        return text("<" + std::to_string(r.colliding_points) + " of " +
                    std::to_string(r.environment_points) + " points collide, of " +
                    std::to_string(r.parts) + " parts>");
      });
}

}  // namespace

void add_merge(py::module_& module) {
  add_merge_report(module);
  module.def(
      "merge",
      [](const py::object& parts, const py::object& output, int threads, std::uint64_t memory_bytes,
         bool overwrite, bool resume, py::object progress, py::object stop) {
        MergeOptions options{threads, memory_bytes, overwrite, resume};
        Watch watch(std::move(progress), py::none(), std::move(stop));
        watch.attach(options);
        return watch.run(
            [&, from = paths_of(parts), to = path_of(output)] { return merge(from, to, options); });
      },
      "parts"_a, "output"_a, py::kw_only(), "threads"_a = 0,
      "memory_bytes"_a = MergeOptions{}.memory_bytes, "overwrite"_a = false, "resume"_a = false,
      "progress"_a = py::none(), "stop"_a = py::none(),
      R"(merge(parts, output, *, threads=0, memory_bytes=4294967296, overwrite=False, resume=False, progress=None, stop=None)
--

Make one result of all parts of a search, in any order. Returns a MergeReport.

The result has the same bytes as one search of everything.

parts: the files that searches with shard=(1, n) to shard=(n, n) wrote.
output: the result.
overwrite: an existing result.
resume: leaves a result of the same parts as it is.
threads, memory_bytes, progress, stop: as search() takes them.)");
}

}  // namespace clearway::python
