// What becomes of the conflicts of a ledger in the next scan, case by case.
#include <functional>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "clearway/clearway.hpp"
#include "findings/ledger_scene.hpp"
#include "support/catch.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// Two epochs: what is scanned, what the owner writes in between, and what the second one shows.
struct Case {
  const char* name;
  std::vector<std::vector<Vec3>> before;
  std::function<void(LedgerScene&)> edit;
  RoadScan after;
  std::function<void(RoadQuestion&)> ask;
  std::string counts;
  Verdict outside;
};

using Panels = std::vector<std::vector<Vec3>>;

std::function<void(LedgerScene&)> status(const std::string& value) {
  return [value](LedgerScene& scene) { scene.set("status", value); };
}

std::function<void(LedgerScene&)> accepted_until(const std::string& day) {
  return [day](LedgerScene& scene) {
    scene.set("status", "accepted");
    scene.set("until", day);
  };
}

/// The status of each row.
std::function<void(LedgerScene&)> statuses(const std::vector<std::string>& values) {
  return [values](LedgerScene& scene) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      scene.set("status", values[i], static_cast<int>(i));
    }
  };
}

std::vector<Vec3> noisy(std::vector<Vec3> points, double noise, unsigned seed) {
  Random random(seed);
  std::uniform_real_distribution<double> within(-noise, noise);
  for (Vec3& p : points) {
    for (int k = 0; k < 3; ++k) p[k] += within(random);
  }
  return points;
}

/// A kerb that is bent: its box holds places that are far from all of its points.
std::vector<Vec3> bent_kerb() {
  std::vector<Vec3> out;
  for (int i = 0; i <= 80; ++i) {
    for (int k = 0; k < 3; ++k) {
      out.push_back({8 + 0.05 * i, i < 60 ? 1.0 : 1.0 - 0.045 * (i - 60), 0.3 + 0.05 * k});
    }
  }
  return out;
}

const auto kAccepted = status("accepted");
const auto kNothing = [](LedgerScene&) {};
const auto kSame = [](RoadQuestion&) {};

