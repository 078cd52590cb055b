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
  void clearances(std::span<const double> distance) const;
  /// Distance, source and point of a pose belong together.
  void profile(std::span<const double> distance, std::span<const std::uint64_t> source,
               std::span<const Vec3> xyz) const;
  void chainages(std::span<const double> chainage) const;

  [[noreturn]] void refuse_row(const char* dataset, std::size_t row,
                               const std::string& expected) const;
};

}  // namespace clearway
