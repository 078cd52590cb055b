#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <vector>

#include "clearway/convert.hpp"
#include "clearway/pose.hpp"
#include "core/geometry/rigid.hpp"
#include "support/classed_scans.hpp"
#include "support/scenes.hpp"

/// A road between two walls along a path, as a scan with classes.
namespace clearway::test {

/// Classes of the points of a road.
inline constexpr std::uint8_t kGroundClass = 2, kWallClass = 6, kObstacleClass = 7;

/// Poses with x forward, y left and z up on a line that bends to the left with a radius, or is
/// straight for a radius of 0. They stand on the ground.
inline std::vector<Pose> road_path(double from, double to, double step, double radius = 0) {
  std::vector<Pose> path;
  for (int i = 0; from + i * step <= to + 1e-9; ++i) {
    const double s = from + i * step;
    const double angle = radius == 0 ? 0 : s / radius;
    const Vec3 at = radius == 0 ? Vec3{s, 0, 0}
                                : Vec3{radius * std::sin(angle), radius * (1 - std::cos(angle)), 0};
    path.push_back(rotation({0, 0, 1}, angle, at));
  }
  return path;
}

/// A scan: places and classes.
struct RoadScan {
  std::vector<Vec3> points;
  std::vector<std::uint8_t> classes;

  void add(const Vec3& point, std::uint8_t point_class) {
    points.push_back(point);
    classes.push_back(point_class);
  }
  void erase(const std::function<bool(const Vec3&)>& is_gone) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (is_gone(points[i])) continue;
      points[kept] = points[i];
      classes[kept++] = classes[i];
    }
    points.resize(kept);
    classes.resize(kept);
  }
  /// Writes the scan with coordinates from `offset`, each wrong by up to 3 mm as those of a
  /// scanner, and converts it.
  void convert_to(const std::filesystem::path& store,
                  const std::array<double, 3>& offset = {0, 0, 0}) const {
    std::vector<Quantum> quanta;
    Random random(1);
    for (const Vec3& p : points) {
      Quantum q{};
      for (std::size_t k = 0; k < 3; ++k) {
        const double at = p[static_cast<int>(k)] + uniform(random, -0.003, 0.003);
        q[k] = static_cast<std::int32_t>(std::lround(1000 * (at - offset[k])));
      }
      quanta.push_back(q);
    }
    std::filesystem::path las = store;
    las.replace_extension(".las");
    write_classed(las, quanta, classes, 6, offset);
    convert({las}, store, {.threads = 2, .overwrite = true});
    std::filesystem::remove(las);
  }
};

/// Ground 6 m to both sides of the path, and thick walls of 3 m height about 3.4 m beside it.
/// dense: poses along the whole road, about 0.1 m apart.
inline RoadScan road_along(const std::vector<Pose>& dense) {
  RoadScan scan;
  for (std::size_t i = 0; i < dense.size(); ++i) {
    const auto add = [&](double y, double z, std::uint8_t point_class) {
      scan.add(dense[i].rotated({0, y, z}) + dense[i].position(), point_class);
    };
    for (double y = -6; y <= 6; y += 0.1) add(y, 0, kGroundClass);
    int n = static_cast<int>(i);
    for (double z = 0; z <= 3; z += 0.05, ++n) {
      for (const double side : {-1.0, 1.0}) add(side * (3.3 + 0.02 * (n % 10)), z, kWallClass);
    }
  }
  return scan;
}

}  // namespace clearway::test
