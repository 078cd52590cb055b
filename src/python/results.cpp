#include <pybind11/stl.h>

#include <memory>
#include <string>

#include "clearway/result.hpp"
#include "core/describe/query.hpp"
#include "python/arrays.hpp"
#include "python/columns.hpp"
#include "python/fields.hpp"
#include "python/model.hpp"

namespace clearway::python {
namespace {

CollisionColumns collisions(const Result& result) {
  Collisions table = without_gil([&] { return result.collisions(); });
  return collision_columns(table, result.parameters(), !result.bodies().empty(), OwnArrays());
}

py::object near_points(const Result& result) {
  if (!result.parameters().has_budget()) return py::none();
  Nearby table = without_gil([&] { return result.near(); });
  return near_columns(table, result.parameters(), !result.bodies().empty(), OwnArrays());
}

py::object unseen_cubes(const Result& result) {
  if (!result.parameters().seen) return py::none();
  UnseenCubes table = without_gil([&] { return result.unseen(); });
  return unseen_columns(table, result.parameters(), OwnArrays());
}

py::object clearance(const Result& result) {
  if (!(result.parameters().clearance > 0)) return py::none();
  Clearances table = without_gil([&] { return result.clearance(); });
  return clearance_columns(table, result.parameters(), OwnArrays());
}

py::object profile(const Result& result) {
  if (!(result.parameters().profile > 0)) return py::none();
  Profile table = without_gil([&] { return result.profile(); });
  return profile_columns(table, result.parameters(), OwnArrays());
}

py::object first_pose(const Result& result) {
  if (!result.parameters().first_pose) return py::none();
  return to_array(without_gil([&] { return result.first_pose(); }));
}

py::object last_pose(const Result& result) {
  if (!result.parameters().first_pose) return py::none();
  return to_array(without_gil([&] { return result.last_pose(); }));
}

py::object first_body(const Result& result) {
  if (result.bodies().empty() || !result.parameters().first_pose) return py::none();
  return to_array(without_gil([&] { return result.first_body(); }));
}

void add_columns(py::module_& module) {
  py::class_<CollisionColumns> touched(module, "Collisions",
                                       "The points that the model touches: arrays of one length, "
                                       "in which row i of each is the same point.");
  touched
      .def_readonly("source", &CollisionColumns::source,
                    "The index of each point in the order of the scans, ascending: n uint64.")
      .def_readonly("xyz", &CollisionColumns::xyz,
                    "The coordinates of the points: n x 3 float64, metres.")
      .def_readonly("first_pose", &CollisionColumns::first_pose,
                    "The first pose that touches each point: n uint32. None where the query did "
                    "not ask for it.")
      .def_readonly("last_pose", &CollisionColumns::last_pose,
                    "The last pose that touches each point: n uint32. Between poses, the start of "
                    "the last way that does. None where the query did not ask for first poses.")
      .def_readonly("body", &CollisionColumns::body,
                    "The body that touches each point at its first pose, as an index of "
                    "Result.bodies(): n uint32. None where there is one model, or the query did "
                    "not ask for first poses.")
      .def_readonly("certain", &CollisionColumns::certain,
                    "Whether the error budget says that each point is certainly too close: n bool. "
                    "None without a budget, and for points that are only near.")
      .def_readonly("depth", &CollisionColumns::depth,
                    "The distance of each point to the nearest free point, which neither collides "
                    "nor is ignored: n float64, metres; NaN where no point is free. None where the "
                    "query did not ask for it.")
      .def_readonly("depth_source", &CollisionColumns::depth_source,
                    "The index of that free point: n uint64; NO_POINT where no point is free. None "
                    "where the query did not ask for it.")
      .def_readonly(
          "point_class", &CollisionColumns::point_class,
          "The class of each point, as the scans have it: n uint8. Empty unless they have "
          "classes.")
      .def("__len__", [](const CollisionColumns& c) { return c.source.size(); });
  touched.attr("NO_POINT") = Collisions::kNoPoint;
  py::class_<UnseenColumns>(module, "UnseenCubes",
                            "The cubes that the model sweeps and no beam passed through: arrays of "
                            "one length, in which row i of each is the same cube.")
      .def_readonly("cube", &UnseenColumns::cube,
                    "The indices of each cube along x, y and z, ascending: n x 3 int32.")
      .def_readonly("first_pose", &UnseenColumns::first_pose,
                    "The first pose at which the model sweeps each cube: n uint32.")
      .def_readonly("group", &UnseenColumns::group,
                    "The number of each cube's group, from 1 on: n uint32.")
      .def("__len__", [](const UnseenColumns& c) { return c.first_pose.size(); });
  py::class_<ClearanceColumns>(module, "Clearances",
                               "The distances of environment points to the moving model: arrays of "
                               "one length, in which row i of each is the same point.")
      .def_readonly("source", &ClearanceColumns::source,
                    "The index of each point in the order of the scans, ascending: n uint64.")
      .def_readonly("xyz", &ClearanceColumns::xyz,
                    "The coordinates of the points: n x 3 float64, metres.")
      .def_readonly("distance", &ClearanceColumns::distance,
                    "The least distance of each point over all poses: n float64, metres.")
      .def_readonly("pose", &ClearanceColumns::pose,
                    "The first pose at which each point has this distance: n uint32.")
      .def_readonly("body", &ClearanceColumns::body,
                    "The body that is so close to the point there, as an index of Result.bodies(): "
                    "n uint32. Empty where there is one model.")
      .def_readonly(
          "point_class", &ClearanceColumns::point_class,
          "The class of each point, as the scans have it: n uint8. Empty unless they have "
          "classes.")
      .def("__len__", [](const ClearanceColumns& c) { return c.source.size(); });
  py::class_<ProfileColumns> profiles(module, "Profile",
                                      "The least distance between model and environment at every "
                                      "pose: arrays with a row for each pose.");
  profiles
      .def_readonly("distance", &ProfileColumns::distance,
                    "The least distance at each pose: n float64, metres; infinity where nothing is "
                    "closer than the distance that was asked for, NaN where no body of a vehicle "
                    "has a pose, because nothing is known there.")
      .def_readonly(
          "source", &ProfileColumns::source,
          "The index of the nearest point at each pose: n uint64; NO_POINT where there is none.")
      .def_readonly("xyz", &ProfileColumns::xyz,
                    "The coordinates of the nearest point at each pose: n x 3 float64, metres; NaN "
                    "where there is none.")
      .def_readonly("chainage", &ProfileColumns::chainage,
                    "How far along the path each pose is: n float64, metres, from 0.")
      .def_readonly(
          "point_class", &ProfileColumns::point_class,
          "The class of the nearest point at each pose, 0 where there is none: n uint8. Empty "
          "unless the scans have classes.")
      .def("__len__", [](const ProfileColumns& p) { return p.distance.size(); });
  profiles.attr("NO_POINT") = Profile::kNoPoint;
}

void add_parameters(py::module_& module) {
  using Counts = IgnoredPointCounts;
  py::class_<Counts>(module, "IgnoredPointCounts",
                     "How many points of the environment a query leaves out of the search.")
      .def_readonly("points", &Counts::points,
                    "How many points are left out in all; a point of an ignored class in an "
                    "ignored box counts once.")
      .def_readonly("of_classes", &Counts::of_classes,
                    "How many points each ignored class has: a list in the order of the query's "
                    "ignore_classes, sorted.")
      .def_readonly("in_boxes", &Counts::in_boxes,
                    "How many points each ignored box has: a list in the order of the query's "
                    "ignore_boxes, sorted.");
  py::class_<QueryParameters> parameters(
      module, "QueryParameters",
      "The parameters of a query: all of it but the model and the poses.");
  add_read_only(parameters, kQueryFields);
}

}  // namespace

void add_results(py::module_& module) {
  add_columns(module);
  add_parameters(module);
  py::class_<Result>(module, "Result",
                     "A result file that search() or merge() wrote. Row i of each of its arrays is "
                     "the same point.")
      .def(py::init([](const py::object& path) {
             return without_gil([file = path_of(path)] { return std::make_unique<Result>(file); });
           }),
           py::arg("path"),
           "__init__(self, path)\n--\n\nOpen a result file, to be read as its methods are called.")
      .def("size", &Result::size, "The number of colliding points.")
      .def("__len__", &Result::size)
      .def(
          "parameters", [](const Result& r) { return r.parameters(); },
          "What was asked: QueryParameters.")
      .def("environment_points", &Result::environment_points,
           "The number of points that the environment has.")
      .def(
          "ignored", [](const Result& r) { return r.ignored(); },
          "How many points of the environment the search left out: IgnoredPointCounts.")
      .def("poses", &Result::poses, "The number of poses that the path had.")
      .def(
          "answer", [](const Result& r) { return without_gil([&] { return r.answer(); }); },
          "The verdict and the places that matter most, an Answer. Reads all tables.")
      .def(
          "warnings", [](const Result& r) { return to_list(r.warnings()); },
          "Warnings of the search: a list of Message, as Answer.warnings has it.")
      .def("collisions", collisions,
           "The colliding points with all of their columns: Collisions. The methods below read one "
           "column each.")
      .def(
          "source",
          [](const Result& r) { return to_array(without_gil([&] { return r.source(); })); },
          "The index of each colliding point in the order of the scans, ascending: n uint64.")
      .def(
          "xyz", [](const Result& r) { return to_array(without_gil([&] { return r.xyz(); })); },
          "The coordinates of the colliding points: n x 3 float64, metres.")
      .def("first_pose", first_pose,
           "The first pose that touches each colliding point: n uint32. None where the query did "
           "not ask for it.")
      .def("last_pose", last_pose,
           "The last pose that touches each colliding point: n uint32. Between poses, the start of "
           "the last way that does. None where the query did not ask for first poses, or an older "
           "release wrote the file.")
      .def("bodies", &Result::bodies,
           "The names of the vehicle's bodies: a list, which is empty where there is one model.")
      .def("first_body", first_body,
           "The body that touches each point at its first pose, as an index of bodies(): n uint32. "
           "None where there is one model, or the query did not ask for first poses.")
      .def("unseen", unseen_cubes,
           "The places that the model sweeps and no beam passed through: UnseenCubes. None where "
           "the query did not ask for seen space.")
      .def("near", near_points,
           "The points that do not collide but may in truth, by the error budget: Collisions, "
           "whose last_pose and certain are None. None without a budget.")
      .def("clearance", clearance,
           "The distances of the points that are closer than the clearance: Clearances. None where "
           "the query did not ask for them.")
      .def("profile", profile,
           "The least distance at every pose: a Profile. None where the query did not ask for it.")
      .def("model_spacing", &Result::model_spacing,
           "Metres: the model's points are samples of a mesh, and no place of its surface is "
           "farther than this from one of them. 0 where the model is no sampled mesh.")
      .def(
          "model_axes", [](const Result& r) { return to_tuple(r.model_axes()); },
          "The axes of the model's file that pointed ahead and up before the search turned the "
          "model, such as ('+y', '+z'); ('+x', '+z') where nothing was turned.")
      .def("model_box", &Result::model_box, "The box around the model in its own frame: a Box.")
      .def("__repr__", [](const Result& r) {
        return text("<Result: " + std::to_string(r.size()) + " of " +
                    std::to_string(r.environment_points()) + " points collide>");
      });
}

}  // namespace clearway::python
