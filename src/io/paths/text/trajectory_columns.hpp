#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/describe/labels.hpp"
#include "io/paths/pose_input.hpp"
#include "io/paths/trajectory_file.hpp"
#include "io/scans/text/text_table.hpp"

namespace clearway {

/// The column of a table that gives a label of the poses. Whether its fields are such values is not
/// known before they are read.
struct LabelColumn {
  std::optional<std::size_t> at{};  ///< none: the table has no such column
  std::string unit{};               ///< its unit in the header, in lower case, or empty
};

/// The columns of a table from which poses are made.
struct PoseColumns {
  char separator = ',';
  std::size_t fields = 0;                 ///< number of fields in every line
  std::array<std::size_t, 3> position{};  ///< x y z; longitude, latitude, height where geographic
  /// 4 columns: quaternion x y z w; 9: matrix, row-major; 3: angles
  std::vector<std::size_t> rotation{};
  bool geographic = false;
  bool heading = false;             ///< whether the third angle is called heading instead of yaw
  std::string position_units[3]{};  ///< units in the header, in lower case, or empty
  std::string angle_units[3]{};  ///< units of three angles in the header, in lower case, or empty
  std::array<LabelColumn, kPoseLabelCount> labels{};  ///< in the order of the labels
  std::vector<std::string> unread{};  ///< names of the columns that no pose is made from
};

/// The unit that a header gives for some columns, of which each may lack it; nullopt where all do.
/// texts: the units as they are written, or empty. what: what is in the columns, for messages.
/// unit_of: reads a unit; nullopt for anything else than what is expected. name: the file's. Throws
/// InputError.
template <typename Unit>
std::optional<Unit> common_unit(std::span<const std::string> texts, const std::string& what,
                                const std::string& expected,
                                std::optional<Unit> (*unit_of)(std::string_view),
                                const std::string& name) {
  std::optional<Unit> common;
  std::string first;  // the first unit, in quotes
  for (const std::string& text : texts) {
    if (text.empty()) continue;
    const auto unit = unit_of(text);
    if (!unit) {
      refuse(name, "the header has " + what + " in " + excerpt(text) + "; expected " + expected);
    }
    if (common && *common != *unit) {
      refuse(name, "the header has " + what + " in " + first + " and in " + excerpt(text) +
                       "; expected one unit");
    }
    if (!common) first = excerpt(text);
    common = unit;
  }
  return common;
}

/// The columns that a header names; nullopt where one is missing or named twice.
std::optional<PoseColumns> pose_columns(const TableHeader& header);

/// Why a header makes no pose, and what is expected.
std::string objection_to_header(const TableHeader& header);

/// The columns of EuRoC: time, position, quaternion w x y z, then any others; `fields` columns in
/// all.
PoseColumns euroc_columns(std::size_t fields);

/// Appends the poses of a table with roll, pitch and heading or yaw. rows: angles in the units of
/// the file; positions in metres already unless they are geographic. name: the file's, for
/// messages. Throws InputError where unit or frame of the angles are neither declared nor certain,
/// and where the values contradict them.
void append_poses_of_angles(std::vector<AttitudeRow> rows, const PoseColumns& columns,
                            const TrajectoryOptions& options, const std::string& name,
                            TrajectoryFile& out);

}  // namespace clearway
