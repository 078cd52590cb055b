#include "findings/match_conflicts.hpp"

#include <catch2/catch.hpp>
#include <utility>

using namespace clearway;

namespace {

/// Conflicts with boxes of 1 m, whose least corners are these places.
Conflicts at(const std::vector<Vec3>& places) {
  Conflicts out;
  for (const Vec3& p : places) {
    Conflict c;
    c.id = static_cast<std::uint32_t>(out.listed.size() + 1);
    c.box = {p, {p.x + 1, p.y + 1, p.z + 1}};
    out.listed.push_back(c);
  }
  return out;
}

using Ids = std::vector<std::uint32_t>;
using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

}  // namespace

TEST_CASE("conflicts at the same place are the same, others are new or gone") {
  const Conflicts a = at({{0, 0, 0}, {10, 0, 0}, {20, 0, 0}});
  const Conflicts b = at({{20.2, 0.1, 0}, {40, 0, 0}, {0, 0, 0}});
  const ConflictMatch match = match_conflicts(a, b, 0.3);
  CHECK(match.same == Pairs{{1, 3}, {3, 1}});
  CHECK(match.gone == Ids{2});
  CHECK(match.added == Ids{2});
}

TEST_CASE("boxes overlap up to twice the gap apart") {
  const Conflicts a = at({{0, 0, 0}});
  for (const int axis : {0, 1, 2}) {
    for (const int sign : {-1, 1}) {
      Vec3 near{0, 0, 0}, far{0, 0, 0};
      near[axis] = sign * 1.59;
      far[axis] = sign * 1.61;
      CHECK(match_conflicts(a, at({near}), 0.3).same == Pairs{{1, 1}});
      CHECK(match_conflicts(a, at({far}), 0.3).same.empty());
    }
  }
}

TEST_CASE("the largest overlaps come first, and each conflict is matched once") {
  const Conflicts a = at({{0, 0, 0}, {0.5, 0, 0}});
  const Conflicts b = at({{0.4, 0, 0}, {0.1, 0, 0}, {0.6, 0, 0}});
  const ConflictMatch match = match_conflicts(a, b, 0.3);
  CHECK(match.same == Pairs{{1, 2}, {2, 1}});
  CHECK(match.added == Ids{3});
  CHECK(match.gone.empty());
}

TEST_CASE("long boxes are found from far away") {
  Conflicts b = at({{0, 0, 0}, {-500, 0, 0}});
  b.listed[1].box.hi.x = 100;
  CHECK(match_conflicts(at({{90, 0, 0}}), b, 0.3).same == Pairs{{1, 2}});
  CHECK(match_conflicts(b, at({{90, 0, 0}}), 0.3).same == Pairs{{2, 1}});
}

TEST_CASE("conflicts without extent match at their place whatever the gap") {
  Conflicts a = at({{500'000, 5'000'000, 100}, {500'001, 5'000'000, 100}, {7, 8, 9}});
  for (Conflict& c : a.listed) c.box.hi = c.box.lo;
  for (const double gap : {1e-300, 1e-12, 0.3}) {
    CHECK(match_conflicts(a, a, gap).same == Pairs{{1, 1}, {2, 2}, {3, 3}});
  }
  // Of flat boxes that touch, those with the most in common are matched first.
  a.listed[0].box = {{500'000, 5'000'000, 100}, {500'010, 5'000'010, 100}};
  a.listed[1].box = {{500'008, 5'000'000, 100}, {500'020, 5'000'010, 100}};
  Conflicts b = a;
  std::swap(b.listed[0].box, b.listed[1].box);
  CHECK(match_conflicts(a, b, 1e-300).same == Pairs{{1, 2}, {2, 1}, {3, 3}});
  // Boxes that only touch when grown do not overlap.
  CHECK(match_conflicts(at({{0, 0, 0}}), at({{2, 0, 0}}), 0.5).same.empty());
}

TEST_CASE("nothing matches nothing") {
  CHECK(match_conflicts({}, {}, 0.3).same.empty());
  CHECK(match_conflicts({}, at({{0, 0, 0}}), 0.3).added == Ids{1});
  CHECK(match_conflicts(at({{0, 0, 0}}), {}, 0.3).gone == Ids{1});
}
