// What the program says about a file in the wrong place, about lengths with units, and about
// mistyped words.
#include <nlohmann/json.hpp>

#include "io/store/store_reader.hpp"
#include "support/catch.hpp"
#include "support/result_fixture.hpp"
#include "support/store_fixture.hpp"
#include "tools/cli/support/program.hpp"

using namespace clearway;
using namespace clearway::test;
using nlohmann::json;

namespace {

/// A folder with a file of each kind.
struct Files : Workplace {
  Files() {
    std::string points;
    for (int i = 0; i < 500; ++i) {
      points += std::to_string(i % 25) + " " + std::to_string(i / 25) + " 0.5\n";
    }
    put("scan.xyz", points);
    put("model.xyz", "1 1 0.5\n1 1.05 0.5\n");
    put("path.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n");
    put("tum.txt", "# a comment\n0.5 1 2 3 0 0 0 1\n1.5 2 2 3 0 0 0 1\n");
    put("named.csv", "t,x,y,z,qx,qy,qz,qw\n1,2,3,4,0,0,0,1\n");
    put("empty.txt", "");
    put("car.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    write_las(folder / "scan.las", std::vector<Quantum>{{0, 0, 0}, {1000, 2000, 3000}});
    require_success(run("convert scan.xyz -o site.h5"));
    require_success(search("site.h5", "model.xyz", "path.txt", "-o out.h5"));
  }

  Outcome search(const std::string& environment, const std::string& model,
                 const std::string& trajectory, const std::string& rest) const {
    return run("run --radius 0.1 --env " + environment + " --model " + model + " --trajectory " +
               trajectory + " " + rest);
  }
  json info(const std::string& name) const {
    const Outcome outcome = run("info --json " + name);
    CAPTURE(name, outcome.err);
    require_success(outcome);
    return json_of(outcome);
  }
};

struct Wrong {
  const char *name, *words;
};

}  // namespace

TEST_CASE("a file in the wrong place is refused with what it is and what to do") {
  const Files files;
  const std::string output = "-o x.h5";
  const auto check = [&](const Outcome& outcome, const Wrong& wrong) {
    CAPTURE(wrong.name, outcome.err);
    check_outcome(outcome, 3, wrong.name + std::string(" ... ") + wrong.words);
    CHECK_FALSE(files.has("x.h5"));
  };
  for (const Wrong& wrong :
       {Wrong{
            "scan.las",
            "is a scan (LAS), not a store: convert it first: clearway convert scan.las -o scan.h5"},
        Wrong{"scan.xyz", "convert it first"},
        Wrong{"path.txt", "is a trajectory (12 numbers a line), not a store"},
        Wrong{"out.h5", "is a result, not a store"}, Wrong{"car.obj", "is a mesh, not a store"},
        Wrong{"empty.txt", "is empty, not a store"}}) {
    check(files.search(wrong.name, "model.xyz", "path.txt", output), wrong);
  }
  for (const Wrong& wrong :
       {Wrong{"site.h5", "is a store, not a model"}, Wrong{"out.h5", "is a result, not a model"},
        Wrong{"path.txt", "not a model"}, Wrong{"tum.txt", "not a model"},
        Wrong{"named.csv", "is a trajectory (with named columns)"}}) {
    check(files.search("site.h5", wrong.name, "path.txt", output), wrong);
  }
  for (const Wrong& wrong : {Wrong{"site.h5", "is a store, not a trajectory"},
                             Wrong{"scan.las", "is a scan (LAS), not a trajectory"},
                             Wrong{"car.obj", "is a mesh, not a trajectory"}}) {
    check(files.search("site.h5", "model.xyz", wrong.name, output), wrong);
  }
}

TEST_CASE("a refused scan comes with the command that reads it") {
  const Files files;
  const auto refusal = [&](const std::string& inputs) {
    const Outcome outcome = files.run("convert " + inputs + " -o x.h5");
    check_outcome(outcome, 3);
    return outcome.err;
  };
  check_says(refusal("car.obj"), "expected points; clearway model samples its surface");
  check_says(refusal("car.obj scan.las"), "expected points; --skip-unreadable");
  check_says(refusal("/dev/null"), "is a pipe or device ... clearway convert - < FILE");
  std::filesystem::create_directory(files.folder / "tiles");
  std::filesystem::create_symlink("nowhere.las", files.folder / "tiles/lost.las");
  check_says(refusal("tiles"), "lost.las: is a link that leads to no file");
}

TEST_CASE("info describes every input") {
  const Files files;
  check_json(files.info("scan.las"), R"({
    "kind": "scan", "format": "LAS", "points": 2, "scale": [0.001, 0.001, 0.001],
    "bounds": {"hi": [101.0, -198.0, 3.0]}})");
  const json text = files.info("scan.xyz");
  check_json(text, R"({"format": "text", "points": 500})");
  check_near(text, "/spacing", 1, 0.5);
  for (const char* name : {"path.txt", "tum.txt", "named.csv"}) {
    CHECK(files.info(name)["kind"] == "trajectory");
  }
  CHECK(files.info("tum.txt")["poses"] == 2);
  CHECK(files.info("tum.txt")["bounds"]["hi"] == json::array({2.0, 2.0, 3.0}));
  CHECK(files.info("site.h5")["kind"] == "store");
  CHECK(files.info("out.h5")["kind"] == "result");
  files.put("bad.las", "LASF and nothing more");
  check_outcome(files.run("info bad.las"), 3);
  check_outcome(files.run("info missing"), 4);
}

