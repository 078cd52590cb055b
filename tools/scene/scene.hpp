#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string_view>
#include <vector>

#include "clearway/pose.hpp"
#include "clearway/vec3.hpp"
#include "scene/path.hpp"
#include "scene/scanning/scanner.hpp"
#include "scene/sites/world.hpp"

namespace clearway::scene {

/// Small turns away from a direction of travel, in radians and to first order: to the left, nose
/// up, left side up.
struct Attitude {
  double yaw = 0, pitch = 0, roll = 0;
};

/// The pose of a model whose x axis points along `forward` (not upright), as upright as it can be
/// but for the attitude. Orthonormal to rounding.
Pose pose_along(const Vec3& position, const Vec3& forward, const Attitude& attitude);

enum class Kind { kHall, kPlant, kMine, kTunnel, kRoad };

inline constexpr Kind kAllKinds[] = {Kind::kHall, Kind::kPlant, Kind::kMine, Kind::kTunnel,
                                     Kind::kRoad};

std::string_view name_of(Kind kind);
/// The kind of scene with this name. Throws UsageError where there is none.
Kind kind_named(std::string_view name);

struct Sizes {
  std::uint64_t points;        ///< number of points of the environment, >= 1
  std::uint64_t model_points;  ///< >= 1
  std::uint64_t poses;         ///< >= 1
};

/// The sizes of the data set that the scene resembles (the paper, table 1). The road resembles none
/// of them; its sizes are those of a drive with a car-mounted scanner.
Sizes full_sizes(Kind kind);

/// A synthetic environment, a model and its trajectory: the same for the same kind, sizes and seed,
/// bit for bit, on every machine. The extent does not depend on the sizes. z is up, metres.
struct Scene {
  Kind kind;
  Sizes sizes;
  Path path;
  World world;
  ScanPlan plan;
  std::vector<Vec3> model;
  std::function<Pose(std::uint64_t)> pose;  ///< pose 0 to sizes.poses - 1
  std::vector<double> stations;  ///< arc lengths where a scanner stood; only for the mine
};

/// The distance of the wagon's bogies, metres. The pivots are at x = +-kBogieDistance / 2 of its
/// frame, at the height of the rails' tops.
inline constexpr double kBogieDistance = 20;

/// Makes a scene. It may not be moved or copied, because it refers to itself.
std::unique_ptr<const Scene> make_scene(Kind kind, const Sizes& sizes, std::uint64_t seed);

}  // namespace clearway::scene
