#include "clearway/search.hpp"

#include <map>
#include <optional>
#include <string>
#include <utility>

#include "clearway/error.hpp"
#include "clearway/merge.hpp"
#include "core/describe/answer.hpp"
#include "core/describe/query.hpp"
#include "core/describe/search.hpp"
#include "core/describe/seen.hpp"
#include "python/arrays.hpp"
#include "python/binding.hpp"
#include "python/objects.hpp"
#include "python/watch.hpp"

/// Stores, queries, searches and what they report.
namespace clearway::python {
namespace {

std::map<unsigned, std::uint64_t> class_points(const SharedStore& shared) {
  std::map<unsigned, std::uint64_t> out;
  const std::vector<std::uint64_t> points = shared.store.class_points();
  for (unsigned i = 0; i < points.size(); ++i) {
    if (points[i] > 0) out[i] = points[i];
  }
  return out;
}

constexpr std::tuple kStoreFacts{
    fact<&Store::point_count>("The number of points."),
    fact<&Store::cell_count>("The number of cells into which the points are divided."),
    fact<&Store::box>("The Box around all points; zeros where there are none."),
    fact<&Store::has_origins>("Whether it is known for any point from where it was seen."),
    fact<&Store::crs_wkt>("The coordinate reference system as the scans had it, as WKT, or ''."),
    fact<&Store::length_unit>(
        "The unit of the coordinates: 'metre', 'foot', 'us-survey-foot', 'degree' or 'unknown'."),
    fact<&Store::metres_per_unit>("The metres of that unit; 1 where it is unknown."),
    fact<&Store::warnings>(
        "Warnings of the conversion: a list of Message, with codes as 'store-same-place'.")};

/// The margins of the error budget by the verdicts that they decide.
py::object margins_of(const Answer& answer) {
  if (!answer.budget) return py::none();
  py::dict margins;
  margins["clear"] = answer.budget->clear();
  margins["conflict"] = answer.budget->conflict();
  return margins;
}

void add_answer(py::module_& module) {
  add_class<SearchedLength>(module, "SearchedLength",
                            "How much of a path was searched, in metres along its positions.");
  add_class<SeenSummary>(module, "SeenSummary",
                         "What is known of the space that the model sweeps, in cubes.",
                         kSeenColumns);
  add_class<IgnoredPointCounts>(
      module, "IgnoredPointCounts",
      "How many points of the environment a query leaves out of the search.");
  add_class<QueryParameters>(module, "QueryParameters",
                             "The parameters of a query: all of it but the model and the poses.",
                             kQueryFields);
  auto answer = add_class<Answer>(
      module, "Answer",
      "The answer to a query in short: the verdict, and the places that matter most.");
  answer
      .def_property_readonly(
          "margins", &margins_of,
          "What the error budget adds to the radius for 'clear' and takes from it for 'conflict', "
          "in metres: a dict with these two keys. None without a budget.")
      .def_property_readonly(
          "certain_points", [](const Answer& a) { return a.certain.points; },
          "How many points are certainly too close by the error budget; 0 without one.");
  add_repr(answer, [](const Answer& a) {
    return "<Answer: " + std::string(name_of(a.verdict())) + ", " +
           std::to_string(a.colliding_points) + " of " + std::to_string(a.environment_points) +
           " points collide>";
  });
}

void add_search_report(py::module_& module) {
  add_class<SearchSeconds>(module, "SearchSeconds",
                           "How many seconds the parts of a search took. Parts that run at the "
                           "same time overlap, so that their sum may exceed the total.");
  add_class<DeviceEstimate>(
      module, "DeviceEstimate",
      "How many seconds the search would take on each device, as estimated before it.");
  add_class<BytesRead>(module, "BytesRead",
                       "How many bytes of a store's points were read, by column. What is read "
                       "again counts again.");
  auto report = add_class<SearchReport, Answer>(module, "SearchReport",
                                                "What a search found, and how it searched.");
  add_repr(report, [](const SearchReport& r) {
    return "<" + (r.shard ? in_words(*r.shard) + ": " : "") + std::to_string(r.colliding_points) +
           " of " + std::to_string(r.environment_points) + " points collide" +
           warning_words(r.warnings) + ">";
  });
}

void add_merge_report(py::module_& module) {
  add_class<PartWarning, Message>(
      module, "PartWarning", "A warning of the searches that wrote the parts.",
      std::tuple{fact<&PartWarning::parts>("How many of the parts have this warning.")});
  auto report = add_class<MergeReport, Answer>(module, "MergeReport",
                                               "What merge() found in the merged result.");
  add_repr(report, [](const MergeReport& r) {
    return "<" + std::to_string(r.colliding_points) + " of " +
           std::to_string(r.environment_points) + " points collide, of " + std::to_string(r.parts) +
           " parts" + warning_words({r.part_warnings.begin(), r.part_warnings.end()}) + ">";
  });
}

ArrayQuery make_query(const py::kwargs& given) {
  ArrayQuery query{{},
                   model_object(given["model"]),
                   poses_array(given["poses"], "poses"),
                   argument<bool>(given, "allow_non_rigid"),
                   argument<std::vector<PlacedBody>>(given, "bodies")};
  set_fields(kQueryFields, given, query.parameters);
  return query;
}

void add_query(py::module_& module) {
  py::class_<ArrayQuery> query(
      module, "Query",
      "A question: which points of an environment does the moving model come too close to?\n\n"
      "Its properties can be changed between searches. Arrays are copied when a search begins.");
  query
      .def(py::init(&make_query),
           ("__init__(self, model: ArrayOrModel = (), poses: Array = (), radius: Above0 = None, *, "
            "allow_non_rigid: Flag = False, bodies: Each(Body) = (), " +
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
                     "then those of the path.");
  for_each_field(kQueryFields, [&query](const auto& field) {
    using Value = typename std::decay_t<decltype(field)>::Value;
    query.def_property(
        field.key, [member = field.member](const ArrayQuery& q) { return q.parameters.*member; },
        [field](ArrayQuery& q, const py::object& value) {
          field.of(q.parameters) = value_from_python<Value>(field.key, value);
        },
        field.doc);
  });
  add_repr(query, [](const ArrayQuery& q) {
    const bool has_radius = q.parameters.radius > 0;
    const py::str radius =
        has_radius ? py::str("radius {} m").format(q.parameters.radius) : py::str("no radius yet");
    return py::str("<Query: {}, {} poses, {}>")
        .format(model_words(q.model), q.poses.shape(0), radius);
  });
}

SearchReport search(const py::kwargs& given) {
  const auto& query = argument<const ArrayQuery&>(given, "query");
  require_radius(query);
  SearchOptions options;
  set_fields(kSearchFields, given, options);
  take<&SearchOptions::input_warnings>(given, options);
  const auto shard =
      argument<std::optional<std::pair<std::uint32_t, std::uint32_t>>>(given, "shard");
  if (shard) options.shard = Shard{shard->first, shard->second};
  Watch watch(given, options);
  return watch.run([&, &store = argument<SharedStore&>(given, "store"), asked = query_of(query),
                    rigid = !query.allow_non_rigid, to = path_of(given["output"])] {
    if (rigid) require_rigid(asked);
    return in_turn(store, options.stop,
                   [&](const Store& own) { return search(own, asked, to, options); });
  });
}

MergeReport merge(const py::kwargs& given) {
  using Options = MergeOptions;
  Options options;
  take<&Options::threads, &Options::memory_bytes, &Options::overwrite, &Options::resume,
       &Options::strict>(given, options);
  Watch watch(given, options);
  return watch.run([&, from = paths_of(given["parts"]), to = path_of(given["output"])] {
    return merge(from, to, options);
  });
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

void add_store(py::module_& module) {
  py::class_<SharedStore> store(
      module, "Store",
      "An environment: the file that convert() made of scans.\n\n"
      "Searches on one Store take turns; open the file twice to run two at once.");
  store
      .def(py::init([](const py::kwargs& given) {
             return without_gil(
                 [file = path_of(given["path"])] { return std::make_unique<SharedStore>(file); });
           }),
           "__init__(self, path: Path)\n--\n\nOpen a store.")
      .def("class_points", &class_points,
           "The number of points of each class: a dict, which is empty where the points have no "
           "classes.")
      .def_property_readonly(
          "path", [](const SharedStore& s) { return to_python(s.store.path()); },
          "The file: a pathlib.Path.");
  add_methods(
      store, [](const SharedStore& s) -> const Store& { return s.store; }, kStoreFacts);
  add_repr(store, [](const SharedStore& s) {
    return "<Store " + s.store.path().string() + ": " + std::to_string(s.store.point_count()) +
           " points>";
  });
}

void add_search(py::module_& module) {
  add_answer(module);
  add_search_report(module);
  add_merge_report(module);
  add_query(module);
  module.def(
      "search", &search,
      ("search(store: Store, query: Query, output: Path, *, " + signature_of(kSearchFields) +
       R"DOC(, shard: Part = None, input_warnings: Messages = (), progress: Progress = None,
    message: Tell = None, stop: Stop = None)
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
  module.def("merge", &merge, R"(merge(parts: Paths, output: Path, *, threads: Int = 0,
    memory_bytes: Count = 4294967296, overwrite: Flag = False, resume: Flag = False,
    strict: Flag = False, progress: Progress = None, message: Tell = None, stop: Stop = None)
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
