// The shifts that free a path and its conflicts, against brute force over all shifts.
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "clearway/clearway.hpp"
#include "core/geometry/quantisation.hpp"
#include "core/query/search_result.hpp"
#include "io/result/conflicts/shift_file.hpp"
#include "support/catch.hpp"
#include "support/engines/brute_force.hpp"
#include "support/result_fixture.hpp"
#include "support/scenes.hpp"
#include "support/solid_scene.hpp"
#include "support/store_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

constexpr Quantisation kSteps{{0.001, 0.001, 0.001}, {0, 0, 0}};

/// Points and a query, searched on the CPU.
struct Scene {
  Scene(const std::vector<Vec3>& places, Query asked) : query(std::move(asked)) {
    std::vector<Quantum> quanta;
    for (const Vec3& p : places) {
      quanta.push_back({static_cast<std::int32_t>(std::lround(p.x * 1000)),
                        static_cast<std::int32_t>(std::lround(p.y * 1000)),
                        static_cast<std::int32_t>(std::lround(p.z * 1000))});
      points.push_back(position(kSteps, quanta.back()[0], quanta.back()[1], quanta.back()[2]));
    }
    write_las(folder / "scan.las", quanta, kSteps);
    convert({folder / "scan.las"}, folder / "scan.h5", {.cell_points = 64, .threads = 2});
    query.first_pose = true;
    search(Store(folder / "scan.h5"), query, folder / "out.h5",
           {.device = Device::kCpu, .threads = 2});
  }

  Conflicts conflicts() const {
    ConflictOptions how;
    how.min_points = 1;
    how.threads = 2;
    how.bodies = query.bodies;
    return find_conflicts(Result(folder / "out.h5"), query.poses, how);
  }

  ShiftTable shifts(const ShiftOptions& options, int threads = 2) const {
    const Session session(folder / "scan.h5", {.device = Device::kCpu, .threads = threads});
    return find_shifts(session, Result(folder / "out.h5"), query, conflicts().listed, options);
  }

  std::vector<Vec3> searched_points() const {
    std::vector<Vec3> out;
    for (const Vec3& p : points) {
      const bool ignored = std::ranges::any_of(query.ignore_boxes, [&](const Box& box) {
        return p.x >= box.lo.x && p.x <= box.hi.x && p.y >= box.lo.y && p.y <= box.hi.y &&
               p.z >= box.lo.z && p.z <= box.hi.z;
      });
      if (!ignored) out.push_back(p);
    }
    return out;
  }

  /// Whether nothing is within the radius of what moves at the shifted poses from first to last,
  /// or between poses on the ways that begin there.
  bool is_free(std::uint32_t first, std::uint32_t last, double shift, double radius) const {
    if (query.between_poses && last + 1 < query.poses.size()) ++last;
    std::vector<Body> bodies = query.bodies;
    if (bodies.empty()) {
      Body one{"", query.model, query.poses, {}};
      for (std::uint32_t i = 0; i < query.poses.size(); ++i) one.path_pose.push_back(i);
      bodies.push_back(one);
    }
    const std::vector<Vec3> searched = searched_points();
    for (const Body& body : bodies) {
      Query moved(body.model, {}, {.radius = radius});
      moved.between_poses = query.between_poses;
      moved.floor = body.floor ? body.floor : query.floor;
      if (moved.floor) *moved.floor -= radius - query.radius;
      for (std::size_t k = 0; k < body.poses.size(); ++k) {
        const std::uint32_t i = body.path_pose[k];
        if (i < first || i > last) continue;
        Pose pose = body.poses[k];
        for (int axis = 0; axis < 3; ++axis) {
          pose.translation[axis] += shift * query.poses[i].rotation[3 * axis + 1];
        }
        moved.poses.push_back(pose);
      }
      for (const std::uint32_t touch : brute_force_first_poses(searched, moved)) {
        if (touch != kNoPose) return false;
      }
    }
    return true;
  }

