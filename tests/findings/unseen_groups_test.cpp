// Groups of unseen cubes and the vehicle's cross-section, against their definitions.
#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string>
#include <utility>

#include "clearway/clearway.hpp"
#include "findings/searched_scene.hpp"
#include "findings/station_oracle.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/scenes.hpp"
#include "support/store_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// Steps that differ, so that the sides of a cube have different numbers of them.
constexpr Quantisation kRoadSteps{{0.001, 0.002, 0.0005}, {1000, -500, 20}};
const Vec3 kRoadOffset{1000, -500, 20};

struct RoadBeam {
  Vec3 from, to;
};

/// A car of points, from -0.3 to 0.3 m on each axis, that drives along x past what a scanner saw.
struct UnseenRoad {
  explicit UnseenRoad(const std::vector<RoadBeam>& beams) {
    std::vector<Quantum> quanta;
    std::string origins = "first,x,y,z\n";
    for (std::size_t i = 0; i < beams.size(); ++i) {
      const Vec3 to = beams[i].to;
      Quantum& q = quanta.emplace_back();
      for (int k = 0; k < 3; ++k) {
        q[k] = static_cast<std::int32_t>(std::lround(to[k] / kRoadSteps.scale[k]));
      }
      if (i > 0 && beams[i].from == beams[i - 1].from) continue;
      const Vec3 from = kRoadOffset + beams[i].from;
      origins += std::to_string(i) + "," + std::to_string(from.x) + "," + std::to_string(from.y) +
                 "," + std::to_string(from.z) + "\n";
    }
    write_las(folder / "scan.las", quanta, kRoadSteps);
    put_bytes(folder / "origins.csv", origins);
    convert({folder / "scan.las"}, folder / "scan.h5",
            {.cell_points = 512, .threads = 2, .origins = folder / "origins.csv"});
    std::vector<Vec3> car;
    for (int i = 0; i <= 6; ++i) {
      for (int j = 0; j <= 6; ++j) {
        for (const double x : {-0.3, 0.0, 0.3}) car.push_back({x, -0.3 + 0.1 * i, -0.3 + 0.1 * j});
      }
    }
    for (int i = 0; i <= 70; ++i) {
      query.poses.push_back(translation(kRoadOffset + Vec3{8 + 0.1 * i, 0, 0}));
    }
    query.model = Model{std::move(car)};
    query.radius = 0.1;
    query.first_pose = query.seen = true;
  }

  UnseenGroups groups(const ConflictOptions& options = {}) {
    search(Store(folder / "scan.h5"), query, folder / "out.h5",
           {.device = Device::kCpu, .threads = 2, .overwrite = true});
    return find_unseen_groups(Result(folder / "out.h5"), query.poses, options);
  }

  UnseenCubes cubes() const { return Result(folder / "out.h5").unseen(); }

  /// The middle of a cube whose side along each axis was asked to be `side`.
  static Vec3 middle(const std::array<std::int32_t, 3>& cube, double side) {
    Vec3 out{};
    for (int k = 0; k < 3; ++k) {
      const double quanta = std::round(side / kRoadSteps.scale[k]);
      out[k] = (quanta * cube[static_cast<std::size_t>(k)] + quanta / 2) * kRoadSteps.scale[k] +
               kRoadOffset[k];
    }
    return out;
  }

  Query query;
  ScratchFolder folder;
};

/// Beams from the origin to a wall at x = 20, of which those with y and z of `is_seen` are there.
template <typename IsSeen>
std::vector<RoadBeam> beams_where(IsSeen is_seen) {
  std::vector<RoadBeam> out;
  for (int i = -60; i <= 60; ++i) {
    for (int j = -60; j <= 60; ++j) {
      const double y = 0.04 * i + 0.012, z = 0.04 * j + 0.011;
      if (is_seen(y, z)) out.push_back({{0, 0, 0}, {20, y, z}});
    }
  }
  return out;
}

