// Towed bodies against the closed forms of a tractrix and against figures with 30 digits.
#include <cmath>
#include <functional>
#include <numbers>

#include "clearway/error.hpp"
#include "clearway/follow.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/scenes.hpp"

using namespace clearway;
using namespace clearway::test;
using std::numbers::pi;

namespace {

/// A place and heading in the plane, and a height, as a function of the way.
struct Place {
  double x, y, heading, z = 0;
};
using Curve = std::function<Place(double)>;

/// A path with its x axis along the curve, and a pose every `step` metres.
std::vector<Pose> path_of(const Curve& curve, double step, std::size_t count,
                          const Vec3& shift = {0, 0, 0}) {
  std::vector<Pose> poses;
  for (std::size_t i = 0; i < count; ++i) {
    const Place p = curve(step * static_cast<double>(i));
    poses.push_back(rotation({0, 0, 1}, p.heading, {shift.x + p.x, shift.y + p.y, shift.z + p.z}));
  }
  return poses;
}

/// A circle of curvature k around (0, 1 / k), which begins at the origin along x.
Curve circle(double k) {
  return [k](double s) { return Place{std::sin(k * s) / k, (1 - std::cos(k * s)) / k, k * s}; };
}

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

Vec3 axis_of(const Pose& pose, int axis) {
  return {pose.rotation[axis], pose.rotation[3 + axis], pose.rotation[6 + axis]};
}

/// A point on the body's x axis.
Vec3 on_axis(const Pose& pose, double x) { return pose.position() + x * axis_of(pose, 0); }

double heading_of(const Pose& pose) { return std::atan2(axis_of(pose, 0).y, axis_of(pose, 0).x); }

double distance(const Vec3& a, const Vec3& b) { return length(a - b); }

/// The messages with this code.
std::vector<Message> with_code(const std::vector<Message>& told, const std::string& code) {
  std::vector<Message> found;
  for (const Message& message : told) {
    if (message.code == code) found.push_back(message);
  }
  return found;
}

}  // namespace

TEST_CASE("behind a hitch on a line the tangent of half the angle falls exponentially") {
  // A tower with a motion of its own goes along x and looks elsewhere, so the trailer does at
  // first.
  const double turned = GENERATE(0.5, -1.2, 1.5);
  std::vector<Pose> path, own;
  for (int i = 0; i < 301; ++i) {
    path.push_back(translation({0, 0, 0.1 * i}));
    own.push_back(rotation({0, 0, 1}, turned, {0.13 * i, 7, 3}));
  }
  const double hitch = 9.2, axle = 1.4;
  std::vector<Body> bodies(2);
  bodies[0] = {.name = "trailer", .model = {{0, 0, 0}}, .poses = {}, .path_pose = {}};
  bodies[1] = {.name = "tower", .model = {{0, 0, 0}}, .poses = own, .path_pose = {}};
  bodies = follow(bodies, path, {BodyTowed{"tower", 0, hitch, axle}, BodyOwnPoses{}});
  REQUIRE(bodies[0].poses.size() == path.size());
  CHECK(bodies[1].poses == own);
  double worst = 0;
  for (std::size_t i = 0; i < own.size(); ++i) {
    const double way = 0.13 * static_cast<double>(i);
    const double angle = 2 * std::atan(std::tan(-turned / 2) * std::exp(-way / (hitch - axle)));
    worst = std::max(worst, std::abs(heading_of(bodies[0].poses[i]) + angle));
    worst = std::max(worst, distance(on_axis(bodies[0].poses[i], hitch), own[i].position()));
  }
  CHECK(worst < 1e-12);
}

