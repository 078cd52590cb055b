#include "core/trajectory/trajectory_doubts.hpp"

#include <cmath>
#include <functional>
#include <numbers>
#include <string>

#include "core/geometry/angle.hpp"
#include "support/attitudes.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

Pose pose_at(const Rotation& rotation, double x, double y, double z) {
  Pose pose{{}, {x, y, z}};
  for (std::size_t k = 0; k < 9; ++k) pose.rotation[k] = rotation[k];
  return pose;
}

/// The path of a car on a winding road, at coordinates of a map.
std::vector<Pose> winding_road() {
  std::vector<Pose> poses;
  double x = 5e5;
  double y = 5.3e6;
  for (int i = 0; i < 1000; ++i) {
    const double heading = 1.2 * std::sin(0.01 * i) + 0.3;
    x += 0.1 * std::cos(heading);
    y += 0.1 * std::sin(heading);
    poses.push_back(pose_at(about_z(heading) * about_y(0.01), x, y, 300));
  }
  return poses;
}

std::vector<Pose> changed(std::vector<Pose> poses, const std::function<void(Pose&)>& change) {
  for (Pose& pose : poses) change(pose);
  return poses;
}

void transpose(Pose& pose) {
  std::swap(pose.rotation[1], pose.rotation[3]);
  std::swap(pose.rotation[2], pose.rotation[6]);
  std::swap(pose.rotation[5], pose.rotation[7]);
}

void invert(Pose& pose) {
  transpose(pose);
  const double* p = pose.translation;
  double moved[3];
  for (int row = 0; row < 3; ++row) {
    const double* r = pose.rotation + 3 * row;
    moved[row] = -(r[0] * p[0] + r[1] * p[1] + r[2] * p[2]);
  }
  std::copy_n(moved, 3, pose.translation);
}

/// The codes of the doubts, joined.
std::string doubts(const std::vector<Pose>& poses,
                   RotationSource source = RotationSource::kMatrices) {
  std::string codes;
  for (const Message& doubt : doubts_about(poses, source, "path.txt")) {
    CHECK(doubt.severity == Message::Severity::kWarning);
    CHECK(doubt.text.starts_with("path.txt: "));
    codes += (codes.empty() ? "" : " ") + doubt.code;
  }
  return codes;
}

/// The rotation that a reader makes where it takes w x y z of the file for x y z w.
Rotation misread(double half_angle) {
  const double x = std::cos(half_angle);
  const double y = 0;
  const double z = 0;
  const double w = std::sin(half_angle);
  return {1 - 2 * (y * y + z * z), 2 * (x * y - w * z),     2 * (x * z + w * y),
          2 * (x * y + w * z),     1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
          2 * (x * z - w * y),     2 * (y * z + w * x),     1 - 2 * (x * x + y * y)};
}

}  // namespace

TEST_CASE("nothing is doubted where nothing is wrong") {
  for (const auto source :
       {RotationSource::kMatrices, RotationSource::kQuaternions, RotationSource::kAngles}) {
    CHECK(doubts(winding_road(), source).empty());
    CHECK(doubts({}, source).empty());
    CHECK(doubts({winding_road()[0]}, source).empty());
  }
  // Backwards on the same way, a straight line without rotations, and a turn on the spot.
  auto there_and_back = winding_road();
  there_and_back.insert(there_and_back.end(), there_and_back.rbegin(), there_and_back.rend());
  CHECK(doubts(there_and_back).empty());
  std::vector<Pose> straight;
  std::vector<Pose> turning;
  for (int i = 0; i < 100; ++i) {
    straight.push_back(pose_at(about_z(0), std::abs(50.0 - i), 0, 0));
    turning.push_back(pose_at(about_z(0.1 * i), 1, 2, 3));
  }
  CHECK(doubts(straight).empty());
  CHECK(doubts(turning).empty());
}

TEST_CASE("rotations that are missing are doubted where the path turns") {
  const auto still =
      changed(winding_road(), [](Pose& pose) { std::copy_n(about_z(0).data(), 9, pose.rotation); });
  check_equal(doubts(still), "rotation-missing");
}

TEST_CASE("radians that were read as degrees are doubted") {
  auto poses = winding_road();
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const double heading = 1.2 * std::sin(0.01 * static_cast<double>(i)) + 0.3;
    std::copy_n(about_z(heading * 0.01745).data(), 9, poses[i].rotation);
  }
  check_equal(doubts(poses, RotationSource::kAngles), "rotation-too-small");
}

TEST_CASE("inverse poses, and rotations that turn the other way, are doubted") {
  check_equal(doubts(changed(winding_road(), invert)), "poses-inverse");
  check_equal(doubts(changed(winding_road(), transpose)), "turns-against-path");
  const auto swapped = changed(
      winding_road(), [](Pose& pose) { std::swap(pose.translation[0], pose.translation[1]); });
  check_equal(doubts(swapped), "turns-against-path");
}

