#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "clearway/query.hpp"
#include "clearway/vec3.hpp"

namespace clearway {

class ResultReader;

/// Distances of environment points to the model, ascending by source.
struct Clearances {
  std::vector<std::uint64_t> source;
  std::vector<double> distance;     ///< metres, the least over all poses
  std::vector<std::uint32_t> pose;  ///< the first one that has it
};

/// A result that search() wrote. Columns are read when they are asked for; row i of each is the
/// same colliding point. Throws InputError where the file is damaged, ResourceError where it cannot
/// be read.
class Result {
 public:
  explicit Result(const std::filesystem::path& path);
  ~Result();
  Result(Result&&) noexcept;
  Result& operator=(Result&&) noexcept;

  std::uint64_t size() const;  ///< colliding points
  const QueryParameters& parameters() const;
  std::uint64_t environment_points() const;
  std::uint64_t poses() const;

  std::vector<std::uint64_t> source() const;  ///< indices in the order of the scans, ascending
  std::vector<Vec3> xyz() const;
  /// As QueryParameters::first_pose defines it; empty unless the query asked for it. Files of 0.1.0
  /// with motion between poses may be one higher: their ways did not include their ends.
  std::vector<std::uint32_t> first_pose() const;
  Clearances clearance() const;  ///< empty unless the query asked for it

 private:
  std::unique_ptr<ResultReader> reader_;
};

}  // namespace clearway
