#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "io/formats/e57/e57_cursor.hpp"
#include "io/formats/point_reader.hpp"

namespace clearway {

/// Findings in a scan's records, complete once the scan has been read.
struct E57Findings {
  std::uint64_t absent = 0;  ///< records without a valid point
  std::optional<Box> own;    ///< box of the finite points, without the pose
  std::optional<Box> posed;  ///< box of the finite points, with the pose
};

/// Reads the points of one scan and applies its pose.
class E57ScanReader {
 public:
  /// The arguments must outlive this object. The scan must have coordinates.
  E57ScanReader(E57Pages& pages, const E57Scan& scan, const E57Extent& extent);
  E57ScanReader(const E57ScanReader&) = delete;
  E57ScanReader& operator=(const E57ScanReader&) = delete;

  /// Appends points until the batch has PointReader::kBatchPoints. Returns false, with nothing
  /// appended, once all are read and the section has been compared with the scan's number of
  /// records.
  bool read(PointBatch& batch);
  const E57Findings& findings() const { return findings_; }

 private:
  static constexpr std::size_t kChunk = 1024;
  using Column = std::array<double, kChunk>;

  std::size_t available(std::size_t room);
  void decode(std::size_t count);
  bool is_valid(E57Place state, std::size_t i) const;
  void check_state(E57Place state, std::size_t count) const;
  void place_points(std::span<Vec3> out, std::size_t first, std::vector<std::uint32_t>& absent);
  Vec3 cartesian(std::size_t i) const;
  Vec3 spherical(std::size_t i) const;
  void finish();

  E57Pages& pages_;
  const E57Scan& scan_;
  E57Packets packets_;
  std::array<std::optional<E57Cursor>, kE57Places> cursors_;
  std::array<Column, kE57Places> columns_;
  E57Findings findings_;
  std::uint64_t next_ = 0;  ///< record to read next
  bool finished_ = false;
};

}  // namespace clearway