/// Beams to the wall, but for a wedge on the left that is hidden behind a board at x = 5.
std::vector<RoadBeam> behind_a_board() {
  auto out = beams_where([](double y, double) { return y < 0.1 || y > 1.2; });
  const auto stopped = beams_where([](double y, double) { return y >= 0.1 && y <= 1.2; });
  for (const RoadBeam& beam : stopped) out.push_back({beam.from, 0.25 * beam.to});
  return out;
}

}  // namespace

TEST_CASE("the cross-section holds the volume of the unseen cubes where the model reaches them") {
  const auto side = GENERATE(0.2, 0.1);
  const bool turned = side == 0.1;  // on its way, so that cubes lie askew in its cross-section
  // Along which axis the model is seen, and which two axes point left and up there.
  struct View {
    Axis forward, up;
    int left_axis, left_sign, up_axis, up_sign;
  };
  const auto view = GENERATE(
      View{Axis::kPlusX, Axis::kPlusZ, 1, 1, 2, 1}, View{Axis::kMinusX, Axis::kPlusZ, 1, -1, 2, 1},
      View{Axis::kPlusY, Axis::kMinusZ, 0, 1, 2, -1}, View{Axis::kMinusZ, Axis::kPlusX, 1, 1, 0, 1},
      View{Axis::kPlusZ, Axis::kMinusY, 0, -1, 1, -1});
  CAPTURE(side, static_cast<int>(view.forward), static_cast<int>(view.up));
  UnseenRoad road(behind_a_board());
  if (side != 0.2) road.query.seen_cube = side;
  for (Pose& pose : road.query.poses) {
    if (turned) pose = rotation({0, 0, 1}, 0.5, pose.position());
  }
  const UnseenFront front = road.groups({.forward = view.forward, .up = view.up}).front;
  check_near(front.cell, side, 1e-9);
  check_equal(front.unseen.size(), std::size_t{front.columns} * front.rows);
  const UnseenCubes cubes = road.cubes();
  std::vector<double> expected(front.unseen.size()), rounding(front.unseen.size());
  const double c = turned ? std::cos(0.5) : 1, s = turned ? std::sin(0.5) : 0;
  for (std::size_t i = 0; i < cubes.size(); ++i) {
    const Vec3 from =
        UnseenRoad::middle(cubes.cube[i], side) - road.query.poses[cubes.first_pose[i]].position();
    const Vec3 there{c * from.x + s * from.y, -s * from.x + c * from.y, from.z};
    const double left = view.left_sign * there[view.left_axis];
    const double up = view.up_sign * there[view.up_axis];
    for (std::size_t cell = 0; cell < expected.size(); ++cell) {
      const double y = front.left + static_cast<double>(cell % front.columns) * front.cell;
      const double z = front.up + static_cast<double>(cell / front.columns) * front.cell;
      const auto common = [&](double middle, double least) {
        return std::max(0.0, std::min(middle + side / 2, least + front.cell) -
                                 std::max(middle - side / 2, least));
      };
      // The cube is as long as it is wide and stands for its volume.
      const double part = common(left, y) * common(up, z) * side / (front.cell * front.cell);
      expected[cell] += part;
      if (part > 0) rounding[cell] += side / 64;  // half a step at each of the two axes
    }
  }
  double all = 0, swept = 0;
  for (std::size_t cell = 0; cell < expected.size(); ++cell) {
    CAPTURE(cell);
    CHECK(front.unseen[cell] == Approx(expected[cell]).margin(rounding[cell] + 1e-9));
    CHECK(front.unseen[cell] <= front.swept[cell]);
    all += front.unseen[cell];
    swept += front.swept[cell];
  }
  const double volume = side * side * side / (front.cell * front.cell);
  CHECK(all == Approx(static_cast<double>(cubes.size()) * volume));
  const auto seen = Result(road.folder / "out.h5").answer().seen;
  CHECK(swept == Approx(static_cast<double>(seen->swept) * volume));
  CHECK(swept > all);
}

