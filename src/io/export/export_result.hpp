#pragma once

#include <filesystem>

#include "core/util/progress.hpp"
#include "io/result/result.hpp"

namespace clearway {

/// Writes the colliding points of `result` to `output`, in the format that the ending of its name
/// says, in constant memory and in the order of the result:
/// - .las  the integers of the source, with its scale, offset and CRS; first_pose as extra bytes
/// - .ply  binary little-endian, double x y z, uint first_pose
/// - .xyz  text, "x y z" a line
/// - .csv  text with a header, source,x,y,z and first_pose
/// first_pose only where the result has it. Text has decimals that give back each stored integer,
/// or where there are none the shortest digits that give back each double. The file appears under
/// its name when complete. Throws UsageError for another ending and, unless `overwrite`, for an
/// existing output; InputError for a malformed result.
void export_result(const ResultReader& result, const std::filesystem::path& output, bool overwrite,
                   Progress& progress);

/// Writes the clearances of `result` likewise, with distance (double, metres) and pose (uint32) in
/// the place of first_pose; .xyz has "x y z distance pose". The result must have clearances: if
/// not, UsageError. One of version 2 has no coordinates of them, and gives a .csv without them
/// only.
void export_clearances(const ResultReader& result, const std::filesystem::path& output,
                       bool overwrite, Progress& progress);

}  // namespace clearway
