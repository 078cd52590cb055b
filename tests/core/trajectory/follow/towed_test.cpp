// Towed bodies against an integration of their differential equation in small steps.
#include <cmath>
#include <numbers>

#include "clearway/error.hpp"
#include "clearway/follow.hpp"
#include "core/trajectory/paths.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"

using namespace clearway;
using namespace clearway::test;
using std::numbers::pi;

namespace {

/// Follows the path with bodies named "0", "1" and so on.
std::vector<Body> follow_all(const std::vector<Pose>& path, const std::vector<BodyMount>& mounts,
                             std::vector<Message>* told = nullptr) {
  std::vector<Body> bodies;
  for (std::size_t i = 0; i < mounts.size(); ++i) {
    bodies.push_back(
        {.name = std::to_string(i), .model = {{0, 0, 0}}, .poses = {}, .path_pose = {}});
  }
  return follow(std::move(bodies), path, mounts, told);
}

/// A point on the body's x axis.
Vec3 on_axis(const Pose& pose, double x) { return pose.position() + x * axis_of(pose, 0); }

double heading_of(const Pose& pose) { return std::atan2(axis_of(pose, 0).y, axis_of(pose, 0).x); }

double radius_of(const Vec3& place, double radius) { return std::hypot(place.x, place.y - radius); }

Vec3 ahead(double heading) { return {std::cos(heading), std::sin(heading), 0}; }
Vec3 left(double heading) { return {-std::sin(heading), std::cos(heading), 0}; }

/// A curve in the plane that winds, or is made of lines and arcs, and a vehicle on it that may look
/// aside by an angle.
struct Drive {
  double fast, slow, aside, turned;
  bool arcs;

  explicit Drive(Random& random)
      : fast(uniform(random, 5, 9)),
        slow(uniform(random, 15, 30)),
        aside(uniform(random, 0.1, 0.4)),
        turned(below(random, 2) == 0 ? 0 : uniform(random, -1.2, 1.2)),
        arcs(below(random, 3) == 0) {}

  double curvature(double s) const {
    if (arcs) return static_cast<int>(s / 8) % 3 == 1 ? aside / 4 : 0;
    return aside / fast * std::cos(s / fast) - aside / slow * std::sin(s / slow);
  }
};

/// The headings and hitches of bodies that are towed one behind the other.
struct Towed {
  double at, hitch, axle;  ///< as of BodyTowed: on the body ahead, and on its own
  double heading = 0;
};

/// How fast everything turns where the vehicle has a heading, by the velocity of each hitch.
std::vector<double> rates(const Drive& drive, double s, double heading,
                          const std::vector<double>& headings, const std::vector<Towed>& bodies) {
  std::vector<double> out;
  double rate = drive.curvature(s), frame = heading + drive.turned, from = 0;
  Vec3 velocity = ahead(heading);  // of the place `from` on the axis of the body ahead
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    velocity = velocity + rate * (bodies[i].at - from) * left(frame);
    rate = dot(velocity, left(headings[i])) / (bodies[i].hitch - bodies[i].axle);
    out.push_back(rate);
    frame = headings[i];
    from = bodies[i].hitch;
  }
  return out;
}

}  // namespace

