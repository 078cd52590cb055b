#include <pybind11/stl.h>

#include <memory>
#include <string>

#include "clearway/result.hpp"
#include "python/arrays.hpp"

namespace clearway::python {
namespace {

/// What a result's columns are read from; arrays are made once and then shared.
struct Columns {
  py::array source, xyz, distance;
};
struct ClearanceColumns : Columns {
  py::array pose;
};
struct ProfileColumns : Columns {
  py::array chainage;
};

/// What clearances and profile have alike; the arrays take the vectors.
template <typename Shared, typename Read>
Shared common_columns(Read& read) {
  Shared columns;
  columns.source = to_array(std::move(read.source));
  columns.xyz = to_array(std::move(read.xyz));
  columns.distance = to_array(std::move(read.distance));
  return columns;
}

py::object clearance(const Result& result) {
  if (!(result.parameters().clearance > 0)) return py::none();
  Clearances read = without_gil([&] { return result.clearance(); });
  auto columns = common_columns<ClearanceColumns>(read);
  columns.pose = to_array(std::move(read.pose));
  return py::cast(std::move(columns));
}

py::object profile(const Result& result) {
  if (!(result.parameters().profile > 0)) return py::none();
  Profile read = without_gil([&] { return result.profile(); });
  auto columns = common_columns<ProfileColumns>(read);
  columns.chainage = to_array(std::move(read.chainage));
  return py::cast(std::move(columns));
}

py::object first_pose(const Result& result) {
  if (!result.parameters().first_pose) return py::none();
  return to_array(without_gil([&] { return result.first_pose(); }));
}

void add_columns(py::module_& module) {
  py::class_<ClearanceColumns>(
      module, "Clearances",
      "Distances of environment points to the model, ascending by source. Arrays of one length.")
      .def_readonly("source", &ClearanceColumns::source, "Indices of the points: uint64.")
      .def_readonly("xyz", &ClearanceColumns::xyz,
                    "n x 3 float64, metres. Empty in files before version 3.")
      .def_readonly("distance", &ClearanceColumns::distance,
                    "The least over all poses: float64, metres.")
      .def_readonly("pose", &ClearanceColumns::pose, "The first pose that has it: uint32.")
      .def("__len__", [](const ClearanceColumns& c) { return c.source.size(); });
  py::class_<ProfileColumns> profiles(
      module, "Profile", "Of every pose the least distance between the model and the environment.");
  profiles
      .def_readonly("distance", &ProfileColumns::distance,
                    "float64, metres; infinity where it is not below the one asked for.")
      .def_readonly("source", &ProfileColumns::source,
                    "Index of the point: uint64; NO_POINT where there is none.")
      .def_readonly("xyz", &ProfileColumns::xyz,
                    "Of the point: n x 3 float64, metres; NaN where there is none.")
      .def_readonly("chainage", &ProfileColumns::chainage,
                    "Along the positions of the path: float64, metres.")
      .def("__len__", [](const ProfileColumns& p) { return p.distance.size(); });
  profiles.attr("NO_POINT") = Profile::kNoPoint;
}

void add_parameters(py::module_& module) {
  using Counts = IgnoredPointCounts;
  py::class_<Counts>(module, "IgnoredPointCounts",
                     "How many points of a whole environment a query leaves out.")
      .def_readonly("points", &Counts::points, "Each once.")
      .def_readonly("of_classes", &Counts::of_classes, "Of each of the parameters' classes.")
      .def_readonly("in_boxes", &Counts::in_boxes, "In each of the parameters' boxes.");
  using Q = QueryParameters;
  py::class_<Q>(module, "QueryParameters", "What was asked, whatever the model and the poses.")
      .def_readonly("radius", &Q::radius, "Metres.")
      .def_readonly("first_pose", &Q::first_pose)
      .def_readonly("between_poses", &Q::between_poses)
      .def_readonly("clearance", &Q::clearance, "Metres; 0: not asked for.")
      .def_readonly("profile", &Q::profile, "Metres; 0: not asked for.")
      .def_readonly("tolerance", &Q::tolerance, "Metres; 0: exact.")
      .def_readonly("ignore_classes", &Q::ignore_classes, "Of points left out of the search.")
      .def_readonly("ignore_boxes", &Q::ignore_boxes, "The same, Box objects.");
}

}  // namespace

void add_results(py::module_& module) {
  add_columns(module);
  add_parameters(module);
  py::class_<Result>(module, "Result",
                     "A result that search() wrote. Row i of each column is the same point.")
      .def(py::init([](const py::object& path) {
             return without_gil([file = path_of(path)] { return std::make_unique<Result>(file); });
           }),
           py::arg("path"))
      .def("size", &Result::size, "Colliding points.")
      .def("__len__", &Result::size)
      .def(
          "parameters", [](const Result& r) { return r.parameters(); }, "QueryParameters.")
      .def("environment_points", &Result::environment_points)
      .def(
          "ignored", [](const Result& r) { return r.ignored(); },
          "How many points of the whole environment the search left out: IgnoredPointCounts.")
      .def("poses", &Result::poses, "The number of poses.")
      .def(
          "source",
          [](const Result& r) { return to_array(without_gil([&] { return r.source(); })); },
          "Indices of the points in the order of the scans, ascending: n uint64.")
      .def(
          "xyz", [](const Result& r) { return to_array(without_gil([&] { return r.xyz(); })); },
          "Coordinates: n x 3 float64, metres.")
      .def("first_pose", first_pose,
           "The first pose that touches each point: n uint32. None: the query did not ask for it.")
      .def("clearance", clearance, "Clearances. None: the query did not ask for them.")
      .def("profile", profile, "A Profile. None: the query did not ask for it.")
      .def("model_box", &Result::model_box, "Of the model's points: a Box, or None.")
      .def("__repr__", [](const Result& r) {
        return text("<Result: " + std::to_string(r.size()) + " of " +
                    std::to_string(r.environment_points()) + " points collide>");
      });
}

}  // namespace clearway::python
