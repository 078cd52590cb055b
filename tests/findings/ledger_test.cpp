// What becomes of the conflicts of a ledger in the next scan, case by case.
#include <algorithm>
#include <map>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "clearway/clearway.hpp"
#include "findings/ledger_scene.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/text_rows.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

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

/// A scan of the road with what a text lists, separated by ";": a panel as "from left", with length
/// and step where they are not usual, alone or after "noisy", "class5" or "withheld"; a "point" or
/// a "withheld-point"; "kerb"; and "until", for a road that ends there.
RoadScan scan_of(const std::string& text) {
  RoadScan scan = road();
  std::istringstream items(text);
  for (std::string item; std::getline(items, item, ';');) {
    std::istringstream words(item);
    std::string kind;
    std::vector<double> n;
    for (std::string word; words >> word;) {
      if (std::isalpha(static_cast<unsigned char>(word[0])) != 0) {
        kind = word;
      } else {
        n.push_back(std::stod(word));
      }
    }
    if (kind == "kerb") {
      scan.add(bent_kerb());
    } else if (kind == "until") {
      scan = road(n.at(0));
    } else if (kind == "point" || kind == "withheld-point") {
      scan.add({{n.at(0), n.at(1), n.at(2)}}, 1, kind != "point");
    } else {
      std::vector<Vec3> points =
          panel(n.at(0), n.at(1), n.size() > 2 ? n[2] : 1, n.size() > 3 ? n[3] : 0.05);
      Random random(1);
      for (Vec3& p : points) {
        for (int k = 0; kind == "noisy" && k < 3; ++k) p[k] += uniform(random, -0.005, 0.005);
      }
      scan.add(points, kind == "class5" ? 5 : 1, kind == "withheld");
    }
  }
  return scan;
}

/// Calls `each` with name and value of all words such as "until=2026-06-30", where "_" is a blank.
template <typename Each>
void for_settings(const std::string& text, const Each& each) {
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    std::ranges::replace(word, '_', ' ');
    const std::size_t at = word.find('=');
    each(word.substr(0, at), word.substr(at + 1));
  }
}

RoadQuestion question_of(const std::string& text) {
  RoadQuestion asked;
  Query& query = asked.query;
  for_settings(text, [&](const std::string& name, const std::string& value) {
    if (value == "unknown") {
      (name == "store" ? asked.knows_store : asked.knows_model) = false;
      return;
    }
    const double number = std::stod(value);
    if (name == "date") asked.date = value;
    if (name == "worse-by") asked.worse_by = number;
    if (name == "poses") query.poses.resize(static_cast<std::size_t>(number));
    if (name == "radius") query.radius = number;
    if (name == "clearance") query.clearance = number;
    if (name == "floor") query.floor = number;
    if (name == "ignored-class") query.ignore_classes = {static_cast<std::uint8_t>(number)};
    if (name == "ignored-from") query.ignore_boxes = {{{number, 0.8, 0.5}, {11.5, 1.2, 2.5}}};
    if (name == "longer") query.model.vertices.front().x += number;
    if (name == "width") {
      for (Vec3& v : query.model.vertices) v.y *= number;
    }
  });
  return asked;
}

}  // namespace

