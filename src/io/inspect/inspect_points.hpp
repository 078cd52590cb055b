#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "clearway/box.hpp"
#include "io/formats/point_reader.hpp"

namespace clearway {

/// What a file of points holds, by reading all of it.
struct PointsDescription {
  CloudInfo info;                 ///< with all remarks
  std::uint64_t points = 0;       ///< finite ones
  std::uint64_t absent = 0;       ///< records without a point
  std::uint64_t non_finite = 0;   ///< points that are not finite
  Box box{};                      ///< of the finite ones
  std::optional<double> spacing;  ///< typical, metres; of files that may be models
};

/// Reads the file once; memory is bounded. Throws as the readers do.
PointsDescription inspect_points(const std::filesystem::path& path);

}  // namespace clearway
