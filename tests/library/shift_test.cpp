// The shifts that free a path and its conflicts, against brute force over all shifts.
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "io/result/conflicts/shift_file.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/questions.hpp"
#include "support/solid_scene.hpp"
#include "support/store_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

constexpr Quantisation kSteps{{0.001, 0.001, 0.001}, {0, 0, 0}};

/// Points and a query, searched on the CPU.
struct Scene {
  Scene(const std::vector<Vec3>& places, Query asked) : query(std::move(asked)) {
    const std::vector<Quantum> quanta = quantise(places, kSteps);
    points = positions_of(quanta, kSteps);
    write_las(folder / "scan.las", quanta, kSteps);
    convert({folder / "scan.las"}, folder / "scan.h5", {.cell_points = 64, .threads = 2});
    query.first_pose = true;
    search(Store(folder / "scan.h5"), query, folder / "out.h5",
           {.device = Device::kCpu, .threads = 2});
  }

  Result result() const { return Result(folder / "out.h5"); }

  Conflicts conflicts() const {
    ConflictOptions how{.min_points = 1, .threads = 2};
    how.bodies = query.bodies;
    return find_conflicts(result(), query.poses, how);
  }

  ShiftTable shifts(const ShiftOptions& options, int threads = 2) const {
    const Session session(folder / "scan.h5", {.device = Device::kCpu, .threads = threads});
    return find_shifts(session, result(), query, conflicts().listed, options);
  }

  /// The query with the poses from first to last alone, shifted.
  Query shifted(std::uint32_t first, std::uint32_t last, double shift) const {
    const auto moved = [&](Pose pose, std::uint32_t at) {
      for (int axis = 0; axis < 3; ++axis) {
        pose.translation[axis] += shift * query.poses[at].rotation[3 * axis + 1];
      }
      return pose;
    };
    Query out = query;
    out.poses.clear();
    for (std::uint32_t i = first; i <= last; ++i) out.poses.push_back(moved(query.poses[i], i));
    for (std::size_t b = 0; b < out.bodies.size(); ++b) {
      const Body& whole = query.bodies[b];
      out.bodies[b].poses.clear();
      out.bodies[b].path_pose.clear();
      for (std::size_t k = 0; k < whole.poses.size(); ++k) {
        const std::uint32_t i = whole.path_pose[k];
        if (i < first || i > last) continue;
        out.bodies[b].poses.push_back(moved(whole.poses[k], i));
        out.bodies[b].path_pose.push_back(i - first);
      }
    }
    return out;
  }

