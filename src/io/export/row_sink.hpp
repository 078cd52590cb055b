#pragma once

#include <filesystem>
#include <memory>

#include "core/geometry/quantum_box.hpp"
#include "core/util/progress.hpp"
#include "io/result/result.hpp"
#include "io/system/file.hpp"

namespace clearway {

/// Receives the rows of a table front to back and writes them in a format. `Rows` is Collisions or
/// Clearances. Coordinates are written as they are stored, and the columns that the schema names as
/// fields follow them.
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

}  // namespace clearway
