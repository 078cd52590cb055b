#include <pybind11/stl.h>

#include <string>

#include "clearway/search.hpp"
#include "core/describe/seen.hpp"
#include "python/arrays.hpp"
#include "python/fields.hpp"
#include "python/values.hpp"

namespace clearway::python {
namespace {

using Report = SearchReport;

void add_seconds(py::module_& module) {
  using Seconds = SearchSeconds;
  py::class_<Seconds>(module, "SearchSeconds",
                      "How many seconds the parts of a search took. Parts that run at the same "
                      "time overlap, so that their sum may exceed the total.")
      .def_readonly("total", &Seconds::total, "Seconds from the call until the result was written.")
      .def_readonly("context", &Seconds::context,
                    "Seconds that starting the GPUs took, beside all that comes before the engine.")
      .def_readonly("context_wait", &Seconds::context_wait,
                    "Seconds that the search waited for the GPUs to start.")
      .def_readonly("check", &Seconds::check,
                    "Seconds of looking at the question before it was searched.")
      .def_readonly(
          "field", &Seconds::field,
          "Seconds of making what the engine looks up, such as the field around the model.")
      .def_readonly("plan", &Seconds::plan,
                    "Seconds of planning which cells are searched at which poses.")
      .def_readonly("engine", &Seconds::engine, "Seconds of making the engine with its memory.")
      .def_readonly("search", &Seconds::search,
                    "Seconds from the first cell that was read to the last one that was searched.")
      .def_readonly("read", &Seconds::read, "Seconds in which cells of the store were read.")
      .def_readonly("upload", &Seconds::upload, "Seconds in which cells were copied to a GPU.")
      .def_readonly("compute", &Seconds::compute, "Seconds in which distances were computed.")
      .def_readonly("collect", &Seconds::collect, "Seconds in which what was found was gathered.")
      .def_readonly("swept", &Seconds::swept, "Seconds of finding the cubes that the model sweeps.")
      .def_readonly("beams", &Seconds::beams,
                    "Seconds of following the scanner's beams through these cubes.")
      .def_readonly("write", &Seconds::write, "Seconds of writing the result.")
      .def_readonly(
          "end_wait", &Seconds::end_wait,
          "Seconds that the call waited, once the result was written, for the GPUs to end.");
  py::class_<DeviceEstimate>(
      module, "DeviceEstimate",
      "How many seconds the search would take on each device, as estimated before it.")
      .def_readonly("cpu", &DeviceEstimate::cpu, "Estimated seconds on the CPU.")
      .def_readonly("cuda", &DeviceEstimate::cuda,
                    "Estimated seconds on a GPU, its start included.");
}

void add_bytes_read(py::module_& module) {
  py::class_<BytesRead>(module, "BytesRead",
                        "How many bytes of a store's points were read, by column. What is read "
                        "again counts again.")
      .def_readonly("coordinates", &BytesRead::coordinates, "Bytes of coordinates.")
      .def_readonly("sources", &BytesRead::sources, "Bytes of source indices.")
      .def_readonly("classes", &BytesRead::classes, "Bytes of classes.")
      .def_readonly("origins", &BytesRead::origins, "Bytes of the origins of beams.");
}

py::list reasons_of(const Answer& answer) {
  py::list list;
  for (const Reason reason : answer.reasons()) list.append(text(name_of(reason)));
  return list;
}

void add_searched_length(py::module_& module) {
  py::class_<SearchedLength>(module, "SearchedLength",
                             "How much of a path was searched, in metres along its positions.")
      .def_readonly("path", &SearchedLength::path, "Metres of the whole path.")
      .def_readonly("whole", &SearchedLength::whole,
                    "Metres on which all bodies have poses, so that all of them were searched.")
      .def_readonly("part", &SearchedLength::part,
                    "Metres on which some bodies were searched, and others have no pose.");
}

void add_seen_summary(py::module_& module) {
  py::class_<SeenSummary> seen(module, "SeenSummary",
                               "What is known of the space that the model sweeps, in cubes.");
  add_properties(seen, kSeenColumns);
}

void add_verdict_of(py::class_<Answer>& answer) {
  answer
      .def_property_readonly(
          "verdict", [](const Answer& a) { return text(name_of(a.verdict())); },
          "The verdict: 'clear', 'conflict' or 'undecided'; 'unknown' of one part alone that has "
          "no colliding point.")
      .def_property_readonly(
          "reasons", reasons_of,
          "Why the verdict is undecided: a list of 'near', 'few', 'errors-exceed-margin', "
          "'not-scanned' and 'question-in-doubt'; otherwise empty.")
      .def_property_readonly(
          "margins",
          [](const Answer& a) -> py::object {
            if (!a.budget) return py::none();
            py::dict margins;
            margins["clear"] = a.budget->clear();
            margins["conflict"] = a.budget->conflict();
            return margins;
          },
          "What the error budget adds to the radius for 'clear' and takes from it for 'conflict', "
          "in metres: a dict with these two keys. None without a budget.")
      .def_readonly("near_points", &Answer::near_points,
                    "How many further points are closer than the radius and the error budget.")
      .def_property_readonly(
          "seen", [](const Answer& a) { return a.seen; },
          "What is known of the space that the model sweeps: a SeenSummary. None unless the query "
          "asked for it.")
      .def_property_readonly(
          "certain_points", [](const Answer& a) { return a.certain.points; },
          "How many points are certainly too close by the error budget; 0 without one.")
      .def_property_readonly(
          "warnings", [](const Answer& a) { return to_list(a.warnings); },
          "What may be wrong with the question and its inputs: a list of Message. Read it before "
          "you trust an answer.")
      .def_property_readonly("doubts", &Answer::doubts,
                             "The codes of the warnings that put the question, or a stretch of its "
                             "path, in doubt: a list of str.")
      .def_property_readonly("warned_of", &Answer::warned_of,
                             "The codes of the other warnings: a list of str.");
}

void add_counts_of(py::class_<Answer>& answer) {
  answer.def_readonly("parameters", &Answer::parameters, "What was asked: QueryParameters.")
      .def_readonly("environment_points", &Answer::environment_points,
                    "How many points the environment has.")
      .def_readonly("model_points", &Answer::model_points,
                    "How many points the model has, or corners where it is a surface.")
      .def_readonly("poses", &Answer::poses, "How many poses the path has.")
      .def_readonly("model_spacing", &Answer::model_spacing,
                    "Metres. The model's points are samples of a mesh, and no place of its surface "
                    "is farther than this from one of them. 0: the model is no sampled mesh.")
      .def_readonly("model_solids", &Answer::model_solids,
                    "How many parts of the model have an inside.")
      .def_readonly("colliding_points", &Answer::colliding_points,
                    "How many environment points are closer to the moving model than the radius.")
      .def_readonly("classes", &Answer::classes,
                    "How many of the colliding and near points have each class: a dict of numbers "
                    "by class, which is empty unless the scans have classes.")
      .def_readonly("inside_points", &Answer::inside_points,
                    "How many colliding points are inside a solid of the model at any pose. "
                    "Counted where clearances were asked for.")
      .def_readonly("clearance_points", &Answer::clearance_points,
                    "How many points are closer than the clearance that was asked for.")
      .def_readonly(
          "profile_poses", &Answer::profile_poses,
          "At how many poses something is closer than the profile's distance that was asked for.")
      .def_readonly("ignored", &Answer::ignored,
                    "How many points of the environment the query left out: IgnoredPointCounts.")
      .def_readonly("body_floors", &Answer::body_floors,
                    "The floor of each body in metres of its frame, its own or that of the query, "
                    "None for a body without one; empty where no body has a floor.")
      .def_readonly("floor_colliding", &Answer::floor_colliding,
                    "How many points would collide without the floor and are not judged because of "
                    "it. None without a floor.")
      .def_readonly("ignored_colliding", &Answer::ignored_colliding,
                    "How many ignored points would collide if they were searched.")
      .def_readonly(
          "ignored_colliding_high", &Answer::ignored_colliding_high,
          "How many ignored points the model would first touch more than half a metre above its "
          "lowest point.");
}

void add_places_of(py::class_<Answer>& answer) {
  answer
      .def_readonly("first_place", &Answer::first_place,
                    "The colliding point with the smallest first pose: a FoundPlace. None where "
                    "nothing collides or first poses were not asked for.")
      .def_readonly("least_clearance", &Answer::least_clearance,
                    "The point with the least clearance: a FoundPlace. None where there is none or "
                    "clearances were not asked for.")
      .def_readonly("least_profile", &Answer::least_profile,
                    "The point with the least distance of the profile: a FoundPlace. None where "
                    "there is none or no profile was asked for.")
      .def_property_readonly(
          "first", [](const Answer& a) { return a.first_place; },
          "The colliding point with the smallest first pose, as first_place has it.")
      .def_property_readonly(
          "least", [](const Answer& a) { return a.nearest(); },
          "The place of the least distance that is known, of profile and clearances: a FoundPlace. "
          "None where nothing is that close or neither was asked for.")
      .def_readonly(
          "searched", &Answer::searched,
          "How much of the path was searched: a SearchedLength. None for one model, which "
          "is searched on the whole path.")
      .def_property_readonly(
          "shard",
          [](const Answer& a) -> py::object {
            if (!a.shard) return py::none();
            return py::make_tuple(a.shard->number, a.shard->count);
          },
          "(i, n) where only the i-th of n parts was searched; otherwise None.");
}

void add_answer(py::module_& module) {
  add_searched_length(module);
  add_seen_summary(module);
  py::class_<Answer> answer(
      module, "Answer",
      "The answer to a query in short: the verdict, and the places that matter most.");
  add_verdict_of(answer);
  add_counts_of(answer);
  add_places_of(answer);
  answer.def("__repr__", [](const Answer& a) {
    return text("<Answer: " + std::string(name_of(a.verdict())) + ", " +
                std::to_string(a.colliding_points) + " of " + std::to_string(a.environment_points) +
                " points collide>");
  });
}

void add_findings_of(py::class_<Report, Answer>& report) {
  report
      .def_readonly("was_finished", &Report::was_finished,
                    "Whether the result was there already, so that nothing was searched.")
      .def_readonly("model_triangles", &Report::model_triangles,
                    "How many triangles the model has; 0 where it is points.");
}

void add_work_of(py::class_<Report, Answer>& report) {
  report
      .def_property_readonly(
          "engine", [](const Report& r) { return name_of(r.engine); },
          "The engine that searched: 'sweep', 'grid' or 'kdtree'.")
      .def_property_readonly(
          "device", [](const Report& r) { return name_of(r.device); },
          "The device that searched: 'cpu' or 'cuda'.")
      .def_property_readonly(
          "device_name", [](const Report& r) { return text(r.device_name); },
          "The name of the device for people, such as that of the GPU.")
      .def_readonly("estimate", &Report::estimate,
                    "The DeviceEstimate by which device 'auto' chose. None where it had no choice.")
      .def_readonly("shard_share", &Report::shard_share,
                    "The estimated work of this part over the mean of all parts; None where "
                    "everything was searched.")
      .def_readonly("searches", &Report::searches,
                    "How many pairs of a pose and a model point or triangle were asked about.")
      .def_readonly("cells_total", &Report::cells_total, "How many cells the store has.")
      .def_readonly("cells_read", &Report::cells_read,
                    "How many cells were read; the model comes near no other.")
      .def_readonly("bytes_read", &Report::bytes_read,
                    "How many bytes of the store's points were read: a BytesRead.")
      .def_readonly("resumed_cells", &Report::resumed_cells,
                    "How many cells an interrupted search had finished before.")
      .def_readonly("pages", &Report::pages, "In how many pieces the environment was searched.")
      .def_readonly("page_bytes", &Report::page_bytes,
                    "How many bytes such a piece had at the most.")
      .def_readonly("slots", &Report::slots, "How many pieces were in work at the same time.")
      .def_readonly("needed_host_bytes", &Report::needed_host_bytes,
                    "How much memory the search took at the most, in bytes.")
      .def_readonly("pinned_bytes", &Report::pinned_bytes,
                    "How much memory of the host was reserved for the GPUs, in bytes.")
      .def_readonly("peak_device_bytes", &Report::peak_device_bytes,
                    "How much memory was taken on a GPU at the most, in bytes.")
      .def_readonly("seconds", &Report::seconds,
                    "How long each part of the search took: a SearchSeconds.");
}

}  // namespace

void add_reports(py::module_& module) {
  add_seconds(module);
  add_bytes_read(module);
  add_answer(module);
  py::class_<Report, Answer> report(module, "SearchReport",
                                    "What a search found, and how it searched.");
  add_findings_of(report);
  add_work_of(report);
  report.def("__repr__", [](const Report& r) {
    return text("<" + (r.shard ? in_words(*r.shard) + ": " : "") +
                std::to_string(r.colliding_points) + " of " + std::to_string(r.environment_points) +
                " points collide" + warning_words(r.warnings) + ">");
  });
}

}  // namespace clearway::python