TEST_CASE("towed bodies are where an integration of their motion in steps of 2 mm has them") {
  Random random(17);
  for (int scene = 0; scene < 30; ++scene) {
    CAPTURE(scene);
    const Drive drive(random);
    const Vec3 shift = scene % 3 == 0 ? Vec3{5e5, 4.6e6, 120} : Vec3{0, 0, 0};
    std::vector<Towed> bodies(1 + below(random, 3));
    for (Towed& body : bodies) {
      body = {.at = uniform(random, -1.2, 1),
              .hitch = uniform(random, 4, 9),
              .axle = uniform(random, -0.5, 1.5),
              .heading = drive.turned};
    }
    // The vehicle has poses of its own, and the path only tells how many; the list is turned round.
    std::vector<Pose> own;
    std::vector<std::vector<double>> expected(bodies.size());
    constexpr int kSteps = 50;  // from one pose to the next, which is 0.1 m
    constexpr double h = 0.1 / kSteps;
    double heading = 0;
    Vec3 place = shift;
    for (int i = 0; i <= 400 * kSteps; ++i) {
      if (i % kSteps == 0) {
        own.push_back(headed(heading + drive.turned, place));
        for (std::size_t k = 0; k < bodies.size(); ++k) expected[k].push_back(bodies[k].heading);
      }
      const double s = h * i + 1e-9, half = heading + h / 2 * drive.curvature(s + h / 4),
                   next = heading + h * drive.curvature(s + h / 2);
      const auto moved = [&](const std::vector<double>& by, double part) {
        std::vector<double> out;
        for (std::size_t k = 0; k < bodies.size(); ++k) {
          out.push_back(bodies[k].heading + (by.empty() ? 0 : part * by[k]));
        }
        return out;
      };
      const auto k1 = rates(drive, s, heading, moved({}, 0), bodies);
      const auto k2 = rates(drive, s + h / 2, half, moved(k1, h / 2), bodies);
      for (std::size_t k = 0; k < bodies.size(); ++k) bodies[k].heading += h * k2[k];
      place = place + h / 6 * (ahead(heading) + 4 * ahead(half) + ahead(next));
      heading = next;
    }
    std::vector<BodyMount> mounts;
    std::vector<Body> all;
    for (std::size_t k = bodies.size(); k-- > 0;) {
      const std::string tower = k == 0 ? "tower" : std::to_string(k - 1);
      mounts.push_back(BodyTowed{tower, bodies[k].at, bodies[k].hitch, bodies[k].axle});
      all.push_back(
          {.name = std::to_string(k), .model = {{0, 0, 0}}, .poses = {}, .path_pose = {}});
    }
    mounts.push_back(BodyOwnPoses{});
    all.push_back({.name = "tower", .model = {{0, 0, 0}}, .poses = own, .path_pose = {}});
    all = follow(std::move(all), straight_poses(own.size()), mounts);
    CHECK(all.back().poses == own);
    const double apart = scene % 3 == 0 ? 1e-8 : 1e-12;
    for (std::size_t k = 0; k < bodies.size(); ++k) {
      const auto& poses = all[bodies.size() - 1 - k].poses;
      const auto& tower = k == 0 ? own : all[bodies.size() - k].poses;
      REQUIRE(poses.size() == own.size());
      for (std::size_t i = 0; i < own.size(); ++i) {
        check_near(heading_of(poses[i]), expected[k][i], 2e-5);
        check_near(on_axis(poses[i], bodies[k].hitch), on_axis(tower[i], bodies[k].at), apart);
      }
    }
  }
}

TEST_CASE("bodies on pivots and at stations tow as they move on the path") {
  const double R = 60, L = 7;
  const auto bodies = follow_all(
      circle_poses(1 / R, 0.1, 2200),
      {BodyPivots{6, -4}, BodyTowed{"0", -5.5, L, 0}, BodyStation{-3}, BodyTowed{"2", -1, L, 0}});
  // The tower is a chord, whose origin is not its middle.
  const double chord = 2 * R * std::sin(10 / R / 2), middle = R * std::cos(10 / R / 2);
  const double hitch = -chord / 2 + 0.4 * chord - 5.5;
  const double radius = std::sqrt(middle * middle + hitch * hitch - L * L);
  // At both ends a pivot is off the path, and so is the trailer.
  CHECK(bodies[1].path_pose == bodies[0].path_pose);
  check_equal(bodies[1].path_pose.front(), 40);
  check_equal(bodies[3].path_pose.front(), 30);
  for (const std::size_t i : {1900u, 2000u}) {
    check_near(radius_of(bodies[1].poses[i - 40].position(), R), radius, 1e-6);
    check_near(radius_of(bodies[3].poses[i - 30].position(), R), std::sqrt(R * R + 1 - L * L),
               1e-6);
  }
}

TEST_CASE("a towed body has the heights and the roll of the way that its hitch has gone") {
  // A winding path with hills, and a roll that changes along it.
  const double L = 6.5, hitch = 8, axle = 1.5, at = -0.8;
  const auto height = [](double s) { return 0.8 * std::sin(s / 14) + 0.03 * s; };
  const auto roll = [](double s) { return 0.1 * std::sin(s / 11 + 1); };
  const auto heading = [](double s) { return 0.4 * std::sin(s / 20); };
  std::vector<Pose> path;
  // The places of the plane are summed in small steps; `s` is the way in the plane.
  Vec3 place{0, 0, 0};
  for (int i = 0; i <= 60'000; ++i) {
    const double s = i / 1000.0, slope = 0.8 / 14 * std::cos(s / 14) + 0.03;
    place.z = height(s);
    if (i % 100 == 0) {
      path.push_back(
          turned_at(about_z(heading(s)) * about_y(-std::atan(slope)) * about_x(roll(s)), place));
    }
    place = place + 1e-3 * ahead(heading(s + 5e-4));
  }
  const Body body = follow_all(path, {BodyTowed{"", at, hitch, axle}})[0];
  // The hitch's way, its height and its up, summed over the poses.
  std::vector<double> way{0};
  std::vector<Vec3> place_of, up_of;
  for (const Pose& pose : path) {
    place_of.push_back(on_axis(pose, at));
    up_of.push_back(axis_of(pose, 2));
    if (place_of.size() < 2) continue;
    const Vec3 step = place_of.back() - place_of[place_of.size() - 2];
    way.push_back(way.back() + std::hypot(step.x, step.y));
  }
  for (std::size_t i = 0; i < path.size(); ++i) {
    Vec3 there = place_of[0], up_there = up_of[0];
    for (std::size_t j = 1; j <= i; ++j) {
      if (!(way[j] > way[i] - L && way[j - 1] <= way[i] - L)) continue;
      const double share = (way[i] - L - way[j - 1]) / (way[j] - way[j - 1]);
      there = place_of[j - 1] + share * (place_of[j] - place_of[j - 1]);
      up_there = up_of[j - 1] + share * (up_of[j] - up_of[j - 1]);
    }
    const Pose& pose = body.poses[i];
    const Vec3 x = axis_of(pose, 0), mean = 0.5 * (up_of[i] + up_there);
    const Vec3 up = mean + -dot(mean, x) * x;
    const double rise = place_of[i].z - there.z;
    check_near(on_axis(pose, hitch), place_of[i], 1e-12);
    check_near(x.z, rise / std::hypot(L, rise), 2e-6);
    check_near(on_axis(pose, axle).z, place_of[i].z - L * x.z, 1e-12);
    check_near(axis_of(pose, 2), 1 / length(up) * up, 2e-6);
    check_near(axis_of(pose, 1), cross(axis_of(pose, 2), x), 1e-14);
  }
}

