#include "core/sweep/point_curve.hpp"

#include <cmath>
#include <functional>
#include <memory>
#include <random>
#include <vector>

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
constexpr double kReach = 0.5, kSpacing = 0.1;

struct Place {
  long double x, y, z;
};

Pose turned(double angle, const Vec3& p) {
  return {{std::cos(angle), -std::sin(angle), 0, std::sin(angle), std::cos(angle), 0, 0, 0, 1},
          {p.x, p.y, p.z}};
}

/// The place on the parabola through three poses at t, by Lagrange's formula.
Place place_at(const MotionTreeRef& motion, const MotionNode& node, const Vec3& e, long double t) {
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

long double squared_distance_of(const Place& p, const Vec3& m) {
  return (p.x - m.x) * (p.x - m.x) + (p.y - m.y) * (p.y - m.y) + (p.z - m.z) * (p.z - m.z);
}

Vec3 random_place(std::mt19937_64& random, double beyond) {
  std::uniform_real_distribution<double> unit(0, 1);
  Vec3 place{};
  for (int k = 0; k < 3; ++k) {
    const double lo = kModel.lo[k] - beyond, hi = kModel.hi[k] + beyond;
    place[k] = lo + (hi - lo) * unit(random);
  }
  return place;
}

double root(float squared) { return std::sqrt(static_cast<double>(squared)); }

std::vector<Pose> path(std::uint32_t count, const std::function<Pose(double)>& at) {
  std::vector<Pose> poses;
  for (std::uint32_t i = 0; i < count; ++i) poses.push_back(at(i));
  return poses;
}

std::vector<std::vector<Pose>> paths() {
  auto jitter = std::make_shared<std::mt19937_64>(5);
  const auto noise = [jitter](double size) {
    return std::normal_distribution<double>(0, size)(*jitter);
  };
  return {
      path(200,
           [](double i) {
             return turned(0, {0.02 * i, 0, 0});
           }),
      path(500,
           [](double i) {
             return turned(0.001 * i, {0.02 * i, 0.0001 * i * i, 0});
           }),
      path(257,
           [](double i) {
             return turned(0, {0.0002 * i * i, 0, 0});
           }),
      path(300,
           [](double i) {
             return turned(0.3, {std::sin(0.02 * i), 0, 0});
           }),
      path(128,
           [](double i) {
             return turned(0.02 * i, {0, 0, 0});
           }),
      path(200,
           [&](double i) {
             return turned(0, {0.02 * i + noise(0.001), noise(0.001), 0});
           }),
      path(200,
           [&](double) {
             return turned(0.1, {noise(0.001), noise(0.001), noise(0.001)});
           }),
      path(100,
           [](double i) {
             return turned(0, {i < 50 ? 0.01 * i : 5 + 0.01 * i, 0, 0});
           }),
      path(64,
           [](double) {
             return turned(1, {1, 2, 3});
           }),
  };
}

}  // namespace

TEST_CASE("poses pull places back to their node's parabola within its error") {
  std::mt19937_64 random(1);
  std::size_t smooth = 0;
  for (const std::vector<Pose>& poses : paths()) {
    const MotionTree motion(poses, kModel);
    const MotionCurves curves(motion, kModel, kReach, kSpacing, 2);
    const MotionTreeRef ref = motion.ref();
    for (std::uint32_t at = 0; at < motion.nodes().size(); ++at) {
      const MotionNode& node = motion.nodes()[at];
      const MotionCurve& curve = curves.data()[at];
      if (!curve.is_smooth()) continue;
      smooth += node.count > 2 ? 1 : 0;
      const double error = curve.is_one_place() ? 0 : static_cast<double>(curve.error);
      for (int k = 0; k < 10; ++k) {
        const auto i = std::uniform_int_distribution<std::uint32_t>(0, node.count - 1)(random);
        const Vec3 y = random_place(random, kReach);
        const Vec3 e = transform(poses[node.first + i], y);
        const long double t = node.count > 1 ? i / (node.count - 1.0L) : 0;
        const long double off = squared_distance_of(place_at(ref, node, e, t), y);
        REQUIRE(std::sqrt(off) <= error + 1e-12L);
      }
    }
  }
  CHECK(smooth > 500);
}

