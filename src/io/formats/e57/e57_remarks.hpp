#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "clearway/progress.hpp"
#include "io/formats/e57/e57_scan_reader.hpp"

namespace clearway {

/// Collects remarks on the scans of a file. Memory does not grow with their number.
class E57Remarks {
 public:
  /// Adds a scan that was read completely.
  void add(const E57Scan& scan, const E57Findings& findings);
  /// Adds a scan that has no coordinates and was not read.
  void add_without_coordinates() { ++scans_, ++without_coordinates_; }

  /// The remarks. file: the name with which each text begins.
  std::vector<Message> messages(const std::string& file) const;

 private:
  std::uint64_t scans_ = 0, posed_ = 0, empty_ = 0, without_coordinates_ = 0;
  std::uint64_t records_ = 0, absent_ = 0;
  std::uint64_t beyond_bounds_ = 0;
  std::string first_beyond_bounds_;
};

}  // namespace clearway