TEST_CASE("what becomes of the rows of a ledger in the next scan") {
  // The first scan; what the owner writes into all rows, or into one after the other; the second
  // scan, and what is asked of it; the counts that it shows, and the verdict of the rest. Equal
  // first scans are searched once.
  std::map<std::string, std::pair<std::string, std::string>> begun;
  for (const auto& row : text_rows(R"(
    new, and nobody has looked at it        | 10 .95 |                     | 10 .95 | | new 1      | conflict
    open                                    | 10 .95 | status=open         | 10 .95 | | open 1     | conflict
    accepted, in capitals and with blanks   | 10 .95 | status=_Accepted_   | 10 .95 | | accepted 1 | clear
    resolved, and there again               | 10 .95 | status=resolved     | 10 .95 | | open 1     | conflict
    accepted until yesterday                | 10 .95 | status=accepted until=2026-06-29 | 10 .95 | | expired 1  | conflict
    accepted until today                    | 10 .95 | status=accepted until=2026-06-30 | 10 .95 | | accepted 1 | clear
    accepted until a day in German form     | 10 .95 | status=accepted until=29.06.2026 | 10 .95 | | expired 1  | conflict
    of two ways to read a day, the earlier  | 10 .95 | status=accepted until=07/06/2026 | 10 .95 | | expired 1  | conflict
    an expired day of an open row           | 10 .95 | status=open until=2020-01-01     | 10 .95 | | open 1     | conflict
    rescanned with noise of 5 mm            | 10 .95 | status=accepted     | noisy 10.02 .95 | | accepted 1 | clear
    rescanned with fewer points             | 10 .95 | status=accepted     | 10.03 .95 .9 .1 | | accepted 1 | clear
    rescanned with more points              | 10 .95 | status=accepted     | 10 .95 1 .02    | | accepted 1 | clear
    moved by 0.2 m along the path           | 10 .95 | status=accepted     | 10.2 .95        | | accepted 1 | clear
    moved by 0.4 m along the path           | 10 .95 | status=accepted     | 10.4 .95        | | new 1, accepted 1 | conflict
    moved by 5 m along the path             | 10 .95 | status=accepted     | 15 .95          | | new 1, gone 1     | conflict
    1 cm nearer                             | 10 .95 | status=accepted     | 10 .94          | | accepted 1        | clear
    3 cm nearer                             | 10 .95 | status=accepted     | 10 .92          | | worse 1           | conflict
    3 cm nearer, which was allowed          | 10 .95 | status=accepted     | 10 .92 | worse-by=.05 | accepted 1   | clear
    longer by 1 m                           | 10 .95 | status=accepted     | 10 .95 2        | | new 1, accepted 1 | conflict
    a pole in the box of an accepted kerb   | kerb   | status=accepted     | kerb; 9 0 .2    | | new 1, accepted 1 | conflict
    split into two groups                   | 10 .95 2 | status=accepted   | 10 .95 .6; 11.4 .95 .6 | | accepted 1 | clear
    two accepted ones merged into one       | 10 .95 .6; 11.4 .95 .6 | status=accepted | 10 .95 2 | | new 1, accepted 2 | conflict
    a part is gone                          | 10 .95 2 | status=accepted   | 10 .95 .6       | | accepted 1        | clear
    two conflicts, of which one is accepted | 10 .95; 15 .95 | status=accepted status=open | 10 .95; 15 .95 | | open 1, accepted 1 | conflict
    gone                                    | 10 .95 | status=accepted     |                 | | gone 1            | clear
    an open one is gone                     | 10 .95 | status=open         |                 | | gone 1            | clear
    a resolved one stays resolved           | 10 .95 | status=resolved     |                 | | resolved 1        | clear
    half a path                             | 10 .95 | status=accepted     | | poses=50    | not-searched 1 | clear
    a path on which some places collide     | 10 .95 | status=accepted     | | poses=85    | not-searched 1 | clear
    a smaller radius                        | 10 1.05 | status=accepted    | | radius=.04  | not-searched 1 | clear
    a smaller vehicle                       | 10 .95 | status=accepted     | | width=.5    | not-searched 1 | clear
    a floor above the place                 | 10 .95 | status=accepted     | | floor=1.5   | not-searched 1 | clear
    an ignored class over the place         | 10 .95 | status=accepted     | class5 10 .95 | ignored-class=5 | not-searched 1 | clear
    an ignored class elsewhere              | 10 .95 | status=accepted     | class5 15 .95 | ignored-class=5 | gone 1 | clear
    an ignored box over a part of it        | 10 .95 | status=accepted     | | ignored-from=10.8 | not-searched 1 | clear
    withheld points at the place            | 10 .95 | status=accepted     | withheld 10 .95   | | not-searched 1 | clear
    withheld points in the cube beside it   | 10 .95 | status=accepted     | withheld-point 11.9 1.9 2.9 | | not-searched 1 | clear
    withheld points elsewhere               | 10 .95 | status=accepted     | withheld-point 16 1.9 2.9 | | gone 1 | clear
    a store without the place               | 10 .95 | status=accepted     | until 8 | | not-searched 1 | undecided
    without the store                       | 10 .95 | status=accepted     | | store=unknown | not-searched 1 | clear
    without the model                       | 10 .95 | status=accepted     | | model=unknown | not-searched 1 | clear
    too few points to be listed are left    | 10 .95 | status=accepted     | point 10.5 .95 1.5; point 10.5 .95 1.6; 15 .95 | | new 1, accepted 1 | conflict
    a larger radius                         | 10 .95 | status=accepted     | 10 .95 | radius=.12  | worse 1 | conflict
    a floor                                 | 10 .95 | status=accepted     | 10 .95 | floor=.1    | worse 1 | conflict
    another model                           | 10 .95 | status=accepted     | 10 .95 | longer=.01  | worse 1 | conflict
    no distances any more                   | 10 .95 | status=accepted     | 10 .95 | clearance=0 | worse 1 | conflict
    a stray point beside an accepted one    | 10 .95 | status=accepted     | 10 .95; point 15 .95 1.5 | | accepted 1 | conflict
  )",
                                   7)) {
    const RowName name(row[0]);
    LedgerScene scene;
    auto& [table, places] = begun[row[1]];
    if (table.empty()) {
      scene.run(scan_of(row[1]), RoadQuestion());
      table = scene.text();
      places = text_of_file(scene.places());
    }
    scene.write(table);
    write_text(scene.places(), places);
    int rows = 0;
    for_settings(row[2], [&](const std::string& column, const std::string& value) {
      const bool is_next = column == "status" && rows++ > 0;
      scene.set(column, value, is_next ? rows - 1 : -1);
    });
    const Ledger second = scene.run(scan_of(row[3]), question_of(row[4]), false);
    CAPTURE(reasons_of(second));
    check_equal(counts_of(second), row[5]);
    check_equal(name_of(second.outside.verdict), row[6]);
    for (const LedgerRow& shown : second.rows) {
      const bool needs_reason =
          shown.shown != shown.status || shown.shown == LedgerStatus::kExpired;
      if (needs_reason) CHECK(!shown.why.empty());
    }
  }
}

