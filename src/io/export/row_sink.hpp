#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

#include "core/geometry/quantum_box.hpp"
#include "io/result/result.hpp"
#include "io/system/file.hpp"

namespace clearway {

/// Rows of a result's table, for any format. Columns that the table lacks are empty.
struct ExportRows {
  std::span<const std::uint64_t> source;
  std::span<const Vec3> xyz;
  std::span<const std::uint32_t> first_pose{};
  std::span<const double> distance{};
  std::span<const std::uint32_t> pose{};
  std::span<const std::uint32_t> body{};
};

/// Properties of a table that a file needs before its first row.
struct ExportTable {
  const ResultReader& result;
  std::string group;  ///< group of the result, for messages
  std::uint64_t rows = 0;
  bool first_pose = false;
  bool distance = false;  ///< whether there are the columns distance and pose
  bool body = false;
  QuantumBox bounds{};  ///< box of the points; used only by .las
};

/// Receives the rows front to back.
class RowSink {
 public:
  virtual ~RowSink() = default;
  virtual void write(const ExportRows& rows) = 0;
  virtual void finish() = 0;
};

enum class ExportFormat { kLas, kPly, kXyz, kCsv };

/// The format by the ending of a name. Throws UsageError for any other ending.
ExportFormat export_format_of(const std::filesystem::path& output);

std::unique_ptr<RowSink> make_row_sink(ExportFormat format, const ExportTable& table,
                                       const File& file);

/// Unites `box` with the box of the rows' integers; any: whether `box` holds points yet. Throws
/// InputError for a coordinate that is not on the result's scale.
void unite_rows(const ExportTable& table, const ExportRows& rows, bool& any, QuantumBox& box);

}  // namespace clearway