TEST_CASE("behind a hitch on a circle the axle comes to its steady radius as the formula says") {
  const double k = GENERATE(1.0 / 15, -1.0 / 15, 1.0 / 150), L = 7.8;
  const auto path = path_of(circle(k), 0.1, 2500);
  const Body body = follow_all(path, {BodyTowed{"", 0, 9.2, 1.4}})[0];
  // (t - a) / (t - b) = (t0 - a) / (t0 - b) exp(-w s / L) with t0 = 0
  const double w = std::sqrt(1 - k * k * L * L), a = (1 - w) / (k * L), b = (1 + w) / (k * L);
  double worst = 0;
  for (std::size_t i = 0; i < path.size(); ++i) {
    const double s = 0.1 * static_cast<double>(i), q = a / b * std::exp(-w * s / L);
    const double psi = k * s - 2 * std::atan((a - q * b) / (1 - q));
    const Place hitch = circle(k)(s);
    const Vec3 axle{hitch.x - L * std::cos(psi), hitch.y - L * std::sin(psi), 0};
    worst = std::max(worst, distance(on_axis(body.poses[i], 1.4), axle));
  }
  CHECK(worst < 3e-6);
  const Vec3 last = on_axis(body.poses.back(), 1.4);
  CHECK(std::hypot(last.x, last.y - 1 / k) == Approx(std::sqrt(1 / k / k - L * L)).epsilon(1e-6));
}

TEST_CASE("a hitch ahead of or behind the path's pose goes on a wider circle") {
  const double at = GENERATE(-0.6, 1.1), R = 15, L = 8;
  const auto path = path_of(circle(1 / R), 0.1, 2500);
  const Body body = follow_all(path, {BodyTowed{"", at, L, 0}})[0];
  const Vec3 hitch = on_axis(body.poses.back(), L), axle = body.poses.back().position();
  CHECK(std::hypot(hitch.x, hitch.y - R) == Approx(std::sqrt(R * R + at * at)).epsilon(1e-9));
  check_near(std::hypot(axle.x, axle.y - R), std::sqrt(R * R + at * at - L * L), 1e-5);
}

TEST_CASE("three bodies in a row on a circle of 15 m run at the radii that the formula says") {
  // Each tows the next; the list is in another order.
  const auto path = path_of(circle(1.0 / 15), 0.1, 2000);
  const auto bodies = follow_all(
      path, {BodyTowed{"2", -0.9, 6, 0}, BodyTowed{"", 0, 3.8, 0}, BodyTowed{"1", -0.6, 8, 0}});
  const double expected[] = {10.570241, 14.510686, 12.121056};
  for (std::size_t i = 0; i < 3; ++i) {
    REQUIRE(bodies[i].poses.size() == path.size());
    const Vec3 axle = bodies[i].poses.back().position();
    check_near(std::hypot(axle.x, axle.y - 15), expected[i], 1e-5);
  }
  for (std::size_t i = 0; i < path.size(); i += 97) {
    CHECK(distance(on_axis(bodies[2].poses[i], 8), on_axis(bodies[1].poses[i], -0.6)) < 1e-12);
    CHECK(distance(on_axis(bodies[0].poses[i], 6), on_axis(bodies[2].poses[i], -0.9)) < 1e-12);
  }
}

TEST_CASE("bodies on pivots and at stations tow as they move on the path") {
  const double R = 60, L = 7;
  const auto path = path_of(circle(1 / R), 0.1, 2200);
  const auto bodies = follow_all(path, {BodyPivots{6, -4}, BodyTowed{"0", -5.5, L, 0},
                                        BodyStation{-3}, BodyTowed{"2", -1, L, 0}});
  // The tower is a chord, whose origin is not its middle.
  const double chord = 2 * R * std::sin(10 / R / 2), middle = R * std::cos(10 / R / 2);
  const double hitch = -chord / 2 + 0.4 * chord - 5.5;
  const double radius = std::sqrt(middle * middle + hitch * hitch - L * L);
  // At both ends a pivot is off the path, and so is the trailer.
  CHECK(bodies[1].path_pose == bodies[0].path_pose);
  check_equal(bodies[1].path_pose.front(), 40);
  check_equal(bodies[3].path_pose.front(), 30);
  for (const std::size_t i : {1900u, 2000u}) {
    const Vec3 axle = bodies[1].poses[i - 40].position(),
               other = bodies[3].poses[i - 30].position();
    check_near(std::hypot(axle.x, axle.y - R), radius, 1e-6);
    check_near(std::hypot(other.x, other.y - R), std::sqrt(R * R + 1 - L * L), 1e-6);
  }
}

