// clearway conflicts --vehicle: conflicts are seen from the bodies.
#include <nlohmann/json.hpp>

#include "support/catch.hpp"
#include "tools/cli/conflicts/yard.hpp"

using namespace clearway;
using namespace clearway::test;
using nlohmann::json;

TEST_CASE("conflicts of a vehicle have the sides and offsets of their bodies") {
  const json seen = yard().listed("--vehicle wagon.json");
  REQUIRE(seen.size() == 2);
  CHECK(seen[0]["body_name"] == "truck");
  CHECK(seen[1]["body_name"] == "crane");
  for (const json& conflict : seen) {
    check_json(conflict, R"({"side": "right"})");
    check_near(conflict, "/lateral", -0.3);
    CHECK(conflict["height"].get<double>() > 0.29);
  }
  const json backwards = yard().listed("--forward=-x --vehicle wagon.json");
  CHECK(backwards[1]["side"] == "left");

  const std::string page = "page.html";
  const Outcome report = require_success(yard().run(
      "report out.h5 --env site.h5 --trajectory path.txt --json --vehicle wagon.json -o " + page));
  const json facts = json_of(report)["conflicts"]["list"];
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
  check_says(yard().conflicts("").err, "sides are unknown ... --vehicle");
  check_lacks(yard().conflicts("--vehicle wagon.json").err, "sides are unknown");
  check_lacks(yard().conflicts("", "plain.h5").err, "--vehicle");
}

TEST_CASE("pictures of BCF show the bodies of a vehicle") {
  const auto checked = [](const std::string& more, const std::string& result = "out.h5") {
    require_success(yard().conflicts("--force -o c.bcf" + more, result));
    const Outcome outcome = run_program_at(CHECK_BCF, yard().folder, "c.bcf");
    check_outcome(outcome, 0);
    return outcome.out;
  };
  check_says(checked(""), "2 topics, 0 with the model");
  check_says(checked(" --vehicle wagon.json"), "2 topics, 2 with the model, 0 full of it");
  check_says(checked(" --model box.off", "mesh.h5"), "1 topics, 1 with the model, 1 full of it");
}

TEST_CASE("a vehicle that is not of the result is refused, and no output is left") {
  const std::string output = " -o no.csv";
  const std::string wagon = "--vehicle wagon.json";
  check_refused(yard().conflicts(wagon + " --model box.xyz" + output), 2, "excludes");
  check_refused(yard().conflicts(wagon + output, "plain.h5"), 3, "is of one model");
  check_refused(yard().conflicts("--model box.xyz" + output), 3,
                "is of a vehicle of several bodies; give it with --vehicle");
  check_refused(yard().conflicts("--vehicle other.json" + output), 3,
                "is the result of another vehicle ... --vehicle takes the file of the run");
  check_refused(yard().conflicts(wagon + " --model-unit mm" + output), 3, "another vehicle");
  yard().put("bad.json", R"({"bodies": [{"name": "a", "model": 1}]})");
  check_refused(yard().conflicts("--vehicle bad.json" + output), 3,
                "bodies[0].model: expected a text");
  check_refused(yard().conflicts("--vehicle none.json" + output), 4, "none.json");
  check_refused(yard().conflicts(wagon + " --force -o crane.csv -o wagon.json"), 2, "wagon.json");
  CHECK_FALSE(yard().has("no.csv"));
  CHECK_FALSE(yard().has("no.csv.partial"));
}

TEST_CASE("the station table of a vehicle is seen from its bodies") {
  const auto stations = [](const std::string& options) {
    return yard().run("stations out.h5 --trajectory path.txt --every 4 --force -o s.json " +
                      options);
  };
  require_success(stations("--vehicle wagon.json"));
  const json rows = json::parse(yard().bytes("s.json"))["stations"];
  REQUIRE(rows.size() == 3);
  CHECK(rows[0]["verdict"] == "clear");
  CHECK(rows[1]["verdict"] == "conflict");
  CHECK(rows[2]["verdict"] == "conflict");  // the crane's rear passes its points
  // Both lie to the right of their own bodies, nearest with a front corner beside them.
  CHECK(rows[1]["right"].get<double>() == Approx(0.1));
  CHECK(rows[1]["left"].is_null());
  CHECK(rows[1]["truck_overthrow_end"] == 0);
  CHECK(rows[1]["crane_overthrow_middle"].get<double>() == Approx(10));
  check_outcome(stations(""), 0, "without the bodies of the vehicle");
  check_json(json::parse(yard().bytes("s.json")), R"({
    "stations": {"0": {"verdict": "clear"}}})");
  check_outcome(stations("--vehicle other.json"), 3);
}
