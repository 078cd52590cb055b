#include "core/sweep/point_curve.hpp"

#include <cmath>

#include "core/geometry/predicate.hpp"
#include "core/sweep/triangle_curve.hpp"
#include "core/trajectory/motion_curves.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/random_triangles.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

const Box kModel{{-2, -1, 0}, {3, 1, 1.5}};
constexpr double kReach = 0.5;

struct LongPlace {
  long double x, y, z;
  Vec3 rounded() const {
    return {static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)};
  }
  long double distance_to(const Vec3& m) const {
    return std::sqrt((x - m.x) * (x - m.x) + (y - m.y) * (y - m.y) + (z - m.z) * (z - m.z));
  }
};

/// The place on the parabola through three poses at t, by Lagrange's formula.
LongPlace place_at(const MotionTreeRef& motion, const MotionNode& node, const Vec3& e,
                   long double t) {
  const MotionParabola through(node);
  const Vec3 a = motion.inverse_poses[through.first].apply(e);
  const Vec3 b = motion.inverse_poses[through.middle].apply(e);
  const Vec3 c = motion.inverse_poses[through.last].apply(e);
  const long double m = through.middle_place;
  if (node.count == 1) return {a.x, a.y, a.z};
  long double of[3] = {1 - t, 0, t};
  if (m > 0) {
    of[0] = (t - m) * (t - 1) / m;
    of[1] = t * (t - 1) / (m * (m - 1));
    of[2] = t * (t - m) / (1 - m);
  }
  return {of[0] * a.x + of[1] * b.x + of[2] * c.x, of[0] * a.y + of[1] * b.y + of[2] * c.y,
          of[0] * a.z + of[1] * b.z + of[2] * c.z};
}

/// A point that moves by a little, as Gaussian noise does, more often near than far.
Vec3 noise(Random& random, double size) {
  return plus({}, size * std::abs(std::normal_distribution<double>()(random)),
              random_direction(random));
}

double root(float squared) { return std::sqrt(static_cast<double>(squared)); }

/// Calls visit(motion, node index) for nodes of slow paths: all of them, or every second, and fewer
/// of those farther down.
template <typename Visit>
void for_nodes(Random& random, bool all, const Visit& visit) {
  for (int path = 0; path < 12; ++path) {
    std::vector<Pose> poses = random_slow_path(random, 64 + 40 * static_cast<std::size_t>(path));
    if (path == 0) poses.assign(64, poses[7]);
    const MotionTree motion(poses, kModel);
    for (std::uint32_t at = 0; at < motion.nodes().size(); at += all ? 1 : 1 + at / 20) {
      visit(motion, poses, at);
    }
  }
}

}  // namespace

TEST_CASE("poses pull places back to their node's parabola within its error") {
  Random random(1);
  std::size_t smooth = 0;
  std::optional<MotionCurves> curves;
  for_nodes(random, true, [&](const MotionTree& motion, const auto& poses, std::uint32_t at) {
    if (at == 0) curves.emplace(motion, kModel, kReach, 0.1, 2);
    const MotionNode& node = motion.nodes()[at];
    const MotionCurve& curve = curves->data()[at];
    if (!curve.is_smooth()) return;
    smooth += node.count > 2 ? 1 : 0;
    const double error = curve.is_one_place() ? 0 : static_cast<double>(curve.error);
    for (int k = 0; k < 10; ++k) {
      const auto i = static_cast<std::uint32_t>(below(random, node.count));
      const Vec3 y = random_point(random, kModel.grown(kReach));
      const Vec3 e = transform(poses[node.first + i], y);
      const long double t = node.count > 1 ? i / (node.count - 1.0L) : 0;
      REQUIRE(place_at(motion.ref(), node, e, t).distance_to(y) <= error + 1e-12L);
    }
  });
  CHECK(smooth > 500);
}

TEST_CASE("a point's curve bounds distances and the places within them") {
  Random random(2);
  std::size_t bounded = 0, only_middles = 0;
  for_nodes(random, false, [&](const MotionTree& motion, const auto& poses, std::uint32_t at) {
    const MotionNode& node = motion.nodes()[at];
    const MotionTreeRef ref = motion.ref();
    const Vec3 e = transform(poses[node.mid], random_point(random, kModel.grown(kReach)));
    const PointCurve curve(ref, node, e, kReach);
    only_middles += curve.beside() > 0 ? 1 : 0;
    PointPacket packet{};
    packet.count = PointPacket::kMost;
    for (std::uint32_t i = 0; i < packet.count; ++i) {
      const Vec3 on = place_at(ref, node, e, uniform(random, -0.1, 1.1)).rounded();
      const Vec3 m = plus(on, 1, noise(random, i < 4 ? 0.01 : 0.2));
      for (int k = 0; k < 3; ++k) packet.at[k][i] = m[k];
    }
    double squared[PointPacket::kMost];
    curve.to_points(packet, squared);
    for (std::uint32_t i = 0; i < packet.count; ++i) {
      const Vec3 m = packet.point(i);
      const double within = 0.3 * kReach;
      const PointCurve::Places places = curve.places(m, within * within);
      for (int k = 0; k <= 100; ++k) {
        const long double t = k / 100.0L, distance = place_at(ref, node, e, t).distance_to(m);
        if (distance > kReach) continue;
        ++bounded;
        const double lower = squared[i] > 0 ? std::sqrt(squared[i]) : 0;
        REQUIRE(lower <= distance + curve.beside() + 1e-9L);
        if (distance + curve.beside() > within) continue;
        REQUIRE(places.low <= t + 1e-7L);
        REQUIRE(places.high >= t - 1e-7L);
      }
    }
    const Vec3 middle = place_at(ref, node, e, 0.5L).rounded();
    REQUIRE(std::sqrt(least_squared_distance(curve.box(), middle)) <= curve.beside() + 1e-9);
  });
  CHECK(bounded > 10000);
  CHECK(only_middles > 10);
}

