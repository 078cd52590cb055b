// What has to be taken off a vehicle, and on which side: against brute force, and as a person would
// say it.
#include <array>
#include <cmath>
#include <numbers>

#include "clearway/clearway.hpp"
#include "core/geometry/inside.hpp"
#include "findings/conflict_fixture.hpp"
#include "findings/searched_scene.hpp"
#include "support/compare.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

constexpr double kNone = std::numeric_limits<double>::infinity();

double distance_to(const Box& box, const Vec3& x) {
  Vec3 off{};
  for (int k = 0; k < 3; ++k) off[k] = x[k] - std::clamp(x[k], box.lo[k], box.hi[k]);
  return length(off);
}

/// The distance of a box to a segment, which has one least value along it.
double distance_to(const Box& box, const Vec3& a, const Vec3& b) {
  double from = 0, to = 1;
  const auto at = [&](double s) { return distance_to(box, a + s * (b - a)); };
  for (int step = 0; step < 200; ++step) {
    const double lower = from + (to - from) / 3, upper = to - (to - from) / 3;
    (at(lower) <= at(upper) ? to : from) = at(lower) <= at(upper) ? upper : lower;
  }
  return std::min({at(from), at(0), at(1)});
}

/// The angle by which a body turns from one pose to another, by the trace of its rotation.
double turn_between(const Pose& from, const Pose& to) {
  double trace = 0;
  for (int k = 0; k < 9; ++k) trace += from.rotation[k] * to.rotation[k];
  return std::acos(std::clamp((trace - 1) / 2, -1.0, 1.0));
}

/// Where the points of a conflict lie across the vehicle, pose by pose and point by point.
struct Oracle {
  double y0 = kNone, y1 = -kNone, z0 = kNone, z1 = -kNone;
  bool in_middle = false;
  Box from_floor, whole;

  Oracle(const Found& found, const Box& box, const Conflict& c, const std::vector<Vec3>& points)
      : from_floor(box), whole(box) {
    if (found.floor) from_floor.lo.z = std::clamp(*found.floor, box.lo.z, box.hi.z);
    const double radius = found.header().radius;
    const auto counts = [&](const Vec3& x) { return !found.floor || x.z >= *found.floor; };
    const std::size_t end =
        c.last_pose + (found.between_poses && c.last_pose + 1 < found.poses.size() ? 1u : 0u);
    for (const Vec3& e : points) {
      if (!found.between_poses) {
        for (std::size_t i = c.first_pose; i <= end; ++i) {
          const Vec3 x = pulled_back(found.poses[i], e);
          if (counts(x) && distance_to(box, x) < radius) add(x);
        }
        continue;
      }
      for (std::size_t i = c.first_pose; i < end; ++i) {
        const Pose &from = found.poses[i], &to = found.poses[i + 1];
        const Vec3 x = pulled_back(from, e), y = pulled_back(to, e);
        const double half = turn_between(from, to) / 2;
        const double beyond = std::tan(half) * length(y - x) / 2 + radius / std::cos(half) - radius;
        if (!(counts(x) || counts(y)) || !(distance_to(box, x, y) < radius + beyond)) continue;
        add(x, beyond);
        add(y, beyond);
      }
    }
  }

  void add(const Vec3& x, double beyond = 0) {
    const Vec3 middle = from_floor.centre(), size = from_floor.size();
    y0 = std::min(y0, x.y - beyond);
    y1 = std::max(y1, x.y + beyond);
    z0 = std::min(z0, x.z - beyond);
    z1 = std::max(z1, x.z + beyond);
    in_middle = in_middle ||
                (std::abs(x.y - middle.y) < size.y / 4 && std::abs(x.z - middle.z) < size.z / 4);
  }

  std::array<std::optional<double>, 4> trims(double radius) const {
    const Box& b = from_floor;
    const std::array<double, 4> all{b.hi.y - y0 + radius, y1 - b.lo.y + radius,
                                    b.hi.z - z0 + radius, z1 - whole.lo.z + radius};
    std::array<std::optional<double>, 4> out;
    for (std::size_t k = 0; k < 4; ++k) {
      const double half = (k < 2 ? b.size().y : k == 2 ? b.size().z : whole.size().z) / 2;
      if (std::isfinite(all[k]) && all[k] > 0 && all[k] <= half) out[k] = all[k];
    }
    return out;
  }

  Side side(double radius, Side first_touch) const {
    const auto all = trims(radius);
    std::optional<std::size_t> least;
    for (std::size_t k = 0; k < 4; ++k) {
      if (all[k] && (!least || *all[k] < *all[*least])) least = k;
    }
    if (least) {
      return std::array{Side::kLeft, Side::kRight, Side::kAbove, Side::kBelow}[*least];
    }
    const double middle = from_floor.centre().y;
    return y0 < middle && y1 > middle && !in_middle ? Side::kAround : first_touch;
  }
};

