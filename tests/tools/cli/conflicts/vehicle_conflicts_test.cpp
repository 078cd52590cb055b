// clearway conflicts --vehicle: conflicts are seen from the bodies.
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "tools/cli/support/hall.hpp"

using namespace clearway;
using namespace clearway::test;
using Catch::Contains;
using nlohmann::json;

namespace {

/// A truck on a path along x, and a crane 10 m to its left that looks backwards. Ten points stand
/// 0.3 m to the right of each of them; the crane's right is the path's left.
struct Yard {
  Yard() {
    std::string scan, box, path, crane;
    for (int i = 0; i < 10; ++i) {
      const std::string rest = " " + std::to_string(0.3 + i * 0.05) + "\n";
      scan += "5 -0.3" + rest + "8 10.3" + rest;
    }
    for (const char* x : {"-0.5", "0.5"}) {
      for (const char* y : {"-0.2", "0.2"}) {
        for (int k = 0; k <= 10; ++k) {
          box += std::string(x) + " " + y + " " + std::to_string(k * 0.1) + "\n";
        }
      }
    }
    for (int i = 0; i <= 100; ++i) {
      const std::string x = std::to_string(i * 0.1);
      path += "1 0 0 " + x + " 0 1 0 0 0 0 1 0\n";
      crane += "-1 0 0 " + x + " 0 -1 0 10 0 0 1 0\n";
    }
    put_bytes(folder / "scan.xyz", scan);
    put_bytes(folder / "box.xyz", box);
    put_bytes(folder / "path.txt", path);
    put_bytes(folder / "crane.txt", crane);
    put_vehicle("wagon.json", "crane");
    put_vehicle("other.json", "lift");
    REQUIRE(run("convert " + name("scan.xyz") + " -o " + name("site.h5")).exit_code == 0);
    search("out.h5", "--vehicle " + name("wagon.json"));
    search("plain.h5", "--model " + name("box.xyz"));
    put_bytes(folder / "box.off",
              "OFF\n8 6 0\n-.5 -.2 0\n.5 -.2 0\n.5 .2 0\n-.5 .2 0\n-.5 -.2 1\n.5 -.2 1\n.5 .2 1\n"
              "-.5 .2 1\n4 0 3 2 1\n4 4 5 6 7\n4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 3 0 4 7\n");
    search("mesh.h5", "--model " + name("box.off"));
  }

  void put_vehicle(const std::string& file, const std::string& second) const {
    put_bytes(folder / file, R"({"bodies": [{"name": "truck", "model": "box.xyz"}, {"name": ")" +
                                 second + R"(", "model": "box.xyz", "trajectory": "crane.txt"}]})");
  }
  void search(const std::string& result, const std::string& model) const {
    REQUIRE(run("run --env " + name("site.h5") + " --trajectory " + name("path.txt") +
                " --radius 0.15 --first-pose --clearance 0.3 -o " + name(result) + " " + model)
                .exit_code == 0);
  }
  Outcome run(const std::string& arguments) const { return run_program(folder, arguments); }
  Outcome conflicts(const std::string& options, const std::string& result = "out.h5") const {
    return run("conflicts " + name(result) + " --trajectory " + name("path.txt") + " " + options);
  }
  json listed(const std::string& options) const {
    const Outcome outcome = conflicts("--force -o " + name("listed.json") + " " + options);
    REQUIRE(outcome.exit_code == 0);
    return json::parse(bytes_of(folder / "listed.json"))["conflicts"];
  }
  std::string name(const std::string& file) const { return quoted(folder / file); }

  ScratchFolder folder;
};

const Yard& yard() {
  static const Yard made;
  return made;
}

}  // namespace

TEST_CASE("conflicts of a vehicle have the sides and offsets of their bodies") {
  const json seen = yard().listed("--vehicle " + yard().name("wagon.json"));
  REQUIRE(seen.size() == 2);
  CHECK(seen[0]["body_name"] == "truck");
  CHECK(seen[1]["body_name"] == "crane");
  for (const json& conflict : seen) {
    CHECK(conflict["side"] == "right");
    CHECK(conflict["lateral"].get<double>() == Approx(-0.3));
    CHECK(conflict["height"].get<double>() > 0.29);
  }
  const json backwards = yard().listed("--forward=-x --vehicle " + yard().name("wagon.json"));
  CHECK(backwards[1]["side"] == "left");

  const std::string page = yard().name("page.html");
  const Outcome report = yard().run(
      "report " + yard().name("out.h5") + " --env " + yard().name("site.h5") + " --trajectory " +
      yard().name("path.txt") + " --json --vehicle " + yard().name("wagon.json") + " -o " + page);
  REQUIRE(report.exit_code == 0);
  const json facts = json::parse(report.out)["conflicts"]["list"];
  REQUIRE(facts.size() == seen.size());
  for (std::size_t i = 0; i < seen.size(); ++i) {
    for (const char* key : {"side", "lateral", "height"}) CHECK(facts[i][key] == seen[i][key]);
  }
}

