#include "clearway/search.hpp"

#include <pybind11/stl.h>

#include <map>
#include <optional>
#include <string>
#include <utility>

#include "clearway/error.hpp"
#include "core/query/query_fields.hpp"
#include "python/arrays.hpp"
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
          "What the conversion warned of: a list of Message, with codes as 'store-same-place'.")
      .def_property_readonly(
          "path", [](const SharedStore& s) { return to_python(s.store.path()); },
          "The file: a pathlib.Path.")
      .def("__repr__", [](const SharedStore& s) {
        return text("<Store " + s.store.path().string() + ": " +
                    std::to_string(s.store.point_count()) + " points>");
      });
}

namespace {

template <typename Value>
void add_parameter(py::class_<ArrayQuery>& query, const QueryField<Value>& field) {
  query.def_property(
      field.name, [member = field.member](const ArrayQuery& q) { return q.parameters.*member; },
      [member = field.member](ArrayQuery& q, Value value) {
        q.parameters.*member = std::move(value);
      },
      field.doc);
}

ArrayQuery make_query(const py::object& model, const py::object& poses,
                      std::optional<double> radius, bool first_pose, bool between_poses,
                      double clearance, double profile, std::vector<std::uint8_t> ignore_classes,
                      std::vector<Box> ignore_boxes, bool allow_non_rigid,
                      std::vector<PlacedBody> bodies, std::optional<double> error_scan,
                      std::optional<double> error_registration, std::optional<double> error_pose,
                      std::optional<double> error_angle, std::optional<double> error_model,
                      double sigmas, double gap, bool seen, double seen_cube,
                      std::uint32_t seen_min) {
  return {{radius.value_or(0), first_pose, between_poses, clearance, profile,
           std::move(ignore_classes), std::move(ignore_boxes), seen, seen_cube, seen_min,
           error_scan, error_registration, error_pose, error_angle, error_model, sigmas, gap},
          model_object(model),
          poses_array(poses, "poses"),
          allow_non_rigid,
          std::move(bodies)};
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
          py::kw_only(), "first_pose"_a = false, "between_poses"_a = false, "clearance"_a = 0.0,
          "profile"_a = 0.0, "ignore_classes"_a = nothing, "ignore_boxes"_a = nothing,
          "allow_non_rigid"_a = false, "bodies"_a = nothing, "error_scan"_a = py::none(),
          "error_registration"_a = py::none(), "error_pose"_a = py::none(),
          "error_angle"_a = py::none(), "error_model"_a = py::none(), "sigmas"_a = 3.0,
          "gap"_a = 0.0, "seen"_a = false, "seen_cube"_a = 0.0, "seen_min"_a = 8,
          R"(__init__(self, model=(), poses=(), radius=None, *, first_pose=False, between_poses=False, clearance=0.0, profile=0.0, ignore_classes=(), ignore_boxes=(), allow_non_rigid=False, bodies=(), error_scan=None, error_registration=None, error_pose=None, error_angle=None, error_model=None, sigmas=3.0, gap=0.0, seen=False, seen_cube=0.0, seen_min=8)
--

Ask which points the model comes closer to than the radius, on its way along the poses.

model: in its own frame: points, n x 3, metres; or a Model.
poses: n x 4 x 4 or n x 3 x 4; the translation, in metres, is the last column.
radius: metres, above 0; a search needs one. A point strictly closer to the model collides.
The other arguments are the properties of the same names.)")
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
  for_each_field([&](const auto& field) { add_parameter(query, field); });
}

