#include "io/paths/trajectory_file.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <span>
#include <string>
#include <system_error>
#include <utility>

#include "clearway/answer.hpp"
#include "clearway/trajectory.hpp"
#include "core/describe/labels.hpp"
#include "core/describe/trajectory.hpp"
#include "io/files/file.hpp"
#include "io/files/text_writer.hpp"
#include "io/paths/geographic/sbet.hpp"
#include "io/paths/text/text_trajectory.hpp"
#include "io/paths/threedtk_trajectory.hpp"
#include "io/scans/formatted_message.hpp"
#include "io/scans/input_buffer.hpp"
#include "io/scans/length_unit.hpp"

namespace clearway {

namespace {

/// The column of a label in the header of a table, with its unit.
template <typename Type>
std::string column_of(const PoseLabel<Type>& label) {
  const std::string unit(symbol_of(label.unit));
  return label.key + (unit.empty() ? "" : " [" + unit + "]");
}

}  // namespace

FileUnit TrajectoryFile::own_unit() const {
  if (!crs.empty()) return FileUnit::exactly(metres_per_unit);
  if (unit.is_known()) return unit;
  return in_metres ? FileUnit::exactly(1) : FileUnit();
}

bool TrajectoryColumns::names_unit() const { return !symbol_of(unit).empty(); }

namespace {

void write_comments(const std::string& made_by, std::span<const Message> remarks, TextWriter& out) {
  constexpr std::size_t kMostBytes = 1000;
  if (!made_by.empty()) out << kMadeByComment << made_by << "\n";
  for (const Message& message : remarks) {
    if (doubt_of(message) != Doubt::kQuestion) continue;
    std::string text = message.code + ": " + message.text.substr(0, kMostBytes);
    std::ranges::replace_if(
        text, [](unsigned char c) { return c < ' '; }, ' ');
    out << kDoubtComment << text << "\n";
  }
}

}  // namespace

void write_trajectory(std::span<const Pose> poses, const File& file, Progress& progress,
                      const std::string& made_by, std::span<const Message> remarks) {
  progress.begin("write", poses.size(), "poses");
  TextWriter out(file);
  write_comments(made_by, remarks, out);
  for (const Pose& pose : poses) {
    for (std::size_t row = 0; row < 3; ++row) {
      for (std::size_t k = 0; k < 3; ++k) out << pose.rotation[3 * row + k] << " ";
      out << pose.translation[row] << " ";
    }
    out << "0 0 0 1\n";
    throw_if_stopped(progress);
    progress.advance(1);
  }
  out.flush();
  progress.end();
}

void write_trajectory_table(std::span<const Pose> poses, const PoseLabels& labels,
                            const TrajectoryColumns& columns, const File& file,
                            Progress& progress) {
  progress.begin("write", poses.size(), "poses");
  TextWriter out(file);
  const std::string unit = columns.names_unit() ? " [" + symbol_of(columns.unit) + "]" : "";
  const UnitFactor written =
      unit.empty()
          ? UnitFactor(1)
          : UnitFactor(columns.metres_per_unit, columns.unit.metres_in(columns.metres_per_unit));
  write_comments(labels.made_by, columns.remarks, out);
  if (!columns.path_pose.empty()) out << "path_pose,";
  for_each_label([&](const auto& label) {
    if (!label.of(labels).empty()) out << column_of(label) << ",";
  });
  for (const char* axis : {"x", "y", "z"}) out << axis << unit << ",";
  out << "r00,r01,r02,r10,r11,r12,r20,r21,r22\n";
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (!columns.path_pose.empty()) out << std::to_string(columns.path_pose[i]) << ",";
    for_each_label([&](const auto& label) {
      if (!label.of(labels).empty()) out << label_cell(label.of(labels)[i]) << ",";
    });
    const char* comma = "";
    for (const double coordinate : poses[i].translation) {
      out << comma << written(coordinate);
      comma = ",";
    }
    for (const double number : poses[i].rotation) out << "," << number;
    out << "\n";
    throw_if_stopped(progress);
    progress.advance(1);
  }
  out.flush();
  progress.end();
}

