// What Clearway tells about conflicts: numbers, cuts, distances, and what is refused.
#include "clearway/error.hpp"
#include "findings/check_conflicts.hpp"
#include "findings/conflict_fixture.hpp"
#include "io/result/answer.hpp"
#include "io/result/conflicts/bcf/bcf_text.hpp"
#include "support/compare.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// Points every 0.1 m along x, each touched first at the pose beside it; poses every metre.
Found rail(std::int32_t metres) {
  Found out{.poses = {}};
  for (std::int32_t i = 0; i <= metres; ++i) out.poses.push_back(translation({1.0 * i, 0, 0}));
  for (std::int32_t i = 0; i < 10 * metres; ++i) {
    out.quanta.push_back({100 * i, 2000, 0});
    out.first_pose.push_back(static_cast<std::uint32_t>(i / 10));
  }
  return out;
}

}  // namespace

TEST_CASE("a conflict tells its points, box, centroid, poses and chainage") {
  const Found found{
      .quanta = {{0, 0, 0}, {100, 0, 0}, {101, 50, 7}, {90'000, 0, 0}},
      .first_pose = {2, 1, 1, 0},
      .source = {3, 8, 21, 22},
      .quantisation = {{0.001, 0.001, 0.001}, {500'000, 4'000'000, 100}},
      .poses = {translation({0, 0, 0}), translation({3, 4, 0}), translation({3, 4, 2})}};
  std::vector<std::uint32_t> conflict_of;
  const Conflicts out = found.conflicts({.min_points = 2}, &conflict_of);
  check_equal(out.colliding_points, 4);
  check_equal(out.groups, 2);
  check_equal(out.small_groups, 1);
  check_equal(out.small_points, 1);
  check_equal(out.path_length, 7);
  check_equal(out.longest_group, 2);
  check_equal(out.longest_group_points, 3);
  check_equal(conflict_of, {1, 1, 1, 0});
  REQUIRE(out.listed.size() == 1);
  const Conflict& c = out.listed[0];
  check_equal(c.id, 1);
  check_equal(c.points, 3);
  check_equal(c.source, 3);
  check_equal(c.group, 3);
  CHECK(c.box.lo == Vec3{500'000, 4'000'000, 100});
  CHECK(c.box.hi == position(found.quantisation, 101, 50, 7));
  CHECK(c.centroid == Vec3{67.0 * 0.001 + 500'000, (16 + 2 / 3.0) * 0.001 + 4'000'000,
                           (2 + 1 / 3.0) * 0.001 + 100});
  check_equal(c.first_pose, 1);
  check_equal(c.last_pose, 2);
  check_equal(c.chainage_from, 5);
  check_equal(c.chainage_to, 7);
  CHECK_FALSE((c.least_distance || c.nearest_pose || c.encroachment));
}

TEST_CASE("a conflict along the whole path is told by its height") {
  // The model of these results is 2 m wide and high, around the position of each pose.
  struct Case {
    const char* what;
    std::int32_t from_y, to_y, z;  // a strip of points along the path, millimetres
    std::int32_t rise;             // by how much some points are higher
    GroupPlace is;
    const char* heights;
  };
  const Case cases[] = {
      {"ground", -1400, 1400, -1200, 0, GroupPlace::kGround, ", 0.2 m below"},
      {"track of the left wheels", 500, 900, -1050, 0, GroupPlace::kGround, ", 0.05 m below"},
      {"rails", -700, 700, -950, 0, GroupPlace::kGround, ", 0.05 m above"},
      {"ground and what stands on it", -1400, 1400, -1200, 1500, GroupPlace::kGround,
       "0.2 m below to 1.3 m above"},
      {"roof of the scanner's vehicle", -500, 500, 900, 0, GroupPlace::kInside, ", 1.9 m above"},
      {"bonnet", -600, 300, -200, 40, GroupPlace::kInside, "0.8 to 0.84 m above"},
      {"mast", -50, 50, 0, 500, GroupPlace::kInside, "1 to 1.5 m above"},
      {"ceiling", -1400, 1400, 900, 0, GroupPlace::kOther, ", 1.9 m above"},
      {"rail of a fence", 900, 950, 100, 0, GroupPlace::kOther, ", 1.1 m above"},
      {"kerb", 900, 1200, -900, 0, GroupPlace::kOther, ", 0.1 m above"},
      {"wire that hangs", -100, 100, 800, 500, GroupPlace::kOther, "1.8 to 2.3 m above"},
  };
  for (const Case& of : cases) {
    CAPTURE(of.what);
    Found found = rail(60);
    found.quanta.clear();
    for (std::int32_t i = 0; i < 600; ++i) {
      const std::int32_t y = of.from_y + (of.to_y - of.from_y) * (i % 4) / 3;
      found.quanta.push_back({100 * i, y, of.z + (i >= 590 ? of.rise : 0)});
    }
    const Conflicts conflicts = found.conflicts({.gap = 2});
    CHECK(conflicts.longest_group_is == of.is);
    const std::vector<Message> warnings = conflict_warnings(conflicts, LengthUnit::kMetre);
    REQUIRE(warnings.size() == 1);
    CHECK(warnings[0].code == "one-long-conflict");
    const std::string& text = warnings[0].text;
    check_says(text, "spans 59 m of 60 m of path");
    check_says(text, of.heights);
    const auto says = [&](const char* words) { return text.find(words) != std::string::npos; };
    CHECK(says("under wheels") == (of.is == GroupPlace::kGround));
    CHECK(says("carried the scanner") == (of.is == GroupPlace::kInside));
  }
}

TEST_CASE("a conflict has the class of most of its points") {
  const Conflicts out = Found{
      .quanta = {{0, 0, 0}, {100, 0, 0}, {200, 0, 0}, {90'000, 0, 0}, {90'100, 0, 0}},
      .point_class = {18, 2, 18, 6,
                      5}}.conflicts({.min_points = 2});
  REQUIRE(out.listed.size() == 2);
  CHECK(out.listed[0].main_class == 18U);
  CHECK(out.listed[0].main_class_points == 2U);
  CHECK(out.listed[1].main_class == 5U);  // of equally many the smallest
  CHECK(out.listed[1].main_class_points == 1U);
  CHECK(out.classes == std::map<std::uint8_t, std::uint64_t>{{2, 1}, {5, 1}, {6, 1}, {18, 2}});
}

TEST_CASE("a group is cut at multiples of the split where it is longer") {
  const Found found = rail(60);
  const Conflicts cut = found.conflicts();
  check_equal(cut.groups, 1);
  check_equal(cut.longest_group, 59);
  check_equal(cut.longest_group_points, 600);
  REQUIRE(cut.listed.size() == 3);
  const double from[] = {0, 25, 50}, to[] = {24, 49, 59};
  for (std::size_t i = 0; i < 3; ++i) {
    CHECK(cut.listed[i].id == i + 1);
    CHECK(cut.listed[i].chainage_from == from[i]);
    CHECK(cut.listed[i].chainage_to == to[i]);
    check_equal(cut.listed[i].group, 0);
    CHECK(cut.listed[i].points == (i == 2 ? 100 : 250));
  }
  const std::pair<double, std::size_t> rows[] = {{0, 1}, {59, 1}, {58.5, 2}, {1e-9, 60}};
  for (const auto& [split, parts] : rows) {
    check_equal(found.conflicts({.split = split}).listed.size(), parts);
  }
  // Chainages begin where the first pose is said to be, and nothing else changes.
  for (const double start : {1234.5, -7.0}) {
    const Conflicts moved = found.conflicts({.chainage_start = start});
    REQUIRE(moved.listed.size() == cut.listed.size());
    CHECK(moved.path_length == cut.path_length);
    for (std::size_t i = 0; i < cut.listed.size(); ++i) {
      CHECK(moved.listed[i].id == cut.listed[i].id);
      CHECK(moved.listed[i].source == cut.listed[i].source);
      CHECK(moved.listed[i].chainage_from == cut.listed[i].chainage_from + start);
      CHECK(moved.listed[i].chainage_to == cut.listed[i].chainage_to + start);
    }
  }
}

TEST_CASE(
    "small groups are counted whole, and stretches of large ones listed whatever their size") {
  Found found = rail(26);
  found.quanta.push_back({900'000, 0, 0});
  found.first_pose.push_back(0);
  const Conflicts out = found.conflicts({.min_points = 12});
  check_equal(out.small_groups, 1);
  check_equal(out.small_points, 1);
  REQUIRE(out.listed.size() == 1);  // 25 m long: not cut
  const Conflicts cut = found.conflicts({.min_points = 12, .split = 24.5});
  REQUIRE(cut.listed.size() == 2);
  check_equal(cut.listed[1].points, 10);
}

TEST_CASE("conflicts are numbered along the path, then by source") {
  const Found found{.quanta = {{0, 0, 0}, {5000, 0, 0}, {10'000, 0, 0}, {15'000, 0, 0}},
                    .first_pose = {1, 0, 1, 0}};
  std::vector<std::uint32_t> conflict_of;
  const Conflicts out = found.conflicts({.min_points = 1}, &conflict_of);
  check_equal(conflict_of, {3, 1, 4, 2});
  for (std::size_t i = 0; i < 4; ++i) CHECK(out.listed[i].id == i + 1);
}

TEST_CASE("least distances come from the clearances, of equal ones the smallest source") {
  Found found{.quanta = {{0, 0, 0}, {100, 0, 0}, {5000, 0, 0}, {5100, 0, 0}},
              .source = {2, 4, 6, 8},
              .clearance = 0.6};
  found.clear({1, 2, 4, 5, 8}, {0.01, 0.25, 0.25, 0.02, 0.5}, {0, 1, 0, 0, 1});
  const Conflicts out = found.conflicts({.min_points = 1});
  REQUIRE(out.listed.size() == 2);
  check_equal(out.listed[0].least_distance, 0.25);
  check_equal(out.listed[0].nearest_source, 2);
  CHECK(out.listed[0].nearest_pose == 1);
  check_equal(out.listed[0].encroachment, 0.25);
  CHECK_FALSE(out.listed[0].depth);  // a model of points has no depth
  check_equal(out.listed[1].least_distance, 0.5);
  check_equal(out.listed[1].nearest_source, 8);
}

TEST_CASE("conflicts with solids tell depth and points inside") {
  Found found{
      .quanta = {{0, 0, 0}, {100, 0, 0}, {200, 0, 0}, {5000, 0, 0}, {5100, 0, 0}, {9000, 0, 0}},
      .clearance = 0.4,
      .solids = 2};
  found.clear({0, 1, 2, 4}, {-0.25, 0.125, -0.5, 0.25}, {0, 1, 1, 0});
  const Conflicts out = found.conflicts({.min_points = 1});
  REQUIRE(out.listed.size() == 3);
  check_equal(out.listed[0].least_distance, -0.5);
  check_equal(out.listed[0].nearest_source, 2);
  CHECK(out.listed[0].nearest_pose == 1);
  check_equal(out.listed[0].encroachment, 1);
  check_equal(out.listed[0].depth, 0.5);
  check_equal(out.listed[0].points_inside, 2);
  for (const std::size_t outside : {1, 2}) {
    check_equal(out.listed[outside].depth, 0);
    check_equal(out.listed[outside].points_inside, 0);
  }
  found.clearance = 0;
  found.clearances = {};
  const Conflict without = found.first_conflict();
  CHECK_FALSE((without.depth || without.points_inside));
}

TEST_CASE("a result without colliding points has no conflicts") {
  const Conflicts out = Found().conflicts();
  CHECK(out.listed.empty());
  check_equal(out.groups, 0);
  check_equal(out.path_length, 1);
}

TEST_CASE("options that make no sense are refused") {
  const ScratchFolder folder;
  const Found found = rail(3);
  const Result result = found.write(folder);
  constexpr double kEndless = std::numeric_limits<double>::infinity();
  for (const ConflictOptions& options :
       {ConflictOptions{.up = Axis::kMinusX}, ConflictOptions{.split = -1},
        ConflictOptions{.split = 9e-10}, ConflictOptions{.split = std::nan("")},
        ConflictOptions{.split = kEndless}, ConflictOptions{.chainage_start = kEndless},
        ConflictOptions{.gap = -1}, ConflictOptions{.gap = std::nan("")},
        ConflictOptions{.gap = kEndless}}) {
    CAPTURE(options.gap, options.split, options.chainage_start);
    CHECK_THROWS_AS(find_conflicts(result, found.poses, options), UsageError);
  }
}

TEST_CASE("too little memory is refused with an amount that is enough") {
  const ScratchFolder folder;
  Found found;
  for (std::int32_t i = 0; i < 300'000; ++i) found.quanta.push_back({i * 400, i % 7, 0});
  const Result result = found.write(folder);
  ConflictOptions options{.gap = 0.3, .min_points = 1, .memory_bytes = 1 << 20};
  double enough = 0;
  for (int tries = 0; tries < 4; ++tries) {
    try {
      const Conflicts out = find_conflicts(result, found.poses, options);
      check_equal(out.groups, 300'000);
      CHECK(tries > 0);
      return;
    } catch (const ResourceError& error) {
      REQUIRE(error.remedy() == Remedy::kMoreMemory);
      CHECK(error.amount() > enough);
      enough = error.amount();
      options.memory_bytes = static_cast<std::uint64_t>(enough);
    }
  }
  FAIL("never enough");
}

TEST_CASE("a stop ends the work") {
  const std::atomic<bool> stop{true};
  CHECK_THROWS_AS(rail(3).conflicts({.stop = &stop}), Interrupted);
}

// Where conflicts lie, seen from the model or from the bodies of a vehicle.

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