  /// The first of the shifts, in their order, that frees the poses.
  std::optional<double> least_shift(std::uint32_t first, std::uint32_t last,
                                    const std::vector<double>& shifts) const {
    const auto budget = Result(folder / "out.h5").answer().budget;
    const double radius = budget ? query.radius + budget->clear() : query.radius;
    for (const double shift : shifts) {
      if (is_free(first, last, shift, radius)) return shift;
    }
    return std::nullopt;
  }

  Query query;
  std::vector<Vec3> points;
  ScratchFolder folder;
};

/// Multiples of `hundredths` / 100 by length, left first, so many on each side.
std::vector<double> in_order(int hundredths, int right, int left) {
  std::vector<double> out{0};
  for (int k = 1; k <= std::max(right, left); ++k) {
    if (k <= left) out.push_back(k * hundredths / 100.0);
    if (k <= right) out.push_back(-k * hundredths / 100.0);
  }
  return out;
}

/// What the scenes showed together, so that no kind of answer is missing.
struct Seen {
  int rows = 0, left = 0, right = 0, none = 0, free = 0, paths_shifted = 0, paths_free = 0;
  int in_doubt = 0;  // rows and paths for which warnings put the least shift in doubt
  std::uint64_t searches = 0, tried = 0;

  void count(const StretchShift& row) {
    ++rows;
    if (!row.shift) {
      ++none;
    } else if (*row.shift == 0) {
      ++free;
    } else {
      ++(*row.shift > 0 ? left : right);
    }
  }
};

/// Compares a shift with that of brute force, which knows no warnings: if they put that one in
/// doubt, a later shift is taken, or none.
void check_shift(const StretchShift& row, std::optional<double> least,
                 const std::vector<double>& shifts, Seen& seen) {
  if (row.shift == least) return;
  ++seen.in_doubt;
  REQUIRE(least);
  if (row.shift) {
    CHECK(std::ranges::find(shifts, *row.shift) > std::ranges::find(shifts, *least));
  } else {
    CHECK_FALSE(row.warned_of.empty());
  }
}

void check_scene(const Scene& scene, int hundredths, int right, int left, Seen& seen) {
  ShiftOptions options;
  options.lateral_from = -right * hundredths / 100.0;
  options.lateral_to = left * hundredths / 100.0;
  options.step = hundredths / 100.0;
  const std::vector<double> shifts = in_order(hundredths, right, left);
  const Conflicts conflicts = scene.conflicts();
  const ShiftTable table = scene.shifts(options);
  REQUIRE(table.conflicts.size() == conflicts.listed.size());
  for (std::size_t i = 0; i < table.conflicts.size(); ++i) {
    const Conflict& conflict = conflicts.listed[i];
    const StretchShift& row = table.conflicts[i];
    CAPTURE(conflict.id, conflict.first_pose, conflict.last_pose);
    CHECK(row.conflict == conflict.id);
    CHECK(row.first_pose == conflict.first_pose);
    CHECK(row.last_pose == conflict.last_pose);
    CHECK(row.chainage_from == conflict.chainage_from);
    CHECK(row.chainage_to == conflict.chainage_to);
    const auto least = scene.least_shift(conflict.first_pose, conflict.last_pose, shifts);
    check_shift(row, least, shifts, seen);
    seen.count(row);
    seen.searches += row.searches;
    seen.tried += shifts.size();
  }
  const auto last = static_cast<std::uint32_t>(scene.query.poses.size() - 1);
  CHECK(table.path.conflict == 0);
  CHECK(table.path.first_pose == 0);
  CHECK(table.path.last_pose == last);
  check_shift(table.path, scene.least_shift(0, last, shifts), shifts, seen);
  if (table.path.shift) ++(*table.path.shift == 0 ? seen.paths_free : seen.paths_shifted);
  const ShiftTable alone = scene.shifts(options, 1);
  CHECK(alone.searches == table.searches);
}

/// A path along x that winds a little, and rolls.
std::vector<Pose> winding_path(Random& random, std::size_t poses) {
  std::vector<Pose> out;
  double turn = uniform(random, -0.3, 0.3), y = 0;
  for (std::size_t i = 0; i < poses; ++i) {
    turn += uniform(random, -0.15, 0.15);
    y += 0.3 * std::sin(turn);
    Pose pose = rotation({0, 0, 1}, turn, {0.3 * static_cast<double>(i), y, 0});
    if (below(random, 3) == 0) pose = printed_with_six_digits(pose);
    out.push_back(pose);
  }
  return out;
}