namespace {

bool is_text(std::span<const std::byte> bytes) {
  return std::none_of(bytes.begin(), bytes.end(), [](std::byte byte) {
    const auto c = static_cast<unsigned char>(byte);
    return c < ' ' && c != '\t' && c != '\n' && c != '\r' && c != '\f';
  });
}

/// Whether an input is an SBET, by its ending and content. Throws where the content suggests one
/// and the ending does not.
bool holds_sbet(InputBuffer& input, const std::string& ending) {
  if (ending == ".sbet") return true;
  if (!input.can_seek()) return false;
  const InputBuffer::Mark start = input.mark();
  const auto record = input.take(kSbetRecordBytes);
  const bool text = is_text(record);
  const bool plausible = may_be_sbet(record) && input.size().value_or(0) % kSbetRecordBytes == 0;
  input.return_to(start);
  if (text || record.empty()) return false;
  if (ending == ".out") return true;
  if (plausible) {
    refuse(input.name(), "binary, and may be an SBET; expected the ending .sbet or .out",
           Remedy::kNameFormat);
  }
  return false;
}

/// The format of a file whose name decides it; otherwise kAuto.
TrajectoryFormat format_by_name(const std::string& ending) {
  if (ending == ".pose") return TrajectoryFormat::kThreedtkPose;
  if (ending == ".frames") return TrajectoryFormat::kThreedtkFrames;
  return TrajectoryFormat::kAuto;
}

void read_file(const std::filesystem::path& path, TrajectoryOptions options, TrajectoryFile& out) {
  const std::string ending = file_ending(path);
  if (options.format == TrajectoryFormat::kAuto) options.format = format_by_name(ending);
  if (options.format == TrajectoryFormat::kThreedtkPose ||
      options.format == TrajectoryFormat::kThreedtkFrames) {
    read_threedtk_file(path, options, out);
    return;
  }
  InputBuffer input = InputBuffer::open(path);
  if (options.format == TrajectoryFormat::kAuto && holds_sbet(input, ending)) {
    options.format = TrajectoryFormat::kSbet;
  }
  if (options.format == TrajectoryFormat::kSbet) {
    out.format = options.format;
    read_sbet(input, options, out);
  } else {
    read_text_trajectory(std::move(input), options, out);
  }
}

/// Throws for options that have no effect on this file, because the user meant something by them.
void refuse_useless(const std::filesystem::path& path, const TrajectoryOptions& options,
                    const TrajectoryFile& found) {
  const std::string name = path.string();
  if (found.poses.empty()) return;
  const bool declarable =
      found.rotations == RotationSource::kAngles && found.format == TrajectoryFormat::kCsv;
  if (!declarable && (options.angle_unit != AngleUnit::kDeclared ||
                      options.angle_frame != AngleFrame::kDeclared)) {
    throw UsageError(name +
                     ": has no angles whose unit or frame could be declared; its format is " +
                     name_of(found.format));
  }
  if (found.crs.empty() && !(options.crs.empty() && options.datum.empty())) {
    throw UsageError(name + ": has no latitudes and longitudes that could be turned into a CRS");
  }
  const bool own_unit = found.format == TrajectoryFormat::kSbet ||
                        found.format == TrajectoryFormat::kThreedtkPose ||
                        found.format == TrajectoryFormat::kThreedtkFrames;
  if (options.metres_per_unit.is_known() && own_unit) {
    throw UsageError(name + ": the format " + name_of(found.format) + " has a unit of its own");
  }
}

/// Warns where the path and the environment are in different feet, because the position of the path
/// depends on which foot was meant.
void warn_of_two_feet(const std::filesystem::path& path, const TrajectoryOptions& options,
                      TrajectoryFile& found) {
  if (!is_foot(found.unit.metres()) || !is_foot(options.environment_unit)) return;
  double largest = 0;
  for (const Pose& pose : found.poses) {
    for (const double metres : pose.translation) largest = std::max(largest, std::abs(metres));
  }
  const double moved = feet_apart(largest, found.unit.metres(), options.environment_unit);
  if (!(moved > kFeetApart)) return;
  found.warn("two-feet",
             two_feet_text(path.string() + ": its positions", found.unit.metres(),
                           options.environment_unit, moved),
             {{"metres", moved}});
}

void convert_positions(const std::filesystem::path& path, const TrajectoryOptions& options,
                       TrajectoryFile& found) {
  if (options.environment_unit == 1 || !found.in_metres) return;
  warn_of_two_feet(path, options, found);
  for (Pose& pose : found.poses) {
    for (double& coordinate : pose.translation) coordinate /= options.environment_unit;
  }
  found.metres_per_unit = options.environment_unit;
}

/// Moves poses to the model's origin, where the file has the positions of another point of the
/// model. lever: that point in the model's frame.
void apply_lever_arm(const std::filesystem::path& path, const Vec3& lever,
                     std::vector<Pose>& poses) {
  if (lever == Vec3{0, 0, 0}) return;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    for (int row = 0; row < 3; ++row) {
      const double* r = poses[i].rotation + 3 * row;
      double& coordinate = poses[i].translation[row];
      coordinate -= r[0] * lever.x + r[1] * lever.y + r[2] * lever.z;
      if (!std::isfinite(coordinate)) {
        refuse(path.string(), "pose {} and the lever arm give no finite position", i);
      }
    }
  }
}

