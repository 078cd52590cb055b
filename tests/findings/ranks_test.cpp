// Which conflict is the worst, and that everybody names the same one.
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "clearway/clearway.hpp"
#include "findings/conflict_rank.hpp"
#include "findings/searched_scene.hpp"
#include "io/result/answer.hpp"
#include "io/result/conflicts/conflict_fields.hpp"
#include "io/result/conflicts/conflict_words.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/solid_scene.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// Conflicts with ids in their order, ranked. Returns the ids from the worst on.
std::vector<std::uint32_t> order_of(std::vector<Conflict> listed, bool shifts = true,
                                    bool trims = true) {
  Conflicts conflicts;
  conflicts.knows_shifts = shifts;
  conflicts.knows_trims = trims;
  for (Conflict& conflict : listed) {
    conflict.id = static_cast<std::uint32_t>(conflicts.listed.size() + 1);
    conflicts.listed.push_back(conflict);
  }
  rank(conflicts);
  std::vector<std::uint32_t> out;
  for (const Conflict* conflict : by_rank(conflicts)) out.push_back(conflict->id);
  return out;
}

Conflict deep(double depth) { return {.points = 5, .colliding = 5, .depth = depth}; }

Conflict freed(std::optional<double> shift, std::optional<double> trim, std::uint64_t points = 5) {
  return {.points = points, .colliding = points, .own_shift_right = shift, .trim_above = trim};
}

Conflict near(double distance) { return {.points = 5, .least_distance = distance}; }

using Ids = std::vector<std::uint32_t>;

}  // namespace

TEST_CASE("conflicts are ranked by depth, then by what frees them, then by distance") {
  CHECK(order_of({near(0.2), freed(0.1, {}), deep(0.01), near(0.15), freed(0.3, 0.2), deep(0.5),
                  freed({}, {})}) == Ids{6, 3, 7, 5, 2, 4, 1});
  // The least of shift and trim counts; what is empty is infinite.
  CHECK(order_of({freed(0.1, 0.5), freed(0.4, 0.3), freed({}, 0.2)}) == Ids{2, 3, 1});
  CHECK(order_of({freed(0.1, 0.5), freed(0.4, 0.3), freed({}, 0.2)}, false) == Ids{1, 2, 3});
  CHECK(order_of({freed(0.1, 0.5), freed(0.4, 0.3), freed({}, 0.2)}, true, false) == Ids{3, 2, 1});
  // Where nothing is known, and of equal ones, the most points, and then the first.
  CHECK(order_of({freed({}, {}, 4), freed({}, {}, 9), freed({}, {}, 4)}, false, false) ==
        Ids{2, 1, 3});
  CHECK(order_of({freed(0.1, {}, 4), freed(0.1, {}, 9), freed(0.1, {}, 4)}) == Ids{2, 1, 3});
}

TEST_CASE("a headline says what can be done") {
  Conflicts all;
  all.knows_shifts = all.knows_trims = true;
  Conflict c{.id = 3,
             .points = 9,
             .colliding = 9,
             .own_shift_left = 0.2,
             .own_shift_right = 0.1199,
             .trim_left = 0.15,
             .side = Side::kLeft};
  const auto says = [&](const RemedyWords& how, const std::string& words) {
    check_equal(remedy_words(c, how), words);
  };
  const RemedyWords how{all, "m"};
  const std::string trim = "To pass it: a trim of 0.15 m on the left is enough",
                    shift =
                        " Its own points need a shift of at least 0.12 m to the right; "
                        "clearway shift says whether one frees it.",
                    neither = "Neither a trim nor a shift of up to 2 m is known to free it.";
  says(how, trim + "." + shift);
  ShiftTable shifts;
  shifts.lateral_from = -2;
  shifts.lateral_to = 2;
  shifts.step = 0.01;
  shifts.conflicts.push_back({.conflict = 3, .shift = -0.12});
  RemedyWords confirmed{all, "m"};
  confirmed.shifts = &shifts;
  says(confirmed, trim + ", or a shift of 0.12 m to the right frees it.");
  c.trim_left.reset();
  says(how, "No trim is known to free it." + shift);
  shifts.conflicts[0].shift.reset();
  says(confirmed, neither);
  shifts.lateral_from = 0;
  says(confirmed, "Neither a trim nor a shift of up to 2 m to the left is known to free it.");
  c.own_shift_left = c.own_shift_right = std::nullopt;
  says(how, neither);
  all.knows_shifts = false;
  says(how, "No trim is known to free it.");
  all.knows_trims = false;
  says(how, "");
  all.knows_shifts = true;
  says({all, "ft", 0.3048}, "No shift of up to 6.562 ft is known to free it.");
  all.knows_trims = true;
  c.side = Side::kAbove;
  c.trim_above = 0.0301;
  const std::string above = "To pass it: a trim of 0.031 m at the top";
  says({all, "m", 1, "cab"}, above + " of body cab is enough for that body.");
  says({all, "m", 1, "body"}, above + " of the body is enough for that body.");
  RemedyWords with_errors{all, "m"};
  with_errors.has_budget = true;
  says(with_errors, above + " is enough for what is closer than the margin.");
  c.colliding = 0;
  says(how, "");
}

TEST_CASE("what is missing is said as exactly as it is known") {
  Conflict c{.least_distance = 0.001, .encroachment = 0.099, .encroachment_is = Bound::kExact};
  CHECK(missing_words(c, "m", 1) == "0.099 m");
  c.encroachment_is = Bound::kAtLeast;
  CHECK(missing_words(c, "m", 1) == "at least 0.099 m");
  CHECK(missing_words(c, "", 1) == "at least 0.099");
  c.least_distance = 0.0009;
  CHECK(missing_words(c, "m", 1) == "touches");
  c.encroachment = -0.02;  // of points that are only near
  CHECK(missing_words(c, "m", 1).empty());
  CHECK(missing_words({}, "m", 1).empty());
}
