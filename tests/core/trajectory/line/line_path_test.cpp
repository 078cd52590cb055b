#include "core/trajectory/line/line_path.hpp"

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "core/trajectory/paths.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

using Vertices = std::vector<PlanPoint>;

/// The angle between two headings, from -pi to pi.
double between(double a, double b) { return std::remainder(a - b, 2 * std::numbers::pi); }

/// The greatest difference between the direction that a plan gives and that in which its places
/// move, and the greatest difference between the way of a short step and its stations.
struct Disagreement {
  double heading = 0, way = 0;
};
Disagreement disagreement_of(const LinePlan& plan) {
  Disagreement worst;
  constexpr double kHalf = 1e-4;
  const double length = plan.length();
  for (int i = 1; i < 2000; ++i) {
    const double s = kHalf + (length - 2 * kHalf) * i / 2000;
    const PlanPoint step = plan.at(s + kHalf).at - plan.at(s - kHalf).at;
    worst.heading = std::max(worst.heading, std::abs(between(std::arg(step), plan.at(s).heading)));
    worst.way = std::max(worst.way, std::abs(std::abs(step) / (2 * kHalf) - 1));
  }
  return worst;
}

/// A line that turns to both sides, with legs of 20 to 60 m.
Vertices winding(unsigned seed, double most_turn, std::size_t count = 20) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> turn(-most_turn, most_turn), leg(20, 60);
  Vertices vertices{{-3, 7}};
  double heading = 0.3;
  while (vertices.size() < count) {
    vertices.push_back(vertices.back() + std::polar(leg(random), heading));
    heading += turn(random);
  }
  return vertices;
}

}  // namespace

TEST_CASE("arcs touch both legs and each other, and are as long as their angles say") {
  const Vertices vertices = winding(7, 1.6);
  const double radius = largest_radius(vertices) * 0.999;
  REQUIRE(short_legs(vertices, radius).empty());
  const LinePlan plan = LinePlan::rounded(vertices, radius);
  double length = 0;
  for (std::size_t i = 0; i + 1 < vertices.size(); ++i) {
    length += std::abs(vertices[i + 1] - vertices[i]);
  }
  for (std::size_t i = 1; i + 1 < vertices.size(); ++i) {
    const double turn = std::abs(turn_at(vertices, i)), tangent = radius * std::tan(turn / 2);
    length += radius * turn - 2 * tangent;
    CHECK(plan.arc_at(i) == Approx(radius * turn));
    // The middle of the arc lies on the line from the vertex to the centre.
    const PlanPoint middle = plan.at(plan.station_of(i)).at;
    CHECK(std::abs(middle - vertices[i]) == Approx(radius * (1 / std::cos(turn / 2) - 1)));
    const double half = plan.arc_at(i) / 2;
    for (const auto& [s, other] : {std::pair{plan.station_of(i) - half, i - 1},
                                   std::pair{plan.station_of(i) + half, i + 1}}) {
      const PlanPoint leg = vertices[other] - vertices[i];
      const PlanPoint expected = vertices[i] + tangent * leg / std::abs(leg);
      CHECK(std::abs(plan.at(s).at - expected) < 1e-11);
    }
  }
  CHECK(plan.length() == Approx(length).epsilon(1e-14));
  // The heading is that of the motion and jumps nowhere, the station is the way.
  const Disagreement worst = disagreement_of(plan);
  CHECK(worst.heading < 2e-5);
  CHECK(worst.way < 1e-6);
}

TEST_CASE("arcs that take whole legs make a circle of a square") {
  const Vertices square{{2, 0}, {4, 0}, {4, 4}, {0, 4}, {0, 0}, {2, 0}};
  CHECK(largest_radius(square) == Approx(2).epsilon(1e-15));
  CHECK(short_legs(square, 2).empty());
  const LinePlan plan = LinePlan::rounded(square, 2);
  CHECK(plan.length() == Approx(4 * std::numbers::pi).epsilon(1e-14));
  for (int i = 0; i <= 40; ++i) {
    const double s = plan.length() * i / 40;
    CHECK(std::abs(std::abs(plan.at(s).at - PlanPoint(2, 2)) - 2) < 1e-13);
    CHECK(std::abs(between(plan.at(s).heading, s / 2)) < 1e-12);
  }
}