bool are_equal(const std::array<std::optional<double>, 4>& a,
               const std::array<std::optional<double>, 4>& b) {
  for (std::size_t k = 0; k < 4; ++k) {
    if (a[k].has_value() != b[k].has_value()) return false;
    if (a[k] && std::abs(*a[k] - *b[k]) > 1e-6) return false;
  }
  return true;
}

std::array<std::optional<double>, 4> trims_of(const Conflict& c) {
  return {c.trim_left, c.trim_right, c.trim_above, c.trim_below};
}

}  // namespace

TEST_CASE("trims and sides of random groups are those of every point at every pose") {
  const Box box{{-1, -1, -1}, {1, 1, 1}};
  std::array<int, 8> sides{};
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    CAPTURE(seed);
    Random random(seed);
    Found found;
    // With few poses the vehicle turns by up to 20 degrees from one to the next.
    const std::size_t poses = seed % 4 == 0 ? 6 : seed % 10 == 5 ? 1500 : seed % 10 == 6 ? 120 : 30;
    found.poses = smooth_path(random, {{0, -3, -1}, {8, 3, 1}}, poses);
    found.between_poses = seed % 2 == 0;
    if (seed % 3 == 0) found.floor = -0.9 + 0.3 * static_cast<double>(below(random, 6));
    const std::size_t groups = 1 + below(random, 6);
    for (std::size_t group = 0; group < groups; ++group) {
      const Vec3 at = random_points(random, {{-1, -4, -2}, {9, 4, 2}}, 1).front();
      const double size = 0.05 + 0.3 * static_cast<double>(below(random, 4));
      const Vec3 half{size, size, size};
      for (const Vec3& p : random_points(random, {at - half, at + half}, 1 + below(random, 60))) {
        found.quanta.push_back(millimetres(p));
        found.first_pose.push_back(static_cast<std::uint32_t>(below(random, found.poses.size())));
        found.last_pose.push_back(found.first_pose.back() +
                                  static_cast<std::uint32_t>(
                                      below(random, found.poses.size() - found.first_pose.back())));
      }
    }
    std::vector<std::uint32_t> conflict_of;
    const Conflicts conflicts = found.conflicts(
        {.min_points = 1, .split = 0, .threads = 1 + static_cast<int>(seed % 2)}, &conflict_of);
    const Collisions rows = found.rows();
    const double radius = found.header().radius;
    for (const Conflict& c : conflicts.listed) {
      std::vector<Vec3> points;
      for (std::size_t row = 0; row < rows.size(); ++row) {
        if (conflict_of[row] == c.id) points.push_back(rows.xyz[row]);
      }
      const Oracle oracle(found, box, c, points);
      CHECK(are_equal(trims_of(c), oracle.trims(radius)));
      CHECK(c.side == oracle.side(radius, c.first_touch));
      ++sides[static_cast<std::size_t>(c.side)];
    }
  }
  for (const Side side : {Side::kLeft, Side::kRight, Side::kAbove, Side::kBelow}) {
    CHECK(sides[static_cast<std::size_t>(side)] > 5);
  }
}

TEST_CASE("a half turn takes the trims of no conflict but its own") {
  Found found{.poses = straight_path(9.75, 0.25), .between_poses = true};
  for (int i = 0; i < 30; ++i) {  // a rail that reaches 0.1 m into the vehicle from the left
    found.quanta.push_back({2000 + 20 * i, 900, 10 * i});
    found.first_pose.push_back(4);
    found.last_pose.push_back(8);
  }
  const Conflict straight = found.first_conflict();
  found.poses.push_back(rotation({0, 0, 1}, std::numbers::pi, {10, 0, 0}));
  const Conflict before_turn = found.first_conflict();
  CHECK(straight.side == Side::kLeft);
  CHECK(straight.trim_left == Approx(0.6));
  CHECK(before_turn.side == straight.side);
  CHECK(are_equal(trims_of(before_turn), trims_of(straight)));
}

