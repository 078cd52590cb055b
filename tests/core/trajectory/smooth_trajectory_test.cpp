// Smoothing, against an independent brute force over random paths, and what its error has to cover.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "clearway/error.hpp"
#include "clearway/smooth.hpp"
#include "core/trajectory/paths.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/scenes.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

const Box kCar{{-1, -0.9, 0}, {3.5, 0.9, 1.6}};

/// A pose at (x, y, z) that is turned about z, and then tilted about its own x axis.
Pose pose_at(double x, double y, double z, double heading, double roll = 0) {
  return turned_at(about_z(heading) * about_x(roll), {x, y, z});
}

Vec3 moved(const Pose& pose, const Vec3& m) { return pose.rotated(m) + pose.position(); }

/// Where a model point is on a path whose poses stand at these places, by straight ways.
Vec3 point_at(const std::vector<Pose>& poses, const std::vector<double>& places, double at,
              const Vec3& m) {
  const auto after = std::ranges::upper_bound(places, at);
  const auto k = static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(
      after - places.begin() - 1, 0, static_cast<std::ptrdiff_t>(places.size()) - 1));
  if (k + 1 == places.size()) return moved(poses[k], m);
  const double way = places[k + 1] - places[k];
  const double part = way > 0 ? std::clamp((at - places[k]) / way, 0.0, 1.0) : 0;
  const Vec3 a = moved(poses[k], m);
  return a + part * (moved(poses[k + 1], m) - a);
}

/// Points of a box, its corners among them.
std::vector<Vec3> points_of(Random& random, const Box& box) {
  std::vector<Vec3> points;
  for (int i = 0; i < 8; ++i) {
    points.push_back({(i & 1) != 0 ? box.hi.x : box.lo.x, (i & 2) != 0 ? box.hi.y : box.lo.y,
                      (i & 4) != 0 ? box.hi.z : box.lo.z});
  }
  for (int i = 0; i < 4; ++i) points.push_back(random_point(random, box));
  return points;
}

/// How far the model has moved up to each pose: the sum of the greatest ways of its corners.
std::vector<double> ways_of(Random& random, const std::vector<Pose>& poses, const Box& model) {
  std::vector<double> out{0};
  const std::vector<Vec3> points = points_of(random, model);
  for (std::size_t i = 1; i < poses.size(); ++i) {
    double most = 0;
    for (const Vec3& m : points) {
      most = std::max(most, length(moved(poses[i], m) - moved(poses[i - 1], m)));
    }
    out.push_back(out.back() + most);
  }
  return out;
}

/// The way at each of some places between poses.
std::vector<double> ways_at(const std::vector<double>& ways, const std::vector<double>& places) {
  std::vector<double> out;
  for (const double place : places) {
    const auto i = std::min(static_cast<std::size_t>(place), ways.size() - 1);
    const double part = place - static_cast<double>(i);
    out.push_back(part > 0 ? ways[i] + part * (ways[i + 1] - ways[i]) : ways[i]);
  }
  return out;
}

/// Checks all that smoothing promises, by dense samples of both paths.
void check_promises(const std::vector<Pose>& given, const SmoothParameters& asked,
                    const std::optional<Box>& model, const SmoothPath& path) {
  Random random(3);
  REQUIRE(path.poses.size() == path.place.size());
  REQUIRE(!path.poses.empty());
  CHECK(path.largest_deviation <= asked.within);
  CHECK(path.mean_deviation <= path.largest_deviation);
  check_equal(path.error_between_poses(), path.largest_deviation);
  check_equal(path.error_at_poses(), path.largest_deviation + path.largest_step / 2);
  CHECK(std::ranges::is_sorted(path.place));
  CHECK(given[static_cast<std::size_t>(path.place.front())] == given[0]);
  check_equal(path.place.back(), static_cast<double>(given.size() - 1));
  const double step = asked.step > 0 ? asked.step : 0.1;
  CHECK(path.largest_step <= step);
  const Box box = model.value_or(Box{{0, 0, 0}, {0, 0, 0}});
  const std::vector<double> ways = ways_of(random, given, box),
                            new_ways = ways_at(ways, path.place);
  double deviation = 0, longest = 0;
  for (const Vec3& m : points_of(random, box)) {
    for (std::size_t k = 0; k + 1 < path.poses.size(); ++k) {
      longest = std::max(longest, length(moved(path.poses[k + 1], m) - moved(path.poses[k], m)));
    }
    const auto compare = [&](double at) {
      deviation = std::max(
          deviation, length(point_at(path.poses, new_ways, at, m) - point_at(given, ways, at, m)));
    };
    for (const double at : ways) compare(at);
    for (const double at : new_ways) compare(at);
    for (int i = 0; i < 4000; ++i) compare(uniform(random, 0, ways.back()));
  }
  CHECK(longest <= path.largest_step);
  CHECK(deviation <= path.largest_deviation + 1e-8);
  CHECK(path.largest_deviation <= 1.01 * deviation + 1e-6);
}

SmoothPath smoothed(const std::vector<Pose>& given, double within, double step = 0,
                    const std::optional<Box>& model = kCar) {
  const SmoothParameters asked{.within = within, .step = step};
  const SmoothPath path = smooth_trajectory(given, asked, model);
  check_promises(given, asked, model, path);
  return path;
}

double within(Random& random, double most) { return uniform(random, -most, most); }

