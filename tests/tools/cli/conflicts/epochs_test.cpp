// Two scans of a road, each driven by the same car: what is new, gone, the same and not known.
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "support/catch.hpp"
#include "support/classed_scans.hpp"
#include "tools/cli/support/program.hpp"

using namespace clearway;
using namespace clearway::test;
using nlohmann::json;

namespace {

/// A row of points every 5 cm along x and z, beside the car.
struct Kerb {
  double x_from, x_to, z_from, z_to;
  double y = 1.05;  ///< the car's side is at 1
  bool withheld = false;
};

Kerb pole(double x) { return {x, x + 0.1, 0.4, 1.4}; }

/// A scan of a road from x = 0 to 60, and how it is searched. The defaults are those of scan a.
struct Epoch {
  std::vector<Kerb> things;
  double scanned_to = 60;             ///< metres along x
  std::vector<double> hole = {0, 0};  ///< the ground is missing from here to there
  /// From here to there nothing is scanned to the left, or to the right.
  std::vector<double> no_left = {0, 0}, no_right = {0, 0};
  double lower = 0;  ///< metres by which all is registered too low
  /// Another number gives other noise of up to 5 mm; that of scan b is 1 where none is given.
  std::optional<int> noise = {};
  unsigned year = 0;     ///< year in the file's header; 0: none
  double step = 0.05;    ///< metres between the points of things
  std::string run = {};  ///< options of the search
  std::string path = "path.txt";
  std::string model = "--model car.obj";
};

constexpr int kSurface = 2, kThing = 5;  // classes
constexpr int kWithheld = 0x80;          // flag in the byte of the class, in format 1

std::string joined(const std::set<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

/// The lists of a comparison that have entries, such as "gone 1, same 2".
std::string lists_of(const json& comparison) {
  std::set<std::string> lists;
  for (const char* list :
       {"new", "new_parts", "new_small", "worse", "not_searched", "too_small", "gone", "same"}) {
    const std::size_t count = comparison[list].size();
    if (count > 0) lists.insert(std::string(list) + " " + std::to_string(count));
  }
  return joined(lists);
}

struct Road : Workplace {
  Road() {
    put("path.txt", straight(3, 57, 0));
    put("half.txt", straight(3, 30, 0));
    put("beside.txt", straight(3, 57, -0.5));
    std::string car;
    for (const int x : {-2, 2}) {
      for (const int y : {-1, 1}) {
        for (const double z : {0.3, 1.5}) {
          car +=
              "v " + std::to_string(x) + " " + std::to_string(y) + " " + std::to_string(z) + "\n";
        }
      }
    }
    for (const std::string face :
         {"1 3 4 2", "5 6 8 7", "1 2 6 5", "3 7 8 4", "1 5 7 3", "2 4 8 6"}) {
      car += std::string("f ") + face + "\n";
    }
    put("car.obj", car);
  }

  static std::string straight(double from, double to, double y) {
    std::string text;
    for (double x = from; x <= to; x += 0.5) text += pose_at(x, y);
    return text;
  }

  /// Writes the scan and its store, and searches it.
  void search(const std::string& name, const Epoch& epoch) const {
    std::vector<Quantum> points;
    std::vector<std::uint8_t> classes;
    unsigned seed = 1 + static_cast<unsigned>(epoch.noise.value_or(name == "b")) * 7919;
    const auto noisy = [&](double metres) {
      seed = seed * 1103515245 + 12345;
      return static_cast<std::int32_t>(std::lround(1000 * metres) + (seed >> 16) % 11) - 5;
    };
    const auto add = [&](double x, double y, double z, int of_class) {
      if (x > epoch.scanned_to) return;
      points.push_back({noisy(x), noisy(y), noisy(z - epoch.lower)});
      classes.push_back(static_cast<std::uint8_t>(of_class));
    };
    const auto is_lost = [](double x, const std::vector<double>& stretch) {
      return x >= stretch[0] && x < stretch[1];
    };
    for (double x = 0; x <= 60; x += 0.4) {
      const bool missing = x > epoch.hole[0] && x < epoch.hole[1];
      for (double y = -3; y <= 3 && !missing; y += 0.4) add(x, y, 0, kSurface);
      for (const double y : {-3.0, 3.0}) {
        if (is_lost(x, y > 0 ? epoch.no_left : epoch.no_right)) continue;
        for (double z = 0.2; z < 3; z += 0.4) add(x, y, z, 6);
      }
    }
    for (const Kerb& thing : epoch.things) {
      for (double x = thing.x_from; x <= thing.x_to + 1e-9; x += epoch.step) {
        for (double z = thing.z_from; z <= thing.z_to + 1e-9; z += epoch.step) {
          add(x, thing.y, z, thing.withheld ? kThing | kWithheld : kThing);
        }
      }
    }
    write_classed(folder / (name + ".las"), points, classes, 1, {0, 0, 0});
    if (epoch.year > 0) {
      std::string las = bytes(name + ".las");
      LasBytes::put(las, 90, std::uint16_t{100});
      LasBytes::put(las, 92, static_cast<std::uint16_t>(epoch.year));
      put_bytes(folder / (name + ".las"), las);
    }
    succeed("convert " + name + ".las --force --unit m -o " + name + "_site.h5");
    succeed("run --env " + name + "_site.h5 " + epoch.model + " --trajectory " + epoch.path +
            " --first-pose --force -o " + name + ".h5 " +
            (epoch.run.empty() ? "--radius 0.1 --clearance 0.3" : epoch.run));
  }

  Outcome compare(const Epoch& a, const Epoch& b, const std::string& more) const {
    const bool same_question = b.run == a.run && b.path == a.path && b.model == a.model;
    return run("compare a.h5 b.h5 --conflicts --trajectory " + a.path + " --trajectory-b " +
               b.path + " " + (same_question ? "" : "--allow-other-question ") + more);
  }

  /// Checks what `compare --conflicts` says of two epochs. lists: lists of the comparison that have
  /// entries, with the numbers of these. reasons, doubts: why a place was not searched, and why
  /// stretches of b's path are undecided.
  void check_pair(const std::string& name, const Epoch& a, const Epoch& b, int exit_code,
                  const std::string& lists, const std::string& words,
                  const std::string& reasons = "", const std::string& doubts = "") const {
    const RowName row(name);
    search("a", a);
    search("b", b);
    check_outcome(compare(a, b, ""), exit_code, kAnything, words);
    const json all = json_of(compare(a, b, "--json"));
    check_equal(lists_of(all), lists);
    std::set<std::string> found;
    for (const json& place : all["not_searched"]) {
      for (const json& reason : place["reasons"]) found.insert(reason.get<std::string>());
    }
    check_equal(joined(found), reasons);
    CHECK(all["holds"] == (exit_code == 0));
    check_equal(doubts_of_stations(b), doubts);
  }

  /// The codes for which stretches of a result are undecided.
  std::string doubts_of_stations(const Epoch& epoch) const {
    succeed("stations b.h5 --trajectory " + epoch.path + " --force -o s.json");
    std::set<std::string> codes;
    const json table = json::parse(bytes("s.json"));
    for (const json& row : table["stations"]) {
      if (row["verdict"] != "undecided") continue;
      for (const json& code : row["doubts"]) codes.insert(code.get<std::string>());
    }
    return joined(codes);
  }
};

const std::vector<Kerb> kPoles{pole(20), pole(45)};
const Kerb kSmallPole{45, 45.05, 0.4, 1.0};
const std::vector<Kerb> kBent{{20, 24, 0.35, 0.4}, {20, 20.05, 0.4, 1.4}};

}  // namespace

TEST_CASE("two epochs are told apart as a person would") {
  const Road road;
  road.check_pair("unchanged with other noise", {kPoles}, {kPoles}, 0, "same 2",
                  "no new conflicts");
  road.check_pair("gone", {kPoles}, {{pole(20)}}, 0, "gone 1, same 1",
                  "1 conflict is gone if b was scanned there");
  road.check_pair("one side is missing in a, the other in b",
                  {.things = kPoles, .no_right = {0, 61}},
                  {.things = {pole(20)}, .no_left = {0, 61}}, 6, "not_searched 1, same 1",
                  "b has not searched 1 place", "one-side");
  road.check_pair("one side is missing in both", {.things = kPoles, .no_left = {0, 61}},
                  {.things = {pole(20)}, .no_left = {0, 61}}, 0, "gone 1, same 1",
                  "no new conflicts");
  road.check_pair("a side is missing on stretches that overlap",
                  {.things = {pole(45)}, .no_left = {0, 28}}, {.things = {}, .no_left = {22, 61}},
                  6, "not_searched 1", "b has not searched 1 place", "one-side");
  road.check_pair("a side is missing on one stretch", {.things = {pole(45)}, .no_left = {0, 28}},
                  {.things = {}, .no_left = {0, 28}}, 0, "gone 1", "no new conflicts");
  road.check_pair("lower scan", {kPoles}, {.things = kPoles, .lower = 3.5}, 6, "not_searched 2",
                  "b has not searched 2 places", "floats");
  road.check_pair("withheld pole", {{kSmallPole}}, {.things = {{45, 45.05, 0.4, 1.0, 1.05, true}}},
                  6, "not_searched 1", "b has not searched 1 place", "withheld");
  road.check_pair("pole that is gone between scans with withheld points",
                  {.things = {kSmallPole, {10, 10.05, 0.4, 1.0, 1.05, true}}},
                  {.things = {{10, 10.05, 0.4, 1.0, 1.05, true}}}, 0, "gone 1",
                  "the dates of the files do not show that b is the later scan");
  road.check_pair("shorter scan", {kPoles}, {.things = kPoles, .scanned_to = 33}, 6,
                  "not_searched 1, same 1", "b has not searched 1 place", "leaves-scan",
                  "leaves-scan");
  road.check_pair("hole in the ground", {kPoles}, {.things = {pole(20)}, .hole = {38, 52}}, 6,
                  "not_searched 1, same 1", "its run warned of nothing-below", "nothing-below",
                  "nothing-below");
  road.check_pair("moved pole", {kPoles}, {{pole(20), pole(47)}}, 1, "gone 1, new 1, same 1",
                  "1 new conflict");
  road.check_pair("new pole in the box of a kerb that is gone", {kBent},
                  {.things = {{23, 23.1, 0.9, 1.4}}}, 1, "gone 1, new 1", "1 new conflict");
  road.check_pair("new pole that hangs together with an old kerb",
                  {.things = {{20, 24, 0.35, 0.4}}},
                  {.things = {{20, 24, 0.35, 0.4}, {23, 23.1, 0.4, 1.4}}}, 1, "new_parts 1, same 1",
                  "1 part of another conflict is new");
  road.check_pair("one falls into two", {.things = {{20, 24, 0.35, 0.4}}},
                  {.things = {{20, 21.5, 0.35, 0.4}, {22.5, 24, 0.35, 0.4}}}, 0, "same 2",
                  "no new conflicts");
  road.check_pair("two become one", {.things = {{20, 21.5, 0.35, 0.4}, {22, 24, 0.35, 0.4}}},
                  {.things = {{20, 24, 0.35, 0.4}}}, 0, "same 2", "no new conflicts");
  road.check_pair("the same scan twice", {kPoles}, {.things = kPoles, .noise = 0}, 6, "same 2",
                  "the same scan");
  road.check_pair("older scan", {.things = kPoles, .year = 2024}, {.things = kPoles, .year = 2022},
                  6, "same 2", "by the dates of the files b is older than a");
  road.check_pair("pole that is missing in an older scan", {.things = kPoles, .year = 2024},
                  {.things = {pole(20)}, .year = 2022}, 6, "gone 1, same 1",
                  "by the dates of the files b is older than a");
  road.check_pair("newer scan", {.things = kPoles, .year = 2022}, {.things = kPoles, .year = 2024},
                  0, "same 2", "no new conflicts");
  road.check_pair("smaller radius", {kPoles}, {.things = kPoles, .run = "--radius 0.02"}, 6,
                  "not_searched 2", "b has not searched 2 places", "coarse-scan, radius");
  road.check_pair("ignored class", {kPoles},
                  {.things = kPoles, .run = "--radius 0.1 --clearance 0.3 --ignore-class 5"}, 6,
                  "not_searched 2", "b has not searched 2 places", "ignored");
  road.check_pair("another path", {kPoles}, {.things = kPoles, .path = "beside.txt"}, 6,
                  "not_searched 2", "b has not searched 2 places", "path");
  road.check_pair("shorter path", {kPoles}, {.things = {}, .path = "half.txt"}, 6,
                  "gone 1, not_searched 1", "b has not searched 1 place", "path");
}

TEST_CASE("the floors of a vehicle's bodies are compared body by body") {
  const Road road;
  const auto vehicle = [&](const std::string& name, const std::string& cab,
                           const std::string& box) {
    road.put(name, R"({"bodies": [{"name": "cab", "model": "car.obj")" + cab +
                       R"(}, {"name": "box", "model": "car.obj", "at": -5)" + box + "}]}");
    return Epoch{.things = {pole(20), {45, 45.1, 0.4, 0.7}}, .model = "--vehicle " + name};
  };
  const Epoch low = vehicle("low.json", R"(, "floor": 0.35)", R"(, "floor": 0.4)");
  const Epoch high = vehicle("high.json", R"(, "floor": 0.85)", R"(, "floor": 0.9)");
  const Epoch none = vehicle("none.json", "", "");
  road.check_pair("the same floors", low, low, 0, "same 2", "no new conflicts");
  road.check_pair("higher floors", low, high, 6, "not_searched 2, same 1",
                  "b has not searched 2 places", "floor, model");
  road.check_pair("floors that were not there before", none, high, 6, "not_searched 2, same 1",
                  "b has not searched 2 places", "floor, model");
  // In one scan a vehicle is searched wherever its floors are not higher.
  const auto in_one_scan = [&](const Epoch& a, Epoch b) {
    b.noise = 0;
    road.search("a", a);
    road.search("b", b);
    return lists_of(json_of(road.compare(a, b, "--json")));
  };
  CHECK(in_one_scan(high, low) == "new 1, new_parts 1, same 1");
  CHECK(in_one_scan(low, high) == "not_searched 2, same 1");
  check_json(json_of(road.run("info b.h5 --json")),
             R"({"floor": {"height": null, "bodies": {"cab": 0.85, "box": 0.9}}})");
}

TEST_CASE("what a search of a shorter scan warns of is in all that is made of its result") {
  const Road road;
  const Epoch a{kPoles}, b{.things = {pole(20)}, .scanned_to = 33};
  road.search("a", a);
  road.search("b", b);
  const std::string trajectory = " --trajectory path.txt";
  const std::string result = "b.h5";
  // The run collides, and still its result keeps the warning with its stretch.
  const json info = json_of(road.run("info --json " + result));
  check_json(info, R"({"verdict": "conflict", "doubts": ["leaves-scan"]})");
  REQUIRE(info["warnings"].size() > 0);
  const json& leaves = info["warnings"][0];
  REQUIRE(leaves["stretches"].size() == 1);
  // From where the scan ends to the last pose, with the pole at 45 m
  CHECK(leaves["stretches"][0][0] > 60);
  CHECK(leaves["stretches"][0][0] < 70);
  check_json(leaves, R"({"code": "leaves-scan", "stretches": {"0": {"1": 108}}})");
  const json listed = json_of(road.run("conflicts --json " + result + trajectory));
  CHECK(listed["warnings"] == info["warnings"]);
  road.succeed("stations " + result + trajectory + " -o s.csv");
  check_says(road.bytes("s.csv"), ",doubts\n ... ,leaves-scan\n");
  road.succeed("report " + result + " --env b_site.h5 --model car.obj" + trajectory +
               " -o page.html");
  check_says(road.bytes("page.html"), "leaves-scan");
  check_outcome(road.compare(a, b, "-o c.html -o c.csv"), 6);
  check_says(road.bytes("c.html"), "not searched");
  check_says(road.bytes("c.csv"), "\nnot searched,2,, ... leaves-scan\n");
  // Where nothing collides, the verdict of the whole is undecided too.
  road.search("b", {.things = {}, .scanned_to = 33, .noise = 0});
  check_json(json_of(road.run("info --json " + result)), R"({"verdict": "undecided"})");
}

TEST_CASE("commands that read a result repeat what its run warned of") {
  const Road road;
  road.search("a", {.things = kPoles, .no_left = {0, 61}});
  const std::string result = "a.h5";
  const std::string path = result + " --trajectory path.txt";
  const std::string words = "nothing was scanned on the left of the model";
  const std::string searched = " --env a_site.h5 --model car.obj";
  const std::string shift = "shift " + path + searched;
  for (const std::string& command :
       {"conflicts " + path, "stations " + path + " -o s.csv", "export " + result + " -o out.csv",
        shift, "compare " + result + " " + result}) {
    CAPTURE(command);
    check_says(road.run(command).err, words);
  }
  const json table = json_of(road.run(shift + " --json"));
  const json info = json_of(road.run("info --json " + result));
  CHECK(table["warnings"] == info["warnings"]);
  REQUIRE(info["warnings"].size() > 0);
  check_json(info, R"({"warnings": {"0": {"code": "one-side", "numbers": {"side": 1}}}})");
}

TEST_CASE("a run notes few points that the store left out as withheld") {
  const Road road;
  road.search("a", {.things = {kSmallPole, {10, 10.05, 0.4, 1.0, 1.05, true}}});
  check_says(
      road.run("run --env a_site.h5 --model car.obj --trajectory path.txt --radius 0.1 -o again.h5")
          .err,
      "points of the scans are not searched, because they have the flag");
  const json info = json_of(road.run("info --json a.h5"));
  CHECK(info["withheld_points"] > 20);
}

TEST_CASE("compare --conflicts reads a model as run did") {
  const Road road;
  const Epoch epoch{.things = kPoles, .run = "--radius 0.1 --model-vertices"};
  road.search("a", epoch);
  road.search("b", {.things = kPoles, .run = epoch.run});
  const std::string model = "--model car.obj";
  check_outcome(road.compare(epoch, epoch, model), 3);
  check_outcome(road.compare(epoch, epoch, model + " --model-vertices"), 0);
}

TEST_CASE("both scans are grouped as the first one, whose points may be farther apart") {
  // Two things that are 0.55 m apart: in a thin scan they hang together, and in a dense one not.
  const Road road;
  const std::vector<Kerb> two{{20, 20.75, 0.4, 1.4}, {21.3, 22.05, 0.4, 1.4}};
  road.search("a", {.things = two, .step = 0.25});
  road.search("b", {.things = two});
  const auto alone = [&](const std::string& name) {
    return json_of(road.run("conflicts " + name + ".h5 --trajectory path.txt --json"));
  };
  const json thin = alone("a"), dense = alone("b");
  CHECK(thin["conflict_count"] == 1);
  CHECK(dense["conflict_count"] == 2);
  CHECK(thin["gap"].get<double>() > 0.7);
  check_json(dense, R"({"gap": 0.3})");
  const json both = json_of(road.run("compare a.h5 b.h5 --conflicts --trajectory path.txt --json"));
  CHECK(both["gap"] == thin["gap"]);
  CHECK(both["min_points"] == thin["min_points"]);
  CHECK(both["b"]["conflicts"] == 1);
  check_equal(lists_of(both), "same 1");
  check_outcome(road.run("compare b.h5 a.h5 --conflicts --trajectory path.txt"), 0, kAnything,
                "both are grouped with a gap of 0.3 m and at least");
}
