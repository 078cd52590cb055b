#include "python/inputs.hpp"

#include <pybind11/stl.h>

#include <array>
#include <mutex>
#include <optional>

#include "clearway/alignment.hpp"
#include "clearway/convert.hpp"
#include "clearway/line.hpp"
#include "core/describe/convert.hpp"
#include "core/describe/labels.hpp"
#include "core/describe/trajectory.hpp"
#include "python/arrays.hpp"
#include "python/fields.hpp"
#include "python/store.hpp"
#include "python/values.hpp"
#include "python/watch.hpp"

namespace clearway::python {
namespace {

using namespace py::literals;

constexpr Choice<CantLine> kCants[] = {{"file", CantLine::kFile},
                                       {"none", CantLine::kNone},
                                       {"center", CantLine::kCenter},
                                       {"inside-rail", CantLine::kInsideRail},
                                       {"outside-rail", CantLine::kOutsideRail},
                                       {"left-rail", CantLine::kLeftRail},
                                       {"right-rail", CantLine::kRightRail}};
constexpr Choice<AxisOrder> kOrders[] = {{"ne", AxisOrder::kNorthingEasting},
                                         {"en", AxisOrder::kEastingNorthing}};

std::string names_of_all_labels() {
  return names_of_labels([](const auto&) { return true; });
}

py::array_t<double> label_values(const std::vector<double>& numbers) { return to_array(numbers); }

py::list label_values(const std::vector<std::string>& texts) {
  py::list out;
  for (const std::string& each : texts) out.append(text(each));
  return out;
}

void add_labels(py::module_& module) {
  py::class_<PoseLabels> labels(module, "PoseLabels",
                                ("The " + names_of_all_labels() +
                                 " that a file gives its poses. Make an "
                                 "empty one for read_trajectory(labels=...), "
                                 "read_alignment(labels=...) or read_line(labels=...).")
                                    .c_str());
  labels.def(py::init<>(), "__init__(self)\n--\n\nMake labels that read_trajectory() can fill.");
  for_each_label([&labels](const auto& label) {
    labels.def_property_readonly(
        label.key,
        [member = label.member](const PoseLabels& given) { return label_values(given.*member); },
        label.doc);
  });
  labels.def_readonly("made_by", &PoseLabels::made_by,
                      "How clearway trajectory made the file of another one, whose name and number "
                      "of poses it says; empty for other files.");
}

void add_read_trajectory(py::module_& module) {
  module.def(
      "read_trajectory",
      [](const py::object& path, const EnvironmentUnitArgument& environment_unit,
         const py::object& messages, PoseLabels* labels, const py::kwargs& given) {
        const TrajectoryOptions options = trajectory_options(given, environment_unit);
        PoseLabels found;
        const auto poses = read_noting(messages, [&, file = path_of(path)](auto* noted) {
          auto read = read_trajectory(file, options, noted, &found);
          check_unit_is_given(file, environment_unit, options.metres_per_unit, *noted);
          return read;
        });
        if (labels != nullptr) *labels = std::move(found);
        return to_array(poses);
      },
      "path"_a, py::kw_only(), "environment_unit"_a = py::none(), "messages"_a = py::none(),
      "labels"_a = py::none(),
      ("read_trajectory(path, *, " + signature_of(kTrajectoryFields) +
       R"DOC(, environment_unit=None, messages=None, labels=None)
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
  add_checks(module, "read_trajectory", kTrajectoryFields);
}

void add_read_alignment(py::module_& module) {
  module.def(
      "read_alignment",
      [](const py::object& path, const std::string& alignment, const std::string& profile,
         std::optional<double> station_from, std::optional<double> station_to, double step,
         bool reverse, const std::string& cant, std::optional<double> rail_distance,
         const std::string& order, double max_gap, std::optional<double> height,
         const std::string& environment_crs, const py::object& messages, PoseLabels* labels) {
        const AlignmentOptions options{.alignment = alignment,
                                       .profile = profile,
                                       .station_from = station_from,
                                       .station_to = station_to,
                                       .step = step,
                                       .reverse = reverse,
                                       .cant = value_of("cant", kCants, cant),
                                       .rail_distance = rail_distance,
                                       .order = value_of("order", kOrders, order),
                                       .max_gap = max_gap,
                                       .height = height,
                                       .environment_crs = environment_crs};
        PoseLabels found;
        const auto poses = read_noting(messages, [&, file = path_of(path)](auto* noted) {
          return read_alignment(file, options, noted, &found);
        });
        if (labels != nullptr) *labels = std::move(found);
        return to_array(poses);
      },
      "path"_a, py::kw_only(), "alignment"_a = "", "profile"_a = "", "station_from"_a = py::none(),
      "station_to"_a = py::none(), "step"_a = 0.1, "reverse"_a = false, "cant"_a = "file",
      "rail_distance"_a = py::none(), "order"_a = "ne", "max_gap"_a = 0.001,
      "height"_a = py::none(), "environment_crs"_a = "", "messages"_a = py::none(),
      "labels"_a = py::none(),
      R"(read_alignment(path, *, alignment='', profile='', station_from=None, station_to=None, step=0.1, reverse=False, cant='file', rail_distance=None, order='ne', max_gap=0.001, height=None, environment_crs='', messages=None, labels=None)
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
}

void add_read_line(py::module_& module) {
  module.def(
      "read_line",
      [](const py::object& path, double step, bool reverse, std::optional<double> height,
         std::optional<double> corner_radius, SharedStore* ground, std::optional<double> track,
         const std::string& cant, std::optional<double> rail_distance, const UnitArgument& unit,
         const EnvironmentUnitArgument& environment_unit, const std::string& environment_crs,
         const py::object& messages, PoseLabels* labels) {
        const EnvironmentUnit environment = environment_unit_of(environment_unit);
        const LineOptions options{
            .step = step,
            .reverse = reverse,
            .height = height,
            .corner_radius = corner_radius,
            .ground = ground == nullptr ? nullptr : &ground->store,
            .track = track,
            .cant = value_of("cant", kCants, cant),
            .rail_distance = rail_distance,
            .unit = file_unit(unit),
            .environment_unit = environment.metres,
            .environment_unit_is_assumed = environment_unit && environment.is_assumed,
            .environment_crs = environment_crs};
        PoseLabels found;
        const auto poses = read_noting(messages, [&, file = path_of(path)](auto* noted) {
          std::unique_lock<std::timed_mutex> turn;
          if (ground != nullptr) turn = std::unique_lock(ground->turn);
          return read_line(file, options, noted, &found);
        });
        if (labels != nullptr) *labels = std::move(found);
        return to_array(poses);
      },
      "path"_a, py::kw_only(), "step"_a = 0.1, "reverse"_a = false, "height"_a = py::none(),
      "corner_radius"_a = py::none(), "ground"_a = py::none(), "track"_a = py::none(),
      "cant"_a = "center", "rail_distance"_a = py::none(), "unit"_a = 0.0,
      "environment_unit"_a = py::none(), "environment_crs"_a = "", "messages"_a = py::none(),
      "labels"_a = py::none(),
      R"(read_line(path, *, step=0.1, reverse=False, height=None, corner_radius=None, ground=None, track=None, cant='center', rail_distance=None, unit=0.0, environment_unit=None, environment_crs='', messages=None, labels=None)
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
}

py::dict busy_seconds(const ConvertReport& report) {
  py::dict seconds;
  for (const StageSeconds& stage : report.busy_seconds) seconds[text(stage.stage)] = stage.seconds;
  return seconds;
}

void add_origins_path_report(py::module_& module) {
  using Report = OriginsPathReport;
  py::class_<Report>(module, "OriginsPathReport",
                     "How the points of a moving scanner found their places on its path.")
      .def_readonly("point_clock", &Report::point_clock,
                    "What the GPS times of the points are: 'week-seconds', 'adjusted' (adjusted "
                    "standard GPS time), or 'mixed' where files differ.")
      .def_readonly("path_clock", &Report::path_clock,
                    "What the times of the path are taken for: 'week-seconds', 'adjusted', or "
                    "'standard', which is any other epoch.")
      .def_readonly("first_point", &Report::first_point,
                    "The least GPS time of a point, seconds as in the file.")
      .def_readonly("last_point", &Report::last_point,
                    "The greatest GPS time of a point, seconds as in the file.")
      .def_readonly("first_pose", &Report::first_pose, "The time of the first pose, seconds.")
      .def_readonly("last_pose", &Report::last_pose, "The time of the last pose, seconds.")
      .def_readonly("shifts", &Report::shifts,
                    "What was added to times of points to compare them with the path: a list of "
                    "seconds, ascending.")
      .def_readonly("before", &Report::before, "How many points are from before the first pose.")
      .def_readonly("after", &Report::after, "How many points are from after the last pose.")
      .def_readonly("in_gaps", &Report::in_gaps,
                    "How many points are from between poses more than 1 s apart.")
      .def_readonly("without_time", &Report::without_time,
                    "How many points have no finite GPS time.");
}

void add_convert_report(py::module_& module) {
  using Report = ConvertReport;
  py::class_<Report>(
      module, "ConvertReport",
      "What a conversion did: how many points it stored, how exactly, and in what time.")
      .def_readonly("was_finished", &Report::was_finished,
                    "Whether the store was there already, so that nothing was converted.")
      .def_readonly("points", &Report::points, "How many points were stored.")
      .def_readonly("cells", &Report::cells, "Into how many cells the points were divided.")
      .def_readonly("non_finite_points", &Report::non_finite_points,
                    "How many points were left out because a coordinate was not a finite number.")
      .def_readonly("absent_points", &Report::absent_points,
                    "How many records of the scans have no point, such as beams that hit nothing.")
      .def_readonly("withheld_points", &Report::withheld_points,
                    "How many points were left out because they have the flag withheld.")
      .def_readonly("kept_withheld_points", &Report::kept_withheld_points,
                    "How many points were stored although they have the flag withheld.")
      .def_readonly("far_points", &Report::far_points,
                    "How many points were left out because they are too far from the path of near.")
      .def_readonly("unread_points", &Report::unread_points,
                    "How many of these were not even read.")
      .def_readonly("passed_over_files", &Report::passed_over_files,
                    "How many files were not read because of trust_bounds.")
      .def_readonly("origins", &Report::origins,
                    "From how many distinct places the points were seen; 0 where no input says so.")
      .def_readonly("points_without_origin", &Report::points_without_origin,
                    "For how many points it is not known from where they were seen.")
      .def_readonly("origins_path", &Report::origins_path,
                    "How the points found their places on origins_path: an OriginsPathReport; None "
                    "without it.")
      .def_property_readonly(
          "scale", [](const Report& r) { return to_array(r.scale); },
          "The step of the stored coordinates on each axis: 3 float64, metres.")
      .def_property_readonly(
          "offset", [](const Report& r) { return to_array(r.offset); },
          "The place that the stored coordinates count from: 3 float64, metres.")
      .def_readonly("box", &Report::box,
                    "The Box around the points of the scans, those too far from a path included; "
                    "None where there are no points.")
      .def_readonly("largest_change", &Report::largest_change,
                    "By how much rounding to the scale changed any coordinate at the most, metres.")
      .def_readonly("temporary_bytes", &Report::temporary_bytes,
                    "How many bytes temporary files took.")
      .def_readonly("output_bytes", &Report::output_bytes, "How many bytes the store has.")
      .def_readonly(
          "resumed_from", &Report::resumed_from,
          "What an interrupted call had come to, which resume=True took over: 'the inputs "
          "were inspected', 'all points were counted' or 'all points were distributed'. "
          "Empty where nothing was taken over.")
      .def_readonly("count_seconds", &Report::count_seconds,
                    "Seconds of counting the points of the inputs.")
      .def_readonly("distribute_seconds", &Report::distribute_seconds,
                    "Seconds of distributing the points to places of the store.")
      .def_readonly("partition_seconds", &Report::partition_seconds,
                    "Seconds of dividing the points into cells and writing them.")
      .def_readonly("confirm_seconds", &Report::confirm_seconds,
                    "Seconds of confirming that the inputs did not change meanwhile.")
      .def_property_readonly("busy_seconds", busy_seconds,
                             "For how many seconds all threads together were busy with each stage: "
                             "a dict by its name.")
      .def_property_readonly(
          "warnings", [](const Report& r) { return to_list(r.warnings); },
          "What may be wrong with the scans: a list of Message.")
      .def("__repr__", [](const Report& r) {
        return text("<" + std::to_string(r.points) + " points in " + std::to_string(r.cells) +
                    " cells" + warning_words(r.warnings) + ">");
      });
}

void add_convert(py::module_& module) {
  module.def(
      "convert",
      [](const py::object& inputs, const py::object& output, py::object progress,
         py::object message, py::object stop, const py::kwargs& given) {
        ConvertOptions options;
        set_fields(kConvertFields, given, options);
        set_fields(kReadingFields, given, options.path_options);
        Watch watch(std::move(progress), std::move(message), std::move(stop));
        watch.attach(options);
        return watch.run([&, from = paths_of(inputs), to = path_of(output)] {
          return convert(from, to, options);
        });
      },
      "inputs"_a, "output"_a, py::kw_only(), "progress"_a = py::none(), "message"_a = py::none(),
      "stop"_a = py::none(),
      ("convert(inputs, output, *, " + signature_of(kConvertFields) + ", " +
       signature_of(kReadingFields) + R"DOC(, progress=None, message=None, stop=None)
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
  add_checks(module, "convert", kConvertFields);
  add_checks(module, "convert", kReadingFields);
}

}  // namespace

TrajectoryOptions trajectory_options(const py::kwargs& given,
                                     const EnvironmentUnitArgument& environment_unit) {
  TrajectoryOptions options;
  set_fields(kTrajectoryFields, given, options);
  const EnvironmentUnit environment = environment_unit_of(environment_unit);
  options.environment_unit = environment.metres;
  options.environment_unit_is_assumed = environment.is_assumed;
  return options;
}

void add_inputs(py::module_& module) {
  add_labels(module);
  add_read_trajectory(module);
  add_origins_path_report(module);
  add_read_alignment(module);
  add_read_line(module);
  add_convert_report(module);
  add_convert(module);
}

}  // namespace clearway::python