TEST_CASE("a towed body that is pushed for more than 0.1 m is refused with the place") {
  const double back = GENERATE(0.095, 0.105);
  std::vector<Pose> path = straight_poses(201, 0.1);
  for (int i = 1; i <= 5; ++i) path.push_back(translation({20 - back * i / 5, 0, 0}));
  for (int i = 1; i <= 100; ++i) path.push_back(translation({20 - back + 0.1 * i, 0, 0}));
  const BodyMount mount = BodyTowed{"", -1, 5, 0};
  if (back > 0.1) {
    check_refused<InputError>([&] { follow_all(path, {mount}); },
                              "body 0:  ... from pose 200 of the path ... 20 m along it");
    // So is one whose path is driven against its x axis, from its first pose on.
    check_refused([&] { follow_all(straight_poses(51, -0.1), {mount}); },
                  "from pose 0 of the path ... along its x axis");
    return;
  }
  std::vector<Message> told;
  const auto bodies = follow_all(path, {mount}, &told);
  check_equal(codes_of(told), "note body-transient");
  for (std::size_t i = 0; i < path.size(); ++i) {
    check_near(bodies[0].poses[i].position(), path[i].position() - Vec3{6, 0, 0}, 1e-12);
  }
}

TEST_CASE("a recorded path that stands and jitters by millimetres leaves a trailer in its place") {
  Random random(91);
  std::vector<Pose> clean = circle_poses(1.0 / 40, 0.05, 800), standing_still;
  // The path climbs, which shows how much way the hitch has gone.
  for (int i = 0; i < 800; ++i) clean[i].translation[2] = 0.0025 * i;
  for (int k = 0; k < 3000; ++k) {
    const Vec3 off{uniform(random, -3e-3, 3e-3), uniform(random, -3e-3, 3e-3), 0};
    standing_still.push_back(
        headed(heading_of(clean[400]) + uniform(random, -1e-3, 1e-3), clean[400].position() + off));
  }
  standing_still.push_back(clean[400]);
  std::vector<Pose> path = clean;
  path.insert(path.begin() + 401, standing_still.begin(), standing_still.end());
  std::vector<Message> told;
  const BodyMount tow = BodyTowed{"", -0.6, 8, 0};
  const auto jittering = follow_all(path, {tow}, &told), still = follow_all(clean, {tow});
  check_equal(codes_of(told), "body-transient");  // because the path begins in a bend
  const Pose& standing = jittering[0].poses[3400];
  CHECK(distance(standing.position(), still[0].poses[400].position()) < 0.03);
  CHECK(distance(axis_of(standing, 0), axis_of(still[0].poses[400], 0)) < 0.004);
  // The slope of the body is that of the ramp: the way that only jitters is not counted.
  check_near(axis_of(standing, 0).z, axis_of(still[0].poses[400], 0).z, 3e-4);
}

TEST_CASE("a turn on the spot drags a trailer along the arc of its hitch") {
  // The hitch, 2 m behind, goes on a circle of 2 m: its curvature as seen from the way is -1 / 2.
  std::vector<Pose> path{rotation({0, 0, 1}, 0, {0, 0, 0})};
  for (int i = 1; i <= 5; ++i) path.push_back(rotation({0, 0, 1}, 0.1 * i, {0, 0, 0}));
  const Body body = follow_all(path, {BodyTowed{"", -2, 1.5, 0}})[0];
  // By Heun's method in 200,000 steps.
  check_near(heading_of(body.poses.back()), -0.5422572495, 1e-4);
}

