// Where conflicts lie, seen from the model.
#include "clearway/error.hpp"
#include "findings/conflict_fixture.hpp"

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
  CHECK(left.lateral == 2.5);
  CHECK(left.height == 0.75);
  CHECK(at({101, 48.5, -0.75}, translation({100, 50, 0})).lateral == -1.5);
  const Pose turned{{0, -1, 0, 1, 0, 0, 0, 0, 1}, {100, 50, 0}};  // y is ahead, -x is left
  CHECK(at({98, 50, 3}, turned).lateral == 2);
  CHECK(at({98, 50, 3}, turned).height == 3);
  ConflictOptions how;
  how.forward = Axis::kPlusY;
  how.up = Axis::kMinusZ;  // +x is left; seen from above it would be -x
  CHECK(at({102, 50, 3}, translation({100, 50, 0}), how).lateral == 2);
  CHECK(at({102, 50, 3}, translation({100, 50, 0}), how).height == -3);
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
  CHECK(found_one.height == -1);
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
    return conflicts_with_sides(found, options).listed.at(0).side;
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