TEST_CASE("the hint names what the file has: columns, headings, matrices or quaternions") {
  const auto text = [](const std::vector<Pose>& poses, RotationSource source) {
    const auto found = doubts_about(poses, source, "path.txt");
    return found.size() == 1 ? found[0].text : "not one doubt";
  };
  const auto swapped = changed(
      winding_road(), [](Pose& pose) { std::swap(pose.translation[0], pose.translation[1]); });
  CHECK_THAT(text(swapped, RotationSource::kMatrices),
             EndsWith("The columns x and y may be swapped, as northing before easting"));
  CHECK_THAT(text(swapped, RotationSource::kAngles),
             EndsWith("swapped, or headings may be counted clockwise from north"));
  const auto transposed = changed(winding_road(), transpose);
  CHECK_THAT(text(transposed, RotationSource::kMatrices),
             EndsWith("right. Matrices may be column by column"));
  CHECK_THAT(text(transposed, RotationSource::kAngles),
             EndsWith("right. Angles may be counted the other way"));
  CHECK_THAT(text(transposed, RotationSource::kQuaternions),
             EndsWith("right. Quaternions may be of the inverse rotations"));
  const auto turned = changed(winding_road(), [](Pose& pose) {
    for (const int k : {1, 2, 4, 5, 7, 8}) pose.rotation[k] *= -1;
  });
  check_lacks(text(turned, RotationSource::kMatrices), "quaternion");
  check_says(text(turned, RotationSource::kQuaternions), "order of quaternions");
}

TEST_CASE("quaternions in another order are doubted") {
  auto poses = winding_road();
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const double heading = 1.2 * std::sin(0.01 * static_cast<double>(i)) + 0.3;
    std::copy_n(misread(heading / 2).data(), 9, poses[i].rotation);
  }
  check_equal(doubts(poses, RotationSource::kQuaternions), "quaternion-order");
}

TEST_CASE("free motion is not doubted, near the origin or on a map") {
  for (const double far : {0.0, 5e6}) {
    std::vector<Pose> drone;
    for (int i = 0; i < 1000; ++i) {
      const double a = 0.01 * i;
      drone.push_back(pose_at(about_z(std::sin(7 * a)) * about_x(std::sin(5 * a)),
                              far + std::sin(3 * a), far + std::cos(2 * a), std::sin(a)));
    }
    CHECK(doubts(drone).empty());
    CHECK(doubts(drone, RotationSource::kQuaternions).empty());
  }
}

TEST_CASE("a model that stands on its head is doubted") {
  const auto turned = changed(winding_road(), [](Pose& pose) {
    for (const int k : {1, 2, 4, 5, 7, 8}) pose.rotation[k] *= -1;
  });
  check_equal(doubts(turned), "upside-down");
}

TEST_CASE("roll to the outside of curves is doubted where the path is level elsewhere") {
  struct Row {
    double inwards, slope;  // degrees: in curves, and everywhere to the left
    std::string codes;
  };
  // A straight of 100 m, a curve of 80 m to the left, a straight, and a curve to the right.
  const auto path = [](const Row& row) {
    std::vector<Pose> poses;
    double x = 5e5, y = 5.3e6, heading = 0.4;
    for (int i = 0; i < 3600; ++i) {
      const int part = i / 900;
      const bool curves = i % 900 >= 450;
      const double turn = curves ? (part % 2 == 0 ? 1 : -1) / 100.0 : 0;
      heading += 0.1 * turn;
      x += 0.1 * std::cos(heading);
      y += 0.1 * std::sin(heading);
      const double to_right = (turn > 0 ? -1 : turn < 0 ? 1 : 0) * row.inwards - row.slope;
      poses.push_back(pose_at(about_z(heading) * about_x(to_right * kDegree), x, y, 300));
    }
    return poses;
  };
  for (const Row& row : {Row{-5, 0, "cant-side"}, Row{-2.2, 0, "cant-side"}, Row{5, 0, ""},
                         Row{-1.5, 0, ""}, Row{0, 4, ""}, Row{-5, 4, ""}}) {
    CAPTURE(row.inwards, row.slope);
    CHECK(doubts(path(row)) == row.codes);
  }
}

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
  check_equal(jump.length, 31);
  check_equal(jump.usual, 0.5);
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
  check_equal(single.code, "trajectory-jump");
  CHECK(single.severity == Message::Severity::kWarning);
  check_says(single.text, "path.txt: the step from pose 40 to 41 is 31 m long, 62 times");
  Doubles steps = even(100, {40, 60, 61});
  steps[70] = 40;
  const Message many = jump_warning(jumps_of(steps, 0.1), "", "ft", ". So");
  check_says(
      many.text,
      "4 steps ... after poses 40, 60-61, 70. ... from pose 70 to 71, is 40 ft ... wrong. So");
  CHECK(many.numbers.at(0) == std::pair<std::string, double>{"jumps", 4});
}

TEST_CASE("equal jumps after equal numbers of poses are the rows of a grid") {
  std::vector<double> steps;
  for (int i = 1; i < 40; ++i) steps.push_back(i % 10 == 0 ? 9 : 1);
  const Message grid = jump_warning(jumps_of(steps, 0.1), "", "m", "");
  CHECK(grid.severity == Message::Severity::kNote);
  check_says(grid.text, "after every 10 poses ... rows of a grid");
  check_lacks(grid.text, "missing");
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
    check_equal(chord_deviations(poses, 2)[0], 0);
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
  check_equal(farthest_from_origin(std::vector<Vec3>{{1, 0, 0}, {-3, 4, 0}}), 5);
  check_equal(farthest_from_origin({}), 0);
}
