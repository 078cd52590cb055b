#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "clearway/box.hpp"
#include "io/scans/point_reader.hpp"

namespace clearway {

/// How many points have each of the flags of LAS. One point may have several.
struct FlagCounts {
  std::uint64_t synthetic = 0, key_point = 0, withheld = 0, overlap = 0;
};

/// Contents of a file of points, found by reading all of it.
struct PointsDescription {
  CloudInfo info;                ///< declarations and all remarks
  std::uint64_t points = 0;      ///< number of finite points
  std::uint64_t absent = 0;      ///< number of records without a point
  std::uint64_t non_finite = 0;  ///< number of points that are not finite
  /// Number of points with each flag; nullopt where the file has no flags.
  std::optional<FlagCounts> flags{};
  Box box{};                      ///< box of the finite points
  std::optional<double> spacing;  ///< typical spacing in metres, for files that may be models
};

/// Reads the file once; memory is bounded. Throws as the readers do.
PointsDescription inspect_points(const std::filesystem::path& path);

}  // namespace clearway
