#include "clearway/merge.hpp"

#include <pybind11/stl.h>

#include <string>
#include <utility>

#include "python/python.hpp"
#include "python/values.hpp"
#include "python/watch.hpp"

namespace clearway::python {
namespace {

using namespace py::literals;

py::list list_of(const std::vector<PartWarning>& warnings) {
  py::list list;
  for (const PartWarning& warning : warnings) list.append(warning);
  return list;
}

void add_merge_report(py::module_& module) {
  py::class_<PartWarning, Message>(module, "PartWarning",
                                   "A warning of the searches that wrote the parts.")
      .def_readonly("parts", &PartWarning::parts, "How many of the parts have this warning.");
  using Report = MergeReport;
  py::class_<Report, Answer>(module, "MergeReport", "What merge() found in the merged result.")
      .def_readonly("was_finished", &Report::was_finished, "The result was there already.")
      .def_property_readonly(
          "length_unit", [](const Report& r) { return text(r.length_unit); },
          "The unit of the environment: 'metre', 'foot', 'us-survey-foot', 'degree' or 'unknown'.")
      .def_readonly("parts", &Report::parts, "How many parts were merged.")
      .def_property_readonly(
          "warnings", [](const Report& r) { return list_of(r.part_warnings); },
          "The warnings of the parts, each once, and of the merge: a list of PartWarning. The "
          "result keeps them too.")
      .def("__repr__", [](const Report& r) {
        return text("<" + std::to_string(r.colliding_points) + " of " +
                    std::to_string(r.environment_points) + " points collide, of " +
                    std::to_string(r.parts) + " parts" +
                    warning_words({r.part_warnings.begin(), r.part_warnings.end()}) + ">");
      });
}

}  // namespace

void add_merge(py::module_& module) {
  add_merge_report(module);
  module.def(
      "merge",
      [](const py::object& parts, const py::object& output, int threads, std::uint64_t memory_bytes,
         bool overwrite, bool resume, bool strict, py::object progress, py::object message,
         py::object stop) {
        MergeOptions options{threads, memory_bytes, overwrite, resume, strict};
        Watch watch(std::move(progress), std::move(message), std::move(stop));
        watch.attach(options);
        return watch.run(
            [&, from = paths_of(parts), to = path_of(output)] { return merge(from, to, options); });
      },
      "parts"_a, "output"_a, py::kw_only(), "threads"_a = 0,
      "memory_bytes"_a = MergeOptions{}.memory_bytes, "overwrite"_a = false, "resume"_a = false,
      "strict"_a = false, "progress"_a = py::none(), "message"_a = py::none(),
      "stop"_a = py::none(),
      R"(merge(parts, output, *, threads=0, memory_bytes=4294967296, overwrite=False, resume=False, strict=False, progress=None, message=None, stop=None)
--

Make one result of all parts of a search, in any order. Returns a MergeReport.

The result has the same bytes as one search of everything.

parts: the files that searches with shard=(1, n) to shard=(n, n) wrote.
output: the file of the result to write.
overwrite: replaces an existing result.
resume: leaves a result of the same parts as it is.
strict: raises InputError where a search of the parts gave a warning, and merges nothing.
message: called with each of these warnings once, a Message, in this thread.
threads, memory_bytes, progress, stop: as search() takes them.)");
}

}  // namespace clearway::python