TEST_CASE("where no beam went, all that the cross-section sweeps is unseen") {
  const std::vector<RoadBeam> nowhere{{{0, 50, 0}, {0, 51, 0}}};
  UnseenRoad seen(behind_a_board()), blind(nowhere);
  const UnseenFront some = seen.groups().front, all = blind.groups().front;
  CHECK(all.swept == some.swept);
  CHECK(all.unseen == all.swept);
  CHECK(some.unseen != some.swept);
  CHECK(std::pair(all.left, all.up) == std::pair(some.left, some.up));
}

TEST_CASE("a wide model has cells of several cubes, and their sums stay") {
  UnseenRoad wide(behind_a_board());
  for (const double y : {-3.1, 3.1}) wide.query.model.vertices.push_back({0, y, 0.1});
  const UnseenFront front = wide.groups().front;
  CHECK(front.cell == Approx(2 * 0.2));
  CHECK(front.columns <= 24);
  double swept = 0;
  for (const double length : front.swept) swept += length;
  const auto seen = Result(wide.folder / "out.h5").answer().seen;
  CHECK(swept * front.cell * front.cell == Approx(static_cast<double>(seen->swept) * 0.008));
}

TEST_CASE("a hidden wedge is one group on its side, with its stretch of the path") {
  UnseenRoad road(behind_a_board());
  const UnseenGroups found = road.groups({.chainage_start = 100});
  const UnseenCubes cubes = road.cubes();
  REQUIRE(found.listed.size() == 1);
  const UnseenGroup& group = found.listed[0];
  check_equal(group.id, 1);
  CHECK(group.cubes == cubes.size());
  CHECK(group.first_pose == *std::ranges::min_element(cubes.first_pose));
  CHECK(group.last_pose == *std::ranges::max_element(cubes.first_pose));
  CHECK(group.chainage_from == Approx(100 + 0.1 * group.first_pose));
  CHECK(group.chainage_to == Approx(100 + 0.1 * std::min(70u, group.last_pose + 1)));
  REQUIRE(group.seen);
  CHECK(group.seen->lo.y > -0.11);  // the wedge is on the left
  CHECK(group.seen->hi.y > 0.2);
  CHECK(group.along_path);
  CHECK_FALSE(group.is_ground);  // it goes along the path, but is too narrow
  CHECK_FALSE(group.behind_conflict);
  REQUIRE(found.middles.size() == cubes.size());
  check_equal(std::ranges::count(found.middles, group.middle), 1);
  for (std::size_t i = 0; i < cubes.size(); ++i) {
    CHECK(group.box.contains(UnseenRoad::middle(cubes.cube[i], 0.2)));
  }
  // Every step on which a cube is first reached lies in a stretch.
  for (const std::uint32_t pose : cubes.first_pose) {
    const double at = 100 + 0.1 * pose;
    CHECK(std::ranges::any_of(found.stretches, [&](const auto& stretch) {
      return stretch.first <= at + 1e-9 && at <= stretch.second + 1e-9;
    }));
  }

  // Groups that are too small are counted alone.
  road.query.seen_min = 100000;
  const UnseenGroups small = road.groups();
  CHECK(small.listed.empty());
  CHECK(small.stretches.empty());
  check_equal(small.small_groups, 1);
  CHECK(small.small_cubes == cubes.size());
  CHECK(small.front.unseen == found.front.unseen);
}

