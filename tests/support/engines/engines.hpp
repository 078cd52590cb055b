#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "clearway/query.hpp"
#include "support/engines/answer_sets.hpp"
#include "support/engines/brute_force.hpp"
#include "support/memory_cloud.hpp"

namespace clearway {

/// An engine under test. Every engine runs through the same scenes, against brute force.
struct Engine {
  std::string name;
  SearchResult (*run)(const PackedCloud& cloud, const Query& query, int threads);
  /// Whether it finds more than which points collide with a model of points at its poses
  bool finds_all;
};

/// The engines that every scene is searched with. Another program may put its own in their place.
std::vector<Engine>& engines();

/// A small scene.
struct EngineScene {
  std::vector<Quantum> points;
  Quantisation quantisation;
  Query query;
  std::vector<std::uint8_t> classes = {};  ///< of each point; without any, all are 0

  void move_far_away(const Vec3& offset) {
    for (int k = 0; k < 3; ++k) quantisation.offset[k] += offset[k];
    for (Pose& pose : query.poses) {
      for (int k = 0; k < 3; ++k) pose.translation[k] += offset[k];
    }
  }
};

/// What brute force finds in a scene, as if ignored points were not there. Everything is computed
/// when it is first asked for.
class Expected {
 public:
  explicit Expected(const EngineScene& scene);

  /// The first pose of every point, or kNoPose.
  const std::vector<std::uint32_t>& first_poses(bool between_poses) const;
  const std::vector<Clearance>& clearances() const;  ///< of every point, however far it is
  const std::vector<NearestPoint>& nearest() const;  ///< of every pose, however far it is
  std::uint64_t colliding(bool between_poses = false) const;

  /// The number of points and poses for which the answer to the query is wrong.
  std::uint64_t wrong(const SearchResult& answer, const MemoryCloud& cloud,
                      const Query& query) const;

 private:
  Query query_;
  std::vector<Vec3> searched_;
  std::vector<std::uint64_t> sources_;  ///< the index of each searched point
  std::size_t points_;
  mutable std::optional<std::vector<std::uint32_t>> first_poses_[2];
  mutable std::optional<std::vector<Clearance>> clearances_;
  mutable std::optional<std::vector<NearestPoint>> nearest_;
};

/// Ways to pack points: cells of one block, of many, of all; and cells in several buckets.
inline const std::vector<MemoryCloudOptions> kPackings{{64, 0}, {1000, 0}, {65536, 0}, {128, 500}};

struct Asked {
  double reach = 0;  ///< metres: clearances and profiles up to this are asked for, too
  std::vector<MemoryCloudOptions> packings = kPackings;
};

/// Runs every engine on the scene and checks the answers against brute force: the set at poses, and
/// where an engine finds all, with first poses, between poses for a model of points, and clearances
/// and profiles from below the radius to above it.
Expected check_engines(const EngineScene& scene, const Asked& asked = {});

}  // namespace clearway
