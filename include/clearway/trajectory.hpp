#pragma once

#include <filesystem>
#include <vector>

#include "clearway/pose.hpp"

namespace clearway {

enum class TrajectoryFormat { kAuto, kMatrix, kTum, kEuroc, kCsv };

struct TrajectoryOptions {
  TrajectoryFormat format = TrajectoryFormat::kAuto;
  bool allow_non_rigid = false;  ///< still refuses singular and non-finite matrices
};

/// Reads a trajectory: 12 or 16 numbers a line (row-major 3x4 or 4x4), TUM (`t x y z qx qy qz qw`),
/// EuRoC CSV (ns, p, q as w x y z) or CSV with a header that names the columns. Rotations stay as
/// read (matrices) or follow from the normalised quaternion. Throws InputError with file and line
/// for anything malformed and, unless allowed, for a matrix whose singular values are not within
/// 1e-4 of 1. An empty trajectory gives an empty vector.
std::vector<Pose> read_trajectory(const std::filesystem::path& path,
                                  const TrajectoryOptions& options = {});

}  // namespace clearway