void add_searches(py::module_& module) {
  module.def(
      "search",
      [](SharedStore& store, const ArrayQuery& query, const py::object& output,
         const std::string& engine, const std::string& device, std::vector<int> gpus, int threads,
         std::uint64_t memory_bytes, std::uint64_t device_memory_bytes,
         std::optional<std::pair<std::uint32_t, std::uint32_t>> shard, bool overwrite, bool resume,
         bool strict, const py::object& input_warnings, bool model_is_cut, bool end_gpus,
         double journal_interval_seconds, py::object progress, py::object message,
         py::object stop) {
        require_radius(query);
        SearchOptions options;
        options.engine = value_of("engine", kEngines, engine);
        options.device = value_of("device", kDevices, device);
        options.gpus = std::move(gpus);
        options.threads = threads;
        options.memory_bytes = memory_bytes;
        options.device_memory_bytes = device_memory_bytes;
        if (shard) options.shard = Shard{shard->first, shard->second};
        options.overwrite = overwrite;
        options.resume = resume;
        options.strict = strict;
        options.model_is_cut = model_is_cut;
        options.input_warnings = messages_of(input_warnings);
        options.end_gpus = end_gpus;
        options.journal_interval_seconds = journal_interval_seconds;
        Watch watch(std::move(progress), std::move(message), std::move(stop));
        watch.attach(options);
        return watch.run(
            [&, asked = query_of(query), rigid = !query.allow_non_rigid, to = path_of(output)] {
              if (rigid) require_rigid(asked);
              return in_turn(store, options.stop,
                             [&](const Store& own) { return search(own, asked, to, options); });
            });
      },
      "store"_a, "query"_a, "output"_a, py::kw_only(), "engine"_a = "auto", "device"_a = "auto",
      "gpus"_a = std::vector<int>{}, "threads"_a = 0,
      "memory_bytes"_a = SearchOptions{}.memory_bytes, "device_memory_bytes"_a = 0,
      "shard"_a = py::none(), "overwrite"_a = false, "resume"_a = false, "strict"_a = false,
      "input_warnings"_a = py::tuple(), "model_is_cut"_a = false, "end_gpus"_a = false,
      "journal_interval_seconds"_a = SearchOptions{}.journal_interval_seconds,
      "progress"_a = py::none(), "message"_a = py::none(), "stop"_a = py::none(),
      R"(search(store, query, output, *, engine='auto', device='auto', gpus=(), threads=0, memory_bytes=4294967296, device_memory_bytes=0, shard=None, overwrite=False, resume=False, strict=False, input_warnings=(), model_is_cut=False, end_gpus=False, journal_interval_seconds=5.0, progress=None, message=None, stop=None)
--

Find every point of the store within the query's radius of the moving model.

Writes the result file `output` and returns a SearchReport. Open the file with Result.
Ctrl-C stops the search and raises KeyboardInterrupt. The same call with resume=True goes on.

store: the Store to search.
query: the Query to answer.
output: the file of the result to write.
engine: 'auto', 'sweep', 'grid' or 'kdtree'; 'auto' takes the one that is estimated faster.
device: 'auto', 'cpu' or 'cuda'; 'auto' takes a GPU where that is estimated faster.
gpus: the numbers that CUDA gives the GPUs to take; empty: the first one with room.
threads: how many threads work; 0: as many as there are cores.
memory_bytes: how many bytes of working memory may be taken.
device_memory_bytes: how many bytes may be taken on each GPU; 0: 2 GiB, or what is free.
shard: (i, n) searches the i-th of n parts, from 1; the output is a part for merge().
overwrite: replaces an existing result, and the journal of an earlier search.
resume: goes on from the journal of an earlier search.
strict: raises InputError where anything is warned of, and searches nothing.
input_warnings: messages of read_model() and read_trajectory(), which the report then holds too,
    and which strict counts.
model_is_cut: says that the model lacks its lowest part, as with above= of read_model(), so that it
    does not stand on the ground: ignored points that collide are not warned of for their number
    alone.
end_gpus: says that nothing else in this process uses CUDA, so that it ends with the search.
journal_interval_seconds: how often what was found is made safe on the disk, seconds.
progress: called with a ProgressUpdate, in this thread, up to 20 times a second.
message: called with each note and warning, a Message, in this thread.
stop: an object with is_set(), such as threading.Event. When it is set, Interrupted is raised.)");
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
