#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/geometry/predicate.hpp"
#include "core/query/search_result.hpp"
#include "library/vehicle_scene.hpp"
#include "support/catch.hpp"
#include "support/engines/brute_force.hpp"

/// Runs of vehicles against brute force, body by body, merged by hand.
namespace clearway::test {

inline constexpr std::uint32_t kNever = kNoPose;

/// The first pose of the path at which a point collides, and the body; kNever where none does.
struct First {
  std::uint32_t pose = kNever, body = kNever;
  friend bool operator<(const First& a, const First& b) {
    return a.pose != b.pose ? a.pose < b.pose : a.body < b.body;
  }
};

inline std::vector<First> first_by_hand(const Vehicle& vehicle) {
  std::vector<First> out(vehicle.places.size());
  for (std::uint32_t body = 0; body < vehicle.query.bodies.size(); ++body) {
    const auto poses = brute_force_first_poses(vehicle.searched_places(), vehicle.of(body));
    for (std::size_t i = 0; i < poses.size(); ++i) {
      if (poses[i] == kNever) continue;
      out[i] = std::min(out[i], First{vehicle.query.bodies[body].path_pose[poses[i]], body});
    }
  }
  return out;
}

inline void check_first_poses(Vehicle& vehicle, const SearchOptions& options = {}) {
  vehicle.query.first_pose = true;
  const Result result = vehicle.run(options);
  const auto expected = first_by_hand(vehicle);
  const auto source = result.source();
  const auto pose = result.first_pose(), body = result.first_body();
  std::size_t row = 0;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    if (expected[i].pose == kNever) continue;
    REQUIRE(row < source.size());
    CHECK(source[row] == i);
    CHECK(pose[row] == expected[i].pose);
    CHECK(body[row] == expected[i].body);
    ++row;
  }
  CHECK(row == source.size());
  CHECK(row > 20);
}

inline void check_clearances(Vehicle& vehicle) {
  const Clearances found = vehicle.run({.threads = 2}).clearance();
  struct Least {
    double squared = std::numeric_limits<double>::infinity();
    First first;
  };
  std::vector<Least> expected(vehicle.places.size());
  for (std::uint32_t body = 0; body < vehicle.query.bodies.size(); ++body) {
    const auto all = brute_force_clearances(vehicle.searched_places(), vehicle.of(body));
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (!all[i].found()) continue;  // it is below the floor at all poses
      const First first{vehicle.query.bodies[body].path_pose[all[i].pose], body};
      Least& least = expected[i];
      const bool nearer = all[i].squared < least.squared;
      if (nearer || (all[i].squared == least.squared && first < least.first)) {
        least = {all[i].squared, first};
      }
    }
  }
  std::size_t row = 0;
  const double limit = rounded_product(vehicle.query.clearance, vehicle.query.clearance);
  for (std::size_t i = 0; i < expected.size(); ++i) {
    if (!(expected[i].squared < limit)) continue;
    REQUIRE(row < found.source.size());
    CHECK(found.source[row] == i);
    CHECK(found.distance[row] == signed_root(expected[i].squared));
    CHECK(found.pose[row] == expected[i].first.pose);
    CHECK(found.body[row] == expected[i].first.body);
    ++row;
  }
  CHECK(row == found.source.size());
  CHECK(row > 10);
}

inline void check_profile(Vehicle& vehicle) {
  const Profile found = vehicle.run({.threads = 2}).profile();
  std::vector<NearestPoint> expected(vehicle.query.poses.size(),
                                     {std::numeric_limits<double>::infinity(), Profile::kNoPoint});
  std::vector<bool> has_body(expected.size());
  for (std::size_t body = 0; body < vehicle.query.bodies.size(); ++body) {
    for (const std::uint32_t pose : vehicle.query.bodies[body].path_pose) has_body[pose] = true;
    const auto all = brute_force_profile(vehicle.searched_places(), vehicle.of(body));
    for (std::size_t k = 0; k < all.size(); ++k) {
      if (std::isinf(all[k].squared)) continue;
      NearestPoint& least = expected[vehicle.query.bodies[body].path_pose[k]];
      const bool nearer = all[k].squared < least.squared;
      if (nearer || (all[k].squared == least.squared && all[k].source < least.source)) {
        least = all[k];
      }
    }
  }
  REQUIRE(found.distance.size() == expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    if (has_body[i]) {
      CHECK(found.distance[i] == signed_root(expected[i].squared));
    } else {
      CHECK(std::isnan(found.distance[i]));
    }
    CHECK(found.source[i] == expected[i].source);
  }
  CHECK(vehicle.report.profile_poses > 10);
}

}  // namespace clearway::test
