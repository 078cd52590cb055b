#pragma once

#include <filesystem>
#include <vector>

#include "io/result/result.hpp"

namespace clearway {

/// All parts of one result, in the order of their numbers.
class PartSet {
 public:
  /// Throws InputError, with the names of files, unless they are the parts of one result, each
  /// once.
  explicit PartSet(const std::vector<std::filesystem::path>& files);

  const std::vector<ResultReader>& parts() const { return parts_; }
  /// Of the result that they make.
  const ResultHeader& header() const { return header_; }
  std::uint64_t collisions() const;
  std::uint64_t clearances() const;

 private:
  std::vector<ResultReader> parts_;
  ResultHeader header_;
};

}  // namespace clearway