std::vector<Case> cases() {
  const std::vector<Vec3> one = panel(10, 0.95);
  const Panels known{one};
  const auto same = road_with({one});
  const auto clear = road();
  std::vector<Case> out{
      // A conflict that is still there.
      {"new, and nobody has looked at it", known, kNothing, same, kSame, "new 1",
       Verdict::kConflict},
      {"open", known, status("open"), same, kSame, "open 1", Verdict::kConflict},
      {"accepted", known, kAccepted, same, kSame, "accepted 1", Verdict::kClear},
      {"a status in capitals and with blanks", known, status(" Accepted "), same, kSame,
       "accepted 1", Verdict::kClear},
      {"resolved, and there again", known, status("resolved"), same, kSame, "open 1",
       Verdict::kConflict},
      {"accepted until yesterday", known, accepted_until("2026-06-29"), same, kSame, "expired 1",
       Verdict::kConflict},
      {"accepted until today", known, accepted_until("2026-06-30"), same, kSame, "accepted 1",
       Verdict::kClear},
      {"accepted until a day in German form", known, accepted_until("29.06.2026"), same, kSame,
       "expired 1", Verdict::kConflict},
      {"a day that can be read in two ways is the earlier one", known, accepted_until("07/06/2026"),
       same, kSame, "expired 1", Verdict::kConflict},
      {"an expired day of an open row says nothing", known,
       [](LedgerScene& scene) {
         scene.set("status", "open");
         scene.set("until", "2020-01-01");
       },
       same, kSame, "open 1", Verdict::kConflict},

      // The same obstacle, scanned again.
      {"rescanned with noise of 5 mm", known, kAccepted,
       road_with({noisy(panel(10.02, 0.95), 0.005, 1)}), kSame, "accepted 1", Verdict::kClear},
      {"rescanned with fewer points", known, kAccepted, road_with({panel(10.03, 0.95, 0.9, 0.1)}),
       kSame, "accepted 1", Verdict::kClear},
      {"rescanned with more points", known, kAccepted, road_with({panel(10, 0.95, 1, 0.02)}), kSame,
       "accepted 1", Verdict::kClear},

      // Moved obstacles.
      {"moved by 0.2 m along the path", known, kAccepted, road_with({panel(10.2, 0.95)}), kSame,
       "accepted 1", Verdict::kClear},
      {"moved by 0.4 m along the path", known, kAccepted, road_with({panel(10.4, 0.95)}), kSame,
       "new 1, accepted 1", Verdict::kConflict},
      {"moved by 5 m along the path", known, kAccepted, road_with({panel(15, 0.95)}), kSame,
       "new 1, gone 1", Verdict::kConflict},
      {"1 cm nearer", known, kAccepted, road_with({panel(10, 0.94)}), kSame, "accepted 1",
       Verdict::kClear},
      {"3 cm nearer", known, kAccepted, road_with({panel(10, 0.92)}), kSame, "worse 1",
       Verdict::kConflict},
      {"3 cm nearer, which was allowed", known, kAccepted, road_with({panel(10, 0.92)}),
       [](RoadQuestion& asked) { asked.worse_by = 0.05; }, "accepted 1", Verdict::kClear},
      {"longer by 1 m", known, kAccepted, road_with({panel(10, 0.95, 2)}), kSame,
       "new 1, accepted 1", Verdict::kConflict},
      {"a new pole in the box of an accepted kerb",
       {bent_kerb()},
       kAccepted,
       road_with({bent_kerb(), panel(9, 0, 0.2)}),
       kSame,
       "new 1, accepted 1",
       Verdict::kConflict},

      // Groups that fall apart or grow together.
      {"split into two groups",
       {panel(10, 0.95, 2)},
       kAccepted,
       road_with({panel(10, 0.95, 0.6), panel(11.4, 0.95, 0.6)}),
       kSame,
       "accepted 1",
       Verdict::kClear},
      {"two accepted ones merged into one",
       {panel(10, 0.95, 0.6), panel(11.4, 0.95, 0.6)},
       kAccepted,
       road_with({panel(10, 0.95, 2)}),
       kSame,
       "new 1, accepted 2",
       Verdict::kConflict},
      {"a part is gone",
       {panel(10, 0.95, 2)},
       kAccepted,
       road_with({panel(10, 0.95, 0.6)}),
       kSame,
       "accepted 1",
       Verdict::kClear},

      // Two rows on one place.
      {"two conflicts, of which one is accepted",
       {one, panel(15, 0.95)},
       statuses({"accepted", "open"}),
       road_with({one, panel(15, 0.95)}),
       kSame,
       "open 1, accepted 1",
       Verdict::kConflict},

      // Nothing is found there.
      {"gone", known, kAccepted, clear, kSame, "gone 1", Verdict::kClear},
      {"an open one is gone", known, status("open"), clear, kSame, "gone 1", Verdict::kClear},
      {"a resolved one stays resolved", known, status("resolved"), clear, kSame, "resolved 1",
       Verdict::kClear},
      {"half a path", known, kAccepted, clear,
       [](RoadQuestion& asked) { asked.query.poses.resize(50); }, "not-searched 1",
       Verdict::kClear},
      {"a part of the path, on which some places collide", known, kAccepted, clear,
       [](RoadQuestion& asked) { asked.query.poses.resize(85); }, "not-searched 1",
       Verdict::kClear},
      {"a smaller radius",
       {panel(10, 1.05)},
       kAccepted,
       clear,
       [](RoadQuestion& asked) { asked.query.radius = 0.04; },
       "not-searched 1",
       Verdict::kClear},
      {"a smaller vehicle", known, kAccepted, clear,
       [](RoadQuestion& asked) {
         for (Vec3& v : asked.query.model.vertices) v.y *= 0.5;
       },
       "not-searched 1", Verdict::kClear},
      {"a floor above the place", known, kAccepted, clear,
       [](RoadQuestion& asked) { asked.query.floor = 1.5; }, "not-searched 1", Verdict::kClear},
      {"an ignored class over the place", known, kAccepted, road().add(one, 5),
       [](RoadQuestion& asked) { asked.query.ignore_classes = {5}; }, "not-searched 1",
       Verdict::kClear},
      {"an ignored class elsewhere", known, kAccepted, road().add(panel(15, 0.95), 5),
       [](RoadQuestion& asked) { asked.query.ignore_classes = {5}; }, "gone 1", Verdict::kClear},
      {"an ignored box over a part of the place", known, kAccepted, clear,
       [](RoadQuestion& asked) {
         asked.query.ignore_boxes = {{{10.8, 0.8, 0.5}, {11.5, 1.2, 2.5}}};
       },
       "not-searched 1", Verdict::kClear},
      {"withheld points at the place", known, kAccepted, road().add(one, 1, true), kSame,
       "not-searched 1", Verdict::kClear},
      {"withheld points in the cube beside it", known, kAccepted,
       road().add({{11.9, 1.9, 2.9}}, 1, true), kSame, "not-searched 1", Verdict::kClear},
      {"withheld points elsewhere", known, kAccepted, road().add({{16, 1.9, 2.9}}, 1, true), kSame,
       "gone 1", Verdict::kClear},
      {"a store without the place", known, kAccepted, road(8), kSame, "not-searched 1",
       Verdict::kUndecided},
      {"without the store", known, kAccepted, clear,
       [](RoadQuestion& asked) { asked.knows_store = false; }, "not-searched 1", Verdict::kClear},
      {"without the model", known, kAccepted, clear,
       [](RoadQuestion& asked) { asked.knows_model = false; }, "not-searched 1", Verdict::kClear},
      {"a few points are left, too few to be listed", known, kAccepted,
       road_with({{{10.5, 0.95, 1.5}, {10.5, 0.95, 1.6}}, panel(15, 0.95)}), kSame,
       "new 1, accepted 1", Verdict::kConflict},

      // Another question.
      {"a larger radius", known, kAccepted, same,
       [](RoadQuestion& asked) { asked.query.radius = 0.12; }, "worse 1", Verdict::kConflict},
      {"a floor", known, kAccepted, same, [](RoadQuestion& asked) { asked.query.floor = 0.1; },
       "worse 1", Verdict::kConflict},
      {"another model", known, kAccepted, same,
       [](RoadQuestion& asked) { asked.query.model.vertices.front().x += 0.01; }, "worse 1",
       Verdict::kConflict},
      {"no distances any more", known, kAccepted, same,
       [](RoadQuestion& asked) { asked.query.clearance = 0; }, "worse 1", Verdict::kConflict},

      // What is outside of the accepted conflicts.
      {"a stray point beside an accepted conflict", known, kAccepted,
       road_with({one, {{15, 0.95, 1.5}}}), kSame, "accepted 1", Verdict::kConflict},
  };
  return out;
}

}  // namespace