TEST_CASE("legs that are too short for arcs are found with what they need") {
  const Vertices vertices{{0, 0}, {10, 0}, {10, 5}, {20, 5}, {20, 50}};
  CHECK(largest_radius(vertices) == Approx(2.5));
  CHECK(short_legs(vertices, 2.5).empty());
  const std::vector<ShortLeg> found = short_legs(vertices, 6);
  REQUIRE(found.size() == 2);
  check_equal(found[0].from, 1);
  check_equal(found[0].length, 5);
  CHECK(found[0].needed == Approx(12));
  check_equal(found[1].from, 2);
  check_equal(short_legs(vertices, 11).size(), 3);
  // No arc rounds a line that turns back.
  check_equal(short_legs(Vertices{{0, 0}, {10, 0}, {0, 0}}, 0.001).size(), 2);
}

TEST_CASE("a curve through the places of a circle is nearly that circle") {
  double before = 0;
  for (const int count : {36, 72, 144}) {
    constexpr double kRadius = 20;
    Vertices circle;
    for (int i = 0; i <= count; ++i)
      circle.push_back(std::polar(kRadius, 2 * std::numbers::pi * i / count));
    const LinePlan plan = LinePlan::through(circle);
    double away = 0, heading = 0;
    for (int i = 0; i <= 2000; ++i) {
      const PlanPlace place = plan.at(plan.length() * i / 2000);
      away = std::max(away, std::abs(std::abs(place.at) - kRadius));
      heading = std::max(
          heading, std::abs(between(place.heading, std::arg(place.at) + std::numbers::pi / 2)));
    }
    const double apart = 2 * std::numbers::pi / count;
    CHECK(away < kRadius * std::pow(apart, 4) / 31);
    CHECK(heading < std::pow(apart, 3) / 3.9);
    if (before > 0) CHECK(away < before / 15);
    before = away;
    CHECK(plan.length() == Approx(2 * std::numbers::pi * kRadius).epsilon(2e-5));
  }
}

TEST_CASE("a curve meets all vertices, with the direction and the length of its motion") {
  const Vertices vertices = winding(3, 0.2);
  const LinePlan plan = LinePlan::through(vertices);
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    CHECK(std::abs(plan.at(plan.station_of(i)).at - vertices[i]) < 1e-9);
  }
  const Disagreement worst = disagreement_of(plan);
  CHECK(worst.heading < 1e-5);
  CHECK(worst.way < 1e-6);
}