  /// The first of the shifts, in their order, at which nothing is within the radius of what moves
  /// at the poses from first to last, or between poses on the ways that begin there.
  std::optional<double> least_shift(std::uint32_t first, std::uint32_t last,
                                    const std::vector<double>& shifts) const {
    const auto budget = result().answer().budget;
    const double radius = budget ? query.radius + budget->clear() : query.radius;
    if (query.between_poses && last + 1 < query.poses.size()) ++last;
    std::vector<Vec3> searched;
    for (const Vec3& p : points) {
      const auto holds = [&](const Box& box) { return box.contains(p); };
      if (!std::ranges::any_of(query.ignore_boxes, holds)) searched.push_back(p);
    }
    for (const double shift : shifts) {
      const auto touches = first_touches(searched, shifted(first, last, shift), radius);
      if (std::ranges::all_of(touches, [](const auto& t) { return t.pose == kNoPose; })) {
        return shift;
      }
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
struct Shown {
  int rows = 0, left = 0, right = 0, none = 0, free = 0, paths_shifted = 0, paths_free = 0;
  int in_doubt = 0;  // rows and paths for which warnings put the least shift in doubt
  std::uint64_t searches = 0, tried = 0;
};

void check_scene(const Scene& scene, int hundredths, int right, int left, Shown& shown) {
  const ShiftOptions options{.lateral_from = -right * hundredths / 100.0,
                             .lateral_to = left * hundredths / 100.0,
                             .step = hundredths / 100.0};
  const std::vector<double> shifts = in_order(hundredths, right, left);
  const auto check_row = [&](const StretchShift& row, std::uint32_t conflict, std::uint32_t first,
                             std::uint32_t last) {
    CAPTURE(conflict, first, last);
    CHECK(row.conflict == conflict);
    CHECK(row.first_pose == first);
    CHECK(row.last_pose == last);
    const auto least = scene.least_shift(first, last, shifts);
    if (row.shift == least) return;
    // Brute force knows no warnings: if they put its shift in doubt, a later one is taken, or none.
    ++shown.in_doubt;
    REQUIRE(least);
    if (row.shift) {
      CHECK(std::ranges::find(shifts, *row.shift) > std::ranges::find(shifts, *least));
    } else {
      CHECK_FALSE(row.warned_of.empty());
    }
  };
  const Conflicts conflicts = scene.conflicts();
  const ShiftTable table = scene.shifts(options);
  REQUIRE(table.conflicts.size() == conflicts.listed.size());
  for (std::size_t i = 0; i < table.conflicts.size(); ++i) {
    const Conflict& conflict = conflicts.listed[i];
    const StretchShift& row = table.conflicts[i];
    check_row(row, conflict.id, conflict.first_pose, conflict.last_pose);
    CHECK(row.chainage_from == conflict.chainage_from);
    CHECK(row.chainage_to == conflict.chainage_to);
    const double shift = row.shift.value_or(0);
    ++shown.rows;
    ++(!row.shift ? shown.none : shift == 0 ? shown.free : shift > 0 ? shown.left : shown.right);
    shown.searches += row.searches;
    shown.tried += shifts.size();
  }
  check_row(table.path, 0, 0, static_cast<std::uint32_t>(scene.query.poses.size() - 1));
  if (table.path.shift) ++(*table.path.shift == 0 ? shown.paths_free : shown.paths_shifted);
  CHECK(scene.shifts(options, 1).searches == table.searches);
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
  const Surface surface = box_surface(box);
  return {surface.vertices, surface.triangles, std::vector<std::uint32_t>(kind == 2 ? 12 : 0)};
}

int chosen(Random& random, int of) {
  return static_cast<int>(below(random, static_cast<std::uint64_t>(of)));
}

Query random_query(Random& random) {
  const auto choose = [&](int of) { return chosen(random, of); };
  const std::size_t poses = 1 + below(random, 14);
  const bool ways = choose(3) == 0;
  const int kind = ways ? 0 : choose(3);
  Query query(part_of(random, kind), winding_path(random, poses),
              {.radius = uniform(random, 0.02, 0.2)});
  query.between_poses = ways;
  if (choose(3) == 0) {
    query.bodies = three_bodies(random, query.poses, !ways);
    std::erase_if(query.bodies, [](const Body& body) { return body.poses.empty(); });
    query.bodies.resize(1 + below(random, query.bodies.size()));
    for (Body& body : query.bodies) body.model = part_of(random, ways ? 0 : choose(3));
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

/// A solid of 2 x 1 x 1 m that goes along the x axis in so many poses, without a margin to speak
/// of.
Query box_on(int poses, double radius = 0.001) {
  Bodies bodies;
  bodies.add(box_surface({{-1, -0.5, 0}, {1, 0.5, 1}}));
  std::vector<Pose> straight;
  for (int i = 0; i < poses; ++i) straight.push_back(translation({0.5 * i, 0, 0}));
  return bodies.query(straight, radius);
}

}  // namespace

TEST_CASE("shifts are those that brute force finds, in 300 random scenes") {
  Shown seen;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    CAPTURE(seed);
    Random random(seed);
    const auto choose = [&](int of) { return chosen(random, of); };
    const Query query = random_query(random);
    const double length = 0.3 * static_cast<double>(query.poses.size());
    const Scene scene(clumps(random, length), query);
    const int hundredths = 2 + choose(8);
    check_scene(scene, hundredths, choose(120 / hundredths), choose(120 / hundredths), seen);
  }
  CAPTURE(seen.rows, seen.paths_shifted, seen.paths_free, seen.searches, seen.tried);
  CHECK(seen.rows > 300);
  CHECK(std::min({seen.left, seen.right, seen.none}) > 50);
  CHECK(seen.free == 0);
  CHECK(seen.in_doubt * 8 < seen.rows);
  CHECK(seen.paths_shifted > 20);
  CHECK(seen.paths_free > 10);
  // Most shifts were ruled out without a search.
  CHECK(seen.searches * 3 < seen.tried);
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
    const Scene scene(all, box_on(60, 0.005));
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

TEST_CASE(
    "the shortest step that frees a stretch is taken, and of equal ones the one to the left") {
  const Query box = box_on(12);
  std::vector<Vec3> post;
  for (int i = 0; i < 20; ++i) post.push_back({3, 0, 0.02 * i});
  const std::vector<Vec3> left = wall(2, 4, 0.4), right = wall(2, 4, -0.07);
  std::vector<Vec3> narrow = wall(2, 3, 0.45);
  for (const Vec3& p : wall(2, 3, -0.45)) narrow.push_back(p);
  for (const Vec3& p : wall(8, 9, -0.4)) narrow.push_back(p);
  // The front of this vehicle points along +y, so that +x is to its right.
  Query box_along_y = box;
  for (Vec3& p : box_along_y.model.vertices) std::swap(p.x, p.y);
  for (Pose& pose : box_along_y.poses) std::swap(pose.translation[0], pose.translation[1]);
  std::vector<Vec3> turned = left;
  for (Vec3& p : turned) std::swap(p.x, p.y);
  const Query close = box_on(12, 0.0001);
  using Shifts = std::vector<std::optional<double>>;
  const Shifts nothing{{}, {}};
  // shifts: of the conflicts, and then of the path.
  const auto check_shifts = [](const std::vector<Vec3>& points, const Query& query,
                               const ShiftOptions& options, const Shifts& shifts) {
    CAPTURE(options.lateral_from, options.lateral_to, options.step, shifts.size());
    const ShiftTable table = Scene(points, query).shifts(options);
    Shifts found;
    for (const StretchShift& stretch : table.conflicts) found.push_back(stretch.shift);
    found.push_back(table.path.shift);
    CHECK(found == shifts);
    if (!table.path.shift) CHECK(table.path.searches == 0);  // what no stretch has, no path has
    const double path = table.path.shift.value_or(0);
    check_equal(side_of(table.path), path > 0 ? "left" : path < 0 ? "right" : "");
    return table.searches;
  };
  check_shifts(post, box, {}, {0.51, 0.51});
  check_shifts(post, box, {.lateral_from = -2, .lateral_to = 0.4}, {-0.51, -0.51});
  check_shifts(left, box, {.lateral_from = -0.11, .lateral_to = 0}, {-0.11, -0.11});
  check_shifts(left, box, {.lateral_from = -0.1, .lateral_to = 0}, nothing);
  check_equal(check_shifts(left, box, {.lateral_from = 0, .lateral_to = 0}, nothing), 0);
  // 57 steps of 0.01 are more than 0.57 in doubles.
  check_shifts(right, close, {.lateral_from = -0.01, .lateral_to = 0.57}, {0.44, 0.44});
  check_shifts(right, close, {.lateral_from = 0, .lateral_to = 0.57, .step = 0.57}, {0.57, 0.57});
  check_shifts(right, close, {.lateral_from = 0, .lateral_to = 0.9, .step = 0.3}, {0.6, 0.6});
  check_equal(check_shifts(wall(2, 4, 3), box, {}, {0}), 1);
  // Two walls are too near, and further on there is one.
  check_shifts(narrow, box_on(24), {.lateral_from = -0.5, .lateral_to = 0.5}, {{}, {}, 0.11, {}});
  check_shifts(wall(-0.5, 0.5, 0.3), box_on(1), {}, {-0.21, -0.21});
  check_shifts(turned, box_along_y, {.forward = Axis::kPlusY}, {0.11, 0.11});
  check_shifts(turned, box_along_y, {.forward = Axis::kMinusY}, {-0.11, -0.11});
}

TEST_CASE("the shifted stretch has its least distance where the result has clearances") {
  Query query = box_on(12, 0.1);
  query.clearance = 0.3;
  const ShiftTable table = Scene(wall(2, 4, 0.4), query).shifts({.step = 0.05});
  REQUIRE(table.conflicts.size() == 1);
  CHECK(table.conflicts[0].shift == -0.2);
  REQUIRE(table.conflicts[0].least_distance);
  CHECK(*table.conflicts[0].least_distance == Approx(0.1).margin(1e-12));
  query.clearance = 0;
  const ShiftTable without = Scene(wall(2, 4, 0.4), query).shifts({.step = 0.05});
  CHECK_FALSE(without.conflicts[0].least_distance);
}

TEST_CASE("what shifts cannot be found of is refused, and a stop ends the search for them") {
  const Scene scene(wall(2, 4, 0.4), box_on(12));
  const std::vector<double> stations{1, 2};
  const auto refused = [&](const ShiftOptions& options, const char* words) {
    check_refused<UsageError>([&] { scene.shifts(options); }, words);
  };
  refused({.step = 0}, "a step of 0 m");
  refused({.step = -1}, "above 0");
  refused({.step = std::nan("")}, "above 0");
  refused({.lateral_from = 0.1}, "contains 0");
  refused({.lateral_to = -0.1}, "contains 0");
  refused({.lateral_to = std::numeric_limits<double>::infinity()}, "contains 0");
  refused({.step = 1e-6}, "more than 1,000,000");
  refused({.step = 1e-300}, "more than 1,000,000");
  refused({.forward = Axis::kPlusZ}, "same axis");
  refused({.station = stations}, "one for each pose");
  const Session session(scene.folder / "scan.h5", {.device = Device::kCpu, .threads = 2});
  const auto of = [&](const Scene& searched, const std::function<void(Query&)>& change,
                      const std::vector<Conflict>& conflicts) {
    return [&, change, conflicts] {
      Query query = scene.query;
      change(query);
      find_shifts(session, searched.result(), query, conflicts);
    };
  };
  check_refused<InputError>(of(scene, [](Query& q) { q.poses[3].translation[1] += 1; }, {}),
                            "another trajectory");
  check_refused<InputError>(of(scene, [](Query& q) { q.model.vertices[0].x -= 1; }, {}),
                            "another model");
  Conflict beyond;
  beyond.id = 7;
  beyond.last_pose = 12;
  check_refused<UsageError>(of(scene, [](Query&) {}, {beyond}), "conflict 7 is at poses 0 to 12");
  const Scene elsewhere(wall(2, 4, 0.3), box_on(12));
  check_refused<InputError>(of(elsewhere, [](Query&) {}, {}), "another environment");
  const std::atomic<bool> stop = true;
  CHECK_THROWS_AS(scene.shifts({.stop = &stop}), Interrupted);
}

TEST_CASE("a table of shifts that was written is read again, and only for its result") {
  const Scene scene(wall(2, 4, 0.4), box_on(12));
  const ShiftTable table = scene.shifts({});
  const Result result = scene.result();
  const Conflicts conflicts = scene.conflicts();
  const auto file = scene.folder / "s.json";
  write_shifts({table, conflicts, {.min_points = 1}, result.reader(), "m"}, ShiftFormat::kJson,
               file);
  const ShiftTable again = read_shifts(file, result.reader());
  CHECK(again.step == 0.01);
  CHECK(again.lateral_from == -2);
  CHECK(again.searches == table.searches);
  CHECK(again.path.shift == table.path.shift);
  REQUIRE(again.conflicts.size() == 1);
  CHECK(again.conflicts[0].shift == table.conflicts[0].shift);
  CHECK(again.conflicts[0].chainage_to == table.conflicts[0].chainage_to);

  check_shifts(again, conflicts, result.reader());
  check_refused<InputError>([&] { check_shifts(again, Conflicts(), result.reader()); },
                            "its 0 conflicts are not those of the table of shifts");
  const Scene other(wall(2, 4, 0.3), box_on(12));
  check_refused<InputError>([&] { read_shifts(file, other.result().reader()); },
                            "of another result");
}
