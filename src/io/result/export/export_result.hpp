#pragma once

#include <cstdint>
#include <filesystem>
#include <type_traits>
#include <vector>

#include "clearway/trajectory.hpp"
#include "core/util/progress.hpp"
#include "io/result/result.hpp"
#include "io/result/tables.hpp"
#include "io/scans/point_field.hpp"

namespace clearway {

enum class ExportFormat { kLas, kPly, kXyz, kCsv };

/// The format by the ending of a name. Throws UsageError for any other ending.
ExportFormat export_format_of(const std::filesystem::path& output);

/// The columns of a table that are exported as fields of its points.
template <typename Rows>
std::vector<PointField> fields_of(const ResultHeader& header) {
  std::vector<PointField> out;
  for_each_column<Rows>([&](const auto& column) {
    if (column.field == nullptr || !column.is_in(header)) return;
    using Value = typename std::decay_t<decltype(column)>::Value;
    constexpr auto kType = std::is_same_v<Value, double>          ? PointField::Type::kDouble
                           : std::is_same_v<Value, std::uint64_t> ? PointField::Type::kUint64
                           : std::is_same_v<Value, std::uint8_t>  ? PointField::Type::kClass
                                                                  : PointField::Type::kUint32;
    out.push_back({column.dataset, kType, column.field});
  });
  return out;
}

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

/// Writes the points of `result` that are only near, by its error budget, as export_result() writes
/// colliding ones. Throws UsageError for a result without a budget.
void export_near(const ResultReader& result, const std::filesystem::path& output, bool overwrite,
                 Progress& progress);

/// Writes the clearances of `result` to `output` in the formats of export_result(), with distance
/// (double, metres) and pose (uint32) in the place of first_pose; a line of .xyz is "x y z distance
/// pose". Throws UsageError for a result without clearances.
void export_clearances(const ResultReader& result, const std::filesystem::path& output,
                       bool overwrite, Progress& progress);

/// Writes the profile of `result` as text with a header and one line per pose:
/// pose,time,name,station,chainage,distance,source,x,y,z. The columns between pose and chainage are
/// the labels that `labels` has, for each pose of the result. chainage_start: the chainage of the
/// first pose. The last five columns are empty where the pose has no point. With several bodies
/// there is one more column, searched: 0 where no body has a pose, so that nothing is known,
/// otherwise 1. Throws UsageError for a result without a profile or a name that does not end in
/// .csv; otherwise like export_result().
void export_profile(const ResultReader& result, const PoseLabels& labels, double chainage_start,
                    const std::filesystem::path& output, bool overwrite, Progress& progress);

}  // namespace clearway
