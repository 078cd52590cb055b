#include "clearway/search.hpp"

#include <pybind11/stl.h>

#include <map>
#include <optional>
#include <string>
#include <utility>

#include "python/arrays.hpp"
#include "python/model.hpp"
#include "python/store.hpp"
#include "python/values.hpp"
#include "python/watch.hpp"

namespace clearway::python {
namespace {

using namespace py::literals;

constexpr Named<Engine> kEngines[] = {{"auto", Engine::kAuto},
                                      {"sweep", Engine::kSweep},
                                      {"grid", Engine::kGrid},
                                      {"kdtree", Engine::kKdtree}};
constexpr Named<Device> kDevices[] = {
    {"auto", Device::kAuto}, {"cpu", Device::kCpu}, {"cuda", Device::kCuda}};

void add_store(py::module_& module) {
  py::class_<SharedStore>(
      module, "Store",
      "An environment that convert() made. Searches on one Store take turns; open it twice to run\n"
      "two at once.")
      .def(py::init([](const py::object& path) {
             return without_gil(
                 [file = path_of(path)] { return std::make_unique<SharedStore>(file); });
           }),
           "path"_a)
      .def("point_count", [](const SharedStore& s) { return s.store.point_count(); })
      .def("cell_count", [](const SharedStore& s) { return s.store.cell_count(); })
      .def(
          "box", [](const SharedStore& s) { return s.store.box(); },
          "Of all points, a Box; of no points: zeros.")
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
          "Number of points by class; empty where the points have no classes.")
      .def(
          "crs_wkt", [](const SharedStore& s) { return text(s.store.crs_wkt()); },
          "Coordinate reference system as the scans had it, or ''.")
      .def(
          "length_unit", [](const SharedStore& s) { return text(s.store.length_unit()); },
          "'metre', 'foot', 'us-survey-foot', 'degree' or 'unknown'.")
      .def_property_readonly(
          "path", [](const SharedStore& s) { return to_python(s.store.path()); }, "A pathlib.Path.")
      .def("__repr__", [](const SharedStore& s) {
        return text("<Store " + s.store.path().string() + ": " +
                    std::to_string(s.store.point_count()) + " points>");
      });
}

template <auto Member>
void add_parameter(py::class_<ArrayQuery>& query, const char* name, const char* doc) {
  query.def_property(
      name, [](const ArrayQuery& q) { return q.parameters.*Member; },
      [](ArrayQuery& q, std::remove_cvref_t<decltype(std::declval<QueryParameters>().*Member)> v) {
        q.parameters.*Member = v;
      },
      doc);
}

ArrayQuery make_query(const py::object& model, const py::object& poses, double radius,
                      bool first_pose, bool between_poses, double clearance, double profile,
                      double tolerance, std::vector<std::uint8_t> ignore_classes,
                      std::vector<Box> ignore_boxes, bool allow_non_rigid,
                      std::vector<Body> bodies) {
  return {{radius, first_pose, between_poses, clearance, profile, tolerance,
           std::move(ignore_classes), std::move(ignore_boxes)},
          model_object(model),
          poses_array(poses, "poses"),
          allow_non_rigid,
          std::move(bodies)};
}

void add_query(py::module_& module) {
  const py::tuple nothing;
  py::class_<ArrayQuery> query(
      module, "Query",
      "Which points of an environment lie within the search radius of the moving model?");
  query
      .def(py::init(&make_query), "model"_a = nothing, "poses"_a = nothing, "radius"_a = 0.0,
           py::kw_only(), "first_pose"_a = false, "between_poses"_a = false, "clearance"_a = 0.0,
           "profile"_a = 0.0, "tolerance"_a = 0.0, "ignore_classes"_a = nothing,
           "ignore_boxes"_a = nothing, "allow_non_rigid"_a = false, "bodies"_a = nothing)
      .def_property(
          "model", [](const ArrayQuery& q) { return q.model; },
          [](ArrayQuery& q, const py::object& value) { q.model = model_object(value); },
          "In the model's own frame: points, n x 3 float64, metres; or a ModelShape.")
      .def_property(
          "poses", [](const ArrayQuery& q) { return q.poses; },
          [](ArrayQuery& q, const py::object& value) { q.poses = poses_array(value, "poses"); },
          "n x 4 x 4 or n x 3 x 4 float64; the translation, in metres, is the last column.")
      .def_readwrite("allow_non_rigid", &ArrayQuery::allow_non_rigid,
                     "Takes poses that scale or shear too.")
      .def_readwrite("bodies", &ArrayQuery::bodies,
                     "Of a vehicle: Body objects, in the place of a model; poses are the path's.")
      .def("__repr__", [](const ArrayQuery& q) {
        return py::str("<Query: {}, {} poses, radius {} m>")
            .format(model_words(q.model), q.poses.shape(0), q.parameters.radius);
      });
  using Q = QueryParameters;
  add_parameter<&Q::radius>(query, "radius",
                            "Metres, above 0: a point strictly closer to the model collides.");
  add_parameter<&Q::first_pose>(query, "first_pose",
                                "Asks for the first pose that touches each colliding point.");
  add_parameter<&Q::between_poses>(query, "between_poses",
                                   "Moves model points on straight segments from pose to pose.");
  add_parameter<&Q::clearance>(query, "clearance",
                               "Metres: asks for the distances below it too; 0: none.");
  add_parameter<&Q::profile>(
      query, "profile", "Metres: asks for the least distance below it of every pose; 0: none.");
  add_parameter<&Q::tolerance>(
      query, "tolerance",
      "Metres: points whose distance differs from the radius by no more may be answered wrongly.");
  add_parameter<&Q::ignore_classes>(query, "ignore_classes",
                                    "Numbers of classes: their points are left out of the search.");
  add_parameter<&Q::ignore_boxes>(
      query, "ignore_boxes",
      "Boxes in the environment's coordinates: points in them are left out of the search.");
}

void add_searches(py::module_& module) {
  module.def(
      "search",
      [](SharedStore& store, const ArrayQuery& query, const py::object& output,
         const std::string& engine, const std::string& device, std::vector<int> gpus, int threads,
         std::uint64_t memory_bytes, std::uint64_t device_memory_bytes, double field_voxel,
         double grid_cell, bool float_precision,
         std::optional<std::pair<std::uint32_t, std::uint32_t>> shard, bool overwrite, bool resume,
         bool strict, const py::object& input_warnings, bool end_gpus,
         double journal_interval_seconds, py::object progress, py::object message,
         py::object stop) {
        SearchOptions options;
        options.engine = value_of("engine", kEngines, engine);
        options.device = value_of("device", kDevices, device);
        options.gpus = std::move(gpus);
        options.threads = threads;
        options.memory_bytes = memory_bytes;
        options.device_memory_bytes = device_memory_bytes;
        options.field_voxel = field_voxel;
        options.grid_cell = grid_cell;
        options.float_precision = float_precision;
        if (shard) options.shard = Shard{shard->first, shard->second};
        options.overwrite = overwrite;
        options.resume = resume;
        options.strict = strict;
        options.input_warnings = messages_of(input_warnings);
        options.end_gpus = end_gpus;
        options.journal_interval_seconds = journal_interval_seconds;
        Watch watch(std::move(progress), std::move(message), std::move(stop));
        watch.attach(options);
        return watch.run(
            [&, asked = query_of(query), rigid = !query.allow_non_rigid, to = path_of(output)] {
              if (rigid) {
                require_rigid(asked.poses);
                for (const Body& body : asked.bodies) require_rigid(body.poses);
              }
              return in_turn(store, options.stop,
                             [&](const Store& own) { return search(own, asked, to, options); });
            });
      },
      "store"_a, "query"_a, "output"_a, py::kw_only(), "engine"_a = "auto", "device"_a = "auto",
      "gpus"_a = std::vector<int>{}, "threads"_a = 0,
      "memory_bytes"_a = SearchOptions{}.memory_bytes, "device_memory_bytes"_a = 0,
      "field_voxel"_a = 0.0, "grid_cell"_a = 0.0, "float_precision"_a = false,
      "shard"_a = py::none(), "overwrite"_a = false, "resume"_a = false, "strict"_a = false,
      "input_warnings"_a = py::tuple(), "end_gpus"_a = false,
      "journal_interval_seconds"_a = SearchOptions{}.journal_interval_seconds,
      "progress"_a = py::none(), "message"_a = py::none(), "stop"_a = py::none(),
      R"(search(store, query, output, *, engine='auto', device='auto', gpus=(), threads=0, memory_bytes=4294967296, device_memory_bytes=0, field_voxel=0.0, grid_cell=0.0, float_precision=False, shard=None, overwrite=False, resume=False, strict=False, input_warnings=(), end_gpus=False, journal_interval_seconds=5.0, progress=None, message=None, stop=None)
--

Find every point of the store within the query's radius of the moving model.

Writes the result file `output` and returns a SearchReport. Open the file with Result.
Ctrl-C stops the search and raises KeyboardInterrupt. The same call with resume=True goes on.

engine: 'auto', 'sweep', 'grid' or 'kdtree'. device: 'auto', 'cpu' or 'cuda'.
gpus: CUDA's numbers; empty: the first with room.
threads: 0: all cores.
memory_bytes: bound of the working memory.
device_memory_bytes: bound on each GPU; 0: 2 GiB, or what is free.
field_voxel, grid_cell: metres; 0: chosen.
float_precision: engine grid decides in single precision, for comparison.
shard: (i, n) searches the i-th of n parts, from 1; the output is a part for merge().
overwrite: an existing result, and the journal of an earlier run.
resume: goes on from the journal of an earlier run.
strict: raises InputError where anything is warned of, and searches nothing.
input_warnings: messages of read_model and read_trajectory, for the report and for strict.
end_gpus: nothing else in this process uses CUDA: its contexts end with the search.
journal_interval_seconds: between two syncs of the journal to the disk.
progress: called with a ProgressUpdate, in this thread, up to 20 times a second.
message: called with each note and warning, a Message, in this thread.
stop: an object with is_set(), such as threading.Event. When it is set, Interrupted is raised.)");
}

}  // namespace

Query query_of(const ArrayQuery& query) {
  ModelShape shape = model_of(query.model);
  Query asked(std::move(shape.points), poses_of(query.poses, "poses"), query.parameters);
  asked.triangles = std::move(shape.triangles);
  asked.solid_of = std::move(shape.solid_of);
  asked.bodies = query.bodies;
  return asked;
}

void add_search(py::module_& module) {
  add_store(module);
  add_query(module);
  add_searches(module);
}

}  // namespace clearway::python
