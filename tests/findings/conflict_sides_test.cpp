// Where conflicts lie, seen from the model.
#include "clearway/error.hpp"
#include "findings/conflict_fixture.hpp"
#include "io/result/answer.hpp"
#include "io/result/conflicts/bcf/bcf_text.hpp"
#include "support/compare.hpp"

using namespace clearway;
using namespace clearway::test;

TEST_CASE("lateral and height are along the axes of the model at the pose") {
  const Pose straight = translation({100, 50, 0});
  const Pose turned{{0, -1, 0, 1, 0, 0, 0, 0, 1}, {100, 50, 0}};  // y is ahead, -x is left
  // +x is left; seen from above it would be -x
  const ConflictOptions upside_down{.forward = Axis::kPlusY, .up = Axis::kMinusZ};
  struct Row {
    Vec3 at;
    Pose pose;
    double lateral, height;
    ConflictOptions options = {};
  };
  for (const Row& row :
       {Row{{101, 52.5, 0.75}, straight, 2.5, 0.75}, Row{{101, 48.5, -0.75}, straight, -1.5, -0.75},
        Row{{98, 50, 3}, turned, 2, 3}, Row{{102, 50, 3}, straight, 2, -3, upside_down}}) {
    const Conflict found = one_point(row.at, row.pose).first_conflict(row.options);
    check_equal(found.lateral, row.lateral);
    check_equal(found.height, row.height);
  }
}

TEST_CASE("lateral and height are of the nearest point where it is known") {
  Found found{.quanta = {{0, 0, 0}, {0, 100, 0}},
              .poses = {translation({0, 0, 0}), translation({0, 10, 1})},
              .clearance = 0.6};
  found.clear({0, 1}, {0.3, 0.2}, {0, 1});
  found.clearances.xyz = found.rows().xyz;
  const Conflict one = found.first_conflict();
  CHECK(one.lateral == found.rows().xyz[1].y - 10);
  check_equal(one.height, -1);
}

TEST_CASE("an obstacle has the station where it stands, whichever way the vehicle faces") {
  const auto station = [](double turn, const std::vector<double>& ways, Axis forward) {
    Found found{.quanta = {{2400, 300, 0}}, .first_pose = {2}, .poses = {}};
    for (const double x : ways) {
      found.poses.push_back(rotation({0, 0, 1}, turn * std::acos(-1) / 180, {x, 0, 0}));
    }
    return *found.first_conflict({.forward = forward}).obstacle_chainage;
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
  const Pose ahead = translation({100, 50, 0});
  const Pose turned = rotation({0, 0, 1}, std::acos(-1) / 2, {100, 50, 0});
  const ConflictOptions to_minus_y{.forward = Axis::kMinusY},
      lying{.forward = Axis::kMinusY, .up = Axis::kPlusX};
  struct Row {
    Vec3 at;
    Side side;
    Pose pose;
    ConflictOptions options = {};
  };
  for (const Row& row :
       {Row{{100, 52, 0}, Side::kLeft, ahead}, Row{{100, 48, 0}, Side::kRight, ahead},
        Row{{100, 50, 2}, Side::kAbove, ahead}, Row{{100, 50, -2}, Side::kBelow, ahead},
        Row{{103, 50.5, 0}, Side::kFront, ahead},
        Row{{103, 52, 0}, Side::kLeft, ahead},  // beside the way, however far ahead
        Row{{97, 50, 0}, Side::kBehind, ahead},
        Row{{100, 50.9, 0.5}, Side::kLeft, ahead},  // inside: the nearest side
        Row{{100, 52, 0}, Side::kFront, turned}, Row{{98, 50, 0}, Side::kLeft, turned},
        Row{{100, 48, 0}, Side::kFront, ahead, to_minus_y},
        Row{{102, 50, 0}, Side::kLeft, ahead, to_minus_y},
        Row{{102, 50, 0}, Side::kAbove, ahead, lying}}) {
    CAPTURE(row.at.x, row.at.y, row.at.z);
    CHECK(one_point(row.at, row.pose).first_conflict(row.options).first_touch == row.side);
  }
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

  Conflict conflict(std::span<const Body> given) const { return first_conflict({.bodies = given}); }
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
  found.clear({0}, {0.3}, {1});
  found.clearances.body = {1};
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
  const Found one{.quanta = {{0, 0, 0}}};
  check_refused([&] { one.first_conflict({.bodies = found.bodies}); },
                "is the result of one model, and a vehicle");
}

TEST_CASE("a topic of BCF names the body that it is seen from") {
  const TwoBodies found;
  const ResultHeader header = found.header();
  const auto markup = [&](std::span<const Body> given) {
    Conflicts conflicts;
    conflicts.listed.push_back(found.conflict(given));
    const ConflictOptions options{.bodies = given};
    const Answer answer = answer_of(header);
    const ConflictFile file{conflicts, options, header, answer, found.poses, {}};
    return bcf_markup(file, conflicts.listed[0]);
  };
  check_says(markup(found.bodies),
             "2 m right of the position of body a &lt; b &amp; c and 0.5 m above it");
  check_says(markup({}), "10 m left of the path's position");
}