TEST_CASE("a group is behind a conflict where a colliding point is in it or touches it") {
  for (const double y : {0.25, -0.25}) {  // beside the wedge, and far from it
    CAPTURE(y);
    std::vector<RoadBeam> with_post = behind_a_board();
    for (int i = 0; i < 8; ++i) with_post.push_back({{11, -6, 0.3}, {11, y, -0.1 + 0.02 * i}});
    UnseenRoad road(with_post);
    const UnseenGroups found = road.groups();
    const UnseenCubes cubes = road.cubes();
    const Collisions hits = Result(road.folder / "out.h5").collisions();
    REQUIRE(hits.size() > 0);
    // By the definition: each pair of a colliding point's cube and an unseen cube.
    std::set<std::uint32_t> behind;
    for (const Vec3& hit : hits.xyz) {
      for (std::size_t i = 0; i < cubes.size(); ++i) {
        const Vec3 off = hit - UnseenRoad::middle(cubes.cube[i], 0.2);
        const double most = std::max({std::abs(off.x), std::abs(off.y), std::abs(off.z)});
        if (most < 1.5 * 0.2) behind.insert(cubes.group[i]);
      }
    }
    std::uint64_t count = 0;
    for (const UnseenGroup& group : found.listed) {
      CHECK(group.behind_conflict == behind.contains(group.id));
      count += group.behind_conflict ? 1 : 0;
    }
    CHECK(found.behind_conflicts == count);
    CHECK((count > 0) == (y > 0));
  }
}

TEST_CASE("what is unseen below or above all of the path is told as ground or sky") {
  UnseenRoad low(beams_where([](double, double z) { return z > -0.15; }));
  const UnseenGroups ground = low.groups();
  REQUIRE(ground.listed.size() == 1);
  CHECK(ground.listed[0].is_ground);
  CHECK_FALSE(ground.listed[0].is_sky);
  CHECK(ground.listed[0].side == Side::kBelow);
  // A model without its lowest part sweeps none of it, at the radius and half a cube above it.
  std::erase_if(low.query.model.vertices, [](const Vec3& m) { return m.z < 0.15; });
  CHECK(low.groups().listed.empty());

  UnseenRoad high(beams_where([](double, double z) { return z < 0.15; }));
  const UnseenGroups sky = high.groups();
  REQUIRE(sky.listed.size() == 1);
  CHECK(sky.listed[0].is_sky);
  CHECK_FALSE(sky.listed[0].is_ground);
  CHECK(sky.listed[0].side == Side::kAbove);
}

TEST_CASE("a row of stations on which the model meets an unseen cube is not clear") {
  UnseenRoad road(behind_a_board());
  std::vector<Pose>& path = road.query.poses;
  for (std::size_t i = 40; i < path.size(); ++i) path[i].translation[1] -= 0.7;
  const UnseenGroups groups = road.groups();
  const StationTable table =
      station_table(Result(road.folder / "out.h5"), path, {.every = 0.5, .threads = 2});
  const std::vector<std::size_t> row_of = rows_of(path, 0.5);
  std::size_t met = 0;
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (!collide(groups.middles, {Model{road.query.model}, {path[i]}, {.radius = 0.1}})) continue;
    ++met;
    CHECK(table.rows[row_of[i]].verdict == Verdict::kUndecided);
    CHECK(table.rows[row_of[i]].reasons == std::vector{Reason::kNotScanned});
  }
  CHECK(met > 20);
  const auto clear = std::ranges::count(table.rows, Verdict::kClear, &StationRow::verdict);
  CHECK(clear > 3);
  check_equal(std::ranges::count(table.rows, Verdict::kConflict, &StationRow::verdict), 0);
}

TEST_CASE("a result without seen space has no groups, and another path is refused") {
  UnseenRoad road(behind_a_board());
  road.groups();
  std::vector<Pose> other = road.query.poses;
  other.back().translation[0] += 1;
  CHECK_THROWS_AS(find_unseen_groups(Result(road.folder / "out.h5"), other), InputError);
  road.query.seen = false;
  const UnseenGroups none = road.groups();
  CHECK(none.listed.empty());
  CHECK(none.front.swept.empty());
  // Neither has one without poses.
  road.query.seen = true;
  road.query.poses.clear();
  CHECK(road.groups().listed.empty());
}
