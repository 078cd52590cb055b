#include "core/sweep/tolerance.hpp"

#include <algorithm>
#include <cmath>

#include "core/geometry/point_box.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/random_triangles.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

const Box kBox{{-1, -2, 0}, {1, 2, 1}};

long double distance(const Vec3& a, const Vec3& b) {
  long double squared = 0;
  for (int k = 0; k < 3; ++k) {
    const long double d = static_cast<long double>(a[k]) - b[k];
    squared += d * d;
  }
  return std::sqrt(squared);
}

/// The largest distance of anything from the nearest kept one, by `distance_of(i, kept)`.
template <typename DistanceOf>
long double worst_cover(std::size_t count, const std::vector<std::uint32_t>& kept,
                        const DistanceOf& distance_of) {
  CHECK(std::ranges::adjacent_find(kept, std::greater_equal<>()) == kept.end());
  long double worst = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    long double nearest = HUGE_VALL;
    for (const std::uint32_t k : kept) nearest = std::min(nearest, distance_of(i, k));
    worst = std::max(worst, nearest);
  }
  return worst;
}

}  // namespace

TEST_CASE("kept points cover the model and no more of them are kept than need be") {
  Random random(1);
  for (const double extent : {1.0, 0.01}) {
    for (const double offset : {0.0, -1e6}) {
      const std::vector<Vec3> model =
          random_points(random, {{offset, 0, 0}, {offset + 1, extent, extent * extent}}, 1000);
      for (const double cover : {1e-12, 1e-3, 0.03, 0.2, 5.0}) {
        CAPTURE(extent, offset, cover);
        const auto kept = kept_points(model, cover);
        CHECK(worst_cover(model.size(), kept, [&](std::uint32_t i, std::uint32_t k) {
                return distance(model[i], model[k]);
              }) <= cover);
        // No kept point lies within the cover of one before it.
        for (std::size_t i = 0; i < kept.size(); ++i) {
          for (std::size_t j = 0; j < i; ++j) {
            if (distance(model[kept[i]], model[kept[j]]) < cover * (1 - 1e-12)) FAIL("too near");
          }
        }
      }
    }
  }
}

TEST_CASE("kept poses stand for the others") {
  Random random(3);
  for (int path = 0; path < 4; ++path) {
    std::vector<Pose> poses = smooth_path(random, kBox, 300);
    if (path == 1) poses = random_slow_path(random, 300);
    for (std::size_t i = 0; i < poses.size() && path > 1; ++i) {  // a stop with noise, and jumps
      poses[i] = translation(random_point(random, {{0, 0, 0}, {0.03, 0.03, 0.03}}));
      if (i % 50 == 0) poses[i] = random_rotation(random, random_point(random, kBox));
    }
    for (const double most : {-1.0, 0.0, 1e-6, 0.01, 0.02, 0.3, 100.0}) {
      CAPTURE(path, most);
      const auto kept = kept_poses(poses, kBox, most);
      // How far a corner of the box is, at a pose, from where it is at a kept pose.
      const auto motion = [&](std::uint32_t i, std::uint32_t k) {
        long double farthest = 0;
        for (int c = 0; c < 8; ++c) {
          const Vec3 m{c & 1 ? kBox.hi.x : kBox.lo.x, c & 2 ? kBox.hi.y : kBox.lo.y,
                       c & 4 ? kBox.hi.z : kBox.lo.z};
          farthest = std::max(farthest, distance(transform(poses[i], m), transform(poses[k], m)));
        }
        return farthest;
      };
      CHECK(worst_cover(poses.size(), kept, motion) <= std::max(most, 0.0));
    }
  }
  CHECK(kept_poses({}, kBox, 1).empty());
}

TEST_CASE("of equal points and of equal poses in a row one is kept, and of a smooth path few") {
  Random random(2);
  std::vector<Vec3> model = random_points(random, kBox, 20);
  for (int i = 0; i < 200; ++i) model.push_back(model[below(random, 20)]);
  std::vector<Pose> poses, smooth;
  for (int i = 0; i < 30; ++i) {
    poses.insert(poses.end(), 1 + below(random, 9), random_rotation(random, {5e6, 5e6, 0}));
  }
  for (const double most : {-1.0, 0.0, 1e-200}) {
    check_equal(kept_points(model, most).size(), 20);
    check_equal(kept_poses(poses, kBox, most).size(), 30);
  }
  check_equal(kept_points(model, 1e100).size(), 1);
  // Every kept pose stands for 10 before and 10 behind it.
  for (int i = 0; i <= 1000; ++i) smooth.push_back(translation({0.001 * i, 0, 0}));
  check_equal(kept_poses(smooth, kBox, 0.0105).size(), 48);
}

TEST_CASE("model points nearer to each other than a moved one's rounding") {
  Random random(5);
  Query query{random_points(random, kBox, 50),
              {random_rotation(random, {5e6, -5e6, 5e6})},
              {.radius = 0.5}};
  while (query.model.vertices.size() < 2000) {
    query.model.vertices.push_back(plus(query.model.vertices[below(random, 50)],
                                        uniform(random, 0, 2e-10), random_direction(random)));
  }
  for (const double tolerance : {3e-10, 8e-10, 5e-8}) {
    const ThinnedQuery thinned(query, tolerance);
    CHECK(search_radius(0.5, tolerance) <= 0.5 + tolerance);
    CHECK(search_radius(0.5, tolerance) >= 0.5);
    const auto moved = [&](const Vec3& m) { return transform(query.poses[0], m); };
    for (const Vec3& m : query.model.vertices) {
      if (std::ranges::none_of(thinned.query().model.vertices, [&](const Vec3& kept) {
            return distance(moved(m), moved(kept)) <= tolerance;
          })) {
        FAIL("no kept point is near " << m.x);
      }
    }
  }
}
