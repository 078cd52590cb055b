// Two scans of a road, each driven by the same car: what is new, gone, the same and not known.
#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "support/classed_scans.hpp"
#include "tools/cli/support/hall.hpp"

using namespace clearway;
using namespace clearway::test;
using Catch::Contains;
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
  double lower = 0;      ///< metres by which all is registered too low
  int noise = 0;         ///< another number gives other noise of up to 5 mm
  unsigned year = 0;     ///< year in the file's header; 0: none
  std::string run = {};  ///< options of the search
  std::string path = "path.txt";
};

/// A pair of epochs with what `compare --conflicts` says of it.
struct Pair {
  std::string name;
  Epoch a, b;
  int exit_code;
  /// The lists of the comparison that are not empty, with their numbers of entries.
  std::map<std::string, std::size_t> lists;
  std::string words;  ///< part of the last line
  /// Why a place was not searched, and why stretches of b's path are undecided
  std::set<std::string> reasons = {}, doubts = {};
};

constexpr int kSurface = 2, kThing = 5;  // classes
constexpr int kWithheld = 0x80;          // flag in the byte of the class, in format 1

struct Road : Work {
  Road() {
    put_bytes(folder / "path.txt", path(3, 57, 0));
    put_bytes(folder / "half.txt", path(3, 30, 0));
    put_bytes(folder / "beside.txt", path(3, 57, -0.5));
    std::string car;
    for (const int x : {-2, 2}) {
      for (const int y : {-1, 1}) {
        for (const double z : {0.3, 1.5}) {
          car +=
              "v " + std::to_string(x) + " " + std::to_string(y) + " " + std::to_string(z) + "\n";
        }
      }
    }
    for (const char* face : {"1 3 4 2", "5 6 8 7", "1 2 6 5", "3 7 8 4", "1 5 7 3", "2 4 8 6"}) {
      car += std::string("f ") + face + "\n";
    }
    put_bytes(folder / "car.obj", car);
  }

  static std::string path(double from, double to, double y) {
    std::string text;
    for (double x = from; x <= to; x += 0.5) {
      text += "1 0 0 " + std::to_string(x) + " 0 1 0 " + std::to_string(y) + " 0 0 1 0\n";
    }
    return text;
  }

