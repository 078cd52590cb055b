// run --forward and --up: a model whose file has other axes gives the answer of the model that was
// turned by hand, and what reads the result turns the file in the same way.
#include <array>
#include <nlohmann/json.hpp>
#include <random>

#include "clearway/result.hpp"
#include "support/catch.hpp"
#include "support/store_fixture.hpp"
#include "tools/cli/support/hall.hpp"

using namespace clearway;
using namespace clearway::test;
using nlohmann::json;

namespace {

using Row = std::array<double, 3>;

/// The unit vector that an axis such as "-y" names.
Row unit_of(const std::string& axis) {
  Row out{};
  out[static_cast<std::size_t>(axis[1] - 'x')] = axis[0] == '-' ? -1 : 1;
  return out;
}

Row across(const Row& a, const Row& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// The place in a file with these axes that stands for x ahead, y to the left and z up.
Row in_file(const Row& p, const std::string& forward, const std::string& up) {
  const Row ahead = unit_of(forward), above = unit_of(up), left = across(above, ahead);
  Row out{};
  for (std::size_t k = 0; k < 3; ++k) out[k] = p[0] * ahead[k] + p[1] * left[k] + p[2] * above[k];
  return out;
}

/// A model without any symmetry in the hall, as it is and as files with other axes.
struct Turned {
  Turned() {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> x(-1.9, 2.1), y(-0.8, 0.9), z(0.3, 1.4);
    for (int i = 0; i < 12; ++i) corners.push_back({x(random), y(random), z(random)});
    work.put("upright.obj", mesh_of(corners));
  }

  static std::string mesh_of(const std::vector<Row>& corners) {
    std::string text;
    for (const Row& c : corners) {
      char line[100];
      std::snprintf(line, sizeof line, "v %.17g %.17g %.17g\n", c[0], c[1], c[2]);
      text += line;
    }
    for (std::size_t i = 1; i + 2 <= corners.size(); ++i) {
      text += "f " + std::to_string(i) + " " + std::to_string(i + 1) + " " + std::to_string(i + 2) +
              "\n";
    }
    return text;
  }

  void write_turned(const std::string& name, const std::string& forward,
                    const std::string& up) const {
    std::vector<Row> turned;
    for (const Row& c : corners) turned.push_back(in_file(c, forward, up));
    work.put(name, mesh_of(turned));
  }

  Outcome run(const std::string& model, const std::string& output,
              const std::string& options) const {
    return work.run("run --env hall/site.h5 --model " + model +
                    " --trajectory hall/trajectory.txt --radius 0.3 --first-pose --clearance 0.6 "
                    "--profile 1 --force -o " +
                    output + " " + options);
  }
  std::string conflicts(const std::string& result, const std::string& options,
                        const std::string& output) const {
    work.succeed("conflicts " + result + " --trajectory hall/trajectory.txt --force -o " + output +
                 " " + options);
    return work.bytes(output);
  }

  Work work;
  std::vector<Row> corners;
};

}  // namespace

TEST_CASE("each way to turn a model gives the result of the model turned by hand") {
  const Turned turned;
  require_success(turned.run("upright.obj", "upright.h5", ""));
  const Result upright(turned.work.folder / "upright.h5");
  REQUIRE(upright.size() > 0);
  const std::string axes[] = {"+x", "-x", "+y", "-y", "+z", "-z"};
  int ways = 0;
  for (const std::string& forward : axes) {
    for (const std::string& up : axes) {
      if (forward[1] == up[1]) continue;
      CAPTURE(forward, up);
      ++ways;
      turned.write_turned("turned.obj", forward, up);
      const Outcome run = require_success(
          turned.run("turned.obj", "turned.h5", "--forward " + forward + " --up " + up));
      check_outcome(turned.work.run("compare upright.h5 turned.h5"), 0);
      const Result result(turned.work.folder / "turned.h5");
      CHECK(result.source() == upright.source());
      CHECK(result.first_pose() == upright.first_pose());
      CHECK(result.clearance().distance == upright.clearance().distance);
      CHECK(result.profile().distance == upright.profile().distance);
      const ModelAxes kept = result.model_axes();
      CHECK(name_of(kept.forward) == forward);
      CHECK(name_of(kept.up) == up);
      const json info = json_of(turned.work.run("info turned.h5 --json"));
      const bool turns = forward != "+x" || up != "+z";
      CHECK(info.contains("model_axes") == turns);
      if (turns) CHECK(info["model_axes"] == json{{"forward", forward}, {"up", up}});
      // Without a turn the bytes are those of a run that names no axes.
      CHECK((turned.work.bytes("turned.h5") == turned.work.bytes("upright.h5")) == !turns);
    }
  }
  CHECK(ways == 24);
}

TEST_CASE("what reads the result of a turned model turns its file, and takes no other axes") {
  const Turned turned;
  const Work& work = turned.work;
  turned.write_turned("turned.obj", "-y", "+x");
  require_success(turned.run("upright.obj", "upright.h5", ""));
  require_success(turned.run("turned.obj", "turned.h5", "--forward=-y --up x"));
  const std::string expected = turned.conflicts("upright.h5", "--model upright.obj", "upright.csv");
  CHECK(turned.conflicts("turned.h5", "--model turned.obj", "turned.csv") == expected);
  const std::string path = " --trajectory hall/trajectory.txt ";
  const std::string report =
      "report turned.h5 --env hall/site.h5" + path + "--force --json -o page.html --model ";
  const Outcome page = work.succeed(report + "turned.obj");
  check_json(json_of(page), R"({
    "page": {"forward": 0}, "inputs": {"model": {"axes": ["-y", "+x"]}}})");
  const Outcome compared = work.run("compare upright.h5 turned.h5 --conflicts" + path +
                                    "--model upright.obj --model-b turned.obj");
  check_outcome(compared, 6);  // because both are about the same scan
  check_says(compared.out, "the same in both: ");
  for (const std::string axes : {"--forward +y", "--up z", "--forward x"}) {
    CAPTURE(axes);
    work.check({
        {report + "turned.obj " + axes, 2, "turned the model by --forward -y --up +x"},
        {"conflicts turned.h5" + path + axes, 2, "leave out its own --forward and --up"},
        {"compare upright.h5 turned.h5 --conflicts" + path + axes, 2,
         "leave out its own --forward and --up"},
    });
  }
  check_refused(work.run(report + "upright.obj"), 3, "is the result of another model");
}

