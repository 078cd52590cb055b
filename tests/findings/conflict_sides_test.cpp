// Where conflicts lie, seen from the model.
#include "clearway/error.hpp"
#include "findings/conflict_fixture.hpp"
#include "io/result/answer.hpp"
#include "io/result/conflicts/bcf/bcf_text.hpp"
#include "support/compare.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

Conflicts conflicts_with_sides(const Found& found, const ConflictOptions& options = {},
                               std::vector<std::uint32_t>* conflict_of = nullptr) {
  const ScratchFolder folder;
  return find_conflicts(found.write(folder), found.poses, options, conflict_of);
}

}  // namespace

TEST_CASE("lateral and height are along the axes of the model at the pose") {
  const auto at = [](const Vec3& place, const Pose& pose, const ConflictOptions& how = {}) {
    Found found;
    found.poses = {pose};
    for (int k = 0; k < 3; ++k) found.quantisation.offset[k] = place[k];
    found.quanta = {{0, 0, 0}};
    ConflictOptions options = how;
    options.min_points = 1;
    return conflicts_with_sides(found, options).listed.at(0);
  };
  const Conflict left = at({101, 52.5, 0.75}, translation({100, 50, 0}));
  check_equal(left.lateral, 2.5);
  check_equal(left.height, 0.75);
  check_equal(at({101, 48.5, -0.75}, translation({100, 50, 0})).lateral, -1.5);
  const Pose turned{{0, -1, 0, 1, 0, 0, 0, 0, 1}, {100, 50, 0}};  // y is ahead, -x is left
  check_equal(at({98, 50, 3}, turned).lateral, 2);
  check_equal(at({98, 50, 3}, turned).height, 3);
  ConflictOptions how;
  how.forward = Axis::kPlusY;
  how.up = Axis::kMinusZ;  // +x is left; seen from above it would be -x
  check_equal(at({102, 50, 3}, translation({100, 50, 0}), how).lateral, 2);
  check_equal(at({102, 50, 3}, translation({100, 50, 0}), how).height, -3);
}

TEST_CASE("lateral and height are of the nearest point where it is known") {
  Found found;
  found.poses = {translation({0, 0, 0}), translation({0, 10, 1})};
  found.quanta = {{0, 0, 0}, {0, 100, 0}};
  found.clearance = 0.6;
  found.clearances.source = {0, 1};
  found.clearances.distance = {0.3, 0.2};
  found.clearances.pose = {0, 1};
  found.clearances.xyz = found.rows().xyz;
  ConflictOptions options;
  options.min_points = 1;
  const Conflict found_one = conflicts_with_sides(found, options).listed.at(0);
  CHECK(found_one.lateral == found.rows().xyz[1].y - 10);
  check_equal(found_one.height, -1);
}

TEST_CASE("an obstacle has the station where it stands, whichever way the vehicle faces") {
  const auto station = [](double turn, const std::vector<double>& ways, Axis forward) {
    Found found;
    found.poses.clear();
    for (const double x : ways) {
      found.poses.push_back(rotation({0, 0, 1}, turn * std::acos(-1) / 180, {x, 0, 0}));
    }
    found.quanta = {{2400, 300, 0}};
    found.first_pose = {2};
    ConflictOptions options;
    options.min_points = 1;
    options.forward = forward;
    return *conflicts_with_sides(found, options).listed.at(0).obstacle_chainage;
  };
  const std::vector<double> path{0, 1, 2, 3, 4}, to_turn{0, 1, 2, 1, 0}, standing{2, 2, 2.001, 2};
  for (const double turn : {0., 90., 180., 270.}) {
    for (const Axis forward : {Axis::kPlusX, Axis::kMinusX, Axis::kPlusY, Axis::kMinusY}) {
      CAPTURE(turn, forward);
      CHECK(station(turn, path, forward) == Approx(2.4).margin(1e-9));
      CHECK(station(turn, to_turn, forward) == Approx(2.4).margin(1e-9));
    }
  }
  // Up to 45 degrees the vehicle's own axis counts, and beyond that the direction of the path.
  const double turned = 40 * std::acos(-1) / 180;
  CHECK(station(40, path, Axis::kPlusX) ==
        Approx(2 + 0.4 * std::cos(turned) + 0.3 * std::sin(turned)).margin(1e-9));
  CHECK(station(50, path, Axis::kPlusX) == Approx(2.4).margin(1e-9));
  // Where the path stands still, its jitter is no direction.
  CHECK(station(180, standing, Axis::kPlusX) == Approx(0.001 - 0.399).margin(1e-9));
}

