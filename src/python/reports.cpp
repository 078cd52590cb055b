#include <pybind11/stl.h>

#include <string>

#include "clearway/search.hpp"
#include "python/arrays.hpp"
#include "python/values.hpp"

namespace clearway::python {
namespace {

using Report = SearchReport;

void add_seconds(py::module_& module) {
  using Seconds = SearchSeconds;
  py::class_<Seconds>(module, "SearchSeconds", "Wall clock of a search. Parts overlap.")
      .def_readonly("total", &Seconds::total)
      .def_readonly("context", &Seconds::context)
      .def_readonly("context_wait", &Seconds::context_wait)
      .def_readonly("thin", &Seconds::thin)
      .def_readonly("field", &Seconds::field)
      .def_readonly("plan", &Seconds::plan)
      .def_readonly("engine", &Seconds::engine)
      .def_readonly("search", &Seconds::search)
      .def_readonly("read", &Seconds::read)
      .def_readonly("upload", &Seconds::upload)
      .def_readonly("compute", &Seconds::compute)
      .def_readonly("collect", &Seconds::collect)
      .def_readonly("write", &Seconds::write)
      .def_readonly("end_wait", &Seconds::end_wait);
  py::class_<ToleranceReport>(module, "ToleranceReport", "What a tolerance spared.")
      .def_readonly("model_points_kept", &ToleranceReport::model_points_kept)
      .def_readonly("poses_kept", &ToleranceReport::poses_kept)
      .def_readonly("resolved_by_bounds", &ToleranceReport::resolved_by_bounds);
  py::class_<EngineEstimate>(module, "EngineEstimate", "Of the whole call on the CPU.")
      .def_readonly("sweep_seconds", &EngineEstimate::sweep_seconds)
      .def_readonly("kdtree_seconds", &EngineEstimate::kdtree_seconds);
  py::class_<DeviceEstimate>(module, "DeviceEstimate", "Seconds, a GPU's start included.")
      .def_readonly("cpu", &DeviceEstimate::cpu)
      .def_readonly("cuda", &DeviceEstimate::cuda);
}

void add_findings_of(py::class_<Report>& report) {
  report
      .def_readonly("was_finished", &Report::was_finished,
                    "The result was there already: nothing was searched.")
      .def_readonly("environment_points", &Report::environment_points)
      .def_readonly("model_points", &Report::model_points)
      .def_readonly("model_triangles", &Report::model_triangles,
                    "Of a surface, whose corners the model points are; otherwise 0.")
      .def_readonly("poses", &Report::poses)
      .def_readonly("model_solids", &Report::model_solids, "Parts of it that have an inside.")
      .def_readonly("colliding_points", &Report::colliding_points)
      .def_readonly("inside_points", &Report::inside_points,
                    "With clearances: colliding points inside a solid of the model at any pose.")
      .def_readonly("clearance_points", &Report::clearance_points,
                    "Points closer than the clearance asked for.")
      .def_readonly("profile_poses", &Report::profile_poses,
                    "Poses closer than the profile's distance asked for.")
      .def_readonly("ignored", &Report::ignored, "IgnoredPointCounts of the whole environment.")
      .def_readonly("ignored_looked_at", &Report::ignored_looked_at,
                    "Ignored points of the cells that this search looked at.")
      .def_readonly("first_place", &Report::first_place,
                    "The point with the smallest first pose, a FoundPlace, or None.")
      .def_readonly("least_clearance", &Report::least_clearance,
                    "The point with the least clearance, a FoundPlace, or None.")
      .def_readonly("least_profile", &Report::least_profile,
                    "The point with the least distance of the profile, a FoundPlace, or None.")
      .def_property_readonly(
          "warnings", [](const Report& r) { return to_list(r.warnings); },
          "A list of Message: what may be wrong with the question.");
}

void add_work_of(py::class_<Report>& report) {
  report
      .def_property_readonly(
          "engine", [](const Report& r) { return name_of(r.engine); }, "That searched.")
      .def_property_readonly("device", [](const Report& r) { return name_of(r.device); })
      .def_property_readonly("device_name", [](const Report& r) { return text(r.device_name); })
      .def_readonly("engine_estimate", &Report::engine_estimate,
                    "Where engine 'auto' chose, an EngineEstimate.")
      .def_readonly("estimate", &Report::estimate, "Where device 'auto' chose, a DeviceEstimate.")
      .def_property_readonly(
          "shard",
          [](const Report& r) -> py::object {
            if (!r.shard) return py::none();
            return py::make_tuple(r.shard->number, r.shard->count);
          },
          "Where it is the answer of one part alone: (i, n); otherwise None.")
      .def_readonly("shard_share", &Report::shard_share,
                    "Of a shard: its estimated work over the mean; otherwise None.")
      .def_readonly("searches", &Report::searches, "Pairs of pose and model point or triangle.")
      .def_readonly("tolerance", &Report::tolerance, "A ToleranceReport, or None.")
      .def_readonly("field_voxel", &Report::field_voxel, "Metres; 0: none.")
      .def_readonly("grid_cell", &Report::grid_cell, "Metres; 0: none.")
      .def_readonly("cells_total", &Report::cells_total)
      .def_readonly("cells_read", &Report::cells_read)
      .def_readonly("bytes_read", &Report::bytes_read)
      .def_readonly("resumed_cells", &Report::resumed_cells, "Known from a journal.")
      .def_readonly("resumed_poses", &Report::resumed_poses, "Known from a journal.")
      .def_readonly("pages", &Report::pages)
      .def_readonly("page_bytes", &Report::page_bytes)
      .def_readonly("slots", &Report::slots)
      .def_readonly("needed_host_bytes", &Report::needed_host_bytes)
      .def_readonly("pinned_bytes", &Report::pinned_bytes)
      .def_readonly("peak_device_bytes", &Report::peak_device_bytes)
      .def_readonly("seconds", &Report::seconds, "A SearchSeconds.");
}

}  // namespace

void add_reports(py::module_& module) {
  add_seconds(module);
  py::class_<Report> report(module, "SearchReport", "What a search found, and how.");
  add_findings_of(report);
  add_work_of(report);
  report.def("__repr__", [](const Report& r) {
    return text("<" + (r.shard ? in_words(*r.shard) + ": " : "") +
                std::to_string(r.colliding_points) + " of " + std::to_string(r.environment_points) +
                " points collide" + warning_words(r.warnings) + ">");
  });
}

}  // namespace clearway::python
