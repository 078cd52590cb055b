#include "clearway/search.hpp"

#include <pybind11/stl.h>

#include <map>
#include <optional>
#include <string>
#include <utility>

#include "clearway/error.hpp"
#include "core/describe/query.hpp"
#include "core/describe/search.hpp"
#include "python/arrays.hpp"
#include "python/fields.hpp"
#include "python/model.hpp"
#include "python/store.hpp"
#include "python/values.hpp"
#include "python/watch.hpp"

namespace clearway::python {
namespace {

using namespace py::literals;

}  // namespace

void add_store(py::module_& module) {
  py::class_<SharedStore>(
      module, "Store",
      "An environment: the file that convert() made of scans.\n\n"
      "Searches on one Store take turns; open the file twice to run two at once.")
      .def(py::init([](const py::object& path) {
             return without_gil(
                 [file = path_of(path)] { return std::make_unique<SharedStore>(file); });
           }),
           "path"_a, "__init__(self, path)\n--\n\nOpen a store.")
      .def(
          "point_count", [](const SharedStore& s) { return s.store.point_count(); },
          "The number of points.")
      .def(
          "cell_count", [](const SharedStore& s) { return s.store.cell_count(); },
          "The number of cells into which the points are divided.")
      .def(
          "box", [](const SharedStore& s) { return s.store.box(); },
          "The Box around all points; zeros where there are none.")
      .def(
          "class_points",
          [](const SharedStore& s) {
            std::map<unsigned, std::uint64_t> out;
            const std::vector<std::uint64_t> points = s.store.class_points();
            for (unsigned i = 0; i < points.size(); ++i) {
              if (points[i] > 0) out[i] = points[i];
            }
            return out;
          },
          "The number of points of each class: a dict, which is empty where the points have no "
          "classes.")
      .def(
          "has_origins", [](const SharedStore& s) { return s.store.has_origins(); },
          "Whether it is known for any point from where it was seen.")
      .def(
          "crs_wkt", [](const SharedStore& s) { return text(s.store.crs_wkt()); },
          "The coordinate reference system as the scans had it, as WKT, or ''.")
      .def(
          "length_unit", [](const SharedStore& s) { return text(s.store.length_unit()); },
          "The unit of the coordinates: 'metre', 'foot', 'us-survey-foot', 'degree' or 'unknown'.")
      .def(
          "metres_per_unit", [](const SharedStore& s) { return s.store.metres_per_unit(); },
          "The metres of that unit; 1 where it is unknown.")
      .def(
          "warnings", [](const SharedStore& s) { return to_list(s.store.warnings()); },
          "Warnings of the conversion: a list of Message, with codes as 'store-same-place'.")
      .def_property_readonly(
          "path", [](const SharedStore& s) { return to_python(s.store.path()); },
          "The file: a pathlib.Path.")
      .def("__repr__", [](const SharedStore& s) {
        return text("<Store " + s.store.path().string() + ": " +
                    std::to_string(s.store.point_count()) + " points>");
      });
}

namespace {

/// radius: none where the query has none yet. given: the other parameters.
ArrayQuery make_query(const py::object& model, const py::object& poses,
                      std::optional<double> radius, bool allow_non_rigid,
                      std::vector<PlacedBody> bodies, const py::kwargs& given) {
  ArrayQuery query{
      {}, model_object(model), poses_array(poses, "poses"), allow_non_rigid, std::move(bodies)};
  set_fields(kQueryFields, given, query.parameters);
  query.parameters.radius = radius.value_or(0);
  return query;
}

void add_query(py::module_& module) {
  const py::tuple nothing;
  py::class_<ArrayQuery> query(
      module, "Query",
      "A question: which points of an environment does the moving model come too close to?\n\n"
      "Its properties can be changed between searches. Arrays are copied when a search begins.");
  query
      .def(
          py::init(&make_query), "model"_a = nothing, "poses"_a = nothing, "radius"_a = py::none(),
          py::kw_only(), "allow_non_rigid"_a = false, "bodies"_a = nothing,
          ("__init__(self, model=(), poses=(), radius=None, *, allow_non_rigid=False, bodies=(), " +
           signature_of(kQueryFields) + R"DOC()
--

Ask which points the model comes closer to than the radius, on its way along the poses.

model: in its own frame: points, n x 3, metres; or a Model.
poses: n x 4 x 4 or n x 3 x 4; the translation, in metres, is the last column.
radius: metres, above 0; a search needs one. A point strictly closer to the model collides.
The other arguments are the properties of the same names.)DOC")
              .c_str())
      .def_property(
          "model", [](const ArrayQuery& q) { return q.model; },
          [](ArrayQuery& q, const py::object& value) { q.model = model_object(value); },
          "The model in its own frame: points, n x 3 float64, metres; or a Model.")
      .def_property(
          "poses", [](const ArrayQuery& q) { return q.poses; },
          [](ArrayQuery& q, const py::object& value) { q.poses = poses_array(value, "poses"); },
          "The poses of the path: n x 4 x 4 or n x 3 x 4 float64; the translation, in metres, is "
          "the last column.")
      .def_readwrite(
          "allow_non_rigid", &ArrayQuery::allow_non_rigid,
          "Whether poses that scale or shear are searched too, which are refused otherwise.")
      .def_readwrite("bodies", &ArrayQuery::bodies,
                     "The bodies of a vehicle, a list of Body, in the place of a model; poses are "
                     "then those of the path.")
      .def("__repr__", [](const ArrayQuery& q) {
        const bool has_radius = q.parameters.radius > 0;
        const py::str radius = has_radius ? py::str("radius {} m").format(q.parameters.radius)
                                          : py::str("no radius yet");
        return py::str("<Query: {}, {} poses, {}>")
            .format(model_words(q.model), q.poses.shape(0), radius);
      });
  for_each_field(kQueryFields, [&query](const auto& field) {
    query.def_property(
        field.key, [member = field.member](const ArrayQuery& q) { return q.parameters.*member; },
        [field](ArrayQuery& q, const py::object& value) {
          field.of(q.parameters) = value_from_python(field, value);
        },
        field.doc);
  });
  add_checks(module, "Query", kQueryFields);
}

void add_searches(py::module_& module) {
  module.def(
      "search",
      [](SharedStore& store, const ArrayQuery& query, const py::object& output,
         std::optional<std::pair<std::uint32_t, std::uint32_t>> shard,
         const py::object& input_warnings, py::object progress, py::object message, py::object stop,
         const py::kwargs& given) {
        require_radius(query);
        SearchOptions options;
        set_fields(kSearchFields, given, options);
        if (shard) options.shard = Shard{shard->first, shard->second};
        options.input_warnings = messages_of(input_warnings);
        Watch watch(std::move(progress), std::move(message), std::move(stop));
        watch.attach(options);
        return watch.run(
            [&, asked = query_of(query), rigid = !query.allow_non_rigid, to = path_of(output)] {
              if (rigid) require_rigid(asked);
              return in_turn(store, options.stop,
                             [&](const Store& own) { return search(own, asked, to, options); });
            });
      },
      "store"_a, "query"_a, "output"_a, py::kw_only(), "shard"_a = py::none(),
      "input_warnings"_a = py::tuple(), "progress"_a = py::none(), "message"_a = py::none(),
      "stop"_a = py::none(),
      ("search(store, query, output, *, " + signature_of(kSearchFields) +
       R"DOC(, shard=None, input_warnings=(), progress=None, message=None, stop=None)
--

Find every point of the store within the query's radius of the moving model.

Writes the result file `output` and returns a SearchReport. Open the file with Result.
Ctrl-C stops the search and raises KeyboardInterrupt. The same call with resume=True goes on.

store: the Store to search.
query: the Query to answer.
output: the file of the result to write.
)DOC" + lines_of(kSearchFields) +
       R"DOC(shard: (i, n) searches the i-th of n parts, from 1; the output is a part for merge().
input_warnings: messages of read_model() and read_trajectory(), which the report then holds too,
    and which strict counts.
progress: called with a ProgressUpdate, in this thread, up to 20 times a second.
message: called with each note and warning, a Message, in this thread.
stop: an object with is_set(), such as threading.Event. When it is set, Interrupted is raised.)DOC")
          .c_str());
  add_checks(module, "search", kSearchFields);
}

}  // namespace

Query query_of(const ArrayQuery& query) {
  Query asked;
  asked.model = model_of(query.model);
  ask(query, asked);
  return asked;
}

void ask(const ArrayQuery& query, Query& asked) {
  static_cast<QueryParameters&>(asked) = query.parameters;
  asked.poses = poses_of(query.poses, "poses");
  asked.bodies = bodies_on(query.bodies, asked.poses);
}

void require_radius(const ArrayQuery& query) {
  if (query.parameters.radius != 0) return;
  throw UsageError(
      "radius: the query has none; give the distance to keep in metres, as in "
      "Query(model, poses, radius=0.1) or query.radius = 0.1");
}

void require_rigid(const Query& query) {
  require_rigid(query.poses);
  for (const Body& body : query.bodies) require_rigid(body.poses);
}

void add_search(py::module_& module) {
  add_query(module);
  add_searches(module);
}

}  // namespace clearway::python
