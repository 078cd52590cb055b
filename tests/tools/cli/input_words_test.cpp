// What the program says about a file in the wrong place, about lengths with units, and about
// mistyped words.
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "io/store/store_reader.hpp"
#include "support/result_fixture.hpp"
#include "support/store_fixture.hpp"
#include "tools/cli/support/program.hpp"

using namespace clearway;
using namespace clearway::test;
using Catch::Contains;
using nlohmann::json;

namespace {

/// A folder with a file of each kind.
struct Files {
  Files() {
    std::string points;
    for (int i = 0; i < 500; ++i) {
      points += std::to_string(i % 25) + " " + std::to_string(i / 25) + " 0.5\n";
    }
    put_bytes(folder / "scan.xyz", points);
    put_bytes(folder / "model.xyz", "1 1 0.5\n1 1.05 0.5\n");
    put_bytes(folder / "path.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n");
    put_bytes(folder / "tum.txt", "# a comment\n0.5 1 2 3 0 0 0 1\n1.5 2 2 3 0 0 0 1\n");
    put_bytes(folder / "named.csv", "t,x,y,z,qx,qy,qz,qw\n1,2,3,4,0,0,0,1\n");
    put_bytes(folder / "empty.txt", "");
    put_bytes(folder / "car.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    write_las(folder / "scan.las", std::vector<Quantum>{{0, 0, 0}, {1000, 2000, 3000}});
    REQUIRE(run("convert " + path("scan.xyz") + " -o " + path("site.h5")).exit_code == 0);
    REQUIRE(search("site.h5", "model.xyz", "path.txt", "-o " + path("out.h5")).exit_code == 0);
  }

  Outcome run(const std::string& arguments) const { return run_program(folder, arguments); }
  std::string path(const std::string& name) const { return quoted(folder / name); }
  Outcome search(const std::string& environment, const std::string& model,
                 const std::string& trajectory, const std::string& rest) const {
    return run("run --radius 0.1 --env " + path(environment) + " --model " + path(model) +
               " --trajectory " + path(trajectory) + " " + rest);
  }
  json info(const std::string& name) const {
    const Outcome outcome = run("info --json " + path(name));
    CAPTURE(name, outcome.err);
    REQUIRE(outcome.exit_code == 0);
    return json::parse(outcome.out);
  }

  ScratchFolder folder;
};

struct Wrong {
  const char *name, *words;
};

}  // namespace

TEST_CASE("a file in the wrong place is refused with what it is and what to do") {
  const Files files;
  const std::string output = "-o " + files.path("x.h5");
  const auto check = [&](const Outcome& outcome, const Wrong& wrong) {
    CAPTURE(wrong.name, outcome.err);
    CHECK(outcome.exit_code == 3);
    CHECK_THAT(outcome.err, Contains(wrong.name) && Contains(wrong.words));
    CHECK_FALSE(std::filesystem::exists(files.folder / "x.h5"));
  };
  for (const Wrong& wrong :
       {Wrong{"scan.las",
              "is a scan (LAS), not a store: convert it first: "
              "clearway convert scan.las -o scan.h5"},
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
    const Outcome outcome = files.run("convert " + inputs + " -o " + files.path("x.h5"));
    CHECK(outcome.exit_code == 3);
    return outcome.err;
  };
  CHECK_THAT(refusal(files.path("car.obj")),
             Contains("expected points; clearway model samples its surface"));
  CHECK_THAT(refusal(files.path("car.obj") + " " + files.path("scan.las")),
             Contains("expected points; --skip-unreadable"));
  CHECK_THAT(refusal("/dev/null"),
             Contains("is a pipe or device") && Contains("clearway convert - < FILE"));
  std::filesystem::create_directory(files.folder / "tiles");
  std::filesystem::create_symlink("nowhere.las", files.folder / "tiles/lost.las");
  CHECK_THAT(refusal(files.path("tiles")), Contains("lost.las: is a link that leads to no file"));
}

TEST_CASE("info describes every input") {
  const Files files;
  const json las = files.info("scan.las");
  CHECK(las["kind"] == "scan");
  CHECK(las["format"] == "LAS");
  CHECK(las["points"] == 2);
  CHECK(las["scale"] == json::array({0.001, 0.001, 0.001}));
  CHECK(las["bounds"]["hi"] == json::array({101.0, -198.0, 3.0}));
  const json text = files.info("scan.xyz");
  CHECK(text["format"] == "text");
  CHECK(text["points"] == 500);
  CHECK(text["spacing"].get<double>() == Approx(1).margin(0.5));
  for (const char* name : {"path.txt", "tum.txt", "named.csv"}) {
    CHECK(files.info(name)["kind"] == "trajectory");
  }
  CHECK(files.info("tum.txt")["poses"] == 2);
  CHECK(files.info("tum.txt")["bounds"]["hi"] == json::array({2.0, 2.0, 3.0}));
  CHECK(files.info("site.h5")["kind"] == "store");
  CHECK(files.info("out.h5")["kind"] == "result");
  put_bytes(files.folder / "bad.las", "LASF and nothing more");
  CHECK(files.run("info " + files.path("bad.las")).exit_code == 3);
  CHECK(files.run("info " + files.path("missing")).exit_code == 4);
}

TEST_CASE("points that are not finite are counted by info") {
  const Files files;
  put_bytes(files.folder / "nan.xyz", "1 2 3\nnan 0 0\n4 5 6\n");
  const json description = files.info("nan.xyz");
  CHECK(description["points"] == 2);
  CHECK(description["non_finite_points"] == 1);
}

TEST_CASE("a length may have a unit, which is read exactly") {
  const Files files;
  const auto radius = [&](const std::string& text) {
    const Outcome outcome =
        files.run("run --force --env " + files.path("site.h5") + " --model " +
                  files.path("model.xyz") + " --trajectory " + files.path("path.txt") +
                  " --radius " + text + " -o " + files.path("r.h5"));
    CAPTURE(text, outcome.err);
    REQUIRE(outcome.exit_code == 0);
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
    CHECK(outcome.exit_code == 2);
    CHECK_THAT(outcome.err, Contains("mm, cm, m, km, in, ft, ift or us-ft"));
  }
}

TEST_CASE("feet are feet in a scan in feet") {
  const Files files;
  put_bytes(files.folder / "feet.xyz", "x[ft],y[ft],z[ft]\n0,0,0\n1,2,3\n4,5,6\n");
  REQUIRE(
      files.run("convert " + files.path("feet.xyz") + " -o " + files.path("feet.h5")).exit_code ==
      0);
  const auto radius = [&](const std::string& text) {
    const Outcome outcome =
        files.run("run --force --env " + files.path("feet.h5") + " --model " +
                  files.path("model.xyz") + " --trajectory " + files.path("path.txt") +
                  " --radius " + text + " -o " + files.path("r.h5"));
    CAPTURE(text, outcome.err);
    REQUIRE(outcome.exit_code == 0);
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
  const std::string info =
      "trajectory info --json " + files.path("tum.txt") + " --model " + files.path("model.xyz");
  const std::string run = "run --force --json --env " + files.path("site.h5") + " --model " +
                          files.path("car.obj") + " --trajectory " + files.path("path.txt") +
                          " --radius 0.1 -o " + files.path("r.h5");
  const auto same = [&](const std::string& command, const std::string& plain,
                        const std::string& with_unit, const char* what) {
    const Outcome outcomes[] = {files.run(command + plain), files.run(command + with_unit)};
    CAPTURE(command, outcomes[0].err, outcomes[1].err);
    REQUIRE(outcomes[0].exit_code == 0);
    REQUIRE(outcomes[1].exit_code == 0);
    CHECK(json::parse(outcomes[0].out)[what] == json::parse(outcomes[1].out)[what]);
  };
  const std::string model = "model --json " + files.path("car.obj");
  same(model, " --spacing 0.1", " --spacing 10cm", "points");
  same(run, " --model-spacing 0.05", " --model-spacing 50mm", "model_points");
  same(run, " --lever-arm 1,0,-1", " --lever-arm +100cm,0,-1m", "colliding_points");
  same(info, " --radius 0.5", " --radius 50cm", "motion");
  same(info, " --lever-arm 1,0,-1.016", " --lever-arm '1000 mm,0,-40in'", "first_pose");
  const std::string convert =
      "convert --force --json " + files.path("scan.xyz") + " -o " + files.path("c.h5");
  same(convert, " --layout regular:0.5", " --layout regular:50cm", "cells");
  same(convert, " --scale 0.01", " --scale 1cm", "scale");
  const std::string resample = "trajectory resample --force --json " + files.path("tum.txt") +
                               " --model " + files.path("model.xyz") + " -o " +
                               files.path("dense.txt");
  same(resample, " --max-motion 0.1", " --max-motion 10cm", "poses_out");
  for (const char* lever : {"1,2", "1,2,3,4", "1,2,x", "1,2,3parsecs", "nan,0,0", ""}) {
    CAPTURE(lever);
    CHECK(files.run(info + " --lever-arm '" + std::string(lever) + "'").exit_code == 2);
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
    CHECK(outcome.exit_code == 2);
    CHECK_THAT(outcome.err, Contains(words) && !Contains("is required"));
  }
  CHECK(files.run("run --help").exit_code == 0);
}
