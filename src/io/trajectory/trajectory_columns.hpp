#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include "io/formats/text/column_names.hpp"

namespace clearway {

/// Where a table of poses keeps what makes a pose.
struct PoseColumns {
  char separator;
  std::size_t fields = 0;  ///< in every line
  std::array<std::size_t, 3> position;
  std::vector<std::size_t> rotation;  ///< 4: quaternion x y z w; 9: matrix, row-major
};

/// The columns that a header names; none where one is missing or named twice.
std::optional<PoseColumns> pose_columns(const ColumnNames& header);

/// EuRoC's: time, position, quaternion w x y z, then anything; `fields` columns in all.
PoseColumns euroc_columns(std::size_t fields);

}  // namespace clearway
