#pragma once

#include <filesystem>

#include "core/util/progress.hpp"
#include "io/result/result.hpp"

namespace clearway {

/// Writes the colliding points of `result` to `output`, in constant memory and in the order of the
/// result. The ending of the output's name decides the format:
/// - .las  the integers of the source, with its scale, offset and CRS; first_pose as extra bytes
/// - .ply  binary little-endian, double x y z, uint first_pose
/// - .xyz  text, one line "x y z" per point
/// - .csv  text with a header: source,x,y,z and first_pose
/// first_pose is written only where the result has it. Text has decimals that give back each stored
/// integer, or where there are none the shortest digits that give back each double. The file
/// appears under its name when it is complete. Throws UsageError for another ending and, unless
/// `overwrite`, for an existing output; InputError for a malformed result.
void export_result(const ResultReader& result, const std::filesystem::path& output, bool overwrite,
                   Progress& progress);

/// Writes the clearances of `result` to `output` in the formats of export_result(), with distance
/// (double, metres) and pose (uint32) in the place of first_pose; a line of .xyz is "x y z distance
/// pose". Throws UsageError for a result without clearances. A result of version 2 has no
/// coordinates of clearances and can only be written as .csv, without them.
void export_clearances(const ResultReader& result, const std::filesystem::path& output,
                       bool overwrite, Progress& progress);

}  // namespace clearway