TEST_CASE("points that are not finite are counted by info") {
  const Files files;
  files.put("nan.xyz", "1 2 3\nnan 0 0\n4 5 6\n");
  check_json(files.info("nan.xyz"), R"({"points": 2, "non_finite_points": 1})");
}

TEST_CASE("a length may have a unit, which is read exactly") {
  const Files files;
  const auto radius = [&](const std::string& text) {
    const Outcome outcome =
        files.run("run --force --env site.h5 --model model.xyz --trajectory path.txt --radius " +
                  text + " -o r.h5");
    CAPTURE(text, outcome.err);
    require_success(outcome);
    return ResultReader(files.folder / "r.h5").header().radius;
  };
  for (const char* text :
       {"0.1", "10cm", "100mm", "0.1m", "0.0001km", "10 cm", "'10 cm'", "1e2mm"}) {
    CHECK(radius(text) == 0.1);
  }
  CHECK(radius("0.7cm") == 0.007);
  CHECK(radius("4in") == 0.1016);
  CHECK(radius("1ft") == 0.3048);
  for (const char* text : {"10 parsecs", "10 c m", "m", "-1cm", "0mm", "1e400km", "nan", "1.2.3"}) {
    const Outcome outcome = files.search("site.h5", "model.xyz", "path.txt",
                                         "--clearance '" + std::string(text) + "' -o x.h5");
    CAPTURE(text);
    check_outcome(outcome, 2, "mm, cm, m, km, in, ft, ift or us-ft");
  }
}

TEST_CASE("feet are feet in a scan in feet") {
  const Files files;
  files.put("feet.xyz", "x[ft],y[ft],z[ft]\n0,0,0\n1,2,3\n4,5,6\n");
  files.succeed("convert feet.xyz -o feet.h5");
  const auto radius = [&](const std::string& text) {
    const Outcome outcome =
        files.run("run --force --env feet.h5 --model model.xyz --trajectory path.txt --radius " +
                  text + " -o r.h5");
    CAPTURE(text, outcome.err);
    require_success(outcome);
    return ResultReader(files.folder / "r.h5").header().radius;
  };
  for (const char* text : {"0.1", "0.2", "0.3", "0.7", "1.1", "2.3e-1"}) {
    CHECK(radius(std::string(text) + "ft") == std::stod(text));
  }
  CHECK(radius("12in") == 1);
  CHECK(radius("30.48cm") == Approx(1).epsilon(1e-15));
}

TEST_CASE("every option that is a length takes a unit") {
  const Files files;
  const std::string info = "trajectory info --json tum.txt --model model.xyz";
  const std::string run =
      "run --force --json --env site.h5 --model car.obj --trajectory path.txt --radius 0.1 -o r.h5";
  const auto same = [&](const std::string& command, const std::string& plain,
                        const std::string& with_unit, const char* what) {
    const Outcome outcomes[] = {files.run(command + plain), files.run(command + with_unit)};
    CAPTURE(command, outcomes[0].err, outcomes[1].err);
    require_success(outcomes[0]);
    require_success(outcomes[1]);
    CHECK(json::parse(outcomes[0].out)[what] == json::parse(outcomes[1].out)[what]);
  };
  const std::string model = "model --json car.obj";
  same(model, " --spacing 0.1", " --spacing 10cm", "points");
  same(run, " --model-spacing 0.05", " --model-spacing 50mm", "model_points");
  same(run, " --lever-arm 1,0,-1", " --lever-arm +100cm,0,-1m", "colliding_points");
  same(info, " --radius 0.5", " --radius 50cm", "motion");
  same(info, " --lever-arm 1,0,-1.016", " --lever-arm '1000 mm,0,-40in'", "first_pose");
  const std::string convert = "convert --force --json scan.xyz -o c.h5";
  same(convert, " --layout regular:0.5", " --layout regular:50cm", "cells");
  same(convert, " --scale 0.01", " --scale 1cm", "scale");
  const std::string resample =
      "trajectory resample --force --json tum.txt --model model.xyz -o dense.txt";
  same(resample, " --max-motion 0.1", " --max-motion 10cm", "poses_out");
  for (const char* lever : {"1,2", "1,2,3,4", "1,2,x", "1,2,3parsecs", "nan,0,0", ""}) {
    CAPTURE(lever);
    check_outcome(files.run(info + " --lever-arm '" + std::string(lever) + "'"), 2);
  }
}

TEST_CASE("a mistyped word is named before what is then missing") {
  const Files files;
  for (const auto& [arguments, words] : std::vector<std::pair<std::string, std::string>>{
           {"run --radios 0.1", "unknown option --radios; did you mean --radius?"},
           {"run --radus=0.1", "did you mean --radius?"},
           {"run -x", "unknown option -x"},
           {"run --frobnicate", "unknown option --frobnicate (clearway run --help"},
           {"covnert a.las", "covnert: no such command; did you mean convert?"},
           {"trajectory resampel", "did you mean resample?"},
           {"report --model-as solid",
            "unknown option --model-as; leave it out, because the result"},
           {"run --engine swep", "swep not in"},
           {"--vesion", "did you mean --version?"}}) {
    const Outcome outcome = files.run(arguments);
    CAPTURE(arguments);
    check_outcome(outcome, 2, words);
    check_lacks(outcome.err, "is required");
  }
  check_outcome(files.run("run --help"), 0);
}