TEST_CASE("a point's curve bounds distances and the places within them") {
  std::mt19937_64 random(2);
  std::size_t bounded = 0, only_middles = 0;
  for (const std::vector<Pose>& poses : paths()) {
    const MotionTree motion(poses, kModel);
    const MotionTreeRef ref = motion.ref();
    for (std::uint32_t at = 0; at < motion.nodes().size(); at += 1 + at / 20) {
      const MotionNode& node = motion.nodes()[at];
      const Vec3 e = transform(poses[node.mid], random_place(random, kReach));
      const PointCurve curve(ref, node, e, kReach);
      only_middles += curve.beside() > 0 ? 1 : 0;
      PointPacket packet{};
      packet.count = PointPacket::kMost;
      for (std::uint32_t i = 0; i < packet.count; ++i) {
        const Place near =
            place_at(ref, node, e, std::uniform_real_distribution<double>(-0.1, 1.1)(random));
        std::normal_distribution<double> beside(0, i < 4 ? 0.01 : 0.2);
        packet.at[0][i] = static_cast<double>(near.x) + beside(random);
        packet.at[1][i] = static_cast<double>(near.y) + beside(random);
        packet.at[2][i] = static_cast<double>(near.z) + beside(random);
      }
      double squared[PointPacket::kMost];
      curve.to_points(packet, squared);
      for (std::uint32_t i = 0; i < packet.count; ++i) {
        const Vec3 m = packet.point(i);
        const double within = 0.3 * kReach;
        const PointCurve::Places places = curve.places(m, within * within);
        for (int k = 0; k <= 100; ++k) {
          const long double t = k / 100.0L;
          const Place place = place_at(ref, node, e, t);
          const long double distance = std::sqrt(squared_distance_of(place, m));
          if (distance > kReach) continue;
          ++bounded;
          const double lower = squared[i] > 0 ? std::sqrt(squared[i]) : 0;
          REQUIRE(lower <= distance + curve.beside() + 1e-9L);
          if (distance + curve.beside() > within) continue;
          REQUIRE(places.low <= t + 1e-7L);
          REQUIRE(places.high >= t - 1e-7L);
        }
        const Box box = curve.box();
        const Place middle = place_at(ref, node, e, 0.5L);
        const Vec3 there{static_cast<double>(middle.x), static_cast<double>(middle.y),
                         static_cast<double>(middle.z)};
        REQUIRE(std::sqrt(least_squared_distance(box, there)) <= curve.beside() + 1e-9);
      }
    }
  }
  CHECK(bounded > 10000);
  CHECK(only_middles > 10);
}