namespace {

/// A curve of the curvature sin(2 pi s / 40) / 12. Its places are integrated by the rule of Gauss
/// and Legendre with three places on pieces of 0.1 m, which is exact to 1e-12 m.
Place s_curve(double s) {
  const double K = 1.0 / 12, P = 40;
  const auto heading = [&](double u) { return K * P / (2 * pi) * (1 - std::cos(2 * pi * u / P)); };
  long double x = 0, y = 0;
  const int pieces = std::max(1, static_cast<int>(std::ceil(s / 0.1)));
  const double h = s / pieces, away = std::sqrt(0.6) / 2;
  for (int i = 0; i < pieces; ++i) {
    for (const auto& [place, weight] :
         {std::pair{-away, 5.0 / 18}, {0.0, 8.0 / 18}, {away, 5.0 / 18}}) {
      const double tau = heading((i + 0.5 + place) * h);
      x += weight * h * std::cos(tau);
      y += weight * h * std::sin(tau);
    }
  }
  return {static_cast<double>(x), static_cast<double>(y), heading(s)};
}

/// Places at which a chain of two trailers is known, by integrating
///     d psi / ds = sin(tau - psi) / 8,
///     d chi / ds = (velocity of the second hitch across chi) / 6
/// with 45 digits (modified midpoint rule, extrapolated over 14 rows; both last rows agree to
/// 1e-41). The second hitch is 0.9 m behind the first axle.
struct Known {
  double way, hitch_x, hitch_y, axle_x, axle_y, second_x, second_y;
};
constexpr Known kKnown[] = {
    {10, 9.685184790046355968067955388931, 1.886927123959824850905453368359,
     1.810813931445751873684895287315, 0.474736067048053765875635595507,
     -5.070209899708047357034810496819, 0.074843346533749652276666941047},
    {20, 16.058294575581052862963268558368, 9.419972328258180997975273753842,
     9.937163810262983698330310961351, 4.269073556793473900393527669098,
     3.630971478016021196999586850529, 1.581763934108249047946928854131},
    {30, 22.431404361115749757858581727804, 16.953017532556537145045094139326,
     16.734160565534140907119838796455, 11.336843289025015166284930619647,
     11.600473238130211263729160607206, 6.728188161214319509571647851011},
    {40, 32.116589151162105725926537116735, 18.839944656516361995950547507685,
     24.543471583358287299379363493719, 16.261594349785102947961872708785,
     18.691698191660484647415820663182, 12.654600139112013255867539840051}};

}  // namespace

TEST_CASE("two trailers on an S-curve are where an integration with 30 digits has them") {
  const Vec3 shift = GENERATE(Vec3{0, 0, 0}, Vec3{5e5, 4.6e6, 120});
  const auto path = path_of(s_curve, 0.1, 401, shift);
  const auto bodies = follow_all(path, {BodyTowed{"", 0, 8, 0}, BodyTowed{"0", -0.9, 6, 0}});
  for (const Known& known : kKnown) {
    const auto i = static_cast<std::size_t>(std::lround(known.way / 0.1));
    const Vec3 hitch = path[i].position() - shift;
    CHECK(distance(hitch, {known.hitch_x, known.hitch_y, 0}) < 1e-8);
    const Vec3 axle = bodies[0].poses[i].position() - shift;
    const Vec3 second = bodies[1].poses[i].position() - shift;
    CHECK(distance(axle, {known.axle_x, known.axle_y, 0}) < 5e-6);
    CHECK(distance(second, {known.second_x, known.second_y, 0}) < 5e-6);
  }
}

