#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "clearway/body.hpp"
#include "clearway/query.hpp"
#include "clearway/section.hpp"
#include "core/messages/messages.hpp"
#include "core/trajectory/corridor.hpp"
#include "io/store/store_metadata.hpp"

namespace clearway {

/// What a store of points near a path can answer: nothing that a point could change which it left
/// out (docs/design/pipeline.md). For a store of all points, every question passes.
class CorridorCheck {
 public:
  explicit CorridorCheck(const StoreMetadata& store);

  /// Throws InputError, naming the pose and the distance that would do, where a point that was left
  /// out could lie within `reach` of a body, at a pose or, with between_poses, on the way to the
  /// next one.
  void check(std::span<const MovingBody> bodies, bool between_poses, double reach) const;
  /// Checks all that a query asks for. radius: the greatest that is searched.
  void check(const Query& query, double radius) const;

  /// The distance from a path, in the environment's unit, that such a check of the query accepts.
  static double wanted(const Query& query, std::vector<Vec3> path, double radius);

  /// Checks a section with its load, whose poses belong to those of the path by path_pose.
  void check(const SectionParameters& asked, const Body& load) const;

  /// Throws UsageError where seen space is asked for: beams and cubes need the whole scan.
  void refuse_seen(bool seen) const;

 private:
  struct Need {
    double distance = 0;
    std::uint64_t pose = 0;
  };
  Need need_of(std::span<const Pose> poses, std::span<const std::uint32_t> path_pose,
               double farthest_of_model, bool between_poses) const;
  void refuse(const Need& need, double reach, const std::string& what) const;

  CorridorCheck() = default;

  std::optional<Corridor> corridor_;
  double metre_ = 1;  ///< the length of a metre in the store's unit
};

/// Notes on a store of points near a path that the checks which look `looked` far beside the path
/// are not made, if they are not. Returns whether they are made.
bool looks_stay_near(const StoreMetadata& store, double looked, MessageLog& log);

}  // namespace clearway