/// Clumps of points beside and on the way.
std::vector<Vec3> clumps(Random& random, double length) {
  std::vector<Vec3> out;
  const std::uint64_t count = 1 + below(random, 5);
  for (std::uint64_t c = 0; c < count; ++c) {
    const Vec3 middle{uniform(random, -0.5, length + 0.5), uniform(random, -1, 1),
                      uniform(random, -0.2, 0.5)};
    const double size = below(random, 3) == 0 ? 0.6 : 0.15;
    const std::uint64_t points = 1 + below(random, 40);
    for (std::uint64_t i = 0; i < points; ++i) {
      out.push_back(middle + random_point(random, {{-size, -size, -size}, {size, size, size}}));
    }
  }
  return out;
}

Model part_of(Random& random, int kind) {
  const Box box{{-0.5, -0.25, -0.1}, {0.5, 0.25, 0.4}};
  if (kind == 0) return Model(random_points(random, box, 25));
  Bodies bodies;
  bodies.add(box_surface(box), kind == 2);
  Model model(bodies.surface.vertices);
  model.triangles = bodies.surface.triangles;
  if (kind == 2) model.solid_of = bodies.solid_of;
  return model;
}

/// Several bodies that follow the path with offsets of their own; some lack poses at its ends.
std::vector<Body> bodies_on(Random& random, const std::vector<Pose>& path, bool ways) {
  std::vector<Body> out;
  const std::uint64_t count = 1 + below(random, 3);
  for (std::uint64_t b = 0; b < count; ++b) {
    Body body{"body " + std::to_string(b),
              part_of(random, ways ? 0 : static_cast<int>(below(random, 3))),
              {},
              {}};
    const std::uint64_t ends = std::min<std::uint64_t>(path.size(), 4);
    const std::uint64_t from = below(random, ends), to = path.size() - below(random, ends);
    const Vec3 offset{uniform(random, -0.8, 0.8), uniform(random, -0.2, 0.2), 0};
    for (std::uint64_t i = from; i < to; ++i) {
      Pose pose = rotation({0, 0, 1}, 0.1 * static_cast<double>(b), path[i].position() + offset);
      body.poses.push_back(pose);
      body.path_pose.push_back(static_cast<std::uint32_t>(i));
    }
    out.push_back(body);
  }
  return out;
}

Query random_query(Random& random, const std::function<int(int)>& choose) {
  const std::size_t poses = 1 + below(random, 14);
  const bool ways = choose(3) == 0;
  const int kind = ways ? 0 : choose(3);
  Query query(part_of(random, kind), winding_path(random, poses),
              {.radius = uniform(random, 0.02, 0.2)});
  query.between_poses = ways;
  if (choose(3) == 0) {
    query.bodies = bodies_on(random, query.poses, ways);
    query.model = Model();
  }
  if (choose(4) == 0) query.ignore_boxes = {{{0.5, -1, -1}, {1.5, 0.4, 1}}};
  if (choose(5) == 0) {
    query.error_pose = 0.01;
    query.error_scan = 0.005;
  }
  if (choose(3) == 0) query.floor = uniform(random, -0.2, 0.3);
  if (query.floor && !query.bodies.empty()) query.bodies.front().floor = uniform(random, -0.2, 0.3);
  return query;
}

/// A wall of points beside a straight path, at y from the middle.
std::vector<Vec3> wall(double from, double to, double y) {
  std::vector<Vec3> out;
  for (double x = from; x <= to; x += 0.1) {
    for (double z = 0; z < 0.5; z += 0.1) out.push_back({x, y, z});
  }
  return out;
}

std::vector<Pose> straight(int poses) {
  std::vector<Pose> out;
  for (int i = 0; i < poses; ++i) out.push_back(translation({0.5 * i, 0, 0}));
  return out;
}