TEST_CASE("what becomes of the rows of a ledger in the next scan") {
  for (const Case& one : cases()) {
    CAPTURE(one.name);
    LedgerScene scene;
    const RoadQuestion asked;
    RoadQuestion later;
    one.ask(later);
    const Ledger first = scene.run(road_with(one.before), asked);
    CHECK(first.counts()[static_cast<std::size_t>(LedgerStatus::kNew)] == one.before.size());
    one.edit(scene);
    const Ledger second = scene.run(one.after, later, false);
    CAPTURE(reasons_of(second));
    CHECK(counts_of(second) == one.counts);
    CHECK(second.outside.verdict == one.outside);
    for (const LedgerRow& row : second.rows) {
      const bool needs_reason = row.shown != row.status || row.shown == LedgerStatus::kExpired;
      if (needs_reason) CHECK(!row.why.empty());
    }
  }
}

TEST_CASE("what creeps nearer by a centimetre in each scan is worse in the end") {
  LedgerScene scene;
  const RoadQuestion asked;
  scene.run(road_with({panel(10, 0.95)}), asked);
  scene.set("status", "accepted");
  std::string shown;
  for (int epoch = 1; epoch <= 4; ++epoch) {
    const Ledger ledger = scene.run(road_with({panel(10, 0.95 - 0.01 * epoch)}), asked);
    shown += counts_of(ledger) + "; ";
  }
  CHECK(shown == "accepted 1; accepted 1; worse 1; worse 1; ");
}