TEST_CASE("a hitch that does not move leaves a towed body as it is") {
  std::vector<Pose> path = circle_poses(1.0 / 20, 0.1, 100);
  path.insert(path.begin() + 60, 5, path[60]);
  const auto body = follow_all(path, {BodyTowed{"", 0, 5, 0}})[0];
  for (int i = 61; i <= 65; ++i) CHECK(body.poses[i] == body.poses[60]);
  const auto alone = follow_all({headed(0.3, {1, 2, 3})}, {BodyTowed{"", -1, 5, 0}})[0];
  check_near(heading_of(alone.poses[0]), 0.3, 1e-15);
}

TEST_CASE("the first three lengths are said to be transient, with a warning in a bend") {
  struct Row {
    double straight, curvature;  // metres before the bend, 1/m
    const char* codes;
  };
  // A body of 5 m, for which 15 m matter.
  for (const Row& row :
       {Row{0, 0.025, "body-transient"}, Row{0, -0.025, "body-transient"},
        Row{10, 0.025, "body-transient"}, Row{0, 0, "note body-transient"},
        Row{0, 0.005, "note body-transient"}, Row{16, 0.025, "note body-transient"}}) {
    CAPTURE(row.straight, row.curvature);
    std::vector<Pose> path;
    Vec3 at{0, 0, 0};
    double heading = 0;
    for (int i = 0; i < 500; ++i) {
      path.push_back(headed(heading, at));
      if (0.1 * i >= row.straight) heading += 0.1 * row.curvature;
      at = at + 0.1 * ahead(heading);
    }
    std::vector<Message> told;
    follow_all(path, {BodyTowed{"", 0, 5, 0}}, &told);
    check_equal(codes_of(told), row.codes);
    check_says(told.at(0).text, "poses 0-1");
    REQUIRE(told[0].stretches.size() == 1);
    check_equal(told[0].stretches[0].first, 0);
    check_near(static_cast<double>(told[0].stretches[0].last), 150, 1);
  }
}

TEST_CASE("poses of a camera or of a vehicle that looks aside are warned of where they tow") {
  std::vector<Pose> camera, sideways;
  for (int i = 0; i < 30; ++i) {  // x right, y down, z forward
    camera.push_back({{0, 0, 1, -1, 0, 0, 0, -1, 0}, {0.3 * i, 0, 0}});
    sideways.push_back(headed(1.3, {0.3 * i, 0, 0}));
  }
  for (const auto& poses : {camera, sideways}) {
    std::vector<Message> told;
    follow_all(poses, {BodyTowed{"", 0, 5, 0}}, &told);
    CHECK(std::ranges::count_if(told, [](const Message& message) {
            return message.code == "body-turned" && message.severity == Message::Severity::kWarning;
          }) == 1);
  }
}

TEST_CASE("towers that make no sense are refused by name") {
  const auto path = circle_poses(1.0 / 40, 0.1, 50);
  const std::pair<std::vector<BodyMount>, const char*> rows[] = {
      {{BodyTowed{"x", 0, 5, 0}}, "body 0: no body is named \"x\""},
      {{BodyTowed{"0", 0, 5, 0}}, "body 0: the body would tow itself"},
      {{BodyStation{0}, BodyTowed{"2", 0, 5, 0}, BodyTowed{"3", 0, 5, 0}, BodyTowed{"1", 0, 5, 0}},
       "in a ring"},
      {{BodyTowed{"", 0, 5, 5}}, "expected the axle behind the hitch"},
      {{BodyTowed{"", 0, 0, 5}}, "expected the axle behind the hitch"},
      {{BodyTowed{"", std::nan(""), 5, 0}}, "expected at most 1000 km"},
      {{BodyTowed{"", 0, 1e308, -1e308}}, "expected at most 1000 km"},
      {{BodyOwnPoses{}}, "keeps 0 poses"}};
  for (const auto& [mounts, words] : rows) {
    check_refused<UsageError>([&] { follow_all(path, mounts); }, words);
  }
  CHECK_THROWS_AS(follow(std::vector<Body>(2), path, {BodyStation{0}}), UsageError);
  std::vector<Pose> mirrored = path;
  for (Pose& pose : mirrored) pose = stretched(pose, {1, -1, 1});
  check_refused([&] { follow_all(mirrored, {BodyTowed{"", 0, 5, 0}}); }, "mirror");
  check_refused(
      [&] {
        follow_all(straight_poses(2, 2e6), {BodyTowed{"", 0, 5, 0}});
      },
      "at most 1000 km");
}
