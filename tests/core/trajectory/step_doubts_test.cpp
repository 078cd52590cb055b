#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <string>

#include "core/trajectory/trajectory_doubts.hpp"
#include "support/attitudes.hpp"

using namespace clearway;
using namespace clearway::test;
using Catch::Contains;

namespace {

using Doubles = std::vector<double>;

Pose heading(double angle, double x, double y) {
  Pose pose{{}, {x, y, 0}};
  const Rotation turn = about_z(angle);
  std::copy_n(turn.data(), 9, pose.rotation);
  return pose;
}

/// The poses at which jumps begin.
std::vector<std::size_t> starts(const Doubles& steps, double least = 0.1) {
  std::vector<std::size_t> poses;
  for (const Jump& jump : jumps_of(steps, least)) poses.push_back(jump.pose);
  return poses;
}

using Starts = std::vector<std::size_t>;

/// Steps of equal length, except that those at `at` are longer.
Doubles even(std::size_t count, const Starts& at = {}, double longer = 31) {
  Doubles steps(count, 0.5);
  for (const std::size_t i : at) steps[i] = longer;
  return steps;
}

void append(Doubles& to, const Doubles& what) { to.insert(to.end(), what.begin(), what.end()); }

}  // namespace

TEST_CASE("a step far longer than those around it is a jump, wherever it is") {
  CHECK(starts(even(100)).empty());
  CHECK(starts(even(100, {40})) == Starts{40});
  CHECK(starts(even(100, {0})) == Starts{0});
  CHECK(starts(even(100, {99})) == Starts{99});
  CHECK(starts(even(100, {30, 33, 80})) == Starts{30, 33, 80});
  CHECK(starts({0.5, 31}) == Starts{1});
  CHECK(starts({31}).empty());
  CHECK(starts({}).empty());
}

TEST_CASE("a jump is more than five times the median, and longer than what matters") {
  CHECK(starts(even(100, {40}, 2.5)).empty());
  CHECK(starts(even(100, {40}, std::nextafter(2.5, 3))) == Starts{40});
  CHECK(starts(even(100, {40}, 2.6), 2.6).empty());
  CHECK(starts(even(100, {40}, 2.6), 2.5) == Starts{40});
  const Jump jump = jumps_of(even(100, {40}), 0.1).at(0);
  CHECK(jump.length == 31);
  CHECK(jump.usual == 0.5);
}

TEST_CASE("stops are no reason to doubt, and hide no jump") {
  Doubles stopping;
  for (int k = 30; k > 0; --k) stopping.push_back(0.5 * k / 30);
  Doubles starting(stopping.rbegin(), stopping.rend());
  Doubles steps = even(20);
  append(steps, stopping);
  append(steps, Doubles(20, 0));
  append(steps, starting);
  CHECK(starts(steps).empty());
  // A recorder shakes by millimetres and is then driven off at once.
  Doubles shaking = even(20);
  append(shaking, Doubles(20, 0.002));
  append(shaking, even(20));
  CHECK(starts(shaking).empty());
  // Every pose occurs twice, and there is a gap beside a stop.
  Doubles twice;
  for (const double step : even(30, {12})) append(twice, {step, 0});
  CHECK(starts(twice) == Starts{24});
  Doubles beside = even(20);
  append(beside, Doubles(20, 0));
  append(beside, even(20, {0}));
  CHECK(starts(beside) == Starts{40});
}

TEST_CASE("the warning of jumps names the longest, and where the others are") {
  const auto one = jumps_of(even(100, {40}), 0.1);
  const Message single = jump_warning(one, "path.txt: ", "m", "");
  CHECK(single.code == "trajectory-jump");
  CHECK(single.severity == Message::Severity::kWarning);
  CHECK_THAT(single.text, Contains("path.txt: the step from pose 40 to 41 is 31 m long, 62 times"));
  Doubles steps = even(100, {40, 60, 61});
  steps[70] = 40;
  const Message many = jump_warning(jumps_of(steps, 0.1), "", "ft", ". So");
  CHECK_THAT(many.text, Contains("4 steps") && Contains("after poses 40, 60-61, 70.") &&
                            Contains("from pose 70 to 71, is 40 ft") && Contains("wrong. So"));
  CHECK(many.numbers.at(0) == std::pair<std::string, double>{"jumps", 4});
}

TEST_CASE("equal jumps after equal numbers of poses are the rows of a grid") {
  std::vector<double> steps;
  for (int i = 1; i < 40; ++i) steps.push_back(i % 10 == 0 ? 9 : 1);
  const Message grid = jump_warning(jumps_of(steps, 0.1), "", "m", "");
  CHECK(grid.severity == Message::Severity::kNote);
  CHECK_THAT(grid.text, Contains("after every 10 poses") && Contains("rows of a grid") &&
                            !Contains("missing"));
  steps[29] = 8;
  CHECK(jump_warning(jumps_of(steps, 0.1), "", "m", "").severity == Message::Severity::kWarning);
  steps[29] = 1;
  steps[30] = 9;
  CHECK(jump_warning(jumps_of(steps, 0.1), "", "m", "").severity == Message::Severity::kWarning);
}

TEST_CASE("the chord of an even curve leaves it by its sagitta, and that of the model's turn") {
  constexpr double kRadius = 20, kStep = 0.5, kReach = 3;
  const double turn = kStep / kRadius;
  std::vector<Pose> poses;
  for (int i = 0; i < 20; ++i) {
    poses.push_back(heading(turn * i, kRadius * std::sin(turn * i), -kRadius * std::cos(turn * i)));
  }
  const double sagitta = kRadius * (1 - std::cos(turn / 2));
  for (const double deviation : chord_deviations(poses, kReach)) {
    CHECK(deviation == Approx(sagitta + kReach * (1 - std::cos(turn / 2))).epsilon(1e-3));
  }
  CHECK(chord_deviations({poses.data(), 1}, kReach).empty());
  CHECK(chord_deviations({}, kReach).empty());
}

TEST_CASE("the chord's deviation is that of the formula where the curve is uneven") {
  const double quarter = std::numbers::pi / 2;
  SECTION("a turn on the spot has no curvature") {
    const std::vector<Pose> poses{heading(0, 0, 0), heading(0, 1, 0), heading(quarter, 1, 0)};
    CHECK(chord_deviations(poses, 2)[1] == Approx(2 * (1 - std::cos(quarter / 2))));
    CHECK(chord_deviations(poses, 2)[0] == 0);
  }
  SECTION("a quarter circle that is missing") {
    const std::vector<Pose> poses{heading(0, -0.5, 0), heading(0, 0, 0), heading(quarter, 20, 20),
                                  heading(quarter, 20, 20.5)};
    const double step = std::hypot(20, 20);
    CHECK(chord_deviations(poses, 2)[1] ==
          Approx(2 * (1 - std::cos(quarter / 2)) + quarter * step / 8));
  }
  SECTION("a neighbour tells of the curve only where it is a fifth as long") {
    for (const auto& [before, counts] : {std::pair{0.2, true}, std::pair{0.19, false}}) {
      const std::vector<Pose> poses{heading(0, 0, 0), heading(0.1, before, 0),
                                    heading(0.1, before + 1, 0)};
      const double curvature = counts ? 0.1 / before : 0;
      CHECK(chord_deviations(poses, 2)[1] == Approx(curvature / 8).margin(1e-15));
    }
  }
}

TEST_CASE("the model's reach is measured from its origin") {
  CHECK(farthest_from_origin(std::vector<Vec3>{{1, 0, 0}, {-3, 4, 0}}) == 5);
  CHECK(farthest_from_origin({}) == 0);
}
