#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "clearway/progress.hpp"

namespace clearway {

/// Numbers of points that are at the lowest or the greatest of the 32-bit integers in which a file
/// has its coordinates. A program that writes a point beyond them leaves it there.
struct CutOff {
  static constexpr std::int64_t kLowest = std::numeric_limits<std::int32_t>::min();
  static constexpr std::int64_t kGreatest = std::numeric_limits<std::int32_t>::max();

  std::array<std::uint64_t, 3> lowest{}, greatest{};  ///< of x, y and z

  void add(const CutOff& other) {
    for (std::size_t k = 0; k < 3; ++k) {
      lowest[k] += other.lowest[k];
      greatest[k] += other.greatest[k];
    }
  }
};

/// Whether somebody chose this scale of integers. One that has many digits was computed from the
/// range of the points, so that the outermost of them are at the ends of the integers.
bool is_chosen_scale(double scale);

/// The warning on the files (or scans) whose points were cut off. A single point at an end is the
/// outermost one and not cut off.
class CutOffWarning {
 public:
  /// scales: of the file's integers.
  void add(const std::string& name, const CutOff& found, const std::array<double, 3>& scales);
  std::optional<Message> message() const;

 private:
  std::string first_;
  std::uint64_t files_ = 0;
  std::array<std::uint64_t, 3> points_{};
};

}  // namespace clearway
