#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/util/progress.hpp"
#include "io/result/result.hpp"
#include "io/scans/input_buffer.hpp"
#include "io/scans/las/las_header.hpp"
#include "io/scans/las/las_records.hpp"
#include "io/scans/las/las_writer.hpp"

namespace clearway {

/// Reads records of a LAS file in any order; fast where the order is ascending.
class LasRecordReader {
 public:
  /// Opens the file. Throws InputError where it is malformed.
  explicit LasRecordReader(const std::filesystem::path& path);

  const std::string& name() const { return input_.name(); }
  const LasPublicHeader& header() const { return header_; }
  /// The format of the records, with descriptions of all extra bytes.
  LasFormat format() const;
  /// The bytes of a record, valid until the next call. point: below header().points.
  std::span<const std::byte> record(std::uint64_t point);

 private:
  InputBuffer input_;
  LasPublicHeader header_;
  LasRecords records_;
  std::vector<std::byte> window_;  ///< consecutive records
  std::uint64_t first_ = 0, count_ = 0;
};

/// One of several scans, whose points are numbered in their order.
struct ScanFile {
  std::filesystem::path path;
  std::uint64_t first = 0, points = 0;  ///< first source index and number of points
  bool is_las = false;                  ///< whether the file is uncompressed LAS
  bool is_laz = false;
  std::uint64_t end() const { return first + points; }
};

/// The files of the inputs in the order in which a conversion reads them, with their numbers of
/// points. Reads the headers of LAS and LAZ, and files of other formats to their end. Throws as
/// their readers do, and Interrupted.
std::vector<ScanFile> number_scans(const std::vector<std::filesystem::path>& inputs,
                                   Progress& progress);

/// Copies the records of the colliding points from the scans of the environment into a LAS file, in
/// the order of the result and in constant memory. Each record keeps its bytes, followed by extra
/// bytes first_pose (uint32) and distance (double, metres; -1 for none) as far as the result has
/// them. Where a scan differs in scale or offset from the result, the coordinates become the
/// result's integers. scans: files and folders, as given to the conversion. Throws UsageError for
/// an output that is not .las. Throws InputError where the scans are not those of the result,
/// judged by their number of points or the place of a copied point, and where points to copy are
/// not in LAS files, all of one point format, without waveforms. Otherwise like export_result().
void export_scan_records(const ResultReader& result,
                         const std::vector<std::filesystem::path>& scans,
                         const std::filesystem::path& output, bool overwrite, Progress& progress);

}  // namespace clearway
