#include "core/trajectory/trajectory_doubts.hpp"

#include <cmath>
#include <functional>
#include <numbers>
#include <string>

#include "core/geometry/angle.hpp"
#include "core/trajectory/paths.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

void turn(Pose& pose, const Rotation& rotation) { std::ranges::copy(rotation, pose.rotation); }

/// Changes a pose that has a heading.
using Change = std::function<void(Pose& pose, double heading)>;

/// The path of a car on a winding road, at coordinates of a map, with all of its poses changed.
std::vector<Pose> winding_road(const Change& change = [](Pose&, double) {}) {
  std::vector<Pose> poses;
  Vec3 at{5e5, 5.3e6, 300};
  for (int i = 0; i < 1000; ++i) {
    const double heading = 1.2 * std::sin(0.01 * i) + 0.3;
    at = at + 0.1 * Vec3{std::cos(heading), std::sin(heading), 0};
    poses.push_back(turned_at(about_z(heading) * about_y(0.01), at));
    change(poses.back(), heading);
  }
  return poses;
}

void transpose(Pose& pose, double) {
  std::swap(pose.rotation[1], pose.rotation[3]);
  std::swap(pose.rotation[2], pose.rotation[6]);
  std::swap(pose.rotation[5], pose.rotation[7]);
}
void invert(Pose& pose, double) {
  transpose(pose, 0);
  const Vec3 moved = pose.rotated(pose.position());
  for (int k = 0; k < 3; ++k) pose.translation[k] = -moved[k];
}
void swap_columns(Pose& pose, double) { std::swap(pose.translation[0], pose.translation[1]); }
void stand_on_head(Pose& pose, double) {
  for (const int k : {1, 2, 4, 5, 7, 8}) pose.rotation[k] *= -1;
}

/// The rotation that a reader makes where it takes w x y z of the file for x y z w.
void misread(Pose& pose, double heading) {
  const double x = std::cos(heading / 2), w = std::sin(heading / 2);
  turn(pose, {1, 0, 0, 0, 1 - 2 * x * x, -2 * w * x, 0, 2 * w * x, 1 - 2 * x * x});
}

/// The codes of the doubts, all of which are warnings that name the file.
std::string doubts(const std::vector<Pose>& poses,
                   RotationSource source = RotationSource::kMatrices) {
  const std::vector<Message> found = doubts_about(poses, source, "path.txt");
  for (const Message& doubt : found) CHECK(doubt.text.starts_with("path.txt: "));
  return codes_of(found);
}

}  // namespace

TEST_CASE("nothing is doubted where nothing is wrong") {
  for (const auto source :
       {RotationSource::kMatrices, RotationSource::kQuaternions, RotationSource::kAngles}) {
    check_equal(doubts(winding_road(), source), "");
    check_equal(doubts({}, source), "");
    check_equal(doubts({winding_road()[0]}, source), "");
  }
  // Backwards on the same way, a straight line without rotations, and a turn on the spot.
  auto there_and_back = winding_road();
  drive_back(there_and_back);
  check_equal(doubts(there_and_back), "");
  std::vector<Pose> straight, turning;
  for (int i = 0; i < 100; ++i) {
    straight.push_back(translation({std::abs(50.0 - i), 0, 0}));
    turning.push_back(headed(0.1 * i, {1, 2, 3}));
  }
  check_equal(doubts(straight), "");
  check_equal(doubts(turning), "");
}

TEST_CASE("what is wrong with rotations is doubted, with a hint at what the file has") {
  struct Row {
    const char* what;
    Change change;
    RotationSource source;
    const char* code;
    const char* hint = "";
  };
  constexpr auto kMatrices = RotationSource::kMatrices, kAngles = RotationSource::kAngles,
                 kQuaternions = RotationSource::kQuaternions;
  for (const Row& row :
       {Row{"missing", [](Pose&pose, double) { turn(pose, about_z(0)); }, kMatrices,
            "rotation-missing"},
        Row{"radians that were read as degrees",
            [](Pose&pose, double heading) { turn(pose, about_z(heading * 0.01745)); }, kAngles,
            "rotation-too-small"},
        Row{"inverse poses", invert, kMatrices, "poses-inverse"},
        Row{"swapped columns", swap_columns, kMatrices, "turns-against-path",
            "The columns x and y may be swapped, as northing before easting"},
        Row{"headings", swap_columns, kAngles, "turns-against-path",
            "swapped, or headings may be counted clockwise from north"},
        Row{"transposed", transpose, kMatrices, "turns-against-path",
            "right. Matrices may be column by column"},
        Row{"the other way", transpose, kAngles, "turns-against-path",
            "right. Angles may be counted the other way"},
        Row{"inverse rotations", transpose, kQuaternions, "turns-against-path",
            "right. Quaternions may be of the inverse rotations"},
        Row{"another order", misread, kQuaternions, "quaternion-order"},
        Row{"on its head", stand_on_head, kMatrices, "upside-down",
            "down; matrices may be of a frame whose z axis points down, or the frame of the model "
            "may be another"},
        Row{"quaternions on their head", stand_on_head, kQuaternions, "upside-down",
            "down; the order of quaternions, or the frame of the model, may be another"}}) {
    const RowName name(row.what);
    const auto found = doubts_about(winding_road(row.change), row.source, "path.txt");
    check_equal(codes_of(found), row.code);
    if (found.size() == 1) CHECK_THAT(found[0].text, EndsWith(row.hint));
  }
}

