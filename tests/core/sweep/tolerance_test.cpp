#include "core/sweep/tolerance.hpp"

#include <algorithm>
#include <cmath>

#include "core/geometry/point_box.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/scenes.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

long double distance(const Vec3& a, const Vec3& b) {
  long double squared = 0;
  for (int k = 0; k < 3; ++k) {
    const long double d = static_cast<long double>(a[k]) - b[k];
    squared += d * d;
  }
  return std::sqrt(squared);
}

/// The largest distance of any point from the nearest kept one.
long double worst_cover(const std::vector<Vec3>& points, const std::vector<std::uint32_t>& kept) {
  long double worst = 0;
  for (const Vec3& p : points) {
    long double nearest = HUGE_VALL;
    for (const std::uint32_t i : kept) nearest = std::min(nearest, distance(p, points[i]));
    worst = std::max(worst, nearest);
  }
  return worst;
}

/// The largest distance of a corner of the box, at any pose, from where it is at the kept pose that
/// is nearest in that sense.
long double worst_motion(const std::vector<Pose>& poses, const std::vector<std::uint32_t>& kept,
                         const Box& box) {
  long double worst = 0;
  for (const Pose& pose : poses) {
    long double least = HUGE_VALL;
    for (const std::uint32_t i : kept) {
      long double farthest = 0;
      for (int c = 0; c < 8; ++c) {
        const Vec3 m{c & 1 ? box.hi.x : box.lo.x, c & 2 ? box.hi.y : box.lo.y,
                     c & 4 ? box.hi.z : box.lo.z};
        farthest = std::max(farthest, distance(transform(pose, m), transform(poses[i], m)));
      }
      least = std::min(least, farthest);
    }
    worst = std::max(worst, least);
  }
  return worst;
}

bool ascends(const std::vector<std::uint32_t>& kept) {
  return std::adjacent_find(kept.begin(), kept.end(), std::greater_equal<>()) == kept.end();
}

const Box kBox{{-1, -2, 0}, {1, 2, 1}};

}  // namespace

