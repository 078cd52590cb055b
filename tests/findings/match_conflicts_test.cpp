#include "findings/match_conflicts.hpp"

#include <catch2/catch.hpp>
#include <utility>

#include "findings/conflict_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

using Ids = std::vector<std::uint32_t>;
using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

/// Points every 100 mm along x, in quanta of a millimetre.
void add_row(int from, int to, int y, Quanta& out) {
  for (int x = from; x <= to; x += 100) out.push_back({x, y, 0});
}

Quanta row(int from, int to, int y = 0) {
  Quanta out;
  add_row(from, to, y, out);
  return out;
}

Quanta both(Quanta a, const Quanta& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

/// A result with its conflicts, in a folder of its own.
struct Grouped {
  explicit Grouped(const Quanta& quanta, std::uint64_t hash, const Clearances& clearances = {})
      : found{.quanta = quanta, .first_pose = {}, .source = {}}, result(written(hash, clearances)) {
    ConflictOptions options;
    options.min_points = 4;
    conflicts = find_conflicts(result, found.poses, options, &conflict_of, &conflict_of_near);
  }

  Result written(std::uint64_t hash, const Clearances& clearances) {
    if (clearances.size() > 0) found.clearance = 2;
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

}  // namespace

TEST_CASE("conflicts are the same where their points are near, and otherwise new or gone") {
  const ConflictMatch found =
      match(both(row(0, 1000), row(5000, 6000)), both(row(20, 1020), row(9000, 9900)));
  CHECK(found.same == Pairs{{1, 1}});
  CHECK(found.gone == Ids{2});
  CHECK(found.added == Ids{2});
  CHECK(found.grown.empty());
  CHECK(found.not_searched.empty());
}

TEST_CASE("a point is near up to the gap, and not a step beyond") {
  for (const int axis : {0, 1, 2}) {
    for (const int sign : {-1, 1}) {
      for (const int away : {300, 301}) {
        Quanta a, b;
        for (int i = 0; i < 4; ++i) {
          a.push_back({0, 0, 0});
          a.back()[static_cast<std::size_t>((axis + 1) % 3)] = 50 * i;
          b.push_back(a.back());
          b.back()[static_cast<std::size_t>(axis)] = sign * away;
        }
        CHECK(match(a, b).same == (away == 300 ? Pairs{{1, 1}} : Pairs{}));
      }
    }
  }
}

TEST_CASE("a new thing in the box of an old one is new") {
  // Two sides of a rectangle, and a row near its opposite corner.
  Quanta bent = row(0, 4000);
  for (int y = 100; y <= 2000; y += 100) bent.push_back({0, y, 0});
  const ConflictMatch found = match(bent, row(3000, 3600, 1800));
  CHECK(found.same.empty());
  CHECK(found.added == Ids{1});
  CHECK(found.gone == Ids{1});
}

TEST_CASE("conflicts that split or merge are the same, and a new part is named") {
  const Quanta whole = row(0, 3000), halves = both(row(0, 1300), row(1700, 3000));
  const ConflictMatch split = match(whole, halves);
  CHECK(split.same == Pairs{{1, 1}, {1, 2}});
  CHECK((split.added.empty() && split.gone.empty() && split.grown.empty()));
  const ConflictMatch merged = match(halves, whole);
  CHECK(merged.same == Pairs{{1, 1}, {2, 1}});
  CHECK((merged.added.empty() && merged.gone.empty() && merged.grown.empty()));
  const ConflictMatch longer = match(row(0, 1000), whole);
  CHECK(longer.same == Pairs{{1, 1}});
  REQUIRE(longer.grown.size() == 1);
  CHECK(longer.grown[0].conflict == 1);
  CHECK(longer.grown[0].points == 17);  // from 1,400 on
  CHECK(longer.grown[0].source == 14);
  CHECK(longer.grown[0].box.lo.x == Approx(1.4));
}

TEST_CASE("small groups count as points, but are no partners") {
  const Quanta conflict = row(0, 1000), small = row(0, 200), elsewhere = row(7000, 7200);
  CHECK(match(conflict, small).shrunk == Ids{1});
  CHECK(match(conflict, small).gone.empty());
  CHECK(match(row(0, 300), both(row(0, 300), elsewhere)).small == std::vector<std::size_t>{0});
  CHECK(match(both(row(0, 300), elsewhere), both(row(0, 300), elsewhere)).small.empty());
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
  CHECK(found.same == Pairs{{1, 1}});
  REQUIRE(found.grown.size() == 1);
  CHECK(found.grown[0].box.lo.x == Approx(2.3));  // beyond the gap of the last one at 1.9
}

TEST_CASE("equal points match whatever the gap, and nothing matches nothing") {
  const Quanta a = both(row(0, 1000), row(5000, 6000));
  for (const double gap : {1e-300, 1e-12, 0.3}) {
    const ConflictMatch found = match(a, a, gap);
    CHECK(found.same.size() == 2);
    CHECK((found.added.empty() && found.gone.empty() && found.grown.empty()));
  }
  CHECK(match({}, {}).same.empty());
  CHECK(match({}, row(0, 1000)).added == Ids{1});
  CHECK(match(row(0, 1000), {}).gone == Ids{1});
}
