#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "clearway/answer.hpp"
#include "clearway/box.hpp"
#include "clearway/ignored.hpp"
#include "clearway/query.hpp"
#include "clearway/vec3.hpp"

namespace clearway {

class ResultReader;

/// Distances of environment points to the model, ascending by source.
struct Clearances {
  std::vector<std::uint64_t> source;
  std::vector<Vec3> xyz;                 ///< empty in files before version 3
  std::vector<double> distance;          ///< metres, the least over all poses
  std::vector<std::uint32_t> pose;       ///< the first one that has it
  std::vector<std::uint32_t> body = {};  ///< that has it there; empty without bodies
};

/// Of every pose of the trajectory the least distance between the model and the environment.
struct Profile {
  static constexpr std::uint64_t kNoPoint = ~std::uint64_t{0};
  /// Metres; infinity where it is not below the one asked for; NaN where no body of a vehicle has a
  /// pose, because nothing is known there. Results of earlier releases have infinity there too.
  std::vector<double> distance;
  std::vector<std::uint64_t> source;  ///< of the point, of several the smallest; or kNoPoint
  std::vector<Vec3> xyz;              ///< of the point; NaN where there is none
  std::vector<double> chainage;       ///< metres along the positions of the path
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
  const IgnoredPointCounts& ignored() const;  ///< of the parameters' lists
  std::uint64_t poses() const;
  /// The verdict and the places that matter most. Reads all tables.
  Answer answer() const;

  std::vector<std::uint64_t> source() const;  ///< indices in the order of the scans, ascending
  std::vector<Vec3> xyz() const;
  /// As QueryParameters::first_pose defines it; empty unless the query asked for it. Files of 0.1.0
  /// with motion between poses may be one higher: their ways did not include their ends.
  std::vector<std::uint32_t> first_pose() const;
  /// The greatest index of a pose that touches each point; between poses, the start of the last way
  /// that does. Empty where there are no first poses, and in files of older releases.
  std::vector<std::uint32_t> last_pose() const;
  /// Names of the bodies, where the query has several; otherwise none.
  const std::vector<std::string>& bodies() const;
  /// Of the first pose, as an index of bodies(); empty unless the query has bodies and asked for
  /// first poses.
  std::vector<std::uint32_t> first_body() const;
  Clearances clearance() const;  ///< empty unless the query asked for it
  Profile profile() const;       ///< likewise
  /// As Query::model_spacing, the greatest of all bodies; 0 in files of earlier releases, too.
  double model_spacing() const;
  /// Of the model's points; none in files before version 3.
  std::optional<Box> model_box() const;

  /// For the library itself.
  const ResultReader& reader() const { return *reader_; }

 private:
  std::unique_ptr<ResultReader> reader_;
};

}  // namespace clearway