TEST_CASE("kept points cover the model and no more of them are kept than need be") {
  Random random(1);
  for (const double extent : {1.0, 0.01}) {
    for (const double offset : {0.0, -1e6}) {
      std::vector<Vec3> model =
          random_points(random, {{offset, 0, 0}, {offset + 1, extent, extent * extent}}, 1500);
      for (const double cover : {1e-12, 1e-3, 0.03, 0.2, 5.0}) {
        CAPTURE(extent, offset, cover);
        const auto kept = kept_points(model, cover);
        CHECK(ascends(kept));
        CHECK(worst_cover(model, kept) <= cover);
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

TEST_CASE("equal model points are one at any cover") {
  Random random(2);
  std::vector<Vec3> model = random_points(random, kBox, 20);
  for (int i = 0; i < 200; ++i) model.push_back(model[below(random, 20)]);
  for (const double cover : {-1.0, 0.0, 1e-200}) check_equal(kept_points(model, cover).size(), 20);
  check_equal(kept_points(std::vector<Vec3>(50, Vec3{1, 2, 3}), 0).size(), 1);
  check_equal(kept_points(model, 1e100).size(), 1);
}

TEST_CASE("kept poses stand for the others") {
  Random random(3);
  std::vector<std::vector<Pose>> paths{smooth_path(random, kBox, 400)};
  paths.emplace_back();
  for (int i = 0; i < 400; ++i) paths.back().push_back(rotation({0, 0, 1}, 2e-3 * i, {1, 2, 3}));
  paths.emplace_back();
  for (int i = 0; i < 400; ++i) {  // a stop with noise, and jumps
    paths.back().push_back(translation(random_point(random, {{0, 0, 0}, {0.03, 0.03, 0.03}})));
    if (i % 50 == 0) paths.back().push_back(random_rotation(random, random_point(random, kBox)));
  }
  for (std::size_t path = 0; path < paths.size(); ++path) {
    for (const double most : {-1.0, 0.0, 1e-6, 0.01, 0.02, 0.3, 100.0}) {
      CAPTURE(path, most);
      const auto kept = kept_poses(paths[path], kBox, most);
      CHECK(ascends(kept));
      CHECK(worst_motion(paths[path], kept, kBox) <= std::max(most, 0.0));
    }
  }
  CHECK(kept_poses({}, kBox, 1).empty());
}

TEST_CASE("a smooth path keeps a pose for both sides") {
  std::vector<Pose> poses;
  for (int i = 0; i <= 1000; ++i) poses.push_back(translation({0.001 * i, 0, 0}));
  // Every kept pose stands for 10 before and 10 behind it.
  check_equal(kept_poses(poses, kBox, 0.0105).size(), 48);
}

TEST_CASE("equal poses in a row are one at any motion") {
  Random random(4);
  std::vector<Pose> poses;
  for (int i = 0; i < 30; ++i) {
    const Pose pose = random_rotation(random, {5e6, 5e6, 0});
    poses.insert(poses.end(), 1 + below(random, 9), pose);
  }
  for (const double most : {-1.0, 0.0, 1e-9}) check_equal(kept_poses(poses, kBox, most).size(), 30);
}

TEST_CASE("thinning makes distances no larger than the tolerance allows") {
  Random random(6);
  long double largest = 0;  // the largest growth, as a share of the tolerance
  for (int trial = 0; trial < 500; ++trial) {
    const double tolerance = std::exp(uniform(random, -14, -1));
    const double far = trial % 3 == 0 ? 5e6 : 0;
    const double stretch = trial % 2 == 0 ? 2.5 : 1;
    const Vec3 along = random_direction(random);
    const double step = tolerance * uniform(random, 0, 1.1);
    const double move = tolerance * uniform(random, -1.1, 1.1);
    std::vector<Vec3> model;
    std::vector<Pose> poses;
    for (int i = 0; i < 3; ++i) {
      model.push_back({i * step * along.x, i * step * along.y, i * step * along.z});
      const Vec3 by{i * move * along.x, i * move * along.y, far + i * move * along.z};
      poses.push_back(stretched(translation(by), {stretch, stretch, stretch}));
    }
    const ThinnedQuery thinned({model, poses, {.radius = 0.5}}, tolerance);
    const Query& query = thinned.query();
    for (const double side : {-0.5, 0.5}) {
      const Vec3 e{side * along.x, side * along.y, far + side * along.z};
      long double least = HUGE_VALL, least_thinned = HUGE_VALL;
      for (const Pose& pose : poses) {
        for (const Vec3& m : model) least = std::min(least, distance(e, transform(pose, m)));
      }
      for (const Pose& pose : query.poses) {
        for (const Vec3& m : query.model.vertices) {
          least_thinned = std::min(least_thinned, distance(e, transform(pose, m)));
        }
      }
      largest = std::max(largest, (least_thinned - least) / tolerance);
    }
  }
  CHECK(largest <= 1);
  CHECK(largest > 0.8);
}

TEST_CASE("a thinned query spends at most its tolerance") {
  Random random(5);
  for (const double far : {0.0, 5e6}) {
    const std::vector<Vec3> model = random_points(random, kBox, 800);
    std::vector<Pose> poses = smooth_path(random, {{-3, -3, -3}, {3, 3, 3}}, 300);
    for (Pose& pose : poses) {
      pose.translation[1] += far;
      pose = stretched(pose, {3, 0.5, 1});
    }
    for (const double tolerance : {1e-12, 1e-3, 0.05, 0.4}) {
      const ThinnedQuery thinned({model, poses, {.radius = 0.5}}, tolerance);
      const Query& query = thinned.query();
      check_equal(query.radius, 0.5);
      CHECK(search_radius(query.radius, tolerance) <= 0.5 + tolerance);
      CHECK(search_radius(query.radius, tolerance) >= 0.5);
      // Every moved point has a kept one at a kept pose near it.
      for (int i = 0; i < 200; ++i) {
        const Vec3 at = transform(poses[below(random, 300)], model[below(random, 800)]);
        long double nearest = HUGE_VALL;
        for (const Pose& pose : query.poses) {
          for (const Vec3& m : query.model.vertices) {
            nearest = std::min(nearest, distance(at, transform(pose, m)));
          }
        }
        if (nearest > tolerance) FAIL("too far");
      }
    }
  }
}

TEST_CASE("model points nearer to each other than a moved one's rounding") {
  Random random(8);
  std::vector<Vec3> model = random_points(random, kBox, 50);
  while (model.size() < 3000) {
    Vec3 m = model[below(random, 50)];
    for (int k = 0; k < 3; ++k) m[k] += uniform(random, -1e-10, 1e-10);
    model.push_back(m);
  }
  const std::vector<Pose> poses{random_rotation(random, {5e6, -5e6, 5e6})};
  for (const double tolerance : {3e-10, 8e-10, 5e-8}) {
    const ThinnedQuery thinned({model, poses, {.radius = 0.5}}, tolerance);
    long double farthest = 0;
    for (const Vec3& m : model) {
      const Vec3 at = transform(poses[0], m);
      long double nearest = HUGE_VALL;
      for (const Vec3& kept : thinned.query().model.vertices) {
        nearest = std::min(nearest, distance(at, transform(poses[0], kept)));
        if (nearest == 0) break;
      }
      farthest = std::max(farthest, nearest);
    }
    CHECK(farthest <= tolerance);
  }
}
