#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "clearway/conflicts.hpp"
#include "findings/searched_scene.hpp"
#include "io/paths/content_hash.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/result_fixture.hpp"

namespace clearway::test {

using Quanta = std::vector<std::array<std::int32_t, 3>>;

/// Colliding points as a search could have found them.
struct Found {
  Quanta quanta = {};
  std::vector<std::uint32_t> first_pose = {};  ///< empty: all 0
  std::vector<std::uint64_t> source = {};      ///< empty: 0, 1, ...
  Quantisation quantisation{{0.001, 0.001, 0.001}, {0, 0, 0}};
  std::vector<Pose> poses{translation({0, 0, 0}), translation({1, 0, 0})};
  double clearance = 0;
  Clearances clearances = {};
  std::uint64_t solids = 0;
  std::vector<Body> bodies = {};              ///< the bodies of a vehicle
  std::vector<std::uint32_t> body = {};       ///< the body of each row, where there are bodies
  std::vector<std::uint32_t> last_pose = {};  ///< empty: the first poses
  std::optional<double> floor = {};
  bool between_poses = false;
  std::vector<std::uint8_t> point_class = {};  ///< of each row, where the scans have classes

  ResultHeader header() const {
    ResultHeader out;
    out.environment_points = source.empty() ? quanta.size() : source.back() + 1;
    out.model_points = 8;
    out.poses = poses.size();
    out.trajectory_hash = hash_of_trajectory(poses);
    out.radius = 0.5;
    out.first_pose = true;
    out.floor = floor;
    out.between_poses = between_poses;
    if (!point_class.empty()) out.classes_hash = 1;
    out.clearance = clearance;
    out.model_triangles = 12 * solids;
    out.model_solids = solids;
    out.quantisation = quantisation;
    out.model_box = {{-1, -1, -1}, {1, 1, 1}};
    for (const Body& one : bodies) out.bodies.push_back(one.name);
    if (!bodies.empty()) out.model_hash = hash_of_bodies(bodies);
    if (floor) out.body_floors.assign(bodies.size(), floor);
    return out;
  }

  Collisions rows() const {
    Collisions out;
    out.body = body;
    out.last_pose = last_pose;
    out.point_class = point_class;
    for (std::size_t i = 0; i < quanta.size(); ++i) {
      out.source.push_back(source.empty() ? i : source[i]);
      out.xyz.push_back(position(quantisation, quanta[i][0], quanta[i][1], quanta[i][2]));
      out.first_pose.push_back(first_pose.empty() ? 0 : first_pose[i]);
    }
    return out;
  }

  Result write(const ScratchFolder& folder) const {
    write_result(folder / "out.h5", header(), rows(), 1000, clearances);
    return Result(folder / "out.h5");
  }

  Conflicts conflicts(const ConflictOptions& options = {},
                      std::vector<std::uint32_t>* conflict_of = nullptr) const {
    const ScratchFolder folder;
    return find_conflicts(write(folder), poses, options, conflict_of);
  }

  /// Of all points, however few.
  Conflict first_conflict(ConflictOptions options = {}) const {
    options.min_points = 1;
    return conflicts(options).listed.at(0);
  }

  /// Gives some sources clearances, of which all lie at one place.
  void clear(std::vector<std::uint64_t> sources, std::vector<double> distances,
             std::vector<std::uint32_t> at_poses) {
    clearances.source = std::move(sources);
    clearances.distance = std::move(distances);
    clearances.pose = std::move(at_poses);
    clearances.xyz.resize(clearances.source.size(), rows().xyz[0]);
  }
};

/// One point at a place that is no multiple of the steps, first touched at one pose.
inline Found one_point(const Vec3& at, const Pose& pose) {
  Found found{.quanta = {{0, 0, 0}}, .poses = {pose}};
  for (int k = 0; k < 3; ++k) found.quantisation.offset[k] = at[k];
  return found;
}

/// Whether two points are neighbours by the definition, with integers of 128 bits where the scales
/// are equal.
inline bool neighbours(const Found& found, std::size_t i, std::size_t j, double gap) {
  const double* scale = found.quantisation.scale;
  std::int64_t d[3];
  for (std::size_t k = 0; k < 3; ++k) {
    d[k] = std::int64_t{found.quanta[i][k]} - found.quanta[j][k];
  }
  if (scale[0] != scale[1] || scale[1] != scale[2]) {
    const double x = static_cast<double>(d[0]) * scale[0];
    const double y = static_cast<double>(d[1]) * scale[1];
    const double z = static_cast<double>(d[2]) * scale[2];
    return x * x + y * y + z * z <= gap * gap;
  }
  __int128 squared = 0;
  for (const std::int64_t one : d) squared += static_cast<__int128>(one) * one;
  const double steps = gap / scale[0];
  const double whole = std::round(steps);
  if (std::abs(steps - whole) <= 1e-9) {
    const auto n = static_cast<__int128>(whole);
    return squared <= n * n;
  }
  return squared <= static_cast<__int128>(std::floor(steps * steps));
}

/// The smallest row of each row's group, by looking at all pairs.
inline std::vector<std::size_t> all_pairs(const Found& found, double gap) {
  std::vector<std::size_t> group(found.quanta.size());
  std::iota(group.begin(), group.end(), 0);
  const auto root = [&](std::size_t i) {
    while (group[i] != i) i = group[i] = group[group[i]];
    return i;
  };
  for (std::size_t i = 0; i < group.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const std::size_t a = root(i), b = root(j);
      if (a != b && neighbours(found, i, j, gap)) group[std::max(a, b)] = std::min(a, b);
    }
  }
  for (std::size_t i = 0; i < group.size(); ++i) group[i] = root(i);
  return group;
}

/// Checks conflict_of, without small groups and cuts, against all_pairs(). Returns the number of
/// groups.
inline std::size_t check_groups(const Found& found, double gap, int threads = 2) {
  ConflictOptions options{.gap = gap, .min_points = 1, .split = 0};
  options.threads = threads;
  std::vector<std::uint32_t> conflict_of;
  const Conflicts conflicts = found.conflicts(options, &conflict_of);
  const std::vector<std::size_t> group = all_pairs(found, gap);
  REQUIRE(conflict_of.size() == group.size());
  std::map<std::size_t, std::uint32_t> id_of;
  std::map<std::uint32_t, std::uint64_t> points;
  std::map<std::uint32_t, Vec3> sum;
  const std::vector<Vec3> xyz = found.rows().xyz;
  for (std::size_t i = 0; i < group.size(); ++i) {
    const auto known = id_of.emplace(group[i], conflict_of[i]).first;
    if (known->second != conflict_of[i]) FAIL("row " << i << " is in another group");
    ++points[conflict_of[i]];
    sum[conflict_of[i]] = sum[conflict_of[i]] + xyz[i];
  }
  // There are as many numbers as groups, so that no two groups share a number.
  REQUIRE(points.size() == id_of.size());
  REQUIRE(conflicts.listed.size() == id_of.size());
  CHECK(conflicts.groups == id_of.size());
  for (const auto& [row, id] : id_of) {
    const Conflict& conflict = conflicts.listed.at(id - 1);
    check_equal(conflict.points, points[id]);
    check_equal(conflict.source, row);
    check_near(conflict.centroid, 1.0 / static_cast<double>(points[id]) * sum[id], 1e-5);
  }
  return id_of.size();
}

}  // namespace clearway::test