TEST_CASE("a worse conflict is accepted anew by opening and accepting its row") {
  LedgerScene scene;
  const RoadQuestion asked;
  scene.run(road_with({panel(10, 0.95)}), asked);
  scene.set("status", "accepted");
  const RoadScan nearer = road_with({panel(10, 0.9)});
  CHECK(counts_of(scene.run(nearer, asked)) == "worse 1");
  scene.set("status", "open");
  CHECK(counts_of(scene.run(nearer, asked)) == "open 1");
  scene.set("status", "accepted");
  CHECK(counts_of(scene.run(nearer, asked)) == "accepted 1");
}

TEST_CASE("an earlier day or an older scan shows of nothing that it is gone") {
  LedgerScene scene;
  RoadQuestion asked;
  const auto scan_of = [](RoadScan scan, std::uint16_t year) {
    scan.year = year;
    return scan;
  };
  const RoadScan before = road_with({panel(10, 0.95)});
  scene.run(scan_of(before, 2024), asked);
  const auto judged = [&](std::uint16_t year, const std::string& date, bool update = false) {
    asked.date = date;
    return counts_of(scene.run(scan_of(road(), year), asked, update));
  };
  CHECK(judged(2025, "2026-06-29") == "not-searched 1");
  CHECK(judged(2022, "2026-07-01") == "not-searched 1");
  CHECK(judged(2024, "2026-07-01") == "gone 1");
  CHECK(judged(0, "2026-07-01") == "gone 1");  // its file does not say when it was scanned
  // An update by an older scan that shows the row forgets nothing of the later one.
  asked.date = "2026-03-01";
  scene.run(scan_of(before, 2022), asked);
  CHECK(judged(2023, "2026-07-01") == "not-searched 1");
  CHECK(judged(2025, "2026-06-29") == "not-searched 1");
  CHECK(judged(2025, "2026-07-01", true) == "gone 1");
}

TEST_CASE("what is gone is resolved, and open when it is there again") {
  LedgerScene scene;
  const RoadQuestion asked;
  const RoadScan there = road_with({panel(10, 0.95)});
  scene.run(there, asked);
  scene.set("status", "accepted");
  CHECK(counts_of(scene.run(road(), asked)) == "gone 1");
  CHECK_THAT(scene.text(), Contains("1,resolved,"));
  RoadQuestion tomorrow;
  tomorrow.date = "2026-07-01";
  CHECK(counts_of(scene.run(road(), tomorrow)) == "resolved 1");
  const Ledger again = scene.run(there, asked);
  CHECK(counts_of(again) == "open 1");
  CHECK_THAT(again.rows[0].why, Contains("was resolved"));
  CHECK_THAT(scene.text(), Contains("1,open,"));
}

TEST_CASE("a run that is repeated on its day shows the same, and leaves both files as they are") {
  LedgerScene scene;
  RoadQuestion asked;
  scene.run(road_with({panel(10, 0.95), panel(15, 0.95)}), asked);
  scene.set("status", "accepted");
  const RoadScan later = road_with({panel(15, 0.95), panel(18, 0.95)});
  const Ledger first = scene.run(later, asked);
  CHECK(counts_of(first) == "new 1, accepted 1, gone 1");
  const std::string table = scene.text(), places = text_of_file(scene.places());
  const auto same = [&](const Ledger& again) {
    CHECK(counts_of(again) == counts_of(first));
    CHECK(reasons_of(again) == reasons_of(first));
    CHECK(scene.text() == table);
    CHECK(text_of_file(scene.places()) == places);
  };
  same(scene.run(later, asked));
  same(scene.run(later, asked, false));
  // A run of the same day that does not come there knows only what the table says.
  asked.query.poses.resize(60);
  CHECK(counts_of(scene.run(later, asked, false)) == "resolved 1, not-searched 2");
}