TEST_CASE("free motion is not doubted, near the origin or on a map") {
  for (const double far : {0.0, 5e6}) {
    std::vector<Pose> drone;
    for (int i = 0; i < 1000; ++i) {
      const double a = 0.01 * i;
      drone.push_back(turned_at(about_z(std::sin(7 * a)) * about_x(std::sin(5 * a)),
                                {far + std::sin(3 * a), far + std::cos(2 * a), std::sin(a)}));
    }
    CHECK(doubts(drone).empty());
    CHECK(doubts(drone, RotationSource::kQuaternions).empty());
  }
}

TEST_CASE("roll to the outside of curves is doubted where the path is level elsewhere") {
  struct Row {
    double inwards, slope;  // degrees: in curves, and everywhere to the left
    std::string codes;
  };
  // A straight of 100 m, a curve of 80 m to the left, a straight, and a curve to the right.
  const auto path = [](const Row& row) {
    std::vector<Pose> poses;
    Vec3 at{5e5, 5.3e6, 300};
    double heading = 0.4;
    for (int i = 0; i < 3600; ++i) {
      const int part = i / 900;
      const bool curves = i % 900 >= 450;
      const double turn = curves ? (part % 2 == 0 ? 1 : -1) / 100.0 : 0;
      heading += 0.1 * turn;
      at = at + 0.1 * Vec3{std::cos(heading), std::sin(heading), 0};
      const double to_right = (turn > 0 ? -1 : turn < 0 ? 1 : 0) * row.inwards - row.slope;
      poses.push_back(turned_at(about_z(heading) * about_x(to_right * kDegree), at));
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

TEST_CASE("a jump is more than five times the median, and longer than what matters") {
  struct Row {
    Doubles steps;
    Starts starts;
    double least = 0.1;
  };
  for (const Row& row :
       {Row{even(100), {}}, Row{even(100, {40}), {40}}, Row{even(100, {0}), {0}},
        Row{even(100, {99}), {99}}, Row{even(100, {30, 33, 80}), {30, 33, 80}}, Row{{0.5, 31}, {1}},
        Row{{31}, {}}, Row{{}, {}}, Row{even(100, {40}, 2.5), {}},
        Row{even(100, {40}, std::nextafter(2.5, 3)), {40}}, Row{even(100, {40}, 2.6), {}, 2.6},
        Row{even(100, {40}, 2.6), {40}, 2.5}}) {
    CAPTURE(row.steps.size(), row.least);
    CHECK(starts(row.steps, row.least) == row.starts);
  }
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
  const std::vector<Pose> poses = circle_poses(1 / kRadius, kStep, 20);
  const double sagitta = kRadius * (1 - std::cos(turn / 2));
  for (const double deviation : chord_deviations(poses, kReach)) {
    CHECK(deviation == Approx(sagitta + kReach * (1 - std::cos(turn / 2))).epsilon(1e-3));
  }
  CHECK(chord_deviations({poses.data(), 1}, kReach).empty());
  CHECK(chord_deviations({}, kReach).empty());
}

TEST_CASE("the chord's deviation is that of the formula where the curve is uneven") {
  const double quarter = std::numbers::pi / 2, turned = 2 * (1 - std::cos(quarter / 2));
  // A turn on the spot has no curvature.
  const std::vector<Pose> on_the_spot{headed(0, {0, 0, 0}), headed(0, {1, 0, 0}),
                                      headed(quarter, {1, 0, 0})};
  check_near(chord_deviations(on_the_spot, 2), std::vector{0.0, turned}, 1e-12);
  // A quarter circle is missing.
  const std::vector<Pose> missing{headed(0, {-0.5, 0, 0}), headed(0, {0, 0, 0}),
                                  headed(quarter, {20, 20, 0}), headed(quarter, {20, 20.5, 0})};
  check_near(chord_deviations(missing, 2)[1], turned + quarter * std::hypot(20, 20) / 8, 1e-12);
  // A neighbour tells of the curve only where it is a fifth as long.
  for (const auto& [before, curvature] : {std::pair{0.2, 0.5}, std::pair{0.19, 0.0}}) {
    const std::vector<Pose> poses{headed(0, {0, 0, 0}), headed(0.1, {before, 0, 0}),
                                  headed(0.1, {before + 1, 0, 0})};
    check_near(chord_deviations(poses, 2)[1], curvature / 8, 1e-12);
  }
}

TEST_CASE("the model's reach is measured from its origin") {
  check_equal(farthest_from_origin(std::vector<Vec3>{{1, 0, 0}, {-3, 4, 0}}), 5);
  check_equal(farthest_from_origin({}), 0);
}
