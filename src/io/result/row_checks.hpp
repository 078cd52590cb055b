#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "io/result/result.hpp"

namespace clearway {

/// What every row of a result has to be like. All checks throw InputError, which names the row: the
/// first one of the spans is row `first` of the group.
struct RowChecks {
  const std::string& name;  ///< of the file
  const ResultHeader& header;
  const char* group;
  std::uint64_t first;

  void sources(std::span<const std::uint64_t> source) const;
  void points(std::span<const Vec3> xyz) const;
  void poses(const char* dataset, std::span<const std::uint32_t> pose) const;
  void bodies(std::span<const std::uint32_t> body) const;
  /// Of a model with solids, one below 0 too.
  bool is_distance(double distance) const;
  void clearances(std::span<const double> distance) const;
  /// Distance, source and point of a pose belong together.
  void profile(std::span<const double> distance, std::span<const std::uint64_t> source,
               std::span<const Vec3> xyz) const;
  void chainages(std::span<const double> chainage) const;

  /// A check as a call of (first row, values).
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

/// Whether sources ascend from each chunk to the next, where they do in each.
inline bool ascends_at_chunks(std::span<const std::uint64_t> sources, std::uint64_t chunk_rows) {
  for (std::size_t row = chunk_rows; row < sources.size(); row += chunk_rows) {
    if (sources[row] <= sources[row - 1]) return false;
  }
  return true;
}

}  // namespace clearway