TEST_CASE("two rows on one place: a conflict is accepted only if both accept it") {
  LedgerScene scene;
  const RoadQuestion asked;
  const RoadScan small = road_with({panel(10, 0.95)});
  scene.run(small, asked);
  scene.set("status", "accepted");
  CHECK(counts_of(scene.run(road_with({panel(10, 0.95, 2)}), asked)) == "new 1, accepted 1");
  Ledger both = scene.run(small, asked, false);
  CHECK(counts_of(both) == "new 1, accepted 1");
  CHECK(both.conflicts[0].status == LedgerStatus::kNew);
  CHECK(both.conflicts[0].key == "2");
  CHECK(both.outside.verdict == Verdict::kConflict);
  scene.set("status", "accepted");
  both = scene.run(small, asked, false);
  CHECK(counts_of(both) == "accepted 2");
  CHECK(both.accepted_conflicts() == 1);
  CHECK(both.outside.verdict == Verdict::kClear);
}

TEST_CASE("parts of an open row get rows of their own, and those of an accepted one do not") {
  for (const bool accepted : {false, true}) {
    CAPTURE(accepted);
    LedgerScene scene;
    const RoadQuestion asked;
    scene.run(road_with({panel(10, 0.95, 2)}), asked);
    scene.set("status", accepted ? "accepted" : "open");
    scene.set("owner", "me");
    const RoadScan parts = road_with({panel(10, 0.95, 0.6), panel(11.4, 0.95, 0.5)});
    const Ledger ledger = scene.run(parts, asked);
    CHECK(counts_of(ledger) == (accepted ? "accepted 1" : "open 2"));
    CHECK(counts_of(scene.run(parts, asked)) == (accepted ? "accepted 1" : "open 2"));
  }
}

TEST_CASE("a place without points around it is gone only where the scanner looked through it") {
  // In the middle above the road, where the scan has no point within 1 m.
  std::vector<Vec3> sign;
  for (int i = 0; i <= 10; ++i) {
    for (int k = 0; k <= 4; ++k) sign.push_back({10 + 0.05 * i, 0.05 * k, 2.95});
  }
  const RoadQuestion asked;
  for (const bool looked : {false, true}) {
    CAPTURE(looked);
    LedgerScene scene;
    // From just above the sign, beams to the road pass through its place.
    if (looked) scene.set_origin({10.2, 0.1, 3.4});
    scene.run(road().add(sign), asked);
    scene.set("status", "accepted");
    const Ledger ledger = scene.run(road(), asked);
    CAPTURE(reasons_of(ledger));
    CHECK(counts_of(ledger) == (looked ? "gone 1" : "not-searched 1"));
  }
}

TEST_CASE("near points of an error budget outside of what is accepted leave the verdict open") {
  LedgerScene scene;
  RoadQuestion asked;
  asked.query.error_scan = 0.02;
  asked.query.sigmas = 2;
  const RoadScan first = road_with({panel(10, 0.95)});
  scene.run(first, asked);
  scene.set("status", "accepted");
  CHECK(scene.run(first, asked, false).outside.verdict == Verdict::kClear);
  // Nearer than the radius and the budget, but farther than the radius.
  const Ledger ledger = scene.run(road_with({panel(10, 0.95), panel(15, 1.11)}), asked, false);
  CHECK(ledger.outside.verdict == Verdict::kUndecided);
  CHECK(ledger.outside.near > 0);
}