/// A drive with bends, stops, turns on the spot and noise, and without jumps.
std::vector<Pose> random_drive(Random& random) {
  std::vector<Pose> poses;
  const Vec3 from = below(random, 3) == 0 ? Vec3{521234.25, 5412345.5, 312.75} : Vec3{0, 0, 0};
  const double jitter = below(random, 2) == 0 ? 0 : uniform(random, 0, 0.005);
  double x = from.x, y = from.y, z = from.z, heading = uniform(random, -3, 3), roll = 0;
  const double step = jitter > 0 ? uniform(random, 0.02, 0.07) : uniform(random, 0.02, 0.3);
  for (std::uint64_t leg = 1 + below(random, 5); leg > 0; --leg) {
    const std::uint64_t kind = below(random, 5), count = 2 + below(random, 60);
    const double bend = uniform(random, -0.3, 0.3), climb = uniform(random, -0.05, 0.05);
    for (std::uint64_t i = 0; i < count; ++i) {
      if (kind == 0) {
        heading += step / 4;  // on the spot
      } else if (kind > 1) {
        heading += kind == 2 ? 0 : bend * step;
        x += step * std::cos(heading);
        y += step * std::sin(heading);
        z += step * climb;
        roll += 0.01 * std::sin(0.1 * static_cast<double>(i));
      }
      poses.push_back(pose_at(x + within(random, jitter), y + within(random, jitter),
                              z + within(random, jitter), heading + within(random, jitter / 4),
                              roll));
    }
  }
  return poses;
}

}  // namespace

TEST_CASE("a smoothed path keeps its distance, everywhere and for every model point") {
  Random random(11);
  for (int i = 0; i < 60; ++i) {
    const std::vector<Pose> given = random_drive(random);
    smoothed(given, uniform(random, 0.03, 0.2), below(random, 2) == 0 ? 0 : 0.3);
  }
}

TEST_CASE("a straight path becomes one of four control points, with or without a model") {
  std::vector<Pose> given;
  for (int i = 0; i <= 400; ++i) given.push_back(pose_at(0.05 * i, 0.1 * i, 7, 0.3));
  for (const auto& model : {std::optional<Box>(kCar), std::optional<Box>()}) {
    const SmoothPath path = smoothed(given, 0.001, 0, model);
    check_equal(path.control_points, 4);
    CHECK(path.largest_deviation < 1e-9);
    CHECK(path.poses.size() < 480);
    for (const Pose& pose : path.poses)
      CHECK(std::equal(pose.rotation, pose.rotation + 9, given[0].rotation));
  }
}

TEST_CASE("noise of a centimetre on a known curve is taken off") {
  Random random(5);
  std::vector<Pose> given;
  for (int i = 0; i < 4000; ++i) {
    const double s = 0.02 * i;
    given.push_back(pose_at(s, 3 * std::sin(s / 12), 0, 0));
    for (double& value : given.back().translation) value += within(random, 0.01);
  }
  const SmoothPath path = smoothed(given, 0.04, 0, std::nullopt);
  CHECK(path.control_points < 40);
  double worst = 0, mean = 0;
  for (const Pose& pose : path.poses) {
    const auto& [x, y, z] = pose.translation;
    // To the true curve, by its slope here.
    const double aside = (y - 3 * std::sin(x / 12)) / std::hypot(1, std::cos(x / 12) / 4);
    const double away = std::hypot(aside, z);
    worst = std::max(worst, away);
    mean += away / static_cast<double>(path.poses.size());
  }
  CHECK(mean < 0.008);
  CHECK(worst < 0.03);
}

TEST_CASE("stops take no poses, and turns on the spot keep to the step") {
  std::vector<Pose> given;
  for (int i = 0; i <= 100; ++i) given.push_back(pose_at(0.05 * i, 0, 0, 0));
  for (int i = 0; i < 500; ++i) given.push_back(given.back());
  for (int i = 0; i <= 100; ++i) {
    given.push_back(pose_at(5, 0, 0, std::numbers::pi / 2 * i / 100));
  }
  for (int i = 0; i <= 100; ++i) given.push_back(pose_at(5, 0.05 * i, 0, std::numbers::pi / 2));
  const SmoothPath path = smoothed(given, 0.02, 0.1);
  CHECK(path.poses.size() < 1000);
  // The middle of the turn is there: the corner of the car in front goes 5.6 m.
  CHECK(std::ranges::any_of(path.poses, [](const Pose& pose) {
    return std::abs(std::atan2(pose.rotation[3], pose.rotation[0]) - std::numbers::pi / 4) < 0.03 &&
           std::hypot(pose.translation[0] - 5, pose.translation[1]) < 0.02;
  }));
  const std::vector<Pose> still(20, pose_at(1, 2, 3, 0.4));
  check_equal(smoothed(still, 0.01).poses.size(), 1);
  check_equal(smoothed({still[0]}, 0.01).poses.size(), 1);
  check_equal(smoothed({still[0]}, 0.01, 0, std::nullopt).poses.size(), 1);
}

TEST_CASE("what cannot be smoothed is refused") {
  std::vector<Pose> given;
  for (int i = 0; i < 50; ++i) given.push_back(pose_at(0.05 * i, 0, 0, 0.01 * i));
  std::vector<Pose> mirrored = given;
  for (double& value : mirrored[7].rotation) value = -value;
  struct Row {
    std::vector<Pose> poses;
    SmoothParameters asked;
    std::optional<Box> model;
    const char* words;
  };
  for (const Row& row :
       {Row{given, {.within = 0}, kCar, "above 0"},
        Row{given, {.within = 0.01, .step = -1}, kCar, "above 0"},
        Row{{}, {.within = 0.01}, kCar, "no poses"},
        Row{given, {.within = 1e-9}, kCar, "no curve of 65,536 control points"},
        Row{mirrored, {.within = 0.01}, Box{{0, 0, 0}, {1e-3, 1e-3, 1e-3}}, "pose 7"}}) {
    check_refused([&] { smooth_trajectory(row.poses, row.asked, row.model); }, row.words);
  }
}