TEST_CASE("on a turn of 90 degrees a trailer sweeps the width that the closed forms say") {
  const double R = 15, L = 8, before = 20, turn = R * pi / 2, after = 20;
  const Curve curve = [&](double s) {
    if (s <= before) return Place{s, 0, 0};
    const double angle = std::min(s - before, turn) / R;
    return Place{before + R * std::sin(angle),
                 R - R * std::cos(angle) + std::max(0.0, s - before - turn), angle};
  };
  const auto count = static_cast<std::size_t>((before + turn + after) / 0.05);
  const auto path = path_of(curve, 0.05, count);
  const Body body = follow_all(path, {BodyTowed{"", 0, L, 0}})[0];
  const double k = 1 / R, w = std::sqrt(1 - k * k * L * L);
  const double a = (1 - w) / (k * L), b = (1 + w) / (k * L);
  const auto tangent = [&](double s) {
    const double q = a / b * std::exp(-w * std::clamp(s - before, 0.0, turn) / L);
    return (a - q * b) / (1 - q) * std::exp(-std::max(0.0, s - before - turn) / L);
  };
  const auto axle_at = [&](double s) {
    const Place hitch = curve(s);
    const double psi = hitch.heading - 2 * std::atan(tangent(s));
    return Vec3{hitch.x - L * std::cos(psi), hitch.y - L * std::sin(psi), 0};
  };
  // How far the axle is inside the path: from the arc around (before, R), or from the line behind.
  const auto inside = [&](const Vec3& axle) {
    if (axle.x <= before) return axle.y;
    if (axle.y >= R) return before + R - axle.x;
    return R - std::hypot(axle.x - before, axle.y - R);
  };
  double worst = 0, swept = 0, expected = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 axle = body.poses[i].position();
    worst = std::max(worst, distance(axle, axle_at(0.05 * static_cast<double>(i))));
    swept = std::max(swept, inside(axle));
  }
  for (double s = 0; s < before + turn + after; s += 0.01) {
    expected = std::max(expected, inside(axle_at(s)));
  }
  CHECK(worst < 1e-5);
  check_near(swept, expected, 1e-5);
  CHECK(expected > 1.5);
}

