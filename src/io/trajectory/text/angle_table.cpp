#include "io/trajectory/text/angle_table.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <span>
#include <string_view>

#include "core/geometry/angle.hpp"
#include "io/system/input_error.hpp"
#include "io/trajectory/geographic/geographic_poses.hpp"

namespace clearway {
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

/// The unit named by the texts in a header; the first that is not empty must hold for all.
AngleUnit declared_unit(std::span<const std::string> texts, const std::string& name) {
  AngleUnit unit = AngleUnit::kDeclared;
  std::size_t declared = 0;
  for (const std::string& text : texts) {
    if (text.empty()) continue;
    const bool degrees = text.starts_with("deg") || text == "\xC2\xB0";
    if (!degrees && !text.starts_with("rad")) {
      refuse(name, "the header has angles in " + excerpt(text) + "; expected deg or rad");
    }
    const AngleUnit found = degrees ? AngleUnit::kDegrees : AngleUnit::kRadians;
    if (declared++ > 0 && found != unit) {
      refuse(name, "the header has angles in degrees and in radians; expected one unit");
    }
    unit = found;
  }
  if (declared != 0 && declared != texts.size()) {
    refuse(name, "the header has a unit for some of the angles; expected it for all or none");
  }
  return unit;
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
  const std::string largest = "angles up to " + brief(std::max(most.tilt, most.turn));
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
  const std::string largest =
      "latitudes up to " + brief(most.latitude) + " and longitudes up to " + brief(most.longitude);
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
           name +
               (frame == AngleFrame::kNed
                    ? ": angles are a heading clockwise from " + from +
                          "north, a pitch nose up, and a roll right side down"
                    : ": angles are a yaw counter-clockwise from " + from +
                          "east (x), a pitch nose down, and a roll right side down") +
               "; the model is to have x forward, y left and z up");
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