TEST_CASE("coordinates of a map cost no more than their own rounding") {
  const PlanPoint far(512'345.678, 5'401'234.567);
  Vertices near = winding(11, 0.25), moved;
  for (PlanPoint& vertex : near) {
    moved.push_back(vertex + far);
    vertex = moved.back() - far;  // with the rounding that the sum has
  }
  const auto compare = [&](const LinePlan& a, const LinePlan& b) {
    CHECK(a.length() == Approx(b.length()).epsilon(1e-13));
    for (int i = 0; i <= 500; ++i) {
      const double s = a.length() * i / 500;
      CHECK(std::abs(a.at(s).at + far - b.at(s).at) < 2e-9);
      CHECK(std::abs(between(a.at(s).heading, b.at(s).heading)) < 1e-9);
    }
  };
  compare(LinePlan::through(near), LinePlan::through(moved));
  compare(LinePlan::rounded(near, 15), LinePlan::rounded(moved, 15));
}

TEST_CASE("heights on a slope or a parabola stay on it") {
  const std::vector<double> stations{0, 3, 4, 9, 15, 16.5};
  const auto heights_of = [&](const auto& height) {
    std::vector<double> heights;
    for (const double s : stations) heights.push_back(height(s));
    return heights;
  };
  const auto slope = [](double s) { return 7 - 0.04 * s; };
  const auto parabola = [](double s) { return 100 + 0.002 * (s + 20) * (s + 20); };
  const HeightCurve even(stations, heights_of(slope)), bent(stations, heights_of(parabola));
  const HeightCurve flat(stations, std::vector<double>(6, 5.25));
  for (double s = 0; s <= 16.5; s += 0.125) {
    CHECK(std::abs(even.at(s).value - slope(s)) < 1e-14);
    CHECK(std::abs(even.at(s).slope + 0.04) < 1e-14);
    CHECK(std::abs(bent.at(s).value - parabola(s)) < 1e-12);
    CHECK(std::abs(bent.at(s).slope - 0.004 * (s + 20)) < 1e-12);
    check_equal(flat.at(s).value, 5.25);
    check_equal(flat.at(s).slope, 0);
  }
}

TEST_CASE("slopes of a line with corners are joined by parabolas as long as the arcs") {
  const Vertices vertices{{0, 0}, {50, 0}, {50, 50}};
  const LinePlan plan = LinePlan::rounded(vertices, 10);
  const std::vector<double> heights{1, 3, 2};
  const AlignmentProfile profile = rounded_profile(plan, heights, 10);
  const double middle = plan.station_of(1), half = 5 * std::numbers::pi / 2;
  const double g1 = 2 / middle, g2 = -1 / (plan.length() - middle);
  check_equal(profile.at(0).value, 1);
  CHECK(profile.at(10).value == Approx(1 + 10 * g1).epsilon(1e-14));
  CHECK(profile.at(middle - half).slope == Approx(g1));
  CHECK(profile.at(middle + half).slope == Approx(g2));
  CHECK(profile.at(middle).value == Approx(3 + (g2 - g1) * half / 4));
  CHECK(profile.at(plan.length()).value == Approx(2).epsilon(1e-14));
}

TEST_CASE("slopes that meet without a corner are joined by a curve of the radius, if it fits") {
  const Vertices vertices{{0, 0}, {50, 0}, {52, 0}, {100, 0}};
  const LinePlan plan = LinePlan::rounded(vertices, 30);
  check_equal(plan.arc_at(1), 0);
  const AlignmentProfile profile = rounded_profile(plan, std::vector<double>{0, 0, 0.2, 0.2}, 30);
  // The radius asks for 30 tan(5.7 / 2 degrees) = 1.496 m, and half of the leg is 1 m.
  check_equal(profile.at(49).slope, 0);
  CHECK(profile.at(51).slope == Approx(0.1));
  CHECK(profile.at(53).slope == Approx(0));
  CHECK(profile.at(50).value == Approx(0.1 / 4));
  const AlignmentProfile wide = rounded_profile(plan, std::vector<double>{0, 0, 0.2, 0.2}, 5);
  CHECK(wide.at(50 - 0.2494).slope == Approx(0).margin(1e-4));
  CHECK(wide.at(50).slope == Approx(0.05));
}

TEST_CASE("a pose stands on the line, with its heading, climb and roll") {
  const Vertices vertices{{0, 0}, {30, 40}};
  LinePath path{.plan = LinePlan::through(vertices), .height = 2.5};
  Pose pose = path.pose_at(10);
  check_near(pose.position(), {6, 8, 2.5}, 1e-13);
  check_near(pose.rotation, {0.6, -0.8, 0, 0.8, 0.6, 0, 0, 0, 1}, 1e-14);
  path.height.emplace<HeightCurve>(std::vector<double>{0, 50}, std::vector<double>{0, 5});
  path.cant.emplace(std::vector<CantPoint>{{0, 0.3}});
  pose = path.pose_at(10);
  CHECK(pose.translation[2] == Approx(1));
  CHECK(pose.rotation[6] == Approx(0.1 / std::hypot(1, 0.1)));
  // The left rail is 0.3 m higher than the right one, 1.5 m away.
  CHECK(pose.rotation[7] == Approx(0.2 / std::hypot(1, 0.1)).margin(1e-3));
  const Vec3 x = axis_of(pose, 0), y = axis_of(pose, 1);
  check_near(dot(x, y), 0, 1e-14);
  check_near(cross(x, y), axis_of(pose, 2), 1e-14);
}
