#include "clearway/model.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>

#include "support/bytes/mesh_bytes.hpp"
#include "tools/cli/support/hall.hpp"

using namespace clearway;
using namespace clearway::test;
using Catch::Contains;
using nlohmann::json;

namespace {

/// A box of the hall's vehicle's size, millimetres.
std::string vehicle() {
  TriangleMesh mesh = unit_cube();
  for (Vec3& v : mesh.vertices) v = {4000 * v.x - 2000, 1800 * v.y - 900, 1400 * v.z};
  return binary_stl(mesh);
}

struct Meshes {
  Meshes() { put_bytes(work.folder / "car.stl", vehicle()); }

  Outcome model(const std::string& options) const {
    return work.run("model " + work.path("car.stl") + " " + options);
  }
  /// A run in the hall at a radius of 0.4 m.
  Outcome run(const std::string& model, const std::string& output,
              const std::string& options) const {
    return work.run("run --env " + (work.hall / "site.h5") + " --model " + work.path(model) +
                    " --trajectory " + (work.hall / "trajectory.txt") + " --radius 0.4 -o " +
                    work.path(output) + " " + options);
  }

  Work work;
};

}  // namespace

TEST_CASE("model says what a mesh is like, and samples nothing without a spacing") {
  const Meshes meshes;
  const Outcome outcome = meshes.model("--unit mm --json");
  REQUIRE(outcome.exit_code == 0);
  const json facts = json::parse(outcome.out);
  CHECK(facts["kind"] == "mesh");
  CHECK(facts["triangles"] == 12);
  CHECK(facts["size"] == json::parse("[4.0, 1.8, 1.4]"));
  CHECK(facts["area"].get<double>() == Approx(2 * (4 * 1.8 + 4 * 1.4 + 1.8 * 1.4)));
  CHECK(facts["watertight"] == true);
  CHECK(facts["open_edges"] == 0);
  CHECK_FALSE(facts.contains("points"));
  const Outcome text = meshes.model("--unit mm --spacing 0.5");
  CHECK_THAT(text.out, Contains("4.0000 1.8000 1.4000 m") && Contains("watertight        yes") &&
                           Contains("model points"));
}

TEST_CASE("run of a mesh is run of the points that model wrote") {
  const Meshes meshes;
  REQUIRE(meshes.model("--unit mm --spacing 0.1 -o " + meshes.work.path("car.ply")).exit_code == 0);
  const auto points = read_model(meshes.work.folder / "car.ply");
  CHECK(points ==
        read_model(meshes.work.folder / "car.stl", {.spacing = 0.1, .unit = kMetresPerMillimetre}));
  // A quarter of the radius is the default.
  const Outcome mesh = meshes.run("car.stl", "mesh.h5", "--model-unit mm --json");
  REQUIRE(mesh.exit_code == 0);
  CHECK(json::parse(mesh.out)["model_points"] == points.size());
  CHECK(json::parse(mesh.out)["colliding_points"] > 0);
  CHECK_THAT(mesh.err, Contains("a mesh of 12 triangles, sampled to"));
  const json told = json::parse(mesh.out);
  for (const json& warning : told["warnings"]) {
    CHECK(warning["code"] != "");  // that is a note
  }
  REQUIRE(meshes.run("car.ply", "points.h5", "").exit_code == 0);
  CHECK(meshes.work.bytes("mesh.h5") == meshes.work.bytes("points.h5"));
}

TEST_CASE("the vertices alone are the model when asked, in the unit of the file") {
  const Meshes meshes;
  REQUIRE(meshes.model("--vertices --unit in -o " + meshes.work.path("v.ply")).exit_code == 0);
  const auto points = read_model(meshes.work.folder / "v.ply");
  CHECK(points.size() == 8);
  for (const Vec3& p : points) CHECK((p.x == 2000 * 0.0254 || p.x == -2000 * 0.0254));
  const Outcome run = meshes.run("car.stl", "v.h5", "--model-vertices --model-unit mm --json");
  REQUIRE(run.exit_code == 0);
  CHECK(json::parse(run.out)["model_points"] == 8);
  put_bytes(meshes.work.folder / "car.xyz", "1000 0 0\n0 1000 0\n1000 0 0\n");
  const Outcome cloud =
      meshes.work.run("model " + meshes.work.path("car.xyz") + " --unit mm --json");
  CHECK(json::parse(cloud.out)["kind"] == "points");
  CHECK(json::parse(cloud.out)["largest_gap"].get<double>() == Approx(std::sqrt(2.0)));
  CHECK(json::parse(cloud.out)["repeated_points"] == 1);
}

TEST_CASE("model refuses what it cannot do, and leaves no output") {
  const Meshes meshes;
  const std::string out = " -o " + meshes.work.path("car.ply");
  check_refused(meshes.model(out), 3, "--model-spacing METRES");
  const Outcome many = meshes.model("--spacing 0.001" + out);
  check_refused(many, 3, "4000 x 1800 x 1400 m");
  CHECK_THAT(many.err, Contains("--model-spacing 1 ") && Contains("--model-unit"));
  check_refused(meshes.model("--unit yard"), 2, "yard");
  check_refused(meshes.model("--spacing 0.1 --vertices"), 2, "--vertices");
  CHECK_FALSE(std::filesystem::exists(meshes.work.folder / "car.ply"));
  put_bytes(meshes.work.folder / "car.ply", "mine");
  check_refused(meshes.model("--unit mm --spacing 1" + out), 2, "--force");
  CHECK(meshes.work.bytes("car.ply") == "mine");
  CHECK(meshes.model("--unit mm --spacing 1 --force" + out).exit_code == 0);
  check_refused(meshes.model("--force --spacing 1 -o " + meshes.work.path("car.stl")), 2,
                "car.stl");
  CHECK(meshes.work.bytes("car.stl") == vehicle());
  check_refused(
      meshes.work.run("convert " + meshes.work.path("car.stl") + " -o " + meshes.work.path("a.h5")),
      3, "clearway model");
}

TEST_CASE("trajectory takes the box of a mesh in its unit") {
  const Meshes meshes;
  const auto resample = [&](const std::string& options) {
    return meshes.work.run("trajectory resample " + (meshes.work.hall / "trajectory.txt") +
                           " --max-motion 0.2 --force -o " + meshes.work.path("t.txt") +
                           " --model " + meshes.work.path("car.stl") + " --json " + options);
  };
  const Outcome metres = resample("--model-unit mm");
  REQUIRE(metres.exit_code == 0);
  CHECK(json::parse(metres.out)["largest_motion_after"] <= 0.2);
}