TEST_CASE("without the vehicle sides are unknown, and a note says what helps") {
  const json unseen = yard().listed("");
  REQUIRE(unseen.size() == 2);
  for (const json& conflict : unseen) CHECK(conflict["side"] == "unknown");
  CHECK(unseen[1]["lateral"].get<double>() == Approx(10.3));
  CHECK_THAT(yard().conflicts("").err, Contains("sides are unknown") && Contains("--vehicle"));
  CHECK_THAT(yard().conflicts("--vehicle " + yard().name("wagon.json")).err,
             !Contains("sides are unknown"));
  CHECK_THAT(yard().conflicts("", "plain.h5").err, !Contains("--vehicle"));
}

TEST_CASE("pictures of BCF show the bodies of a vehicle") {
  const auto checked = [](const std::string& more, const std::string& result = "out.h5") {
    REQUIRE(yard().conflicts("--force -o " + yard().name("c.bcf") + more, result).exit_code == 0);
    const Outcome outcome = run_program_at(CHECK_BCF, yard().folder, yard().name("c.bcf"));
    INFO(outcome.err);
    CHECK(outcome.exit_code == 0);
    return outcome.out;
  };
  CHECK_THAT(checked(""), Contains("2 topics, 0 with the model"));
  CHECK_THAT(checked(" --vehicle " + yard().name("wagon.json")),
             Contains("2 topics, 2 with the model, 0 full of it"));
  CHECK_THAT(checked(" --model " + yard().name("box.off"), "mesh.h5"),
             Contains("1 topics, 1 with the model, 1 full of it"));
}

TEST_CASE("a vehicle that is not of the result is refused, and no output is left") {
  const std::string output = " -o " + yard().name("no.csv");
  const std::string wagon = "--vehicle " + yard().name("wagon.json");
  check_refused(yard().conflicts(wagon + " --model " + yard().name("box.xyz") + output), 2,
                "excludes");
  check_refused(yard().conflicts(wagon + output, "plain.h5"), 3, "is of one model");
  check_refused(yard().conflicts("--model " + yard().name("box.xyz") + output), 3,
                "is of a vehicle of several bodies; give it with --vehicle");
  const Outcome other = yard().conflicts("--vehicle " + yard().name("other.json") + output);
  check_refused(other, 3, "is the result of another vehicle");
  CHECK_THAT(other.err, Contains("--vehicle takes the file of the run"));
  check_refused(yard().conflicts(wagon + " --model-unit mm" + output), 3, "another vehicle");
  put_bytes(yard().folder / "bad.json", R"({"bodies": [{"name": "a", "model": 1}]})");
  check_refused(yard().conflicts("--vehicle " + yard().name("bad.json") + output), 3,
                "bodies[0].model: expected a text");
  check_refused(yard().conflicts("--vehicle " + yard().name("none.json") + output), 4, "none.json");
  check_refused(yard().conflicts(wagon + " --force -o " + yard().name("crane.csv") + " -o " +
                                 yard().name("wagon.json")),
                2, "wagon.json");
  CHECK_FALSE(std::filesystem::exists(yard().folder / "no.csv"));
  CHECK_FALSE(std::filesystem::exists(yard().folder / "no.csv.partial"));
}

TEST_CASE("the station table of a vehicle is seen from its bodies") {
  const auto stations = [](const std::string& options) {
    return yard().run("stations " + yard().name("out.h5") + " --trajectory " +
                      yard().name("path.txt") + " --every 4 --force -o " + yard().name("s.json") +
                      " " + options);
  };
  const Outcome outcome = stations("--vehicle " + yard().name("wagon.json"));
  INFO(outcome.err);
  REQUIRE(outcome.exit_code == 0);
  const json rows = json::parse(bytes_of(yard().folder / "s.json"))["stations"];
  REQUIRE(rows.size() == 3);
  CHECK(rows[0]["verdict"] == "clear");
  CHECK(rows[1]["verdict"] == "conflict");
  CHECK(rows[2]["verdict"] == "conflict");  // the crane's rear passes its points
  // Both lie to the right of their own bodies, nearest with a front corner beside them.
  CHECK(rows[1]["right"].get<double>() == Approx(0.1));
  CHECK(rows[1]["left"].is_null());
  CHECK(rows[1]["truck_overthrow_end"] == 0);
  CHECK(rows[1]["crane_overthrow_middle"].get<double>() == Approx(10));
  const Outcome blind = stations("");
  CHECK(blind.exit_code == 0);
  CHECK_THAT(blind.err, Contains("without the bodies of the vehicle"));
  CHECK(json::parse(bytes_of(yard().folder / "s.json"))["stations"][0]["verdict"] == "clear");
  CHECK(stations("--vehicle " + yard().name("other.json")).exit_code == 3);
}
