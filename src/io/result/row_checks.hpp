#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "io/result/result.hpp"

namespace clearway {

/// Checks rows of a result. All checks throw InputError, which names the row: the first value of a
/// span belongs to row `first` of the group.
struct RowChecks {
  const std::string& name;  ///< name of the file, for messages
  const ResultHeader& header;
  const char* group;
  std::uint64_t first;

  void sources(std::span<const std::uint64_t> source) const;
  void points(std::span<const Vec3> xyz) const;
  void poses(const char* dataset, std::span<const std::uint32_t> pose) const;
  void bodies(std::span<const std::uint32_t> body) const;
  /// Whether the number can be a distance in metres: 0 or more, or any finite number where the
  /// model has solids.
  bool is_distance(double distance) const;
  void clearances(std::span<const double> distance) const;
  /// Checks that distance, source and point of each pose agree, and that a pose without a point has
  /// infinity, Profile::kNoPoint and NaN.
  void profile(std::span<const double> distance, std::span<const std::uint64_t> source,
               std::span<const Vec3> xyz) const;
  void chainages(std::span<const double> chainage) const;

  /// Wraps a check into a function of (first row, values).
  template <typename Value>
  auto from_any_row(void (RowChecks::*check)(std::span<const Value>) const) const {
    return [*this, check](std::uint64_t row, std::span<const Value> values) {
      (RowChecks{name, header, group, row}.*check)(values);
    };
  }
  auto for_poses(const char* dataset) const {
    return [*this, dataset](std::uint64_t row, std::span<const std::uint32_t> values) {
      RowChecks{name, header, group, row}.poses(dataset, values);
    };
  }

  [[noreturn]] void refuse_row(const char* dataset, std::size_t row,
                               const std::string& expected) const;
};

/// Whether sources ascend from each chunk to the next, given that they ascend within each.
inline bool ascends_at_chunks(std::span<const std::uint64_t> sources, std::uint64_t chunk_rows) {
  for (std::size_t row = chunk_rows; row < sources.size(); row += chunk_rows) {
    if (sources[row] <= sources[row - 1]) return false;
  }
  return true;
}

}  // namespace clearway