namespace {

/// Points on a grid in a box, 5 cm apart.
std::vector<Vec3> filled(const Box& box) {
  std::vector<Vec3> out;
  const auto count = [&](int k) {
    return static_cast<int>(std::lround((box.hi[k] - box.lo[k]) / 0.05));
  };
  for (int i = 0; i <= count(0); ++i) {
    for (int j = 0; j <= count(1); ++j) {
      for (int k = 0; k <= count(2); ++k) {
        out.push_back({box.lo.x + 0.05 * i, box.lo.y + 0.05 * j, box.lo.z + 0.05 * k});
      }
    }
  }
  return out;
}

/// An obstacle beside or in the way of a lorry that drives along x: 2 m wide, from 0.5 to 3 m high,
/// with a radius of 0.2 m.
struct Obstacle {
  std::string what;
  std::vector<Vec3> points;
  Side side, first_touch;
  std::optional<double> trim;         ///< the least one
  std::optional<double> left, right;  ///< the own shifts, to a millimetre
};

std::vector<Vec3> joined(std::vector<Vec3> a, const std::vector<Vec3>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

Conflict conflict_with(const std::vector<Vec3>& points) {
  Query query = solid_box({{-4, -1, 0.5}, {4, 1, 3}}, straight_path(40, 0.5), 0.2);
  query.clearance = 0.3;
  return SearchedScene(points, query).only_conflict({.gap = 3, .min_points = 1, .split = 0});
}

/// Checks a length that may be unknown, to a millimetre.
void check_known(const std::optional<double>& found, const std::optional<double>& expected) {
  REQUIRE(found.has_value() == expected.has_value());
  if (found) check_near(*found, *expected, 1e-3);
}

}  // namespace

TEST_CASE("sides, trims and shifts are what a person would say") {
  const std::vector<Vec3> post = filled({{20, 0, 0}, {20.1, 0.1, 3}});
  const std::vector<Vec3> portal = joined(joined(filled({{20, 0.9, 0.5}, {20.1, 1.1, 3.1}}),
                                                 filled({{20, -1.1, 0.5}, {20.1, -0.9, 3.1}})),
                                          filled({{20, -1.1, 3.1}, {20.1, 1.1, 3.2}}));
  const std::vector<Obstacle> rows{
      {"a tree at 0.1 m on the left", filled({{20, 1.1, 0}, {20.3, 1.4, 4}}), Side::kLeft,
       Side::kLeft, 0.1, std::nullopt, 0.1},
      {"a low sign", filled({{20, -0.4, 2.85}, {20.05, 0.4, 3.5}}), Side::kAbove, Side::kFront,
       0.35, 1.6, 1.6},
      {"a kerb under the right edge", filled({{15, -1.5, 0}, {25, -0.9, 0.4}}), Side::kBelow,
       Side::kBelow, 0.1, 0.273, std::nullopt},
      {"a hump under the whole width", filled({{20, -1, 0}, {20.5, 1, 0.4}}), Side::kBelow,
       Side::kBelow, 0.1, std::nullopt, std::nullopt},
      {"a platform on the right", filled({{10, -3, 0}, {30, -1.05, 1}}), Side::kRight, Side::kRight,
       0.15, 0.15, std::nullopt},
      {"a wall that the load scrapes on the left", filled({{20, 0.95, 0}, {30, 1.05, 3.5}}),
       Side::kLeft, Side::kFront, 0.25, std::nullopt, 0.25},
      {"a post in the middle", post, Side::kFront, Side::kFront, std::nullopt, 1.3, 1.2},
      {"a portal", portal, Side::kAround, Side::kFront, std::nullopt, std::nullopt, std::nullopt},
  };
  for (const Obstacle& row : rows) {
    CAPTURE(row.what);
    const Conflict c = conflict_with(row.points);
    CHECK(c.side == row.side);
    CHECK(c.first_touch == row.first_touch);
    std::optional<double> least;
    for (const auto& trim : trims_of(c)) {
      if (trim && (!least || *trim < *least)) least = trim;
    }
    check_known(least, row.trim);
    check_known(c.own_shift_left, row.left);
    check_known(c.own_shift_right, row.right);
    CHECK(c.encroachment_is == Bound::kExact);
  }
}

TEST_CASE("without an inside what is missing is at least so much") {
  Query surface = solid_box({{-1, -1, 0}, {1, 1, 2}}, straight_path(20), 0.1);
  surface.model.solid_of.clear();
  Query points({{0, 1, 1}}, straight_path(20), {.radius = 0.1});
  const auto conflicts = [](const Query& query) {
    return SearchedScene({{10, 1.05, 1}}, query).conflicts({});
  };
  CHECK_FALSE(conflicts(points).listed[0].encroachment_is);
  surface.clearance = points.clearance = 0.1;
  for (const Query& query : {surface, points}) {
    const Conflicts found = conflicts(query);
    REQUIRE(found.listed.size() == 1);
    CHECK(found.listed[0].encroachment_is == Bound::kAtLeast);
    check_equal(found.min_points, 1);
  }
}

TEST_CASE("own shifts leave out what is below the floor") {
  // A post whose lowest 0.5 m are below the floor, and a wall that is below it altogether.
  Found found{.poses = straight_path(4, 0.25), .solids = 1, .floor = 0.5};
  for (int k = 0; k <= 10; ++k) found.quanta.push_back({2000, 900 + (k < 5 ? -600 : 0), 100 * k});
  found.first_pose.assign(found.quanta.size(), 2);
  found.last_pose.assign(found.quanta.size(), 12);
  const Model model = solid_box({{-1, -1, -1}, {1, 1, 1}}, found.poses, 0.5).model;
  const Conflict c = found.first_conflict({.gap = 1, .model = &model});
  // Only the part of the post at 0.9 m to the left counts, although points at 0.3 m are lower.
  check_known(c.own_shift_right, 0.6);
  check_known(c.trim_left, 0.6);
  CHECK(c.side == Side::kLeft);
}