/// A solid of 2 x 1 x 1 m that goes along the x axis, without a margin to speak of.
Query box_on(std::vector<Pose> poses, double radius = 0.001) {
  Bodies bodies;
  bodies.add(box_surface({{-1, -0.5, 0}, {1, 0.5, 1}}));
  return bodies.query(std::move(poses), radius);
}

template <typename Refusal>
std::string refusal(const std::function<void()>& call) {
  try {
    call();
  } catch (const Refusal& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("shifts are those that brute force finds, in 300 random scenes") {
  Seen seen;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    CAPTURE(seed);
    Random random(seed);
    const auto choose = [&](int of) {
      return static_cast<int>(below(random, static_cast<std::uint64_t>(of)));
    };
    const Query query = random_query(random, choose);
    const double length = 0.3 * static_cast<double>(query.poses.size());
    const Scene scene(clumps(random, length), query);
    const int hundredths = 2 + choose(8);
    check_scene(scene, hundredths, choose(120 / hundredths), choose(120 / hundredths), seen);
  }
  CAPTURE(seen.rows, seen.left, seen.right, seen.none, seen.paths_shifted, seen.paths_free,
          seen.in_doubt, seen.searches, seen.tried);
  CHECK(seen.rows > 300);
  CHECK(seen.left > 50);
  CHECK(seen.right > 50);
  CHECK(seen.none > 50);
  CHECK(seen.free == 0);
  CHECK(seen.in_doubt * 8 < seen.rows);
  CHECK(seen.paths_shifted > 20);
  CHECK(seen.paths_free > 10);
  // Most shifts were ruled out without a search.
  CHECK(seen.searches * 3 < seen.tried);
}

TEST_CASE("of two shifts of the same length the one to the left is taken") {
  // A post in the middle of the way, so that 0.51 m to either side pass it.
  std::vector<Vec3> post;
  for (int i = 0; i < 20; ++i) post.push_back({3, 0, 0.02 * i});
  const Scene scene(post, box_on(straight(12)));
  const ShiftTable table = scene.shifts({});
  REQUIRE(table.conflicts.size() == 1);
  CHECK(table.conflicts[0].shift == 0.51);
  CHECK(table.path.shift == 0.51);
  CHECK(side_of(table.path) == std::string("left"));
  const ShiftTable right = scene.shifts({.lateral_from = -2, .lateral_to = 0.4});
  CHECK(right.conflicts[0].shift == -0.51);
  CHECK(side_of(right.path) == std::string("right"));
}

TEST_CASE("a shift that leads past what was scanned says so") {
  std::vector<Vec3> points;
  for (double x = -3; x <= 40; x += 0.1) {
    for (double y = -6; y <= 6; y += 0.1) points.push_back({x, y, -0.01});
  }
  const auto freed = [&](double half) {
    std::vector<Vec3> all = points;
    for (double y = -half; y <= half; y += 0.05) {
      for (int i = 1; i < 20; ++i) all.push_back({15, y, 0.02 * i});
    }
    Random random(1);
    for (Vec3& p : all) {
      p = p + random_point(random, {{-0.003, -0.003, -0.003}, {0.003, 0.003, 0.003}});
    }
    const Scene scene(all, box_on(straight(60), 0.005));
    const ShiftTable table = scene.shifts({.lateral_from = -15, .lateral_to = 0, .step = 0.8});
    REQUIRE(table.conflicts.size() == 1);
    REQUIRE(table.conflicts[0].shift);
    return table.conflicts[0];
  };
  CHECK(freed(2).warned_of.empty());
  const StretchShift far = freed(6);
  CHECK(*far.shift <= -6.5);
  CHECK(far.warned_of == std::vector<std::string>{"nothing-below"});
}

TEST_CASE("a range ends where it says, and one that ends before the shift frees nothing") {
  const Scene scene(wall(2, 4, 0.4), box_on(straight(12)));
  CHECK(scene.shifts({.lateral_from = -0.11, .lateral_to = 0}).path.shift == -0.11);
  CHECK_FALSE(scene.shifts({.lateral_from = -0.1, .lateral_to = 0}).path.shift);
  const ShiftTable none = scene.shifts({.lateral_from = 0, .lateral_to = 0});
  CHECK_FALSE(none.path.shift);
  CHECK(none.searches == 0);
  // 57 steps of 0.01 are more than 0.57 in doubles.
  const Scene far(wall(2, 4, -0.07), box_on(straight(12), 0.0001));
  CHECK(far.shifts({.lateral_from = -0.01, .lateral_to = 0.57, .step = 0.01}).path.shift == 0.44);
  CHECK(far.shifts({.lateral_from = 0, .lateral_to = 0.57, .step = 0.57}).path.shift == 0.57);
  CHECK(far.shifts({.lateral_from = 0, .lateral_to = 0.9, .step = 0.3}).path.shift == 0.6);
}

TEST_CASE("a path on which nothing collides is free as it is") {
  const Scene scene(wall(2, 4, 3), box_on(straight(12)));
  const ShiftTable table = scene.shifts({});
  CHECK(table.conflicts.empty());
  CHECK(table.path.shift == 0);
  CHECK(table.searches == 1);
  CHECK(side_of(table.path) == std::string());
}

TEST_CASE(
    "where both walls are too near, nothing frees the place, and the others are still freed") {
  std::vector<Vec3> points = wall(2, 3, 0.45);
  const auto add = [&](const std::vector<Vec3>& more) {
    points.insert(points.end(), more.begin(), more.end());
  };
  add(wall(2, 3, -0.45));
  add(wall(8, 9, -0.4));
  const Scene scene(points, box_on(straight(24)));
  const ShiftTable table = scene.shifts({.lateral_from = -0.5, .lateral_to = 0.5});
  REQUIRE(table.conflicts.size() == 3);
  CHECK_FALSE(table.conflicts[0].shift);
  CHECK_FALSE(table.conflicts[1].shift);
  CHECK(table.conflicts[2].shift == 0.11);
  CHECK_FALSE(table.path.shift);
  CHECK(table.path.searches == 0);  // what no stretch has, the path cannot have
}

TEST_CASE("a path of one pose has shifts") {
  const Scene scene(wall(-0.5, 0.5, 0.3), box_on({translation({0, 0, 0})}));
  const ShiftTable table = scene.shifts({});
  REQUIRE(table.conflicts.size() == 1);
  CHECK(table.conflicts[0].first_pose == table.conflicts[0].last_pose);
  CHECK(table.conflicts[0].shift == -0.21);
  CHECK(table.path.shift == -0.21);
}

TEST_CASE("the shifted stretch has its least distance where the result has clearances") {
  Query query = box_on(straight(12), 0.1);
  query.clearance = 0.3;
  std::vector<Vec3> points = wall(2, 4, 0.4);
  const Scene scene(points, query);
  const ShiftTable table = scene.shifts({.step = 0.05});
  REQUIRE(table.conflicts.size() == 1);
  CHECK(table.conflicts[0].shift == -0.2);
  REQUIRE(table.conflicts[0].least_distance);
  CHECK(*table.conflicts[0].least_distance == Approx(0.1).margin(1e-12));
  query.clearance = 0;
  CHECK_FALSE(Scene(points, query).shifts({.step = 0.05}).conflicts[0].least_distance);
}

TEST_CASE("left is seen along the axes that point ahead and up") {
  // The front of this vehicle points along +y, so that +x is to its right.
  std::vector<Pose> poses;
  for (int i = 0; i < 12; ++i) poses.push_back(translation({0, 0.5 * i, 0}));
  Bodies bodies;
  bodies.add(box_surface({{-0.5, -1, 0}, {0.5, 1, 1}}));
  std::vector<Vec3> points;
  for (const Vec3& p : wall(2, 4, 0.4)) points.push_back({p.y, p.x, p.z});
  const Scene scene(points, bodies.query(poses, 0.001));
  CHECK(scene.shifts({.forward = Axis::kPlusY}).path.shift == 0.11);
  CHECK(scene.shifts({.forward = Axis::kMinusY}).path.shift == -0.11);
}

TEST_CASE("what shifts cannot be found of is refused") {
  const Scene scene(wall(2, 4, 0.4), box_on(straight(12)));
  const auto refused = [&](const ShiftOptions& options) {
    return refusal<UsageError>([&] { scene.shifts(options); });
  };
  CHECK_THAT(refused({.step = 0}), Contains("a step of 0 m"));
  CHECK_THAT(refused({.step = -1}), Contains("above 0"));
  CHECK_THAT(refused({.step = std::nan("")}), Contains("above 0"));
  CHECK_THAT(refused({.lateral_from = 0.1}), Contains("contains 0"));
  CHECK_THAT(refused({.lateral_to = -0.1}), Contains("contains 0"));
  CHECK_THAT(refused({.lateral_to = std::numeric_limits<double>::infinity()}),
             Contains("contains 0"));
  CHECK_THAT(refused({.step = 1e-6}), Contains("more than 1,000,000"));
  CHECK_THAT(refused({.step = 1e-300}), Contains("more than 1,000,000"));
  CHECK_THAT(refused({.forward = Axis::kPlusZ}), Contains("same axis"));
  const std::vector<double> stations{1, 2};
  CHECK_THAT(refused({.station = stations}), Contains("one for each pose"));

  const Session session(scene.folder / "scan.h5", {.device = Device::kCpu, .threads = 2});
  const Result result(scene.folder / "out.h5");
  const auto of = [&](const Query& query, const std::vector<Conflict>& conflicts) {
    find_shifts(session, result, query, conflicts);
  };
  Query other = scene.query;
  other.poses[3].translation[1] += 1;
  CHECK_THAT(refusal<InputError>([&] { of(other, {}); }), Contains("another trajectory"));
  other = scene.query;
  other.model.vertices[0].x -= 1;
  CHECK_THAT(refusal<InputError>([&] { of(other, {}); }), Contains("another model"));
  Conflict beyond;
  beyond.id = 7;
  beyond.last_pose = 12;
  CHECK_THAT(refusal<UsageError>([&] { of(scene.query, {beyond}); }),
             Contains("conflict 7 is at poses 0 to 12"));

  const Scene elsewhere(wall(2, 4, 0.3), box_on(straight(12)));
  CHECK_THAT(refusal<InputError>([&] {
               find_shifts(session, Result(elsewhere.folder / "out.h5"), scene.query, {});
             }),
             Contains("another environment"));
}

TEST_CASE("a stop ends the search for shifts") {
  const Scene scene(wall(2, 4, 0.4), box_on(straight(12)));
  std::atomic<bool> stop = true;
  ShiftOptions options;
  options.stop = &stop;
  CHECK_THROWS_AS(scene.shifts(options), Interrupted);
}

TEST_CASE("a table of shifts that was written is read again, and only for its result") {
  const Scene scene(wall(2, 4, 0.4), box_on(straight(12)));
  const ShiftTable table = scene.shifts({});
  const Result result(scene.folder / "out.h5");
  const Conflicts conflicts = scene.conflicts();
  ConflictOptions how;
  how.min_points = 1;
  write_shifts({table, conflicts, how, result.reader(), "m"}, ShiftFormat::kJson,
               scene.folder / "s.json");
  const ShiftTable again = read_shifts(scene.folder / "s.json", result.reader());
  CHECK(again.step == 0.01);
  CHECK(again.lateral_from == -2);
  CHECK(again.searches == table.searches);
  CHECK(again.path.shift == table.path.shift);
  REQUIRE(again.conflicts.size() == 1);
  CHECK(again.conflicts[0].shift == table.conflicts[0].shift);
  CHECK(again.conflicts[0].chainage_to == table.conflicts[0].chainage_to);

  check_shifts(again, conflicts, result.reader());
  CHECK_THAT(refusal<InputError>([&] { check_shifts(again, Conflicts(), result.reader()); }),
             Contains("its 0 conflicts are not those of the table of shifts"));
  const Scene other(wall(2, 4, 0.3), box_on(straight(12)));
  CHECK_THAT(refusal<InputError>([&] {
               read_shifts(scene.folder / "s.json", Result(other.folder / "out.h5").reader());
             }),
             Contains("of another result"));
}
