#include "io/paths/text/trajectory_columns.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <span>
#include <string_view>
#include <utility>

#include "core/geometry/angle.hpp"
#include "core/util/format.hpp"
#include "io/paths/geographic/geographic_poses.hpp"
#include "io/scans/formatted_message.hpp"
#include "io/scans/length_unit.hpp"

namespace clearway {
namespace {

constexpr std::string_view kPosition[] = {"",
                                          "t",
                                          "t_",
                                          "p",
                                          "p_",
                                          "pos",
                                          "pos_",
                                          "position_",
                                          "position.",
                                          "pose.position.",
                                          "p_rs_r_",
                                          "translation_",
                                          "translation.",
                                          "field.pose.position.",
                                          "field.pose.pose.position."};
constexpr std::string_view kQuaternion[] = {"q",
                                            "q_",
                                            "quat_",
                                            "quaternion_",
                                            "orientation_",
                                            "orientation.",
                                            "rotation_",
                                            "rotation.",
                                            "pose.orientation.",
                                            "q_rs_",
                                            "field.pose.orientation.",
                                            "field.pose.pose.orientation."};
constexpr std::string_view kMatrix[] = {"r", "r_"};

/// The columns with each of the suffixes; empty where one is missing or not unique.
std::vector<std::size_t> find_all(const TableHeader& header, ColumnNames prefixes,
                                  ColumnNames suffixes) {
  std::vector<std::size_t> found;
  for (const std::string_view suffix : suffixes) {
    const auto column = header.find(prefixes, suffix);
    if (!column) return {};
    found.push_back(*column);
  }
  return found;
}

// Without the single letters that name coordinates of a scan: beside a pose they mean other things.
constexpr std::string_view kEasting[] = {"easting", "east"};
constexpr std::string_view kNorthing[] = {"northing", "north"};
constexpr std::string_view kHeight[] = {"height", "altitude", "alt", "elevation", "elev", "z"};

bool find_position(const TableHeader& header, PoseColumns& columns) {
  static constexpr std::string_view kXyz[] = {"x", "y", "z"};
  const auto xyz = find_all(header, kPosition, kXyz);
  const auto height = header.find(kHeight);
  const bool map = header.has(kEasting) || header.has(kNorthing);
  const bool globe = header.has(kLatitudeColumns) || header.has(kLongitudeColumns);
  if (!xyz.empty() && !map && !globe) {
    columns.position = {xyz[0], xyz[1], xyz[2]};
    return true;
  }
  // Neither, or both, so that it is not clear which is meant.
  if (!height || map == globe) return false;
  const auto first = globe ? header.find(kLongitudeColumns) : header.find(kEasting);
  const auto second = globe ? header.find(kLatitudeColumns) : header.find(kNorthing);
  if (!first || !second) return false;
  columns.position = {*first, *second, *height};
  columns.geographic = globe;
  return true;
}

bool find_angles(const TableHeader& header, PoseColumns& columns) {
  const auto roll = header.find(kRollColumns);
  const auto pitch = header.find(kPitchColumns);
  const auto heading = header.find(kHeadingColumns);
  const auto yaw = header.find(kYawColumns);
  if (!roll || !pitch || heading.has_value() == yaw.has_value()) return false;
  columns.heading = heading.has_value();
  columns.rotation = {*roll, *pitch, heading ? *heading : *yaw};
  return true;
}

bool find_rotation(const TableHeader& header, PoseColumns& columns) {
  static constexpr std::string_view kXyzw[] = {"x", "y", "z", "w"};
  static constexpr std::string_view kFromZero[] = {"00", "01", "02", "10", "11",
                                                   "12", "20", "21", "22"};
  static constexpr std::string_view kFromOne[] = {"11", "12", "13", "21", "22",
                                                  "23", "31", "32", "33"};
  auto& found = columns.rotation;
  found = find_all(header, kQuaternion, kXyzw);
  if (found.empty()) found = find_all(header, kMatrix, kFromZero);
  if (found.empty()) found = find_all(header, kMatrix, kFromOne);
  return !found.empty() || find_angles(header, columns);
}

}  // namespace

std::optional<PoseColumns> pose_columns(const TableHeader& header) {
  PoseColumns columns{.separator = header.separator, .fields = header.names.size()};
  if (!find_position(header, columns) || !find_rotation(header, columns)) return std::nullopt;
  if (columns.geographic && columns.rotation.size() != 3) return std::nullopt;
  for (std::size_t k = 0; k < 3; ++k) {
    columns.position_units[k] = header.units[columns.position[k]];
    if (columns.rotation.size() == 3) columns.angle_units[k] = header.units[columns.rotation[k]];
  }
  std::size_t next = 0;
  for_each_label([&](const auto& label) {
    LabelColumn& column = columns.labels[next++];
    column.at = header.find(label.columns);
    if (!column.at) column.at = header.find(label.other_columns);
    if (column.at) column.unit = header.units[*column.at];
  });
  // A column "station" may hold names too, such as numbers of scanner stations, but not where its
  // header gives it a unit.
  next = 0;
  const auto found = columns.labels;
  for_each_label([&](const auto& label) {
    LabelColumn& column = columns.labels[next++];
    const bool is_shared = column.at && std::ranges::count(found, column.at, &LabelColumn::at) > 1;
    if (label.is_text() && is_shared && !column.unit.empty()) column.at.reset();
  });
  std::vector<std::size_t> used = columns.rotation;
  used.insert(used.end(), columns.position.begin(), columns.position.end());
  for (const LabelColumn& column : found) {
    if (column.at) used.push_back(*column.at);
  }
  columns.unread = other_columns(header, used);
  std::erase(columns.unread, "path_pose");  // which `trajectory follow` writes for people
  return columns;
}

std::string objection_to_header(const TableHeader& header) {
  static constexpr std::string_view kPhotogrammetric[] = {"omega", "phi", "kappa"};
  PoseColumns columns{};
  if (header.has(kPhotogrammetric)) {
    return "omega, phi and kappa are not read, as their order and axes differ between programs; "
           "expected roll, pitch and heading, or a quaternion or a matrix";
  }
  const bool globe = header.has(kLatitudeColumns) || header.has(kLongitudeColumns);
  if (globe && (header.has(kEasting) || header.has(kNorthing))) {
    return "both latitude and longitude and easting and northing; expected one of them";
  }
  if (header.has(kHeadingColumns) && header.has(kYawColumns))
    return "both heading and yaw; expected one of them";
  if (!find_position(header, columns)) {
    return "no position; expected the columns x y z (or tx, p_x, pos_x, ...), easting northing "
           "height, or latitude longitude height";
  }
  if (globe) {
    return "latitude and longitude without angles; expected roll, pitch and heading beside them";
  }
  return "no rotation; expected the columns qx qy qz qw (or q_x, ...), r00 to r22, or roll pitch "
         "heading; clearway trajectory line makes poses of places without a rotation";
}

PoseColumns euroc_columns(std::size_t fields) {
  std::vector<std::string> names{"time", "x", "y", "z", "qw", "qx", "qy", "qz"};
  names.resize(fields);
  return *pose_columns({.separator = ',',
                        .names = names,
                        .units = std::vector<std::string>(fields),
                        .written = names});
}

namespace {

constexpr double kSlack = 1 + 1e-9;

/// Greatest roll and pitch in radians. A heading in radians may be counted on beyond a full turn,
/// but a tilt not so far.
constexpr double kMostTiltRadians = 2 * std::numbers::pi;
constexpr double kMostTurnRadians = 20 * std::numbers::pi;

struct Largest {
  double tilt = 0, turn = 0, latitude = 0, longitude = 0;
};

Largest largest_of(std::span<const AttitudeRow> rows) {
  Largest most;
  for (const AttitudeRow& row : rows) {
    most.tilt = std::max({most.tilt, std::abs(row.roll), std::abs(row.pitch)});
    most.turn = std::max(most.turn, std::abs(row.yaw));
    most.latitude = std::max(most.latitude, std::abs(row.position[1]));
    most.longitude = std::max(most.longitude, std::abs(row.position[0]));
  }
  return most;
}

std::optional<AngleUnit> angle_unit_of(std::string_view text) {
  if (text.starts_with("deg") || text == "\xC2\xB0") return AngleUnit::kDegrees;
  return text.starts_with("rad") ? std::optional(AngleUnit::kRadians) : std::nullopt;
}

/// The unit of angles that a header gives, which must hold for all of them.
AngleUnit declared_unit(std::span<const std::string> texts, const std::string& name) {
  const auto unit = common_unit<AngleUnit>(texts, "angles", "deg or rad", angle_unit_of, name);
  if (unit && std::ranges::count(texts, "") != 0) {
    refuse(name, "the header has a unit for some of the angles; expected it for all or none");
  }
  return unit.value_or(AngleUnit::kDeclared);
}

const char* text_of(AngleUnit unit) { return unit == AngleUnit::kDegrees ? "degrees" : "radians"; }

/// The unit that header or options name; kDeclared where neither does. Throws where they differ.
AngleUnit said_unit(AngleUnit header, AngleUnit option, const std::string& name) {
  if (header != AngleUnit::kDeclared && option != AngleUnit::kDeclared && header != option) {
    refuse(name, std::string("the header has angles in ") + text_of(header) +
                     ", but they were declared to be " + text_of(option));
  }
  return header != AngleUnit::kDeclared ? header : option;
}

double factor_of(AngleUnit unit) { return unit == AngleUnit::kDegrees ? kDegree : 1; }

/// Radians per unit of roll, pitch and the third angle.
double attitude_factor(const Largest& most, const PoseColumns& columns,
                       const TrajectoryOptions& options, TrajectoryFile& out,
                       const std::string& name) {
  const AngleUnit unit =
      said_unit(declared_unit(columns.angle_units, name), options.angle_unit, name);
  const bool surely_degrees = most.tilt > kMostTiltRadians || most.turn > kMostTurnRadians;
  const std::string largest = "angles up to " + format_digits(std::max(most.tilt, most.turn), 9);
  if (unit == AngleUnit::kRadians && surely_degrees) {
    refuse(name, largest + " are declared to be radians; these look like degrees");
  }
  if (unit != AngleUnit::kDeclared) return factor_of(unit);
  if (!surely_degrees) {
    refuse(name, largest + " may be degrees or radians; expected a unit, as in the column roll_deg",
           Remedy::kDeclareAngles);
  }
  out.note("angles-in-degrees", name + ": " + largest + " were taken as degrees",
           {{"greatest", std::max(most.tilt, most.turn)}});
  return kDegree;
}

/// Degrees per unit of latitude and longitude.
double geographic_factor(const Largest& most, const PoseColumns& columns,
                         const TrajectoryOptions& options, const std::string& name) {
  AngleUnit unit = declared_unit(std::span(columns.position_units).first(2), name);
  const bool surely_degrees = most.latitude > std::numbers::pi / 2 * kSlack ||
                              most.longitude > 2 * std::numbers::pi * kSlack;
  if (unit == AngleUnit::kDeclared) {
    unit = surely_degrees ? AngleUnit::kDegrees : options.angle_unit;
  }
  const std::string largest = "latitudes up to " + format_digits(most.latitude, 9) +
                              " and longitudes up to " + format_digits(most.longitude, 9);
  if (unit == AngleUnit::kDeclared) {
    refuse(name, largest + " may be degrees or radians; expected a unit, as in the column lat_deg",
           Remedy::kDeclareAngles);
  }
  if (unit == AngleUnit::kRadians && surely_degrees) {
    refuse(name, largest + " are declared to be radians; these look like degrees");
  }
  if (most.latitude * factor_of(unit) > std::numbers::pi / 2 * kSlack) {
    refuse(name, largest + "; expected latitudes within 90 degrees");
  }
  return factor_of(unit) / kDegree;
}

AngleFrame frame_of(const PoseColumns& columns, const TrajectoryOptions& options,
                    const std::string& name) {
  if (columns.heading && options.angle_frame == AngleFrame::kEnu) {
    refuse(name,
           "a heading is counted clockwise from north, but enu was declared; expected a "
           "column called yaw");
  }
  if (columns.heading) return AngleFrame::kNed;
  if (options.angle_frame == AngleFrame::kDeclared) {
    refuse(name,
           "a yaw may be counted clockwise from north (ned) or counter-clockwise from east (enu)",
           Remedy::kDeclareAngles);
  }
  return options.angle_frame;
}

void note_angle_frame(AngleFrame frame, bool geographic, const std::string& name,
                      TrajectoryFile& out) {
  const std::string from = geographic ? "true " : "the map's ";
  out.note("angle-frame",
           fmt::format("{}{}; the model is to have x forward, y left and z up", name,
                       frame == AngleFrame::kNed
                           ? ": angles are a heading clockwise from " + from +
                                 "north, a pitch nose up, and a roll right side down"
                           : ": angles are a yaw counter-clockwise from " + from +
                                 "east (x), a pitch nose down, and a roll right side down"));
}

}  // namespace

void append_poses_of_angles(std::vector<AttitudeRow> rows, const PoseColumns& columns,
                            const TrajectoryOptions& options, const std::string& name,
                            TrajectoryFile& out) {
  if (rows.empty()) return;
  out.rotations = RotationSource::kAngles;
  const Largest most = largest_of(rows);
  const AngleFrame frame = frame_of(columns, options, name);
  const double to_radians = attitude_factor(most, columns, options, out, name);
  for (AttitudeRow& row : rows) {
    row.roll *= to_radians;
    row.pitch *= to_radians;
    row.yaw *= to_radians;
  }
  note_angle_frame(frame, columns.geographic, name, out);
  if (columns.geographic) {
    const double to_degrees = geographic_factor(most, columns, options, name);
    for (AttitudeRow& row : rows) {
      row.position[0] *= to_degrees;
      row.position[1] *= to_degrees;
    }
    append_geographic_poses(rows, frame, options, name, out);
    return;
  }
  out.poses.reserve(rows.size());
  for (const AttitudeRow& row : rows) {
    Pose pose{{}, {row.position[0], row.position[1], row.position[2]}};
    set_rotation(row, frame, 0, pose);
    out.poses.push_back(pose);
  }
}

}  // namespace clearway
