// Where the conflicts of a vehicle lie, seen from its bodies.
#include "clearway/error.hpp"
#include "findings/conflict_fixture.hpp"
#include "io/result/answer.hpp"
#include "io/result/conflicts/bcf/bcf_text.hpp"

using namespace clearway;
using namespace clearway::test;
using Catch::Contains;

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
  CHECK(seen.side == Side::kRight);
  CHECK(seen.lateral == -2);
  CHECK(seen.height == 0.5);
  const Conflict unseen = found.conflict({});
  CHECK(unseen.side == Side::kUnknown);
  CHECK(unseen.lateral == 10);
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
  CHECK(seen.side == Side::kRight);
  CHECK(seen.lateral == -3.5);
  found.clearances.pose = {0};  // a pose that the second body lacks
  const Conflict lost = found.conflict(found.bodies);
  CHECK(lost.side == Side::kRight);  // seen from the body that touches first, at its first pose
  CHECK_FALSE(lost.lateral);
  CHECK_FALSE(lost.height);
}

TEST_CASE("bodies of another search are refused") {
  const TwoBodies found;
  std::vector<Body> others = found.bodies;
  others[1].poses[0].translation[2] = 1e-9;
  CHECK_THROWS_WITH(found.conflict(others), Contains("is the result of another vehicle"));
  CHECK_THROWS_AS(found.conflict(std::span(found.bodies).first(1)), InputError);
  Found one;
  one.quanta = {{0, 0, 0}};
  const ScratchFolder folder;
  CHECK_THROWS_WITH(find_conflicts(one.write(folder), one.poses, TwoBodies::with(found.bodies)),
                    Contains("is the result of one model, and a vehicle"));
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
  CHECK_THAT(markup(found.bodies),
             Contains("2 m right of the position of body a &lt; b &amp; c and 0.5 m above it"));
  CHECK_THAT(markup({}), Contains("10 m left of the path's position"));
}
