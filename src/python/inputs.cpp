#include "python/inputs.hpp"

#include <pybind11/stl.h>

#include <array>
#include <optional>

#include "clearway/convert.hpp"
#include "python/arrays.hpp"
#include "python/values.hpp"
#include "python/watch.hpp"

namespace clearway::python {
namespace {

using namespace py::literals;

constexpr Named<TrajectoryFormat> kFormats[] = {{"auto", TrajectoryFormat::kAuto},
                                                {"matrix", TrajectoryFormat::kMatrix},
                                                {"tum", TrajectoryFormat::kTum},
                                                {"euroc", TrajectoryFormat::kEuroc},
                                                {"csv", TrajectoryFormat::kCsv},
                                                {"pose-xyzw", TrajectoryFormat::kPoseXyzw},
                                                {"pose-wxyz", TrajectoryFormat::kPoseWxyz},
                                                {"sbet", TrajectoryFormat::kSbet},
                                                {"3dtk-pose", TrajectoryFormat::kThreedtkPose},
                                                {"3dtk-frames", TrajectoryFormat::kThreedtkFrames}};
constexpr Named<AngleUnit> kAngleUnits[] = {
    {"declared", AngleUnit::kDeclared}, {"deg", AngleUnit::kDegrees}, {"rad", AngleUnit::kRadians}};
constexpr Named<AngleFrame> kAngleFrames[] = {
    {"declared", AngleFrame::kDeclared}, {"ned", AngleFrame::kNed}, {"enu", AngleFrame::kEnu}};

void add_labels(py::module_& module) {
  py::class_<PoseLabels>(module, "PoseLabels",
                         "What a trajectory's file says of its poses beside where they are.")
      .def(py::init<>())
      .def_property_readonly(
          "time", [](const PoseLabels& l) { return to_array(l.time); },
          "Seconds as the file counts them: n float64, or empty.")
      .def_property_readonly(
          "name",
          [](const PoseLabels& labels) {
            py::list names;
            for (const std::string& name : labels.name) names.append(text(name));
            return names;
          },
          "Names or indices of the file's own: n texts, or empty.");
}

void add_read_trajectory(py::module_& module) {
  module.def(
      "read_trajectory",
      [](const py::object& path, const std::string& format, bool allow_non_rigid,
         const std::string& angle_unit, const std::string& angle_frame, const std::string& crs,
         const std::string& default_crs, const std::string& datum, double metres_per_unit,
         double environment_unit, const std::array<double, 3>& lever_arm,
         const py::object& messages, PoseLabels* labels) {
        const TrajectoryOptions options =
            trajectory_options(format, allow_non_rigid, angle_unit, angle_frame, crs, default_crs,
                               datum, metres_per_unit, environment_unit, lever_arm);
        PoseLabels found;
        const auto poses = read_noting(messages, [&, file = path_of(path)](auto* noted) {
          return read_trajectory(file, options, noted, &found);
        });
        if (labels != nullptr) *labels = std::move(found);
        return to_array(poses);
      },
      "path"_a, py::kw_only(), "format"_a = "auto", "allow_non_rigid"_a = false,
      "angle_unit"_a = "declared", "angle_frame"_a = "declared", "crs"_a = "", "default_crs"_a = "",
      "datum"_a = "", "metres_per_unit"_a = 0.0, "environment_unit"_a = 1.0,
      "lever_arm"_a = std::array<double, 3>{0, 0, 0}, "messages"_a = py::none(),
      "labels"_a = py::none(),
      R"(read_trajectory(path, *, format='auto', allow_non_rigid=False, angle_unit='declared', angle_frame='declared', crs='', default_crs='', datum='', metres_per_unit=0.0, environment_unit=1.0, lever_arm=(0.0, 0.0, 0.0), messages=None, labels=None)
--

Read the poses of a trajectory: n x 4 x 4 float64.

pose[:3, :3] is the rotation and pose[:3, 3] the translation in metres:
a point m of the model is at pose[:3, :3] @ m + pose[:3, 3].

format: 'auto', 'matrix', 'tum', 'euroc', 'csv', 'pose-xyzw', 'pose-wxyz', 'sbet', '3dtk-pose'
    or '3dtk-frames'.
allow_non_rigid: takes matrices that scale or shear too.
angle_unit: 'deg', 'rad', or 'declared': as the file says.
angle_frame: 'ned' (clockwise from north), 'enu' (counter-clockwise from east), or 'declared'.
crs: the projected coordinate system to turn latitudes and longitudes into, such as 'EPSG:25832'.
default_crs: taken where crs is empty, for example store.crs_wkt().
datum: the geographic coordinate system of latitudes and longitudes; empty: WGS 84.
metres_per_unit: of positions; 0: metres, unless the file says another.
environment_unit: metres of the environment's unit, into which a known unit is converted.
lever_arm: where the file's positions lie in the model's frame: x, y, z.
messages: a list to which notes and warnings are appended.
labels: a PoseLabels, which gets the times and names that the file has.)");
}

py::dict busy_seconds(const ConvertReport& report) {
  py::dict seconds;
  for (const StageSeconds& stage : report.busy_seconds) seconds[text(stage.stage)] = stage.seconds;
  return seconds;
}

void add_convert_report(py::module_& module) {
  using Report = ConvertReport;
  py::class_<Report>(module, "ConvertReport", "What a conversion did.")
      .def_readonly("was_finished", &Report::was_finished,
                    "The store was there already: nothing was converted.")
      .def_readonly("points", &Report::points, "Points stored.")
      .def_readonly("cells", &Report::cells)
      .def_readonly("non_finite_points", &Report::non_finite_points, "Left out.")
      .def_readonly("absent_points", &Report::absent_points, "Records without a point.")
      .def_property_readonly(
          "scale", [](const Report& r) { return to_array(r.scale); },
          "Of the stored integers: 3 float64, metres.")
      .def_property_readonly(
          "offset", [](const Report& r) { return to_array(r.offset); },
          "Of the stored integers: 3 float64, metres.")
      .def_readonly("box", &Report::box, "Of the stored points; None: there is none.")
      .def_readonly("largest_change", &Report::largest_change,
                    "Of any coordinate by rounding to the scale, metres.")
      .def_readonly("temporary_bytes", &Report::temporary_bytes)
      .def_readonly("output_bytes", &Report::output_bytes)
      .def_readonly("count_seconds", &Report::count_seconds)
      .def_readonly("distribute_seconds", &Report::distribute_seconds)
      .def_readonly("partition_seconds", &Report::partition_seconds)
      .def_readonly("confirm_seconds", &Report::confirm_seconds)
      .def_property_readonly("busy_seconds", busy_seconds,
                             "How long all threads together were busy with each stage.")
      .def_property_readonly(
          "warnings", [](const Report& r) { return to_list(r.warnings); }, "A list of Message.")
      .def("__repr__", [](const Report& r) {
        return text("<" + std::to_string(r.points) + " points in " + std::to_string(r.cells) +
                    " cells" + warning_words(r.warnings) + ">");
      });
}

void add_convert(py::module_& module) {
  module.def(
      "convert",
      [](const py::object& inputs, const py::object& output, std::optional<double> scale,
         std::uint32_t cell_points, std::optional<double> regular_size, std::uint64_t memory_bytes,
         int threads, bool ignore_crs, std::vector<std::string> columns, bool skip_unreadable,
         bool strict, bool overwrite, bool resume, py::object progress, py::object message,
         py::object stop) {
        ConvertOptions options{
            scale,      cell_points,        regular_size,    memory_bytes, threads,
            ignore_crs, std::move(columns), skip_unreadable, strict,       overwrite,
            resume};
        Watch watch(std::move(progress), std::move(message), std::move(stop));
        watch.attach(options);
        return watch.run([&, from = paths_of(inputs), to = path_of(output)] {
          return convert(from, to, options);
        });
      },
      "inputs"_a, "output"_a, py::kw_only(), "scale"_a = py::none(),
      "cell_points"_a = ConvertOptions{}.cell_points, "regular_size"_a = py::none(),
      "memory_bytes"_a = ConvertOptions{}.memory_bytes, "threads"_a = 0, "ignore_crs"_a = false,
      "columns"_a = std::vector<std::string>{}, "skip_unreadable"_a = false, "strict"_a = false,
      "overwrite"_a = false, "resume"_a = false, "progress"_a = py::none(),
      "message"_a = py::none(), "stop"_a = py::none(),
      R"(convert(inputs, output, *, scale=None, cell_points=65536, regular_size=None, memory_bytes=4294967296, threads=0, ignore_crs=False, columns=(), skip_unreadable=False, strict=False, overwrite=False, resume=False, progress=None, message=None, stop=None)
--

Turn scans into a store, the one file that searches read. Returns a ConvertReport.

inputs: a path, or several: files or folders of LAS, LAZ, E57, PLY, PCD, PTX, PTS, 3DTK or text.
output: the store.
scale: of the stored integers, metres; None: as the input has it, else what fits.
cell_points: 64 to 1048576.
regular_size: metres; cells are cubes of it. None: cells of about the same number of points.
memory_bytes: bound of the working memory.
threads: 0: all cores.
ignore_crs: takes coordinates in degrees, or in different units, as they are.
columns: of x, y and z in texts: numbers from 1, or names of the header.
skip_unreadable: leaves out files that cannot be read, with a warning.
strict: raises InputError where anything is warned of.
overwrite: an existing store.
resume: leaves a store of the same inputs as it is.
progress: called with a ProgressUpdate, in this thread, up to 20 times a second.
message: called with each note and warning, a Message, in this thread.
stop: an object with is_set(), such as threading.Event. When it is set, Interrupted is raised.)");
}

}  // namespace

TrajectoryOptions trajectory_options(const std::string& format, bool allow_non_rigid,
                                     const std::string& angle_unit, const std::string& angle_frame,
                                     const std::string& crs, const std::string& default_crs,
                                     const std::string& datum, double metres_per_unit,
                                     double environment_unit,
                                     const std::array<double, 3>& lever_arm) {
  TrajectoryOptions options;
  options.format = value_of("format", kFormats, format);
  options.allow_non_rigid = allow_non_rigid;
  options.angle_unit = value_of("angle_unit", kAngleUnits, angle_unit);
  options.angle_frame = value_of("angle_frame", kAngleFrames, angle_frame);
  options.crs = crs;
  options.default_crs = default_crs;
  options.datum = datum;
  options.metres_per_unit = metres_per_unit;
  options.environment_unit = environment_unit;
  options.lever_arm = {lever_arm[0], lever_arm[1], lever_arm[2]};
  return options;
}

void add_inputs(py::module_& module) {
  add_labels(module);
  add_read_trajectory(module);
  add_convert_report(module);
  add_convert(module);
}

}  // namespace clearway::python
