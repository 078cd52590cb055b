#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "clearway/answer.hpp"
#include "clearway/axis.hpp"
#include "clearway/box.hpp"
#include "clearway/ignored.hpp"
#include "clearway/query.hpp"
#include "clearway/seen.hpp"
#include "clearway/vec3.hpp"

namespace clearway {

class ResultReader;

/// Environment points that the model touches, one row per point, ascending by source index.
struct Collisions {
  std::vector<std::uint64_t> source;  ///< index of the point in the order of the scans
  std::vector<Vec3> xyz;
  /// The first pose that touches each point, as QueryParameters::first_pose defines it; empty
  /// unless the query asked for it.
  std::vector<std::uint32_t> first_pose = {};
  /// Index of the body that touches each point at its first pose. Empty unless the query has bodies
  /// and asked for first poses.
  std::vector<std::uint32_t> body = {};
  /// The greatest index of a pose that touches each point; between poses, the start of the last way
  /// that does. Empty if there are no first poses.
  std::vector<std::uint32_t> last_pose = {};

  /// 1 for each point that the error budget says is certainly too close, otherwise 0; empty without
  /// a budget.
  std::vector<std::uint8_t> certain = {};

  /// Metres: the distance of each point to the nearest free point of the environment, as
  /// QueryParameters::depth defines it; NaN where no point is free. Empty unless the query asked
  /// for it.
  std::vector<double> depth = {};
  /// Source index of that free point, the smallest if several are equally near; kNoPoint where no
  /// point is free.
  std::vector<std::uint64_t> depth_source = {};
  static constexpr std::uint64_t kNoPoint = ~std::uint64_t{0};

  /// Class of each point, as the scans have it; empty unless they have classes.
  std::vector<std::uint8_t> point_class = {};

  std::size_t size() const { return source.size(); }
};

/// Environment points that do not collide, but may in truth, because they are closer to the model
/// than the margin plus the error budget; one row per point, ascending by source index.
struct Nearby {
  std::vector<std::uint64_t> source;  ///< index of the point in the order of the scans
  std::vector<Vec3> xyz;
  /// The first pose that comes so close to each point; empty unless the query asked for first poses
  std::vector<std::uint32_t> first_pose = {};
  /// Index of the body that comes so close at that pose; empty unless there are bodies and first
  /// poses.
  std::vector<std::uint32_t> body = {};
  std::vector<std::uint8_t> point_class = {};  ///< as in Collisions

  std::size_t size() const { return source.size(); }
};

/// Distances of environment points to the model, one row per point, ascending by source index.
struct Clearances {
  std::vector<std::uint64_t> source;
  std::vector<Vec3> xyz;
  std::vector<double> distance;          ///< metres, the least over all poses
  std::vector<std::uint32_t> pose;       ///< the first pose that has this distance
  std::vector<std::uint32_t> body = {};  ///< the body that has this distance; empty without bodies
  std::vector<std::uint8_t> point_class = {};  ///< as in Collisions

  std::size_t size() const { return source.size(); }
};

/// For every pose of the trajectory, the least distance between the model and the environment.
struct Profile {
  static constexpr std::uint64_t kNoPoint = ~std::uint64_t{0};
  /// Metres; infinity if the distance is not below the one asked for, and NaN where no body of a
  /// vehicle has a pose, because nothing is known there.
  std::vector<double> distance;
  /// Source index of the nearest point, the smallest if several are; or kNoPoint
  std::vector<std::uint64_t> source;
  std::vector<Vec3> xyz;         ///< position of the nearest point; NaN where there is none
  std::vector<double> chainage;  ///< metres along the positions of the path
  /// Class of the nearest point, as in Collisions; 0 where there is no point.
  std::vector<std::uint8_t> point_class = {};

  std::size_t size() const { return distance.size(); }
};

/// A result that search() wrote. Tables and columns are read when they are asked for; row i of each
/// column of a table belongs to the same point or pose. Throws InputError if the file is damaged,
/// ResourceError if it cannot be read.
class Result {
 public:
  explicit Result(const std::filesystem::path& path);
  ~Result();
  Result(Result&&) noexcept;
  Result& operator=(Result&&) noexcept;

  std::uint64_t size() const;  ///< number of colliding points
  const QueryParameters& parameters() const;
  std::uint64_t environment_points() const;
  /// Counts of the ignored classes and boxes of the parameters
  const IgnoredPointCounts& ignored() const;
  std::uint64_t poses() const;
  /// The verdict and the places that matter most. Reads all tables of the file.
  Answer answer() const;
  /// The warnings of the answer. Reads no table.
  const std::vector<Message>& warnings() const;

  Collisions collisions() const;
  // Single columns of collisions(), for those who need no more.
  std::vector<std::uint64_t> source() const;
  std::vector<Vec3> xyz() const;
  std::vector<std::uint32_t> first_pose() const;
  std::vector<std::uint32_t> last_pose() const;
  std::vector<std::uint32_t> first_body() const;
  /// Names of the bodies of a query that has several; otherwise empty.
  const std::vector<std::string>& bodies() const;
  UnseenCubes unseen() const;    ///< empty unless the query asked for seen space
  Nearby near() const;           ///< empty unless the query has an error budget
  Clearances clearance() const;  ///< empty unless the query asked for clearances
  Profile profile() const;       ///< empty unless the query asked for a profile
  /// Largest gap between the samples of the mesh, metres, the greatest of all bodies; 0 if no model
  /// is a sampled mesh.
  double model_spacing() const;
  /// The axes of the model's file that pointed ahead and up before the search turned the model; for
  /// a vehicle, those of all its bodies' files. They need no turn where nothing was turned.
  ModelAxes model_axes() const;
  Box model_box() const;  ///< box around the model's points

  /// The reader behind this result, for the library itself.
  const ResultReader& reader() const { return *reader_; }

 private:
  std::unique_ptr<ResultReader> reader_;
};

}  // namespace clearway