TEST_CASE("the side is seen from the model's box at the pose") {
  const auto side = [](const Vec3& at, const Pose& pose, const ConflictOptions& how = {}) {
    Found found;
    found.poses = {pose};
    for (int k = 0; k < 3; ++k) found.quantisation.offset[k] = at[k];
    found.quanta = {{0, 0, 0}};
    ConflictOptions options = how;
    options.min_points = 1;
    return conflicts_with_sides(found, options).listed.at(0).first_touch;
  };
  const Pose ahead = translation({100, 50, 0});
  CHECK(side({100, 52, 0}, ahead) == Side::kLeft);
  CHECK(side({100, 48, 0}, ahead) == Side::kRight);
  CHECK(side({100, 50, 2}, ahead) == Side::kAbove);
  CHECK(side({100, 50, -2}, ahead) == Side::kBelow);
  CHECK(side({103, 50.5, 0}, ahead) == Side::kFront);
  CHECK(side({103, 52, 0}, ahead) == Side::kLeft);  // beside the way, however far ahead
  CHECK(side({97, 50, 0}, ahead) == Side::kBehind);
  CHECK(side({100, 50.9, 0.5}, ahead) == Side::kLeft);  // inside: the nearest side
  const Pose turned = rotation({0, 0, 1}, std::acos(-1) / 2, {100, 50, 0});
  CHECK(side({100, 52, 0}, turned) == Side::kFront);
  CHECK(side({98, 50, 0}, turned) == Side::kLeft);
  ConflictOptions other;
  other.forward = Axis::kMinusY;
  CHECK(side({100, 48, 0}, ahead, other) == Side::kFront);
  CHECK(side({102, 50, 0}, ahead, other) == Side::kLeft);
  other.up = Axis::kPlusX;
  CHECK(side({102, 50, 0}, ahead, other) == Side::kAbove);
}

// Where the conflicts of a vehicle lie, seen from its bodies.
namespace {

const std::vector<Vec3> kCube{{-1, -1, -1}, {1, 1, 1}};

/// A path along x, and two bodies beside it, of which one is turned to y and one has no pose 0.
struct TwoBodies : Found {
  TwoBodies() {
    poses = {translation({100, 50, 0}), translation({101, 50, 0})};
    const Pose turned{{0, -1, 0, 1, 0, 0, 0, 0, 1}, {100, 60, 0}};  // y is ahead, -x is left
    bodies = {{.name = "a < b & c", .model = kCube, .poses = {turned, turned}, .path_pose = {0, 1}},
              {.name = "rear",
               .model = {{-1, -1, -4}, {1, 1, 4}},
               .poses = {translation({100, 63.5, 0})},
               .path_pose = {1}}};
    quantisation.offset[0] = 102;
    quantisation.offset[1] = 60;
    quantisation.offset[2] = 0.5;
    quanta = {{0, 0, 0}};
    body = {0};
  }

  Conflict conflict(std::span<const Body> given) const {
    const ScratchFolder folder;
    return find_conflicts(write(folder), poses, with(given)).listed.at(0);
  }
  static ConflictOptions with(std::span<const Body> given) {
    ConflictOptions options;
    options.min_points = 1;
    options.bodies = given;
    return options;
  }
};

}  // namespace

TEST_CASE("a conflict of a vehicle is seen from its body at its own pose") {
  const TwoBodies found;
  const Conflict seen = found.conflict(found.bodies);
  CHECK(seen.first_touch == Side::kRight);
  check_equal(seen.lateral, -2);
  check_equal(seen.height, 0.5);
  const Conflict unseen = found.conflict({});
  CHECK(unseen.first_touch == Side::kUnknown);
  check_equal(unseen.lateral, 10);
  CHECK(unseen.body == 0u);
}

TEST_CASE("with clearances it is seen from the nearest body at the nearest pose") {
  TwoBodies found;
  found.clearance = 0.6;
  found.clearances.source = {0};
  found.clearances.distance = {0.3};
  found.clearances.pose = {1};
  found.clearances.body = {1};
  found.clearances.xyz = found.rows().xyz;
  const Conflict seen = found.conflict(found.bodies);
  CHECK(seen.body == 1u);
  CHECK(seen.first_touch == Side::kRight);
  check_equal(seen.lateral, -3.5);
  found.clearances.pose = {0};  // a pose that the second body lacks
  const Conflict lost = found.conflict(found.bodies);
  CHECK(lost.first_touch ==
        Side::kRight);  // seen from the body that touches first, at its first pose
  CHECK_FALSE(lost.lateral);
  CHECK_FALSE(lost.height);
}

TEST_CASE("bodies of another search are refused") {
  const TwoBodies found;
  std::vector<Body> others = found.bodies;
  others[1].poses[0].translation[2] = 1e-9;
  check_refused([&] { return found.conflict(others); }, "is the result of another vehicle");
  CHECK_THROWS_AS(found.conflict(std::span(found.bodies).first(1)), InputError);
  Found one;
  one.quanta = {{0, 0, 0}};
  const ScratchFolder folder;
  check_refused(
      [&] { return find_conflicts(one.write(folder), one.poses, TwoBodies::with(found.bodies)); },
      "is the result of one model, and a vehicle");
}

TEST_CASE("a topic of BCF names the body that it is seen from") {
  const TwoBodies found;
  const ResultHeader header = found.header();
  const auto markup = [&](std::span<const Body> given) {
    Conflicts conflicts;
    conflicts.listed.push_back(found.conflict(given));
    const ConflictOptions options = TwoBodies::with(given);
    const Answer answer = answer_of(header);
    const ConflictFile file{conflicts, options, header, answer, found.poses, {}};
    return bcf_markup(file, conflicts.listed[0]);
  };
  check_says(markup(found.bodies),
             "2 m right of the position of body a &lt; b &amp; c and 0.5 m above it");
  check_says(markup({}), "10 m left of the path's position");
}
