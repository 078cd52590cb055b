// Groups of colliding points, against all pairs.
#include <utility>

#include "findings/colliding_spacing.hpp"
#include "findings/conflict_fixture.hpp"
#include "findings/group/point_groups.hpp"
#include "findings/match_conflicts.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

std::int32_t within(Random& random, std::int32_t extent) {
  return static_cast<std::int32_t>(below(random, 2 * static_cast<std::uint64_t>(extent) + 1)) -
         extent;
}

/// Loose points, clumps of many, lines and repeated points, some of them far away.
Quanta random_quanta(Random& random, std::size_t count, std::int32_t extent) {
  Quanta out;
  while (out.size() < count) {
    const std::array<std::int32_t, 3> at{within(random, extent), within(random, extent),
                                         within(random, extent / 4)};
    const std::uint64_t kind = below(random, 5);
    const std::uint64_t more = kind == 0 ? 1 : below(random, 40);
    const std::int32_t spread = kind == 1 ? 0 : std::max(1, extent / 40);
    for (std::uint64_t i = 0; i < more && out.size() < count; ++i) {
      auto p = at;
      for (std::int32_t& q : p) q += within(random, spread);
      if (kind == 2) p = {at[0] + static_cast<std::int32_t>(i) * spread, at[1], at[2]};
      out.push_back(p);
    }
  }
  return out;
}

}  // namespace

