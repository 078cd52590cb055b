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

/// The records of a LAS file, any of them in any order; quick where the order is ascending.
class LasRecordReader {
 public:
  /// Throws InputError for a file that is malformed.
  explicit LasRecordReader(const std::filesystem::path& path);

  const std::string& name() const { return input_.name(); }
  const LasPublicHeader& header() const { return header_; }
  /// With descriptions for all extra bytes.
  LasRecordFormat format() const;
  /// Valid until the next call. point < header().points
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
  std::uint64_t first = 0, points = 0;  ///< source indices
  bool is_las = false;                  ///< uncompressed
  bool is_laz = false;
  std::uint64_t end() const { return first + points; }
};

/// The files of the inputs, in the order in which a conversion reads them. Reads headers of LAS and
/// LAZ, and files of other formats to their end. Throws as their readers do, and Interrupted.
std::vector<ScanFile> number_scans(const std::vector<std::filesystem::path>& inputs,
                                   Progress& progress);

}  // namespace clearway
