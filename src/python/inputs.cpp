#include <mutex>
#include <optional>
#include <string>

#include "clearway/alignment.hpp"
#include "clearway/convert.hpp"
#include "clearway/error.hpp"
#include "clearway/line.hpp"
#include "clearway/smooth.hpp"
#include "core/describe/convert.hpp"
#include "core/describe/labels.hpp"
#include "core/describe/reports.hpp"
#include "core/describe/smooth.hpp"
#include "core/describe/trajectory.hpp"
#include "core/geometry/point_box.hpp"
#include "core/util/format.hpp"
#include "python/arrays.hpp"
#include "python/binding.hpp"
#include "python/objects.hpp"
#include "python/watch.hpp"

/// Paths and scans from files.
namespace clearway::python {
namespace {

std::string names_of_all_labels() {
  return names_of_labels([](const auto&) { return true; });
}

py::array_t<double> label_values(const std::vector<double>& numbers) { return to_array(numbers); }

std::vector<py::str> label_values(const std::vector<std::string>& texts) { return shown(texts); }

constexpr std::tuple kMakerOfLabels{fact<&PoseLabels::made_by>(
    "How clearway trajectory made the file of another one, whose name and number of poses it says; "
    "empty for other files.")};

void add_labels(py::module_& module) {
  auto labels = add_class<PoseLabels>(
      module, "PoseLabels",
      ("The " + names_of_all_labels() +
       " that a file gives its poses. Make an empty one for read_trajectory(labels=...), "
       "read_alignment(labels=...) or read_line(labels=...).")
          .c_str(),
      kMakerOfLabels);
  labels.def(py::init<>(), "__init__(self)\n--\n\nMake labels that read_trajectory() can fill.");
  for_each_label([&labels](const auto& label) {
    labels.def_property_readonly(
        label.key,
        [member = label.member](const PoseLabels& given) { return label_values(given.*member); },
        label.doc);
  });
}

/// Reads the file of the argument `path`, appends to `messages` and fills `labels`.
template <typename Read>
py::array_t<double> poses_of_file(const py::kwargs& given, Read read) {
  PoseLabels found;
  const auto poses = read_noting(
      given, [&, file = path_of(given["path"])](auto* noted) { return read(file, noted, &found); });
  if (auto* const labels = argument<PoseLabels*>(given, "labels")) *labels = std::move(found);
  return to_array(poses);
}

py::array_t<double> read_trajectory(const py::kwargs& given) {
  TrajectoryOptions options;
  set_fields(kTrajectoryFields, given, options);
  const EnvironmentUnit environment = take_environment_unit(given, options);
  return poses_of_file(given, [&](const auto& file, auto* noted, PoseLabels* labels) {
    auto poses = read_trajectory(file, options, noted, labels);
    check_unit_is_given(file, environment, options.metres_per_unit, *noted);
    return poses;
  });
}

py::array_t<double> read_alignment(const py::kwargs& given) {
  using Options = AlignmentOptions;
  Options options;
  take<&Options::alignment, &Options::profile, &Options::station_from, &Options::station_to,
       &Options::step, &Options::reverse, &Options::cant, &Options::rail_distance, &Options::order,
       &Options::max_gap, &Options::height, &Options::environment_crs>(given, options);
  return poses_of_file(given, [&](const auto& file, auto* noted, PoseLabels* labels) {
    return read_alignment(file, options, noted, labels);
  });
}

py::array_t<double> read_line(const py::kwargs& given) {
  using Options = LineOptions;
  Options options;
  take<&Options::step, &Options::reverse, &Options::height, &Options::corner_radius,
       &Options::track, &Options::cant, &Options::rail_distance, &Options::unit,
       &Options::environment_crs>(given, options);
  if (!take_environment_unit(given, options).is_given) options.environment_unit_is_assumed = false;
  auto* const ground = argument<SharedStore*>(given, "ground");
  if (ground != nullptr) options.ground = &ground->store;
  return poses_of_file(given, [&](const auto& file, auto* noted, PoseLabels* labels) {
    std::unique_lock<std::timed_mutex> turn;
    if (ground != nullptr) turn = std::unique_lock(ground->turn);
    return read_line(file, options, noted, labels);
  });
}

/// What smooth_trajectory() is asked, and what watches it.
struct SmoothOptions : SmoothParameters {
  ProgressCallback progress = nullptr;
  StopFlag stop = nullptr;
};

void add_smooth_path(py::module_& module) {
  auto path = add_class<SmoothPath>(
      module, "SmoothPath",
      "A path on a smooth curve, and how far it is from the given one. Distances are upper bounds, "
      "between poses as well.");
  path.def_property_readonly(
      "place", member_array<&SmoothPath::place, SmoothPath>,
      "For each of them the place of the given path, as the index of a pose and a part of the way "
      "to the next one: n float64.");
  add_repr(path, [](const SmoothPath& p) {
    return "<SmoothPath: " + counted(p.poses.size(), "pose") + ", " +
           counted(p.control_points, "control point") + ", largest deviation " +
           format_brief(p.largest_deviation) + ">";
  });
}

SmoothPath smooth_trajectory(const py::kwargs& given) {
  SmoothOptions options;
  set_fields(kSmoothFields, given, options);
  const std::vector<Pose> path = poses_of(given);
  std::optional<Box> box;
  if (!given["model"].is_none()) {
    const Model model = model_of(given["model"]);
    if (model.empty()) throw InputError("model: has no points");
    box = box_of(model.vertices);
  }
  Watch watch(given, options);
  return watch.run(
      [&] { return smooth_trajectory(path, options, box, options.progress, options.stop); });
}

py::dict busy_seconds(const ConvertReport& report) {
  py::dict seconds;
  for (const StageSeconds& stage : report.busy_seconds) seconds[text(stage.stage)] = stage.seconds;
  return seconds;
}

void add_convert_report(py::module_& module) {
  add_class<OriginsPathReport>(
      module, "OriginsPathReport",
      "How the points of a moving scanner found their places on its path.");
  auto report = add_class<ConvertReport>(
      module, "ConvertReport",
      "What a conversion did: how many points it stored, how exactly, and in what time.");
  report.def_property_readonly(
      "busy_seconds", &busy_seconds,
      "For how many seconds all threads together were busy with each stage: a dict by its name.");
  add_repr(report, [](const ConvertReport& r) {
    return "<" + std::to_string(r.points) + " points in " + std::to_string(r.cells) + " cells" +
           warning_words(r.warnings) + ">";
  });
}

ConvertReport convert(const py::kwargs& given) {
  ConvertOptions options;
  set_fields(kConvertFields, given, options);
  set_fields(kReadingFields, given, options.path_options);
  Watch watch(given, options);
  return watch.run([&, from = paths_of(given["inputs"]), to = path_of(given["output"])] {
    return convert(from, to, options);
  });
}

}  // namespace

void add_inputs(py::module_& module) {
  add_labels(module);
  add_convert_report(module);
  add_smooth_path(module);
  module.def(
      "read_trajectory", &read_trajectory,
      ("read_trajectory(path: Path, *, " + signature_of(kTrajectoryFields) +
       R"DOC(, environment_unit: EnvironmentUnit = None, messages: Notes = None, labels: PoseLabels = None)
--

Read the poses of a trajectory. Returns an array of n x 4 x 4 float64.

pose[:3, :3] is the rotation and pose[:3, 3] the translation in metres, so that a point m of
the model is at pose[:3, :3] @ m + pose[:3, 3].

path: the file.

)DOC" + lines_of(kTrajectoryFields) +
       R"DOC(environment_unit: the environment's unit, into which a known unit is converted:
    store.metres_per_unit(), store.length_unit(), or a name. None: the metre; a file that names
    another unit is refused then.
messages: a list to which notes and warnings are appended.
labels: a PoseLabels, which gets the )DOC" +
       names_of_all_labels() + R"DOC( that the file has.)DOC")
          .c_str());
  module.def("read_alignment", &read_alignment,
             R"(read_alignment(path: Path, *, alignment: Text = '', profile: Text = '',
    station_from: Number = None, station_to: Number = None, step: Above0 = 0.1,
    reverse: Flag = False,
    cant: OneOf('file', 'none', 'center', 'inside-rail', 'outside-rail', 'left-rail', 'right-rail') = 'file',
    rail_distance: Above0 = None, order: OneOf('ne', 'en') = 'ne', max_gap: From0 = 0.001,
    height: Number = None, environment_crs: Text = '', messages: Notes = None,
    labels: PoseLabels = None)