TEST_CASE("axes along one line are refused before anything is read") {
  const Turned turned;
  const Outcome run = turned.run("none.obj", "out.h5", "--forward +z");
  check_refused(run, 2, "forward and up lie along the same axis");
  check_outcome(turned.run("upright.obj", "out.h5", "--forward w"), 2);
}

TEST_CASE("the floor and the points of clearway model are of the turned model") {
  const Turned turned;
  const Work& work = turned.work;
  turned.write_turned("turned.obj", "+z", "+y");
  for (const std::string& options :
       {std::string("--floor 0.8"), std::string("--model-as points --floor 0.8"),
        std::string("--model-vertices")}) {
    CAPTURE(options);
    require_success(turned.run("upright.obj", "upright.h5", options));
    require_success(turned.run("turned.obj", "turned.h5", options + " --forward z --up y"));
    check_outcome(work.run("compare upright.h5 turned.h5"), 0);
  }
  work.succeed("model upright.obj --spacing 0.1 -o upright.ply");
  work.succeed("model turned.obj --forward z --up y --spacing 0.1 -o turned.ply");
  check_same(work.bytes("upright.ply"), work.bytes("turned.ply"));
}

TEST_CASE("the steps of a path are those of the turned model") {
  const Turned turned;
  const Work& work = turned.work;
  turned.write_turned("turned.obj", "+z", "+y");
  const auto resampled = [&](const std::string& model, const std::string& axes) {
    work.succeed(
        "trajectory resample hall/trajectory.txt --max-motion 0.05 --force -o dense.txt --model " +
        model + axes);
    return work.bytes("dense.txt");
  };
  const std::string expected = resampled("upright.obj", "");
  CHECK(resampled("turned.obj", " --forward z --up y") == expected);
  const auto described = [&](const std::string& model, const std::string& axes) {
    return work.run("trajectory info hall/trajectory.txt --json --model " + model + axes).out;
  };
  CHECK(described("turned.obj", " --forward z --up y") == described("upright.obj", ""));
}

TEST_CASE("the axes hold for all bodies of a vehicle, and a merge keeps them") {
  const Turned turned;
  const Work& work = turned.work;
  turned.write_turned("turned.obj", "+y", "+z");
  const auto wagon = [&](const std::string& model) {
    const std::string name = model + ".json";
    work.put(name, R"({"bodies": [{"name": "front", "model": ")" + model +
                       R"("}, {"name": "rear", "model": ")" + model + R"(", "at": -3}]})");
    return "--vehicle " + name + " ";
  };
  const std::string run =
      "run --env hall/site.h5 --trajectory hall/trajectory.txt --radius 0.3 --first-pose --force "
      "-o ";
  work.succeed(run + "upright.h5 " + wagon("upright.obj"));
  work.succeed(run + "turned.h5 --forward y " + wagon("turned.obj"));
  check_outcome(work.run("compare upright.h5 turned.h5"), 0);
  CHECK(turned.conflicts("turned.h5", wagon("turned.obj"), "turned.csv") ==
        turned.conflicts("upright.h5", wagon("upright.obj"), "upright.csv"));
  for (const std::string part : {"1", "2"}) {
    work.succeed(run + "part" + part + ".h5 --forward y --shard " + part + "/2 " +
                 wagon("turned.obj"));
  }
  work.succeed("merge part1.h5 part2.h5 -o merged.h5");
  check_same(work.bytes("merged.h5"), work.bytes("turned.h5"));
}