TEST_CASE("random points are grouped as all pairs are, with any threads and scales") {
  Random random(1);
  std::size_t groups = 0, scenes = 0;
  for (const std::int32_t extent : {30, 400, 5000, 1'000'000}) {
    for (const double part : {0.002, 0.02, 0.1, 0.7}) {
      for (const bool skewed : {false, true}) {
        Found found{.quanta = random_quanta(random, 200 + below(random, 400), extent)};
        if (skewed) {
          const double z_scale = std::pow(10, uniform(random, -4, -0.3));
          found.quantisation = {{0.001, 0.002, z_scale}, {500'000, 4'000'000, 100}};
        }
        const double gap = std::max(1.0, part * extent) * 0.001 * uniform(random, 0.7, 1.3);
        groups += check_groups(found, gap, static_cast<int>(1 + below(random, 4)));
        ++scenes;
      }
    }
  }
  CHECK(groups > 3 * scenes);  // not all points are in one group
}

TEST_CASE("points are grouped alike however few are at work at the same time") {
  Random random(2);
  for (const std::int32_t extent : {30, 400, 5000}) {
    std::vector<QuantumPoint> points;
    for (const auto& q : random_quanta(random, 1000, extent))
      points.push_back({{q[0], q[1], q[2]}});
    const Quantisation steps{{0.001, 0.001, 0.001}, {0, 0, 0}};
    const Neighbourhood near(steps, 0.05 * extent * 0.001);
    NoProgress progress;
    std::vector<bool> only;
    for (std::size_t i = 0; i < points.size(); ++i) only.push_back(below(random, 3) > 0);
    for (const std::vector<bool>* of : {static_cast<const std::vector<bool>*>(nullptr),
                                        static_cast<const std::vector<bool>*>(&only)}) {
      const PointGroups whole = group_points(points, near, 3, progress, {}, of);
      for (const std::uint64_t at_work : {1, 50, 700}) {
        std::uint64_t most = 0;  // of a layer that is not divided
        const GroupingLimit limit{at_work, [&](std::uint64_t count) {
                                    CHECK(count > at_work);
                                    most = std::max(most, count);
                                  }};
        const PointGroups found = group_points(points, near, 3, progress, limit, of);
        CHECK(found.of_point == whole.of_point);
        check_equal(found.count, whole.count);
        check_equal(found.small_points, whole.small_points);
        CHECK(most < points.size());
      }
    }
  }
}

TEST_CASE("points exactly at the gap are neighbours, wherever the scan is") {
  for (const Vec3& offset : {Vec3{0, 0, 0}, Vec3{500'000, 4'000'000, 100}}) {
    const Quantisation steps{{0.001, 0.001, 0.001}, {offset.x, offset.y, offset.z}};
    for (const double gap : {0.3, 0.1, 1.0, 0.05}) {
      for (const std::int32_t more : {0, 1}) {
        Found found{.quantisation = steps};
        // A lattice whose neighbours are as far apart as the gap, or a step more.
        const std::int32_t edge = static_cast<std::int32_t>(std::lround(gap / 0.001)) + more;
        for (std::int32_t i = 0; i < 216; ++i) {
          found.quanta.push_back({i % 6 * edge, i / 6 % 6 * edge, i / 36 * edge});
        }
        CHECK(check_groups(found, gap) == (more == 0 ? 1 : 216));
      }
    }
    // Points 0.3 m apart, on the diagonal of 0.1, 0.2 and 0.2.
    const Found slanted{.quanta = {{0, 0, 0}, {100, 200, 200}, {1000, 0, 0}, {1100, 200, 201}},
                        .quantisation = steps};
    check_equal(check_groups(slanted, 0.3), 3);
  }
}

TEST_CASE("a gap below the step joins only points at one place") {
  Found found;
  found.quanta = {{0, 0, 0}, {0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {1, 1, 0}, {7, 7, 7}};
  check_equal(check_groups(found, 0.0009), 4);
  check_equal(check_groups(found, 0.001), 2);
}

TEST_CASE("integers over their whole range are compared without overflow") {
  constexpr std::int32_t kMost = 2'147'483'647, kLeast = -kMost - 1;
  Found found;
  found.quantisation = {{1, 1, 1}, {0, 0, 0}};
  found.quanta = {{kLeast, kLeast, kLeast}, {kMost, kMost, kMost}, {0, 0, 0}, {kMost, 0, 0}};
  check_equal(check_groups(found, 1e9), 4);
  check_equal(check_groups(found, 2'147'483'647), 3);
  check_equal(check_groups(found, 3'719'550'786), 2);  // sqrt(3) 2^31, rounded down
  check_equal(check_groups(found, 3'719'550'787), 1);
  check_equal(check_groups(found, 7'439'101'574), 1);
  check_equal(check_groups(found, 1e30), 1);
  found.quantisation.scale[2] = 2;
  check_equal(check_groups(found, 1e9), 4);
  check_equal(check_groups(found, 1e200), 1);
}

TEST_CASE("dense places that are just too far apart stay apart") {
  // Two tilted plates of many points that are the gap, or a step more, apart.
  for (const std::int32_t more : {0, 1}) {
    Found found;
    for (std::int32_t i = 0; i < 1500; ++i) {
      const std::int32_t x = i % 50, y = i / 50, z = x / 3;
      found.quanta.push_back({x, y, z});
      found.quanta.push_back({x, y, z + 300 + more});
    }
    // The nearest pairs are not straight above each other; all_pairs() decides.
    check_groups(found, 0.3);
    check_equal(check_groups(found, 0.2), 2);
  }
}

TEST_CASE("many points at few places are grouped fast") {
  Found found;
  for (std::int32_t i = 0; i < 200'000; ++i) found.quanta.push_back({i % 2 * 300, 0, i % 3 * 900});
  check_equal(found.conflicts({.threads = 2}).groups, 3);
  check_equal(found.conflicts({.gap = 0.299, .threads = 2}).groups, 6);
}

namespace {

/// Points every 100 mm along x, in quanta of a millimetre.
Quanta row(int from, int to, int y = 0) {
  Quanta out;
  for (int x = from; x <= to; x += 100) out.push_back({x, y, 0});
  return out;
}

Quanta both(Quanta a, const Quanta& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

/// A result with its conflicts, in a folder of its own.
struct Grouped {
  explicit Grouped(const Quanta& quanta, std::uint64_t hash, const Clearances& clearances = {})
      : found{.quanta = quanta, .clearance = clearances.size() > 0 ? 2.0 : 0.0},
        result(written(hash, clearances)) {
    conflicts =
        find_conflicts(result, found.poses, {.min_points = 4}, &conflict_of, &conflict_of_near);
  }

  Result written(std::uint64_t hash, const Clearances& clearances) const {
    ResultHeader header = found.header();
    header.environment_hash = hash;
    header.environment_points = 1000;
    write_result(folder / "out.h5", header, found.rows(), 1000, clearances);
    return Result(folder / "out.h5");
  }
  GroupedResult grouped() const {
    return {result, conflicts, conflict_of, conflict_of_near, found.poses};
  }

  ScratchFolder folder;
  Found found;
  Result result;
  Conflicts conflicts;
  std::vector<std::uint32_t> conflict_of, conflict_of_near;
};

ConflictMatch match(const Quanta& a, const Quanta& b, double gap = 0.3) {
  return match_conflicts(Grouped(a, 1).grouped(), Grouped(b, 2).grouped(), gap, 0);
}

/// What a match says, as in "same 1-1, gone 2".
std::string text_of(const ConflictMatch& match) {
  std::string out;
  const auto add = [&](const std::string& what, const auto& number) {
    out += (out.empty() ? "" : ", ") + what + " " + std::to_string(number);
  };
  for (const auto& [a, b] : match.same) add("same " + std::to_string(a) + " as", b);
  for (const std::uint32_t id : match.added) add("added", id);
  for (const std::uint32_t id : match.gone) add("gone", id);
  for (const auto& part : match.grown) add("grown", part.conflict);
  for (const std::uint32_t id : match.shrunk) add("shrunk", id);
  for (const std::size_t group : match.small) add("small", group);
  for (const NotSearched& one : match.not_searched) add("not searched", one.conflict);
  return out;
}

}  // namespace

TEST_CASE("conflicts are the same where their points are near, and otherwise new or gone") {
  const Quanta one = row(0, 1000), whole = row(0, 3000), few = row(0, 300), away = row(7000, 7200);
  const Quanta halves = both(row(0, 1300), row(1700, 3000)), two = both(one, row(5000, 6000));
  // Two sides of a rectangle, whose box holds a row near its opposite corner.
  Quanta bent = row(0, 4000);
  for (int y = 100; y <= 2000; y += 100) bent.push_back({0, y, 0});
  struct Row {
    Quanta before, after;
    const char* match;
    double gap = 0.3;
  };
  for (const Row& given :
       {Row{two, both(row(20, 1020), row(9000, 9900)), "same 1 as 1, added 2, gone 2"},
        Row{bent, row(3000, 3600, 1800), "added 1, gone 1"},
        Row{whole, halves, "same 1 as 1, same 1 as 2"},
        Row{halves, whole, "same 1 as 1, same 2 as 1"}, Row{one, whole, "same 1 as 1, grown 1"},
        // Small groups count as points, but are no partners.
        Row{one, row(0, 200), "shrunk 1"}, Row{few, both(few, away), "same 1 as 1, small 0"},
        Row{both(few, away), both(few, away), "same 1 as 1"},
        // Equal points match whatever the gap.
        Row{two, two, "same 1 as 1, same 2 as 2", 1e-300},
        Row{two, two, "same 1 as 1, same 2 as 2", 1e-12}, Row{two, two, "same 1 as 1, same 2 as 2"},
        Row{{}, {}, ""}, Row{{}, one, "added 1"}, Row{one, {}, "gone 1"}}) {
    check_equal(text_of(match(given.before, given.after, given.gap)), given.match);
  }
  const ConflictMatch longer = match(one, whole);
  REQUIRE(longer.grown.size() == 1);
  check_equal(longer.grown[0].points, 17);  // from 1,400 on
  check_equal(longer.grown[0].source, 14);
  CHECK(longer.grown[0].box.lo.x == Approx(1.4));
}

TEST_CASE("a point is near up to the gap, and not a step beyond") {
  for (const int axis : {0, 1, 2}) {
    for (const int away : {-301, -300, 300, 301}) {
      Quanta a, b;
      for (int i = 0; i < 4; ++i) {
        a.push_back({0, 0, 0});
        a.back()[static_cast<std::size_t>((axis + 1) % 3)] = 50 * i;
        b.push_back(a.back());
        b.back()[static_cast<std::size_t>(axis)] = away;
      }
      CHECK(match(a, b).same.size() == (std::abs(away) == 300 ? 1 : 0));
    }
  }
}

TEST_CASE("what was just free before is not a new part") {
  Clearances clearances;
  const Quanta further = row(1400, 2000);
  for (std::size_t i = 0; i < further.size(); ++i) {
    clearances.source.push_back(100 + i);
    clearances.xyz.push_back({further[i][0] / 1000.0, 0, 0});
    clearances.distance.push_back(i < 6 ? 0.51 : 0.53);  // the radius is 0.5
    clearances.pose.push_back(0);
  }
  const Grouped a(row(0, 1000), 1, clearances), b(row(0, 2400), 2);
  const ConflictMatch found = match_conflicts(a.grouped(), b.grouped(), 0.3, 0.02);
  check_equal(text_of(found), "same 1 as 1, grown 1");
  CHECK(found.grown.at(0).box.lo.x == Approx(2.3));  // beyond the gap of the last one at 1.9
}

namespace {

/// The lower median of the distances to the nearest point at another place, by looking at all
/// pairs.
std::optional<double> spacing_by_all_pairs(const Found& found) {
  const std::vector<Vec3> xyz = found.rows().xyz;
  std::vector<double> distances;
  for (std::size_t i = 0; i < xyz.size(); ++i) {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t j = 0; j < xyz.size(); ++j) {
      if (found.quanta[i] == found.quanta[j]) continue;
      const Vec3 d = xyz[i] - xyz[j];
      least = std::min(least, std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z));
    }
    distances.push_back(least);
  }
  std::ranges::sort(distances);
  return distances[(distances.size() - 1) / 2];
}

}  // namespace

TEST_CASE("the usual grouping follows from how far apart the colliding points are") {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    CAPTURE(seed);
    Random random(seed);
    Found found;
    const double size = 0.2 * static_cast<double>(1 + below(random, 40));
    for (const Vec3& p : random_points(random, {{0, 0, 0}, {size, size, size / 4}}, 400)) {
      found.quanta.push_back(millimetres(p));
      if (seed % 2 == 0) found.quanta.push_back(found.quanta[below(random, found.quanta.size())]);
    }
    const Conflicts conflicts = found.conflicts();
    REQUIRE(conflicts.spacing);
    const double s = spacing_by_all_pairs(found).value();
    CHECK(*conflicts.spacing == Approx(s).epsilon(1e-9));
    CHECK(conflicts.gap == Approx(std::max(0.3, 3 * s)));
    const double patch = std::clamp(std::ceil(0.01 / (s * s)), 1.0, 10.0);
    CHECK(conflicts.min_points == static_cast<std::uint64_t>(patch));
  }
}

TEST_CASE("with few places, or where nothing collides, the grouping is fixed") {
  Found few;
  for (int k = 0; k < 9; ++k) few.quanta.push_back({5000 * k, 0, 0});
  for (int k = 0; k < 9; ++k) few.quanta.push_back({5000 * k, 0, 0});
  const Conflicts found = few.conflicts();
  check_equal(found.listed.size(), 9);
  check_equal(found.gap, 0.3);
  check_equal(found.min_points, 1);
  CHECK_FALSE(found.spacing);
  few.quanta.push_back({5000 * 9, 0, 0});
  CHECK(few.conflicts().spacing == 5.0);
  check_equal(few.conflicts().listed.size(), 1);
  check_equal(Found().conflicts().gap, 0.3);
  check_equal(Found().conflicts().min_points, 10);
  // What is asked for is taken, and the other of the two stays as usual.
  const Conflicts asked = few.conflicts({.gap = 1});
  check_equal(asked.gap, 1);
  check_equal(asked.min_points, 1);
}

TEST_CASE("the spacing of many points is that of every place to its nearest, however they lie") {
  // Lattices, whose spacing is known: sparse points beside dense ones, and points at one place.
  struct Part {
    std::int32_t edge, step;  ///< points on each edge of a cube, and steps from one to the next
    int copies = 1;
  };
  struct Row {
    std::vector<Part> parts;
    double spacing;  ///< in steps
  };
  const Quantisation millimetres{{0.001, 0.001, 0.001}, {0, 0, 0}};
  for (const Row& row : {Row{{{60, 7}}, 7}, Row{{{40, 5, 4}}, 5}, Row{{{50, 1}, {44, 900}}, 1},
                         Row{{{44, 1}, {50, 900}}, 900}, Row{{{30, 1, 3}, {52, 2000}}, 2000}}) {
    CAPTURE(row.spacing);
    std::vector<QuantumPoint> points;
    std::int32_t from = -70'000;
    for (const Part& part : row.parts) {
      for (std::int32_t i = 0; i < part.edge * part.edge * part.edge * part.copies; ++i) {
        const std::int32_t at = i / part.copies;
        points.push_back(
            {{from + at % part.edge * part.step, at / part.edge % part.edge * part.step,
              at / part.edge / part.edge * part.step}});
      }
      from += 200'000;
    }
    Random random(1);
    std::ranges::shuffle(points, random);
    REQUIRE(points.size() > 2 * kSpacingSample);
    NoProgress progress;
    const std::optional<double> spacing = colliding_spacing(points, millimetres, progress);
    REQUIRE(spacing);
    CHECK(*spacing == Approx(0.001 * row.spacing).epsilon(1e-12));
  }
}