  /// Writes the scan and its store, and searches it.
  void search(const std::string& name, const Epoch& epoch) const {
    std::vector<Quantum> points;
    std::vector<std::uint8_t> classes;
    unsigned seed = 1 + static_cast<unsigned>(epoch.noise) * 7919;
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
      for (double x = thing.x_from; x <= thing.x_to + 1e-9; x += 0.05) {
        for (double z = thing.z_from; z <= thing.z_to + 1e-9; z += 0.05) {
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
    const Outcome converted = run("convert " + path_of(name, ".las") + " --force --unit m -o " +
                                  path_of(name, "_site.h5"));
    INFO(converted.err);
    REQUIRE(converted.exit_code == 0);
    const Outcome searched = run("run --env " + path_of(name, "_site.h5") + " --model " +
                                 Work::path("car.obj") + " --trajectory " + Work::path(epoch.path) +
                                 " --first-pose --force -o " + path_of(name, ".h5") + " " +
                                 (epoch.run.empty() ? "--radius 0.1 --clearance 0.3" : epoch.run));
    INFO(searched.err);
    REQUIRE(searched.exit_code == 0);
  }

  std::string path_of(const std::string& name, const char* ending) const {
    return Work::path(name + ending);
  }

  Outcome compare(const Pair& pair, const std::string& more) const {
    const bool same_question = pair.b.run == pair.a.run && pair.b.path == pair.a.path;
    return run("compare " + Work::path("a.h5") + " " + Work::path("b.h5") +
               " --conflicts --trajectory " + Work::path(pair.a.path) + " --trajectory-b " +
               Work::path(pair.b.path) + " " + (same_question ? "" : "--allow-other-question ") +
               more);
  }

  /// The codes for which stretches of a result are undecided.
  std::set<std::string> doubts_of_stations(const Epoch& epoch) const {
    REQUIRE(run("stations " + Work::path("b.h5") + " --trajectory " + Work::path(epoch.path) +
                " --force -o " + Work::path("s.json"))
                .exit_code == 0);
    std::set<std::string> codes;
    const json table = json::parse(bytes("s.json"));
    for (const json& row : table["stations"]) {
      if (row["verdict"] != "undecided") continue;
      for (const json& code : row["doubts"]) codes.insert(code.get<std::string>());
    }
    return codes;
  }
};

const std::vector<Kerb> kPoles{pole(20), pole(45)};
const Kerb kSmallPole{45, 45.05, 0.4, 1.0};
const std::vector<Kerb> kBent{{20, 24, 0.35, 0.4}, {20, 20.05, 0.4, 1.4}};

const std::vector<Pair>& pairs() {
  static const std::vector<Pair> kPairs{
      {"unchanged with other noise",
       {.things = kPoles},
       {.things = kPoles, .noise = 1},
       0,
       {{"same", 2}},
       "no new conflicts"},
      {"gone",
       {.things = kPoles},
       {.things = {pole(20)}, .noise = 1},
       0,
       {{"gone", 1}, {"same", 1}},
       "1 conflict is gone if b was scanned there"},
      {"one side is missing in a, the other in b",
       {.things = kPoles, .no_right = {0, 61}},
       {.things = {pole(20)}, .no_left = {0, 61}, .noise = 1},
       6,
       {{"not_searched", 1}, {"same", 1}},
       "b has not searched 1 place",
       {"one-side"}},
      {"one side is missing in both",
       {.things = kPoles, .no_left = {0, 61}},
       {.things = {pole(20)}, .no_left = {0, 61}, .noise = 1},
       0,
       {{"gone", 1}, {"same", 1}},
       "no new conflicts"},
      {"a side is missing on stretches that overlap",
       {.things = {pole(45)}, .no_left = {0, 28}},
       {.things = {}, .no_left = {22, 61}, .noise = 1},
       6,
       {{"not_searched", 1}},
       "b has not searched 1 place",
       {"one-side"}},
      {"a side is missing on one stretch",
       {.things = {pole(45)}, .no_left = {0, 28}},
       {.things = {}, .no_left = {0, 28}, .noise = 1},
       0,
       {{"gone", 1}},
       "no new conflicts"},
      {"lower scan",
       {.things = kPoles},
       {.things = kPoles, .lower = 3.5, .noise = 1},
       6,
       {{"not_searched", 2}},
       "b has not searched 2 places",
       {"floats"}},
      {"withheld pole",
       {.things = {kSmallPole}},
       {.things = {{45, 45.05, 0.4, 1.0, 1.05, true}}, .noise = 1},
       6,
       {{"not_searched", 1}},
       "b has not searched 1 place",
       {"withheld"}},
      {"pole that is gone between scans with withheld points",
       {.things = {kSmallPole, {10, 10.05, 0.4, 1.0, 1.05, true}}},
       {.things = {{10, 10.05, 0.4, 1.0, 1.05, true}}, .noise = 1},
       0,
       {{"gone", 1}},
       "the dates of the files do not show that b is the later scan"},
      {"shorter scan",
       {.things = kPoles},
       {.things = kPoles, .scanned_to = 33, .noise = 1},
       6,
       {{"not_searched", 1}, {"same", 1}},
       "b has not searched 1 place",
       {"leaves-scan"},
       {"leaves-scan"}},
      {"hole in the ground",
       {.things = kPoles},
       {.things = {pole(20)}, .hole = {38, 52}, .noise = 1},
       6,
       {{"not_searched", 1}, {"same", 1}},
       "its run warned of nothing-below",
       {"nothing-below"},
       {"nothing-below"}},
      {"moved pole",
       {.things = kPoles},
       {.things = {pole(20), pole(47)}, .noise = 1},
       1,
       {{"gone", 1}, {"new", 1}, {"same", 1}},
       "1 new conflict"},
      {"new pole in the box of a kerb that is gone",
       {.things = kBent},
       {.things = {{23, 23.1, 0.9, 1.4}}, .noise = 1},
       1,
       {{"gone", 1}, {"new", 1}},
       "1 new conflict"},
      {"new pole that hangs together with an old kerb",
       {.things = {{20, 24, 0.35, 0.4}}},
       {.things = {{20, 24, 0.35, 0.4}, {23, 23.1, 0.4, 1.4}}, .noise = 1},
       1,
       {{"new_parts", 1}, {"same", 1}},
       "1 part of another conflict is new"},
      {"one falls into two",
       {.things = {{20, 24, 0.35, 0.4}}},
       {.things = {{20, 21.5, 0.35, 0.4}, {22.5, 24, 0.35, 0.4}}, .noise = 1},
       0,
       {{"same", 2}},
       "no new conflicts"},
      {"two become one",
       {.things = {{20, 21.5, 0.35, 0.4}, {22, 24, 0.35, 0.4}}},
       {.things = {{20, 24, 0.35, 0.4}}, .noise = 1},
       0,
       {{"same", 2}},
       "no new conflicts"},
      {"the same scan twice",
       {.things = kPoles},
       {.things = kPoles},
       6,
       {{"same", 2}},
       "the same scan"},
      {"older scan",
       {.things = kPoles, .year = 2024},
       {.things = kPoles, .noise = 1, .year = 2022},
       0,
       {{"same", 2}},
       "by the dates of the files b is older than a"},
      {"newer scan",
       {.things = kPoles, .year = 2022},
       {.things = kPoles, .noise = 1, .year = 2024},
       0,
       {{"same", 2}},
       "no new conflicts"},
      {"smaller radius",
       {.things = kPoles},
       {.things = kPoles, .noise = 1, .run = "--radius 0.02"},
       6,
       {{"not_searched", 2}},
       "b has not searched 2 places",
       {"coarse-scan", "radius"}},
      {"ignored class",
       {.things = kPoles},
       {.things = kPoles, .noise = 1, .run = "--radius 0.1 --clearance 0.3 --ignore-class 5"},
       6,
       {{"not_searched", 2}},
       "b has not searched 2 places",
       {"ignored"}},
      {"another path",
       {.things = kPoles},
       {.things = kPoles, .noise = 1, .path = "beside.txt"},
       6,
       {{"not_searched", 2}},
       "b has not searched 2 places",
       {"path"}},
      {"shorter path",
       {.things = kPoles},
       {.things = {}, .noise = 1, .path = "half.txt"},
       6,
       {{"gone", 1}, {"not_searched", 1}},
       "b has not searched 1 place",
       {"path"}},
  };
  return kPairs;
}

/// What differs from what is expected of a pair, in words; empty where nothing does.
std::string faults_of(const Pair& pair, const Road& road) {
  std::string faults;
  const Outcome text = road.compare(pair, "");
  if (text.exit_code != pair.exit_code) {
    faults += "exit code " + std::to_string(text.exit_code) + "; ";
  }
  if (text.out.find(pair.words) == std::string::npos) faults += "without \"" + pair.words + "\"; ";
  const json all = json::parse(road.compare(pair, "--json").out);
  for (const char* list :
       {"new", "new_parts", "new_small", "worse", "not_searched", "too_small", "gone", "same"}) {
    const auto expected = pair.lists.find(list);
    const std::size_t count = expected == pair.lists.end() ? 0 : expected->second;
    if (all[list].size() != count) {
      faults += std::string(list) + " has " + std::to_string(all[list].size()) + "; ";
    }
  }
  std::set<std::string> reasons;
  for (const json& place : all["not_searched"]) {
    for (const json& reason : place["reasons"]) reasons.insert(reason.get<std::string>());
  }
  if (reasons != pair.reasons) faults += "reasons " + json(reasons).dump() + "; ";
  if (all["holds"] != (pair.exit_code == 0)) faults += "holds; ";
  const std::set<std::string> doubts = road.doubts_of_stations(pair.b);
  if (doubts != pair.doubts) faults += "doubts " + json(doubts).dump() + "; ";
  return faults.empty() ? "" : faults + "\n" + text.out + text.err;
}

}  // namespace

TEST_CASE("two epochs are told apart as a person would") {
  const Road road;
  for (const Pair& pair : pairs()) {
    road.search("a", pair.a);
    road.search("b", pair.b);
    const std::string faults = faults_of(pair, road);
    INFO(pair.name);
    CHECK(faults == "");
  }
}

TEST_CASE("what a search of a shorter scan warns of is in all that is made of its result") {
  const Road road;
  const Pair pair{
      "", {.things = kPoles}, {.things = {pole(20)}, .scanned_to = 33, .noise = 1}, 6, {}, ""};
  road.search("a", pair.a);
  road.search("b", pair.b);
  const std::string trajectory = " --trajectory " + road.Work::path("path.txt");
  const std::string result = road.Work::path("b.h5");
  // The run collides, and still its result keeps the warning with its stretch.
  const json info = json::parse(road.run("info --json " + result).out);
  CHECK(info["verdict"] == "conflict");
  CHECK(info["doubts"] == json{"leaves-scan"});
  REQUIRE(info["warnings"].size() > 0);
  const json& leaves = info["warnings"][0];
  CHECK(leaves["code"] == "leaves-scan");
  REQUIRE(leaves["stretches"].size() == 1);
  // From where the scan ends to the last pose, with the pole at 45 m
  CHECK(leaves["stretches"][0][0] > 60);
  CHECK(leaves["stretches"][0][0] < 70);
  CHECK(leaves["stretches"][0][1] == 108);
  const json listed = json::parse(road.run("conflicts --json " + result + trajectory).out);
  CHECK(listed["warnings"] == info["warnings"]);
  REQUIRE(
      road.run("stations " + result + trajectory + " -o " + road.Work::path("s.csv")).exit_code ==
      0);
  CHECK_THAT(road.bytes("s.csv"), Contains(",doubts\n") && Contains(",leaves-scan\n"));
  REQUIRE(road.run("report " + result + " --env " + road.Work::path("b_site.h5") + " --model " +
                   road.Work::path("car.obj") + trajectory + " -o " + road.Work::path("page.html"))
              .exit_code == 0);
  CHECK_THAT(road.bytes("page.html"), Contains("leaves-scan"));
  CHECK(road.compare(pair, "-o " + road.Work::path("c.html") + " -o " + road.Work::path("c.csv"))
            .exit_code == 6);
  CHECK_THAT(road.bytes("c.html"), Contains("not searched"));
  CHECK_THAT(road.bytes("c.csv"), Contains("\nnot searched,2,,") && Contains("leaves-scan\n"));
  // Where nothing collides, the verdict of the whole is undecided too.
  road.search("b", {.things = {}, .scanned_to = 33});
  CHECK(json::parse(road.run("info --json " + result).out)["verdict"] == "undecided");
}

TEST_CASE("commands that read a result repeat what its run warned of") {
  const Road road;
  road.search("a", {.things = kPoles, .no_left = {0, 61}});
  const std::string result = road.Work::path("a.h5");
  const std::string path = result + " --trajectory " + road.Work::path("path.txt");
  const std::string words = "nothing was scanned on the left of the model";
  const std::string searched =
      " --env " + road.Work::path("a_site.h5") + " --model " + road.Work::path("car.obj");
  const std::string shift = "shift " + path + searched;
  for (const std::string& command :
       {"conflicts " + path, "stations " + path + " -o " + road.Work::path("s.csv"),
        "export " + result + " -o " + road.Work::path("out.csv"), shift,
        "compare " + result + " " + result}) {
    CAPTURE(command);
    CHECK_THAT(road.run(command).err, Contains(words));
  }
  const json table = json::parse(road.run(shift + " --json").out);
  const json info = json::parse(road.run("info --json " + result).out);
  CHECK(table["warnings"] == info["warnings"]);
  REQUIRE(info["warnings"].size() > 0);
  CHECK(info["warnings"][0]["code"] == "one-side");
  CHECK(info["warnings"][0]["numbers"]["side"] == 1);
}

TEST_CASE("a run notes few points that the store left out as withheld") {
  const Road road;
  road.search("a", {.things = {kSmallPole, {10, 10.05, 0.4, 1.0, 1.05, true}}});
  CHECK_THAT(road.run("run --env " + road.Work::path("a_site.h5") + " --model " +
                      road.Work::path("car.obj") + " --trajectory " + road.Work::path("path.txt") +
                      " --radius 0.1 -o " + road.Work::path("again.h5"))
                 .err,
             Contains("points of the scans are not searched, because they have the flag"));
  const json info = json::parse(road.run("info --json " + road.Work::path("a.h5")).out);
  CHECK(info["withheld_points"] > 20);
}

TEST_CASE("compare --conflicts reads a model as run did") {
  const Road road;
  const Epoch epoch{.things = kPoles, .run = "--radius 0.1 --model-above 0.5"};
  road.search("a", epoch);
  road.search("b", {.things = kPoles, .noise = 1, .run = epoch.run});
  const Pair pair{"", epoch, epoch, 0, {}, ""};
  const std::string model = "--model " + road.Work::path("car.obj");
  CHECK(road.compare(pair, model).exit_code == 3);
  CHECK(road.compare(pair, model + " --model-above 0.5").exit_code == 0);
}