--

Make poses along an alignment of a LandXML file. Returns an array of n x 4 x 4 float64, metres.

The model has x forward, y left and z up, with its origin in the middle of the track on the plane
of the tops of the rails.

path: the LandXML 1.2 file.
alignment: the name of the alignment, where the file has several.
profile: the name of its profile, where it has several.
station_from: the internal station of the first pose, in the unit of the file; None: as far as
    plan and profile reach.
station_to: that of the last pose.
step: metres along the alignment from one pose to the next.
reverse: travels against the stations, so that x and y of the poses point the other way.
cant: what cant turns the track about: 'center', 'inside-rail', 'outside-rail', 'left-rail',
    'right-rail', 'file', which is what the file says, or 'none', which leaves it out.
rail_distance: metres between the middles of the rails; None: 1.5 for a gauge of 1.435 or 1.5.
order: the order of the coordinates in the file: 'ne' (northing, easting) or 'en'.
max_gap: how many metres an element may miss the next one, or its own end, at the most.
height: the height in metres of an alignment that has no profile.
environment_crs: the coordinate system of the environment, for example store.crs_wkt(); a file in
    another one causes a warning.
messages: a list to which notes and warnings are appended.
labels: a PoseLabels, which gets the station of each pose.)");
  module.def(
      "read_line", &read_line,
      R"(read_line(path: Path, *, step: Above0 = 0.1, reverse: Flag = False, height: Number = None,
    corner_radius: Above0 = None, ground: Store = None, track: Above0 = None,
    cant: OneOf('none', 'center', 'inside-rail', 'outside-rail', 'left-rail', 'right-rail') = 'center',
    rail_distance: Above0 = None, unit: Unit = 0.0, environment_unit: EnvironmentUnit = None,
    environment_crs: Text = '', messages: Notes = None, labels: PoseLabels = None)