void remark_times(const std::filesystem::path& path, TrajectoryFile& found) {
  const std::vector<double>& times = found.labels.time;
  const auto late = std::is_sorted_until(times.begin(), times.end());
  if (late == times.end()) return;
  const auto pose = static_cast<std::uint32_t>(late - times.begin());
  found.warn("time-order", {{"pose", pose}},
             "{}: time goes back at pose {}; poses are taken in the order of the file",
             path.string(), pose);
  found.remarks.back().stretches = {{pose - 1, pose}};
}

}  // namespace

const char* name_of(TrajectoryFormat format) {
  return std::ranges::find(kChoices<TrajectoryFormat>, format, &Choice<TrajectoryFormat>::value)
      ->name;
}

namespace {

TrajectoryFile read_without_doubts(const std::filesystem::path& path,
                                   const TrajectoryOptions& options) {
  TrajectoryFile found;
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) {
    read_threedtk_folder(path, options, found);
  } else {
    read_file(path, options, found);
  }
  refuse_useless(path, options, found);
  if (options.environment_unit_is_assumed && found.in_metres && found.unit.is_known() &&
      found.unit.metres() != 1) {
    found.warn("unit-assumed",
               unit_assumed_text(path.string() + ": its positions", found.unit.metres()),
               {{"metres", found.unit.metres()}});
  }
  convert_positions(path, options, found);
  apply_lever_arm(path, options.lever_arm, found.poses);
  remark_times(path, found);
  return found;
}

}  // namespace

TrajectoryFile read_trajectory_file(const std::filesystem::path& path,
                                    const TrajectoryOptions& options) {
  TrajectoryFile found = read_without_doubts(path, options);
  for (Message& doubt : doubts_about(found.poses, found.rotations, path.string())) {
    // What the path was made of may have had the same fault.
    const bool known =
        std::ranges::find(found.remarks, doubt.code, &Message::code) != found.remarks.end();
    if (!known) found.remarks.push_back(std::move(doubt));
  }
  return found;
}

std::vector<Pose> read_trajectory(const std::filesystem::path& path,
                                  const TrajectoryOptions& options, std::vector<Message>* remarks,
                                  PoseLabels* labels) {
  TrajectoryFile found =
      remarks == nullptr ? read_without_doubts(path, options) : read_trajectory_file(path, options);
  if (labels != nullptr) *labels = std::move(found.labels);
  if (remarks == nullptr) return std::move(found.poses);
  remarks->insert(remarks->end(), std::make_move_iterator(found.remarks.begin()),
                  std::make_move_iterator(found.remarks.end()));
  return std::move(found.poses);
}

}  // namespace clearway
