#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/formats/text/column_names.hpp"

namespace clearway {

/// Where a table of poses keeps what makes a pose.
struct PoseColumns {
  char separator = ',';
  std::size_t fields = 0;                 ///< in every line
  std::array<std::size_t, 3> position{};  ///< x y z; where geographic, longitude, latitude, height
  std::vector<std::size_t> rotation{};  ///< 4: quaternion x y z w; 9: matrix, row-major; 3: angles
  bool geographic = false;
  bool heading = false;               ///< the third angle is called heading, not yaw
  std::string position_units[3]{};    ///< as the header has them, lower case, or empty
  std::string angle_units[3]{};       ///< the same of three angles
  std::optional<std::size_t> time{};  ///< where a column is called so
  std::optional<std::size_t> name{};  ///< or an index
};

/// The columns that a header names; none where one is missing or named twice.
std::optional<PoseColumns> pose_columns(const ColumnNames& header);

/// Why a header makes no pose, and what is expected.
std::string objection_to_header(const ColumnNames& header);

/// EuRoC's: time, position, quaternion w x y z, then anything; `fields` columns in all.
PoseColumns euroc_columns(std::size_t fields);

}  // namespace clearway
