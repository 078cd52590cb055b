#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "clearway/conflicts.hpp"
#include "clearway/vec3.hpp"
#include "findings/row_pieces.hpp"

/// The points of a result with their conflicts, and points found by place.
namespace clearway {

/// A cube of a regular grid.
struct GridCube {
  std::int64_t x, y, z;
  friend bool operator==(const GridCube&, const GridCube&) = default;
};

struct GridCubeHash {
  std::size_t operator()(const GridCube& c) const {
    std::uint64_t hash = 0;
    for (const std::int64_t one : {c.x, c.y, c.z}) {
      hash = (hash ^ static_cast<std::uint64_t>(one)) * 0x9e3779b97f4a7c15U;
      hash ^= hash >> 29;
    }
    return hash;
  }
};

/// A point of a result with its conflict; 0 for a point of no listed conflict.
struct NumberedPoint {
  Vec3 xyz;
  std::uint32_t conflict;
};

/// Points in cubes. Two points in one cube are within the gap, but for roundings, and two points
/// within the gap are at most two cubes apart on each axis. So most points find one near them in
/// their own cube.
class Places {
 public:
  /// More than the roundings of coordinates, so that points a whole gap apart are near, and less
  /// than the steps of any scan.
  static constexpr double kRounding = 1e-6;

  /// slack: how much farther than the gap a point may be and still be near.
  explicit Places(double gap, double slack = kRounding)
      : limit_(gap + slack), edge_(std::max(kShareOfGap * gap, kShortestEdge)) {}

  void add(const NumberedPoint& point) { cubes_[cube_of(point.xyz)].push_back(point); }

  /// The conflict of a point within the gap: 0 where only points of no listed conflict are near,
  /// and nothing where no point is. Not safe to call from several threads.
  std::optional<std::uint32_t> near(const Vec3& p) {
    bool any = false;
    for (const Points* points : around(cube_of(p))) {
      for (const NumberedPoint& other : *points) {
        const double x = p.x - other.xyz.x, y = p.y - other.xyz.y, z = p.z - other.xyz.z;
        if (x * x + y * y + z * z > limit_ * limit_) continue;
        if (other.conflict > 0) return other.conflict;
        any = true;
      }
    }
    return any ? std::optional<std::uint32_t>(0) : std::nullopt;
  }

 private:
  using Points = std::vector<NumberedPoint>;

  std::int64_t along(double at) const { return static_cast<std::int64_t>(std::floor(at / edge_)); }
  GridCube cube_of(const Vec3& p) const { return {along(p.x), along(p.y), along(p.z)}; }

  /// The points of the cube and of those at most two away, beginning with its own. They are cached
  /// because consecutive points of a result mostly lie in few cubes. Valid until the next call.
  const std::vector<const Points*>& around(const GridCube& own) {
    if (around_.size() >= kMostCached) around_.clear();
    const auto [found, is_new] = around_.try_emplace(own);
    std::vector<const Points*>& out = found->second;
    if (!is_new) return out;
    const auto take = [&](const GridCube& cube) {
      const auto points = cubes_.find(cube);
      if (points != cubes_.end()) out.push_back(&points->second);
    };
    take(own);
    for (int i = 0; i < 125; ++i) {
      const GridCube cube{own.x + i % 5 - 2, own.y + i / 5 % 5 - 2, own.z + i / 25 - 2};
      if (!(cube == own)) take(cube);
    }
    return out;
  }

  static constexpr double kShareOfGap = 0.577;  // below the root of 1/3
  // So that the index of a cube fits its integers.
  static constexpr double kShortestEdge = 1e-3;
  // Cubes whose neighbours are cached. Each takes at most about 1 KiB.
  static constexpr std::size_t kMostCached = std::size_t{1} << 14;
  double limit_, edge_;
  std::unordered_map<GridCube, Points, GridCubeHash> cubes_;
  std::unordered_map<GridCube, std::vector<const Points*>, GridCubeHash> around_;
};

/// A row of the colliding or the near points of a result.
struct PointRow : NumberedPoint {
  std::uint64_t source;
  std::uint32_t first_pose, last_pose;
};

/// Calls visit(row) for each colliding point of a result, and for each near one.
template <typename Visit>
void for_each_point(const GroupedResult& of, Visit visit) {
  const std::size_t colliding = of.result.reader().collisions();
  for_each_rows(of.result.reader(), [&](const auto& rows, std::size_t first) {
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const std::size_t row = first + i;
      const std::uint32_t conflict =
          row < colliding ? of.conflict_of[row] : of.conflict_of_near[row - colliding];
      visit(PointRow{
          {rows.xyz[i], conflict}, rows.source[i], rows.first_pose[i], last_pose_of(rows, i)});
    }
  });
}

}  // namespace clearway