TEST_CASE("what becomes of a ledger from scan to scan") {
  // A row with a name begins a ledger. What the owner writes before the scan; the scan, and what is
  // asked of it; the counts that it shows.
  std::string name;
  std::optional<LedgerScene> scene;
  for (const auto& row : text_rows(R"(
    what creeps nearer is worse in the end   |                 | 10 .95 |                 | new 1
                                             | status=accepted | 10 .94 |                 | accepted 1
                                             |                 | 10 .93 |                 | accepted 1
                                             |                 | 10 .92 |                 | worse 1
                                             |                 | 10 .91 |                 | worse 1
    a worse one is opened, and accepted anew |                 | 10 .95 |                 | new 1
                                             | status=accepted | 10 .9  |                 | worse 1
                                             | status=open     | 10 .9  |                 | open 1
                                             | status=accepted | 10 .9  |                 | accepted 1
    what is gone is resolved until it is there |               | 10 .95 |                 | new 1
                                             | status=accepted |        |                 | gone 1
                                             |                 |        | date=2026-07-01 | resolved 1
                                             |                 | 10 .95 | date=2026-07-02 | open 1
                                             |                 |        | date=2026-07-03 | gone 1
    parts of an open row get rows of their own  |          | 10 .95 2                  | | new 1
                                    | status=open owner=me | 10 .95 .6; 11.4 .95 .5    | | open 2
                                             |             | 10 .95 .6; 11.4 .95 .5    | | open 2
    parts of an accepted row do not          |             | 10 .95 2                  | | new 1
                                         | status=accepted | 10 .95 .6; 11.4 .95 .5    | | accepted 1
                                             |             | 10 .95 .6; 11.4 .95 .5    | | accepted 1
    an earlier day or an older scan shows of nothing that it is gone | | 10 .95 | year=2024 | new 1
                                             |   |        | year=2025 date=2026-06-29 update=0 | not-searched 1
                                             |   |        | year=2022 date=2026-07-01 update=0 | not-searched 1
                                             |   |        | year=2024 date=2026-07-01 update=0 | gone 1
                                             |   |        | year=0 date=2026-07-01 update=0    | gone 1
                                             |   | 10 .95 | year=2022 date=2026-03-01          | new 1
                                             |   |        | year=2023 date=2026-07-01 update=0 | not-searched 1
                                             |   |        | year=2025 date=2026-06-29 update=0 | not-searched 1
                                             |   |        | year=2025 date=2026-07-01          | gone 1
  )",
                                   5)) {
    if (!row[0].empty()) {
      name = row[0];
      scene.emplace();
    }
    const RowName of(name + ": " + row[4]);
    for_settings(row[1], [&](const auto& column, const auto& value) { scene->set(column, value); });
    RoadScan scan = scan_of(row[2]);
    bool update = true;
    for_settings(row[3], [&](const std::string& what, const std::string& value) {
      if (what == "year") scan.year = static_cast<std::uint16_t>(std::stoi(value));
      if (what == "update") update = false;
    });
    const Ledger ledger = scene->run(scan, question_of(row[3]), update);
    CAPTURE(reasons_of(ledger));
    check_equal(counts_of(ledger), row[4]);
  }
}

TEST_CASE("a run that is repeated on its day shows the same, and leaves both files as they are") {
  LedgerScene scene;
  RoadQuestion asked;
  scene.run(scan_of("10 .95; 15 .95"), asked);
  scene.set("status", "accepted");
  const RoadScan later = scan_of("15 .95; 18 .95");
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
  const RoadScan small = scan_of("10 .95");
  scene.run(small, asked);
  scene.set("status", "accepted");
  CHECK(counts_of(scene.run(scan_of("10 .95 2"), asked)) == "new 1, accepted 1");
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
    if (looked) write_text(scene.origins(), "first,x,y,z\n0,10.2,0.1,3.4\n");
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
  const RoadScan first = scan_of("10 .95");
  scene.run(first, asked);
  scene.set("status", "accepted");
  CHECK(scene.run(first, asked, false).outside.verdict == Verdict::kClear);
  // Nearer than the radius and the budget, but farther than the radius.
  const Ledger ledger = scene.run(scan_of("10 .95; 15 1.11"), asked, false);
  CHECK(ledger.outside.verdict == Verdict::kUndecided);
  CHECK(ledger.outside.near > 0);
}
