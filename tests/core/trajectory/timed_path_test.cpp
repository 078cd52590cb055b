#include "core/trajectory/timed_path.hpp"

#include <cmath>
#include <limits>
#include <random>

#include "clearway/error.hpp"
#include "core/trajectory/paths.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

using Where = TimedPath::Where;

Vec3 place_at(const TimedPath& path, double time) {
  std::size_t step = 0;
  const TimedPath::Place place = path.at(time, step);
  REQUIRE(place.where == Where::kOnPath);
  return place.position;
}

Where where_at(const TimedPath& path, double time) {
  std::size_t step = 0;
  return path.at(time, step).where;
}

void check_refused_times(std::vector<double> times, const std::string& words,
                         const Vec3& lever = {}, const Pose& pose = translation({})) {
  const std::vector<Pose> poses(3, pose);
  check_refused<InputError>([&] { TimedPath(poses, times, lever, "p.txt"); }, words);
}

}  // namespace

TEST_CASE("a timed path moves evenly in time on a line, and turns by slerp") {
  const double quarter = std::acos(0.0);
  const std::vector<Pose> poses{headed(0, {0, 0, 0}), headed(quarter, {4, -2, 1}),
                                headed(quarter, {4, -2, 3})};
  const TimedPath path(poses, {10, 10.5, 11.5}, {2, 0, 0.25}, "p.txt");
  check_equal(path.first(), 10);
  check_equal(path.last(), 11.5);
  for (const double share : {0.0, 0.125, 0.5, 0.9, 1.0}) {
    const Vec3 at = place_at(path, 10 + 0.5 * share);
    check_near(at,
               {4 * share + 2 * std::cos(quarter * share),
                -2 * share + 2 * std::sin(quarter * share), share + 0.25},
               1e-12);
  }
  check_near(place_at(path, 11), {4, 0, 2.25}, 1e-12);
}

TEST_CASE("a timed path turns the shorter way round, and ignores rotations without a lever arm") {
  const std::vector<Pose> poses{headed(3, {0, 0, 0}), headed(-3, {0, 0, 0})};
  const Vec3 middle = place_at(TimedPath(poses, {0, 1}, {1, 0, 0}, "p.txt"), 0.5);
  check_near(middle, {-1, 0, 0}, 1e-12);
  const Pose mirror{{1, 0, 0, 0, 1, 0, 0, 0, -1}, {1, 2, 3}};
  const std::vector<Pose> mirrored{mirror, mirror};
  CHECK(place_at(TimedPath(mirrored, {0, 1}, {}, "p.txt"), 0.5) == Vec3{1, 2, 3});
  check_refused_times({0, 1, 2}, "p.txt: pose 0 (counting from 0) mirrors", {0, 0, 1}, mirror);
}

TEST_CASE("nothing is known beside a timed path and in its gaps") {
  const std::vector<Pose> poses{headed(0, {0, 0, 0}), headed(0, {1, 0, 0}), headed(0, {2, 0, 0}),
                                headed(0, {3, 0, 0})};
  const TimedPath path(poses, {0, 1, 2.001, 2.5}, {}, "p.txt");
  CHECK(where_at(path, std::nextafter(0.0, -1.0)) == Where::kBefore);
  CHECK(where_at(path, std::nextafter(2.5, 3.0)) == Where::kAfter);
  CHECK(where_at(path, std::numeric_limits<double>::infinity()) == Where::kAfter);
  CHECK(where_at(path, 1.5) == Where::kInGap);
  CHECK(where_at(path, std::nextafter(2.001, 0.0)) == Where::kInGap);
  check_equal(place_at(path, 1).x, 1);
  check_equal(place_at(path, 2.001).x, 2);
  check_equal(place_at(path, 2.5).x, 3);
  check_equal(path.gaps(), 1);
  CHECK(path.longest_gap() == Approx(1.001));
}

TEST_CASE("a timed path gives the same place whatever was asked before") {
  std::mt19937 random(7);
  const auto below = [&](unsigned n) { return static_cast<double>(random() % n); };
  std::vector<Pose> poses;
  std::vector<double> times;
  double time = 0;
  for (int i = 0; i < 50; ++i) {
    time += 0.01 + 0.001 * below(1200);
    times.push_back(time);
    poses.push_back(headed(below(7), {below(100), below(100), 0}));
  }
  const TimedPath path(poses, times, {0.5, 0.25, 0}, "p.txt");
  std::size_t step = 0;
  for (int i = 0; i < 2000; ++i) {
    const double at = i % 3 == 0 ? times[random() % 50] : time * below(1000) / 990;
    std::size_t fresh = 0;
    const TimedPath::Place expected = path.at(at, fresh), place = path.at(at, step);
    REQUIRE(place.where == expected.where);
    REQUIRE(place.position == expected.position);
  }
}

TEST_CASE("poses without ascending times are refused with the pose") {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  check_refused_times({}, "p.txt: its poses have no times");
  check_refused_times({0, kNan, 1}, "time of pose 1 ... finite");
  check_refused_times({0, 2, 1}, "pose 2  ... time 1 after 2");
  check_refused_times({0, 1, 1}, "pose 2  ... ascend");
  TimedPath(std::vector<Pose>(3, translation({})), {-1, 0, 1}, {}, "p.txt");
}
