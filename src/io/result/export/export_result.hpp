#pragma once

#include <filesystem>
#include <memory>

#include "clearway/trajectory.hpp"
#include "core/geometry/quantisation.hpp"
#include "core/util/progress.hpp"
#include "io/files/file.hpp"
#include "io/result/result.hpp"

namespace clearway {

/// Receives the rows of a table front to back and writes them in a format. `Rows` is Collisions,
/// Nearby or Clearances. Coordinates are written as they are stored, and the columns that the
/// schema names as fields follow them.
template <typename Rows>
class RowSink {
 public:
  virtual ~RowSink() = default;
  virtual void write(const Rows& rows) = 0;
  virtual void finish() = 0;
};

enum class ExportFormat { kLas, kPly, kXyz, kCsv };

/// The format by the ending of a name. Throws UsageError for any other ending.
ExportFormat export_format_of(const std::filesystem::path& output);

/// bounds: the box of the points, used only by .las. The result and the file must outlive the sink.
template <typename Rows>
std::unique_ptr<RowSink<Rows>> make_row_sink(ExportFormat format, const ResultReader& result,
                                             const QuantumBox& bounds, const File& file);

/// The box of the stored integers of all points of a table. Throws InputError for a coordinate that
/// is not on the result's scale.
template <typename Rows>
QuantumBox bounds_of(const ResultReader& result, const Progress& progress);

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
