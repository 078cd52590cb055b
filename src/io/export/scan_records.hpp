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
#include "io/formats/input_buffer.hpp"
#include "io/formats/las/las_header.hpp"
#include "io/formats/las/las_record_writer.hpp"

namespace clearway {

/// Reads records of a LAS file in any order; fast where the order is ascending.
class LasRecordReader {
 public:
  /// Opens the file. Throws InputError where it is malformed.
  explicit LasRecordReader(const std::filesystem::path& path);

  const std::string& name() const { return input_.name(); }
  const LasPublicHeader& header() const { return header_; }
  /// The format of the records, with descriptions of all extra bytes.
  LasRecordFormat format() const;
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

}  // namespace clearway