--

Make poses along a line of CSV or GeoJSON. Returns an array of n x 4 x 4 float64, metres.

The model has x forward, y left and z up.

path: a table whose first line names the columns x, y and, where it has them, z, station and cant;
    or GeoJSON with one LineString in the coordinates of the environment.
step: metres along the line in plan from one pose to the next.
reverse: travels from the last vertex to the first.
height: the height in metres of a line whose vertices have none; on the ground about where it
    begins.
corner_radius: the radius in metres of arcs that are put at the vertices, between straight legs;
    None: a smooth curve leads through the vertices, which may turn by 15 degrees at most.
ground: a Store whose ground under the wheels gives height and roll. Under a parked car the ground
    is not seen, and the path is about 0.3 m too high.
track: metres between the middles of the left and the right wheels; only with ground.
cant: what a column of cant turns the track about, which the line then is: 'center',
    'inside-rail', 'outside-rail', 'left-rail', 'right-rail', or 'none', which leaves it out.
rail_distance: metres between the middles of the rails, over which cant is measured; None: 1.5.
unit: the unit of the coordinates: metres, or a name such as 'mm' or 'us-ft'; 0: what the file
    says, otherwise that of the environment.
environment_unit: the environment's unit: store.metres_per_unit(), store.length_unit(), or a name;
    None: the metre.
environment_crs: the coordinate system of the environment, for example store.crs_wkt(); a file in
    another one causes a warning.
messages: a list to which notes and warnings are appended.
labels: a PoseLabels, which gets the station of each pose if the file has stations.)");
  module.def(
      "convert", &convert,
      ("convert(inputs: Paths, output: Path, *, " + signature_of(kConvertFields) + ", " +
       signature_of(kReadingFields) +
       R"DOC(, progress: Progress = None, message: Tell = None, stop: Stop = None)
--

Turn scans into a store, the one file that searches read. Returns a ConvertReport.

inputs: a path, or several: files or folders of LAS, LAZ, E57, PLY, PCD, PTX, PTS, 3DTK or text.
output: the file of the store to write.
)DOC" + lines_of(kConvertFields) +
       R"DOC(format, angle_unit, angle_frame, crs, datum, metres_per_unit: how origins_path is read, as
    read_trajectory() takes them.
progress: called with a ProgressUpdate, in this thread, up to 20 times a second.
message: called with each note and warning, a Message, in this thread.
stop: an object with is_set(), such as threading.Event. When it is set, Interrupted is raised.)DOC")
          .c_str());
  module.def("smooth_trajectory", &smooth_trajectory,
             ("smooth_trajectory(poses: Array, within: Above0, *, model: ArrayOrModel = None, " +
              signature_of(kSmoothFields) +
              R"DOC(, progress: Progress = None, stop: Stop = None)
--

Put a smooth curve to a noisy path, and poses on it. Returns a SmoothPath.

Lengths are in the unit of the poses. A path with a jump raises InputError.

poses: the path, n x 4 x 4 or n x 3 x 4.
within: the farthest that a model point may be from where the given path has it.
model: points, n x 3, or a Model; required where rotations change. Without it lengths are those of
    the positions.
)DOC" + lines_of(kSmoothFields) +
              R"DOC(progress, stop: as search() takes them.)DOC")
                 .c_str());
}

}  // namespace clearway::python