TEST_CASE("a triangle's bound from a curve is below its distance from every place of it") {
  std::mt19937_64 random(3);
  std::size_t above = 0, clear = 0, close = 0, off_pose = 0;
  for (const std::vector<Pose>& poses : paths()) {
    const MotionTree motion(poses, kModel);
    const MotionTreeRef ref = motion.ref();
    for (std::uint32_t at = 0; at < motion.nodes().size(); at += 1 + at / 20) {
      const MotionNode& node = motion.nodes()[at];
      const Vec3 e = transform(poses[node.mid], random_place(random, kReach));
      const TriangleCurve curve(ref, node, e);
      const auto place = [&](double t) {
        const Place of = place_at(ref, node, e, t);
        return Vec3{static_cast<double>(of.x), static_cast<double>(of.y),
                    static_cast<double>(of.z)};
      };
      Triangle triangles[FloatPacket::kMost];
      for (std::uint32_t i = 0; i < FloatPacket::kMost; ++i) {
        std::normal_distribution<double> beside(0, i < 8 ? 0.05 : 0.5);
        Vec3* const corners[3] = {&triangles[i].a, &triangles[i].b, &triangles[i].c};
        for (Vec3* corner : corners) {
          *corner = place(std::uniform_real_distribution<double>(-0.1, 1.1)(random));
          for (int k = 0; k < 3; ++k) (*corner)[k] += beside(random);
        }
      }
      const FloatPacket packet = FloatPacket::of(triangles, FloatPacket::kMost, 0);
      float squared[FloatPacket::kMost], from_place[TriangleCurve::kMostPlaces];
      curve.to_triangles(packet, squared);
      for (std::uint32_t i = 0; i < FloatPacket::kMost; ++i) {
        double least = kInfinity;
        for (int k = 0; k <= 100; ++k) {
          const double distance = std::sqrt(squared_distance(place(k / 100.0), triangles[i]));
          above += root(squared[i]) > distance + 1e-9;
          least = std::min(least, distance);
        }
        clear += least > 0.05;
        close += least > 0.05 && root(squared[i]) > 0.8 * least;
        curve.from_parts(packet, i, 13, 0.01F, from_place);
        for (int k = 0; k <= 100; ++k) {
          const double distance = std::sqrt(squared_distance(place(k / 100.0), triangles[i]));
          above += root(from_place[k / 13]) > distance + 1e-9;
        }
        curve.from_places(packet, i, 85, 0.01F, from_place);
        for (int k = 0; k < 16; ++k) {
          const double exact = std::sqrt(squared_distance(place(0.85 + 0.01 * k), triangles[i]));
          above += root(from_place[k]) > exact + 1e-9;
          off_pose += !(root(from_place[k]) > exact - 2e-3);
        }
      }
    }
  }
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
    const double size = longest_edge(t) + 1e-12;
    // The path's steps are far shorter or longer than the triangle, and a little bent.
    const double far = size * std::pow(10.0, uniform(random, -3, 3));
    const Vec3 way = plus({}, far, random_direction(random));
    const Vec3 bend = plus({}, 0.1 * far * uniform(random, 0, 1), random_direction(random));
    const Vec3 start = plus(random_place_at(random, t), -uniform(random, 0, 1), way);
    std::vector<Pose> poses;
    constexpr int kPoses = 41;
    for (int k = 0; k < kPoses; ++k) {
      const double s = k / (kPoses - 1.0);
      const Vec3 at = plus(plus({}, -s, way), -s * (1 - s), bend);
      poses.push_back({{1, 0, 0, 0, 1, 0, 0, 0, 1}, {at.x, at.y, at.z}});
    }
    const MotionTree motion(poses, Box{t.a, t.a});
    const MotionTreeRef ref = motion.ref();
    const TriangleCurve curve(ref, motion.nodes()[0], start);
    const FloatPacket packet = FloatPacket::of(&t, 1, 0);
    float of_run[FloatPacket::kMost], of_parts[TriangleCurve::kMostPlaces],
        of_places[TriangleCurve::kMostPlaces];
    curve.to_triangles(packet, of_run);
    curve.from_parts(packet, 0, 4, 1.0F / (kPoses - 1), of_parts);
    for (int k = 0; k < kPoses; ++k) {
      if (k % 16 == 0) {
        curve.from_places(packet, 0, static_cast<std::uint32_t>(k), 1.0F / (kPoses - 1), of_places);
      }
      const Vec3 x = ref.inverse_poses[k].apply(start);
      const double distance = std::sqrt(squared_distance(x, t));
      const double most = distance + 2 * triangle_error(distance, longest_edge(t)) +
                          64 * kUnitRoundoff * (length_of(x) + far);
      above += root(of_run[0]) > most;
      above += root(of_parts[k / 4]) > most;
      above += root(of_places[k % 16]) > most;
      positive += of_run[0] > 0 && of_parts[k / 4] > 0 && of_places[k % 16] > 0;
    }
  }
  check_equal(above, 0);
  CHECK(positive > 50'000);
}