TEST_CASE("a triangle's bound from a curve is below its distance from every place of it") {
  Random random(3);
  std::size_t above = 0, clear = 0, close = 0, off_pose = 0;
  for_nodes(random, false, [&](const MotionTree& motion, const auto& poses, std::uint32_t at) {
    const MotionNode& node = motion.nodes()[at];
    const MotionTreeRef ref = motion.ref();
    const Vec3 e = transform(poses[node.mid], random_point(random, kModel.grown(kReach)));
    const TriangleCurve curve(ref, node, e);
    const auto place = [&](double t) { return place_at(ref, node, e, t).rounded(); };
    // Where a path jumps by a kilometre, floats round by more than bounds are loose elsewhere.
    const bool is_long = length_of(difference(place(0.5), place(0))) > 20;
    Triangle triangles[FloatPacket::kMost];
    for (std::uint32_t i = 0; i < FloatPacket::kMost; ++i) {
      for (Vec3* corner : {&triangles[i].a, &triangles[i].b, &triangles[i].c}) {
        *corner = plus(place(uniform(random, -0.1, 1.1)), 1, noise(random, i < 8 ? 0.05 : 0.5));
      }
    }
    const FloatPacket packet = FloatPacket::of(triangles, FloatPacket::kMost, 0);
    float squared[FloatPacket::kMost], of_parts[TriangleCurve::kMostPlaces],
        of_places[TriangleCurve::kMostPlaces];
    curve.to_triangles(packet, squared);
    for (std::uint32_t i = 0; i < FloatPacket::kMost; ++i) {
      curve.from_parts(packet, i, 13, 0.01F, of_parts);
      curve.from_places(packet, i, 85, 0.01F, of_places);
      double least = kInfinity;
      for (int k = 0; k <= 100; ++k) {
        const double distance = std::sqrt(squared_distance(place(k / 100.0), triangles[i]));
        least = std::min(least, distance);
        above += root(squared[i]) > distance + 1e-9;
        above += root(of_parts[k / 13]) > distance + 1e-9;
        if (k < 85) continue;
        above += root(of_places[k - 85]) > distance + 1e-9;
        off_pose += !(is_long || root(of_places[k - 85]) > distance - 2e-3);
      }
      clear += least > 0.05;
      close += least > 0.05 && root(squared[i]) > 0.8 * least;
    }
  });
  check_equal(above, 0);
  check_equal(off_pose, 0);
  CHECK(clear > 1000);
  CHECK(close > clear / 2);
}

TEST_CASE("bounds from curves hold for triangles and paths of every size") {
  Random random(9);
  std::size_t above = 0, positive = 0;
  for (int i = 0; i < 6'000; ++i) {
    const Triangle t = random_triangle(random);
    // The path's steps are far shorter or longer than the triangle, and a little bent.
    const double far = (longest_edge(t) + 1e-12) * std::pow(10.0, uniform(random, -3, 3));
    const Vec3 way = plus({}, far, random_direction(random));
    const Vec3 bend = plus({}, 0.1 * far * uniform(random, 0, 1), random_direction(random));
    const Vec3 start = plus(random_place_at(random, t), -uniform(random, 0, 1), way);
    constexpr int kPoses = 41;
    constexpr float kStep = 1.0F / (kPoses - 1);
    std::vector<Pose> poses;
    for (int k = 0; k < kPoses; ++k) {
      const double s = k / (kPoses - 1.0);
      poses.push_back(translation(plus(plus({}, -s, way), -s * (1 - s), bend)));
    }
    const MotionTree motion(poses, Box{t.a, t.a});
    const MotionTreeRef ref = motion.ref();
    const TriangleCurve curve(ref, motion.nodes()[0], start);
    const FloatPacket packet = FloatPacket::of(&t, 1, 0);
    float of_run[FloatPacket::kMost], of_parts[TriangleCurve::kMostPlaces],
        of_places[TriangleCurve::kMostPlaces];
    curve.to_triangles(packet, of_run);
    curve.from_parts(packet, 0, 4, kStep, of_parts);
    for (int k = 0; k < kPoses; ++k) {
      if (k % 16 == 0) {
        curve.from_places(packet, 0, static_cast<std::uint32_t>(k), kStep, of_places);
      }
      const Vec3 x = ref.inverse_poses[k].apply(start);
      const double distance = std::sqrt(squared_distance(x, t));
      const double most = distance + 2 * triangle_error(distance, longest_edge(t)) +
                          64 * kUnitRoundoff * (length_of(x) + far);
      for (const float bound : {of_run[0], of_parts[k / 4], of_places[k % 16]}) {
        above += root(bound) > most;
      }
      positive += of_run[0] > 0 && of_parts[k / 4] > 0 && of_places[k % 16] > 0;
    }
  }
  check_equal(above, 0);
  CHECK(positive > 50'000);
}