TEST_CASE("a towed body has the heights and the roll of the way that its hitch has gone") {
  // A winding path with hills, and a roll that changes along it.
  const double L = 6.5, hitch = 8, axle = 1.5, at = -0.8;
  const auto height = [](double s) { return 0.8 * std::sin(s / 14) + 0.03 * s; };
  const auto roll = [](double s) { return 0.1 * std::sin(s / 11 + 1); };
  std::vector<Pose> path;
  const auto tower = [&](double s) {
    // The frame by its axes: x along the plane's heading and the slope, z leaning by the roll.
    const double heading = 0.4 * std::sin(s / 20), slope = 0.8 / 14 * std::cos(s / 14) + 0.03;
    const double norm = std::hypot(1, slope);
    const Vec3 x{std::cos(heading) / norm, std::sin(heading) / norm, slope / norm};
    const Vec3 level{-std::sin(heading), std::cos(heading), 0};
    const Vec3 up = cross(x, level);
    const Vec3 y = std::cos(roll(s)) * level + std::sin(roll(s)) * up, z = cross(x, y);
    return Pose{{x.x, y.x, z.x, x.y, y.y, z.y, x.z, y.z, z.z}, {0, 0, 0}};
  };
  // The places of the plane are summed in small steps; `s` is the way in the plane.
  Vec3 place{0, 0, 0};
  const int fine = 1000, every = 100;
  for (int i = 0; i <= 60 * fine; ++i) {
    const double s = static_cast<double>(i) / fine;
    if (i % every == 0) {
      Pose pose = tower(s);
      pose.translation[0] = place.x;
      pose.translation[1] = place.y;
      pose.translation[2] = height(s);
      path.push_back(pose);
    }
    const double heading = 0.4 * std::sin((s + 0.5 / fine) / 20);
    place = place + 1.0 / fine * Vec3{std::cos(heading), std::sin(heading), 0};
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
  double worst_height = 0, worst_up = 0, worst_hitch = 0, worst_slope = 0;
  for (std::size_t i = 0; i < path.size(); ++i) {
    Vec3 there = place_of[0], up_there = up_of[0];
    for (std::size_t j = 1; j <= i; ++j) {
      if (!(way[j] > way[i] - L && way[j - 1] <= way[i] - L)) continue;
      const double share = (way[i] - L - way[j - 1]) / (way[j] - way[j - 1]);
      there = place_of[j - 1] + share * (place_of[j] - place_of[j - 1]);
      up_there = up_of[j - 1] + share * (up_of[j] - up_of[j - 1]);
    }
    const Pose& pose = body.poses[i];
    worst_hitch = std::max(worst_hitch, distance(on_axis(pose, hitch), place_of[i]));
    const Vec3 x = axis_of(pose, 0);
    const double rise = place_of[i].z - there.z;
    worst_slope = std::max(worst_slope, std::abs(x.z - rise / std::hypot(L, rise)));
    worst_height =
        std::max(worst_height, std::abs(on_axis(pose, axle).z - place_of[i].z + L * x.z));
    const Vec3 mean = 0.5 * (up_of[i] + up_there);
    const Vec3 up = mean + -dot(mean, x) * x;
    worst_up = std::max(worst_up, distance(axis_of(pose, 2), 1 / length(up) * up));
    CHECK(distance(axis_of(pose, 1), cross(axis_of(pose, 2), x)) < 1e-14);
  }
  CHECK(worst_hitch < 1e-12);
  CHECK(worst_height < 1e-12);
  CHECK(worst_slope < 2e-6);
  CHECK(worst_up < 2e-6);
}

TEST_CASE("on a constant ramp with a constant roll a trailer lies along the ramp") {
  const double grade = 0.08;
  std::vector<Pose> path;
  const double norm = std::hypot(1, grade), lean = 0.05;
  const Vec3 x{1 / norm, 0, grade / norm}, up{-grade / norm, 0, 1 / norm};
  const Vec3 y = std::cos(lean) * Vec3{0, 1, 0} + std::sin(lean) * up, z = cross(x, y);
  for (int i = 0; i < 200; ++i) {
    path.push_back({{x.x, y.x, z.x, x.y, y.y, z.y, x.z, y.z, z.z}, {0.1 * i, 5, 0.1 * grade * i}});
  }
  const Body body = follow_all(path, {BodyTowed{"", -0.5, 8, 1}})[0];
  for (std::size_t i = 0; i < path.size(); ++i) {
    const bool is_on_ramp = 0.1 * static_cast<double>(i) > 7.01;
    const double off = distance(axis_of(body.poses[i], 0), x);
    if (is_on_ramp) {
      CHECK(off < 1e-9);
      CHECK(distance(axis_of(body.poses[i], 2), z) < 1e-9);
    }
    // In the first length of the way the axle has the height of the first pose.
    if (i == 0) check_near(axis_of(body.poses[i], 0).z, 0, 1e-12);
  }
}

TEST_CASE("a towed body that is pushed for more than 0.1 m is refused with the place") {
  std::vector<Pose> path;
  const double back = GENERATE(0.095, 0.105);
  for (int i = 0; i <= 200; ++i) path.push_back(translation({0.1 * i, 0, 0}));
  for (int i = 1; i <= 5; ++i) path.push_back(translation({20 - back * i / 5, 0, 0}));
  const double there = path.back().translation[0];
  for (int i = 1; i <= 100; ++i) path.push_back(translation({there + 0.1 * i, 0, 0}));
  const std::vector<BodyMount> mounts{BodyTowed{"1", -1, 5, 0}, BodyPivots{2, 0.5},
                                      BodyTowed{"", -1, 5, 0}};
  std::vector<Message> told;
  if (back > 0.1) {
    check_refused<InputError>([&] { return follow_all(path, {mounts[2]}); },
                              "body 0:  ... from pose 200 of the path ... 20 m along it");
    return;
  }
  const auto bodies = follow_all(path, {mounts[2]}, &told);
  REQUIRE(told.size() == 1);
  check_equal(told[0].code, "body-transient");
  for (std::size_t i = 0; i < path.size(); ++i) {
    CHECK(std::abs(bodies[0].poses[i].translation[0] - path[i].translation[0] + 6) < 1e-12);
    check_near(bodies[0].poses[i].translation[1], 0, 1e-12);
  }
}

TEST_CASE("a path driven against its x axis pushes a towed body from its first pose on") {
  std::vector<Pose> path;
  for (int i = 0; i <= 50; ++i) path.push_back(translation({-0.1 * i, 0, 0}));
  check_refused(
      [&] {
        return follow_all(path, {BodyTowed{"", -1, 5, 0}});
      },
      "from pose 0 of the path ... along its x axis");
}

TEST_CASE("a recorded path that stands and jitters by millimetres leaves a trailer in its place") {
  Random random(91);
  const auto curve = circle(1.0 / 40);
  std::vector<Pose> path, clean;
  for (int i = 0; i < 800; ++i) {
    const Place p = curve(0.05 * i);
    // The height of the jittering path climbs, which shows how much way the hitch has gone.
    const Pose pose = rotation({0, 0, 1}, p.heading, {p.x, p.y, 0.05 * 0.05 * i});
    clean.push_back(pose);
    path.push_back(pose);
    if (i != 400) continue;
    for (int k = 0; k < 3000; ++k) {
      path.push_back(rotation({0, 0, 1}, p.heading + uniform(random, -1e-3, 1e-3),
                              {p.x + uniform(random, -3e-3, 3e-3),
                               p.y + uniform(random, -3e-3, 3e-3), 0.05 * 0.05 * i}));
    }
    path.push_back(pose);
  }
  std::vector<Message> told;
  const BodyMount tow = BodyTowed{"", -0.6, 8, 0};
  const auto jittering = follow_all(path, {tow}, &told), still = follow_all(clean, {tow});
  REQUIRE(told.size() == 1);
  check_equal(told[0].code, "body-transient");  // because the path begins in a bend
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
  // Heun's method with many steps.
  const double L = 1.5;
  double psi = 0;
  const int steps = 200000;
  const auto rate = [&](double turned, double angle) {
    return 2 * std::sin(turned - pi / 2 - angle) / L;
  };
  for (int i = 0; i < steps; ++i) {
    const double h = 0.5 / steps, turned = h * i, first = rate(turned, psi);
    psi += h / 2 * (first + rate(turned + h, psi + h * first));
  }
  check_near(heading_of(body.poses.back()), psi, 1e-4);
  CHECK(psi < -0.2);
}

TEST_CASE("a hitch that does not move leaves a towed body as it is") {
  std::vector<Pose> path = path_of(circle(1.0 / 20), 0.1, 100);
  path.insert(path.begin() + 60, 5, path[60]);
  const auto body = follow_all(path, {BodyTowed{"", 0, 5, 0}})[0];
  for (int i = 61; i <= 65; ++i) CHECK(body.poses[i] == body.poses[60]);
  const std::vector<Pose> one{rotation({0, 0, 1}, 0.3, {1, 2, 3})};
  const auto alone = follow_all(one, {BodyTowed{"", -1, 5, 0}})[0];
  check_near(heading_of(alone.poses[0]), 0.3, 1e-15);
}

TEST_CASE("the first three lengths are said to be transient") {
  std::vector<Message> told;
  follow_all(path_of(circle(1.0 / 40), 0.1, 500), {BodyTowed{"", 0, 5, 0}}, &told);
  REQUIRE(told.size() == 1);
  check_equal(told[0].code, "body-transient");
  check_says(told[0].text, "poses 0-150");
}

TEST_CASE("a path that begins in a bend is warned of for what is towed") {
  struct Row {
    double straight, curvature;  // metres before the bend, 1/m
    bool warned;
  };
  // A body of 5 m, for which 15 m matter.
  for (const Row& row : {Row{0, 0.025, true}, Row{0, -0.025, true}, Row{10, 0.025, true},
                         Row{0, 0, false}, Row{0, 0.005, false}, Row{16, 0.025, false}}) {
    CAPTURE(row.straight, row.curvature);
    std::vector<Pose> path;
    double x = 0, y = 0, heading = 0;
    for (int i = 0; i < 500; ++i) {
      path.push_back(rotation({0, 0, 1}, heading, {x, y, 0}));
      if (0.1 * i >= row.straight) heading += 0.1 * row.curvature;
      x += 0.1 * std::cos(heading);
      y += 0.1 * std::sin(heading);
    }
    std::vector<Message> told;
    follow_all(path, {BodyTowed{"", 0, 5, 0}}, &told);
    REQUIRE(told.size() == 1);
    check_equal(told[0].code, "body-transient");
    CHECK((told[0].severity == Message::Severity::kWarning) == row.warned);
    REQUIRE(told[0].stretches.size() == 1);
    check_equal(told[0].stretches[0].first, 0);
    check_near(static_cast<double>(told[0].stretches[0].last), 150, 1);
  }
}

TEST_CASE("poses of a camera are warned of where they tow") {
  std::vector<Pose> camera, sideways;
  for (int i = 0; i < 30; ++i) {  // x right, y down, z forward
    camera.push_back({{0, 0, 1, -1, 0, 0, 0, -1, 0}, {0.3 * i, 0, 0}});
    sideways.push_back(rotation({0, 0, 1}, 1.3, {0.3 * i, 0, 0}));
  }
  std::vector<Message> told;
  follow_all(sideways, {BodyTowed{"", 0, 5, 0}}, &told);
  REQUIRE(with_code(told, "body-turned").size() == 1);
  CHECK(with_code(told, "body-turned")[0].severity == Message::Severity::kWarning);
  told.clear();
  follow_all(camera, {BodyTowed{"", 0, 5, 0}}, &told);
  check_equal(with_code(told, "body-turned").size(), 1);
}

TEST_CASE("towers that make no sense are refused by name") {
  const auto path = path_of(circle(1.0 / 40), 0.1, 50);
  const auto refused = [&](const std::vector<BodyMount>& mounts, const std::string& words) {
    check_refused<UsageError>([&] { return follow_all(path, mounts); }, words);
  };
  refused({BodyTowed{"x", 0, 5, 0}}, "body 0: no body is named \"x\"");
  refused({BodyTowed{"0", 0, 5, 0}}, "body 0: the body would tow itself");
  refused(
      {BodyStation{0}, BodyTowed{"2", 0, 5, 0}, BodyTowed{"3", 0, 5, 0}, BodyTowed{"1", 0, 5, 0}},
      "in a ring");
  refused({BodyTowed{"", 0, 5, 5}}, "expected the axle behind the hitch");
  refused({BodyTowed{"", 0, 0, 5}}, "expected the axle behind the hitch");
  refused({BodyTowed{"", std::nan(""), 5, 0}}, "expected at most 1000 km");
  refused({BodyTowed{"", 0, 1e308, -1e308}}, "expected at most 1000 km");
  refused({BodyOwnPoses{}}, "keeps 0 poses");
  CHECK_THROWS_AS(follow(std::vector<Body>(2), path, {BodyStation{0}}), UsageError);
  std::vector<Pose> mirrored = path;
  for (Pose& pose : mirrored) {
    for (const int k : {1, 4, 7}) pose.rotation[k] = -pose.rotation[k];
  }
  check_refused([&] { return follow_all(mirrored, {BodyTowed{"", 0, 5, 0}}); }, "mirror");
  std::vector<Pose> far{translation({0, 0, 0}), translation({2e6, 0, 0})};
  check_refused([&] { return follow_all(far, {BodyTowed{"", 0, 5, 0}}); }, "at most 1000 km");
}
