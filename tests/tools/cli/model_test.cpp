#include "clearway/model.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>

#include "support/bytes/mesh_bytes.hpp"
#include "tools/cli/support/hall.hpp"

using namespace clearway;
using namespace clearway::test;
using Catch::Contains;
using nlohmann::json;

TEST_CASE("a box and an outline are models that run takes, and a file keeps its meaning") {
  const Work work;
  const Outcome box = work.run("model box 4,180cm,1.4 -o " + work.path("box.off"));
  CHECK_THAT(box.err, Contains("a closed solid of 8 corners and 12 triangles, 4 x 1.8 x 1.4 m") &&
                          Contains("10.08 m3"));
  put_bytes(work.folder / "half.csv", "height,half_width\n0,0.9\n1.4,0.9\n");
  const Outcome outline = work.run("model outline " + work.path("half.csv") +
                                   " --mirror --x=-2,2 -o " + work.path("outline.ply"));
  REQUIRE(outline.exit_code == 0);
  const json facts = json::parse(work.run("model " + work.path("outline.ply") + " --json").out);
  CHECK(facts["watertight"] == true);
  CHECK(facts["triangles"] == 12);
  const auto colliding = [&](const std::string& model) {
    const Outcome run =
        work.run("run --env " + (work.hall / "site.h5") + " --model " + model +
                 " --model-as solid --trajectory " + (work.hall / "trajectory.txt") +
                 " --radius 0.4 --json --force -o " + work.path("out.h5"));
    INFO(run.err);
    REQUIRE(run.exit_code == 0);
    return json::parse(run.out)["colliding_points"].get<std::uint64_t>();
  };
  const std::uint64_t expected = colliding("box:4,1.8,1.4");
  CHECK(expected > 0);
  CHECK(colliding(work.path("box.off")) == expected);
  CHECK(colliding(work.path("outline.ply")) == expected);
  CHECK(work.run("model").exit_code == 2);
  CHECK(work.run("model box 1,2 -o " + work.path("no.off")).exit_code == 2);
  const Outcome named = work.run("model box 1,2,3 -o " + work.path("no.stl"));
  CHECK_THAT(named.err, Contains("expected a name that ends in .off or .ply"));
  const Outcome crossing = work.run("model outline " + work.path("half.csv") +
                                    " --mirror --x=2,-2 -o " + work.path("no.off"));
  CHECK_THAT(crossing.err, Contains("half.csv: a solid from x = 2 to -2"));
}

namespace {

/// A box of the size of the hall's vehicle, in millimetres.
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
  /// Runs a search in the hall at a radius of 0.4 m.
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
  const auto points = read_model_points(meshes.work.folder / "car.ply");
  CHECK(points == read_model_points(meshes.work.folder / "car.stl",
                                    {.spacing = 0.1, .unit = kMetresPerMillimetre}));
  // The default spacing is a quarter of the radius.
  const Outcome mesh = meshes.run("car.stl", "mesh.h5", "--model-as points --model-unit mm --json");
  REQUIRE(mesh.exit_code == 0);
  CHECK(json::parse(mesh.out)["model_points"] == points.size());
  CHECK(json::parse(mesh.out)["colliding_points"] > 0);
  CHECK_THAT(mesh.err, Contains("a mesh of 12 triangles, sampled to"));
  const json told = json::parse(mesh.out);
  for (const json& warning : told["warnings"]) {
    CHECK(warning["code"] != "");  // an empty code would be a note's
  }
  REQUIRE(meshes.run("car.ply", "points.h5", "").exit_code == 0);
  // The result of the mesh also has the warnings about the mesh.
  CHECK(meshes.work
            .run("compare " + meshes.work.path("mesh.h5") + " " + meshes.work.path("points.h5"))
            .exit_code == 0);
}

TEST_CASE("run of a mesh searches its surface") {
  const Meshes meshes;
  const Outcome run = meshes.run("car.stl", "surface.h5", "--model-unit mm --first-pose --json");
  REQUIRE(run.exit_code == 0);
  const json told = json::parse(run.out);
  CHECK(told["model_as"] == "surface");
  CHECK(told["model_points"] == 8);
  CHECK(told["model_triangles"] == 12);
  CHECK(told["engine"] == "sweep");
  CHECK(told["searches"] == told["poses"].get<std::uint64_t>() * 12);
  CHECK_THAT(run.err, Contains("12 triangles, searched as it is"));
  const json info =
      json::parse(meshes.work.run("info " + meshes.work.path("surface.h5") + " --json").out);
  CHECK(info["model_as"] == "surface");
  CHECK(info["model_triangles"] == 12);
  // Samples lie on the surface, so what touches a sample touches the surface. No place of the
  // surface is far from a sample.
  const auto count = [&](const std::string& output, const std::string& options) {
    const Outcome points = meshes.run("car.stl", output, "--model-unit mm --json " + options);
    REQUIRE(points.exit_code == 0);
    CHECK(json::parse(points.out)["model_as"] == "points");
    return json::parse(points.out)["colliding_points"].get<std::uint64_t>();
  };
  const std::uint64_t hits = told["colliding_points"];
  CHECK(hits >= count("coarse.h5", "--model-as points"));
  const std::uint64_t fine = count("fine.h5", "--model-spacing 0.02");
  CHECK(hits >= fine);
  CHECK(hits - fine < hits / 20);
  // The same search gives the same result in parts, and with the same identity of its journal.
  REQUIRE(meshes.run("car.stl", "part1.h5", "--model-unit mm --first-pose --shard 1/2").exit_code ==
          0);
  REQUIRE(meshes.run("car.stl", "part2.h5", "--model-unit mm --first-pose --shard 2/2").exit_code ==
          0);
  REQUIRE(meshes.work
              .run("merge " + meshes.work.path("part1.h5") + " " + meshes.work.path("part2.h5") +
                   " -o " + meshes.work.path("merged.h5"))
              .exit_code == 0);
  CHECK(meshes.work.bytes("merged.h5") == meshes.work.bytes("surface.h5"));
  CHECK(meshes.run("car.stl", "surface.h5", "--model-unit mm --first-pose --resume").exit_code ==
        0);
  check_refused(meshes.run("car.stl", "surface.h5",
                           "--model-unit mm --first-pose --model-as points --resume"),
                2, "surface.h5");
}

TEST_CASE("run of a solid finds what is inside") {
  const Meshes meshes;
  const std::string options = "--model-unit mm --clearance 0.5 --profile 0.5 --first-pose --json ";
  const Outcome surface = meshes.run("car.stl", "surface.h5", options);
  const Outcome solid = meshes.run("car.stl", "solid.h5", options + "--model-as solid");
  REQUIRE(solid.exit_code == 0);
  const json told = json::parse(solid.out);
  CHECK(told["model_as"] == "solid");
  CHECK(told["model_solids"] == 1);
  CHECK(told["colliding_points"] >= json::parse(surface.out)["colliding_points"]);
  CHECK_THAT(solid.err, Contains("1 closed parts of 12 triangles are solid"));
  CHECK_THAT(solid.err, Contains("the greatest depth inside the model is"));
  const auto inside = told["points_inside"].get<std::uint64_t>();
  const auto depth = told["greatest_depth"].get<double>();
  CHECK(inside > 0);
  CHECK(inside <= told["colliding_points"]);
  CHECK(depth > 0);
  CHECK(depth <= 0.7);  // half the height of the box
  CHECK(told["least_clearance"]["distance"] == -depth);
  CHECK(told["least_profile"]["distance"] == -depth);
  CHECK(json::parse(surface.out)["points_inside"].is_null());
  CHECK(json::parse(surface.out)["greatest_depth"].is_null());
  const Outcome verified = meshes.work.run("verify " + meshes.work.path("solid.h5"));
  CHECK(verified.exit_code == 0);
  const json info = json::parse(meshes.work.run("info --json " + meshes.work.path("solid.h5")).out);
  CHECK(info["model_as"] == "solid");
  CHECK(info["points_inside"] == inside);
  CHECK(info["greatest_depth"] == depth);
  // The search gives the same in parts.
  const std::string shard = "--model-as solid " + options + "--shard ";
  REQUIRE(meshes.run("car.stl", "part1.h5", shard + "1/2").exit_code == 0);
  REQUIRE(meshes.run("car.stl", "part2.h5", shard + "2/2").exit_code == 0);
  const Outcome merged =
      meshes.work.run("merge --json " + meshes.work.path("part1.h5") + " " +
                      meshes.work.path("part2.h5") + " -o " + meshes.work.path("merged.h5"));
  REQUIRE(merged.exit_code == 0);
  CHECK(json::parse(merged.out)["points_inside"] == inside);
  CHECK(json::parse(merged.out)["greatest_depth"] == depth);
  CHECK(meshes.work.bytes("merged.h5") == meshes.work.bytes("solid.h5"));
  check_refused(meshes.run("car.stl", "no.h5", "--model-as solid --model-unit mm --model-above 0"),
                2, "no longer solid");
}

TEST_CASE("conflicts of a solid tell its depth") {
  const Meshes meshes;
  const Outcome run = meshes.run("car.stl", "solid.h5",
                                 "--model-as solid --model-unit mm --clearance 0.2 --first-pose "
                                 "--json");
  REQUIRE(run.exit_code == 0);
  const json told = json::parse(run.out);
  const auto conflicts = [&](const std::string& output) {
    return meshes.work.run("conflicts " + meshes.work.path("solid.h5") + " --trajectory " +
                           (meshes.work.hall / "trajectory.txt") + " --min-points 1 -o " +
                           meshes.work.path(output));
  };
  const Outcome table = conflicts("listed.json");
  REQUIRE(table.exit_code == 0);
  CHECK_THAT(table.out, Contains("depth (m)") && Contains("inside"));
  std::uint64_t inside = 0;
  double deepest = 0;
  const json listed = json::parse(meshes.work.bytes("listed.json"));
  for (const json& c : listed["conflicts"]) {
    const auto depth = c["depth"].get<double>();
    if (depth > 0) CHECK(c["least_distance"] == -depth);
    inside += c["points_inside"].get<std::uint64_t>();
    deepest = std::max(deepest, depth);
  }
  CHECK(inside == told["points_inside"]);
  CHECK(deepest == told["greatest_depth"]);
  for (const char* name : {"listed.csv", "listed.geojson", "listed.gpkg", "listed.bcf"}) {
    CHECK(conflicts(name).exit_code == 0);
  }
}

TEST_CASE("what has no surface is refused and points are named") {
  const Meshes meshes;
  const auto refused = [&](const std::string& options, const char* words) {
    for (const std::string kind : {"--model-as surface ", "--model-as solid ", ""}) {
      INFO(kind << options);
      const Outcome run = meshes.run("car.stl", "no.h5", kind + "--model-unit mm " + options);
      check_refused(run, 2, words);
      CHECK_THAT(run.err, Contains("--model-as points searches points of it"));
    }
  };
  refused("--engine kdtree", "engine kdtree searches models of points");
  refused("--engine grid --device cpu", "engine grid searches models of points");
  refused("--between-poses", "motion between poses is searched for models of points");
  for (const char* options : {"--model-spacing 0.1", "--model-vertices"}) {
    check_refused(meshes.run("car.stl", "no.h5",
                             "--model-as surface --model-unit mm " + std::string(options)),
                  2, "a surface is searched as it is");
  }
  put_bytes(meshes.work.folder / "car.xyz", "1 0 0\n0 1 0\n1 0 0\n");
  check_refused(meshes.run("car.xyz", "no.h5", "--model-as surface"), 3, "has no triangles");
  // Points are searched by every engine, in whatever way they are asked for.
  for (const char* points : {"--model-as points", "--model-spacing 0.1", "--model-vertices"}) {
    for (const char* options :
         {"--engine kdtree", "--engine grid --device cpu", "--between-poses"}) {
      const Outcome run =
          meshes.run("car.stl", "some.h5",
                     "--force --model-unit mm --json " + std::string(points) + " " + options);
      INFO(points << " " << options);
      REQUIRE(run.exit_code == 0);
      CHECK(json::parse(run.out)["model_as"] == "points");
      CHECK(json::parse(run.out)["model_spacing"] > 0);
    }
  }
}

namespace {

/// A plate of two triangles, and one point of the environment that is 0.099 m above it, where no
/// sample of its surface is near.
struct Plate {
  Plate() {
    put_bytes(work.folder / "plate.off",
              "OFF\n4 2 0\n-3 -2 0\n3 -2 0\n3 2 0\n-3 2 0\n3 0 1 2\n3 0 2 3\n");
    const auto samples = read_model_points(work.folder / "plate.off", {.spacing = 0.025});
    Vec3 place{};
    double farthest = 0;
    for (int i = 0; i < 100; ++i) {
      const Vec3 tried{0.3 + 0.001 * i, 0.5, 0};
      double nearest = 9;
      for (const Vec3& s : samples) {
        nearest = std::min(nearest, std::hypot(s.x - tried.x, s.y - tried.y));
      }
      if (nearest <= farthest) continue;
      farthest = nearest;
      place = tried;
    }
    REQUIRE(std::hypot(farthest, 0.099) > 0.1);
    put_bytes(work.folder / "scan.xyz", std::to_string(place.x) + " 0.5 0.099\n");
    put_bytes(work.folder / "path.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 1 0 0 0 0 1 0\n");
    REQUIRE(
        work.run("convert " + work.path("scan.xyz") + " --scale 0.001 -o " + work.path("site.h5"))
            .exit_code == 0);
  }

  Outcome run(const std::string& options, const std::string& output = "out.h5") const {
    return work.run("run --env " + work.path("site.h5") + " --model " + work.path("plate.off") +
                    " --trajectory " + work.path("path.txt") + " --radius 0.1 -o " +
                    work.path(output) + " " + options);
  }

  Work work;
};

}  // namespace

TEST_CASE("a plate that is hit between its samples is never silently clear") {
  const Plate plate;
  for (const char* options : {"--between-poses", "--engine kdtree", "--engine grid --device cpu"}) {
    INFO(options);
    check_refused(plate.run("--force " + std::string(options)), 2, "--model-as points");
    const Outcome points = plate.run("--force --model-as points " + std::string(options));
    REQUIRE(points.exit_code == 0);
    CHECK_THAT(points.out, Contains("clear") &&
                               Contains("no place of its surface is farther than 0.025 m") &&
                               Contains("as close as 0.075 m"));
    const Outcome again = plate.run("--resume --json --model-as points " + std::string(options));
    REQUIRE(again.exit_code == 0);
    CHECK(json::parse(again.out)["was_finished"] == true);
    CHECK(json::parse(again.out)["model_spacing"] == 0.025);
    CHECK_THAT(again.err, Contains("farther than 0.025 m"));
    const json info = json::parse(plate.work.run("info --json " + plate.work.path("out.h5")).out);
    CHECK(info["model_spacing"] == 0.025);
  }
  const Outcome coarse = plate.run("--force --model-vertices");
  CHECK_THAT(coarse.out, Contains("clear") && Contains("may touch"));
  const Outcome surface = plate.run("--force --json --fail-on-collision");
  CHECK(surface.exit_code == 1);
  CHECK(json::parse(surface.out)["verdict"] == "conflict");
  CHECK(json::parse(surface.out)["model_spacing"].is_null());
}

TEST_CASE("the spacing of a sampled mesh goes with its points and its parts") {
  const Plate plate;
  const Work& work = plate.work;
  REQUIRE(
      work.run("model " + work.path("plate.off") + " --spacing 0.025 -o " + work.path("plate.ply"))
          .exit_code == 0);
  const Outcome run = work.run("run --env " + work.path("site.h5") + " --model " +
                               work.path("plate.ply") + " --trajectory " + work.path("path.txt") +
                               " --radius 0.1 -o " + work.path("points.h5"));
  CHECK_THAT(run.out, Contains("farther than 0.025 m"));
  REQUIRE(plate.run("--model-as points", "sampled.h5").exit_code == 0);
  CHECK(work.bytes("points.h5") == work.bytes("sampled.h5"));
  REQUIRE(plate.run("--model-as points --shard 1/2", "one.h5").exit_code == 0);
  REQUIRE(plate.run("--model-as points --shard 2/2", "two.h5").exit_code == 0);
  const Outcome merged = work.run("merge " + work.path("one.h5") + " " + work.path("two.h5") +
                                  " -o " + work.path("merged.h5"));
  CHECK_THAT(merged.out, Contains("clear") && Contains("farther than 0.025 m"));
  CHECK(work.bytes("merged.h5") == work.bytes("sampled.h5"));
  // The report samples the model as the run did, and says so.
  REQUIRE(plate.run("--model-spacing 0.03 --first-pose", "three.h5").exit_code == 0);
  const Outcome report =
      work.run("report " + work.path("three.h5") + " --env " + work.path("site.h5") + " --model " +
               work.path("plate.off") + " --trajectory " + work.path("path.txt") + " --json -o " +
               work.path("page.html"));
  REQUIRE(report.exit_code == 0);
  CHECK(json::parse(report.out)["inputs"]["model"]["spacing"] == 0.03);
}

TEST_CASE("a mast that is drawn as a line, or as points, collides") {
  const Plate plate;
  const Work& work = plate.work;
  const std::string start = "v -3 -2 -5\nv 3 -2 -5\nv 3 2 -5\n";
  const auto verdict = [&](const std::string& mesh, const std::string& options) {
    put_bytes(work.folder / "mast.obj", start + mesh);
    const Outcome run = work.run("run --force --json --env " + work.path("site.h5") + " --model " +
                                 work.path("mast.obj") + " --trajectory " + work.path("path.txt") +
                                 " --radius 0.1 -o " + work.path("mast.h5") + " " + options);
    INFO(run.err);
    REQUIRE(run.exit_code == 0);
    return json::parse(run.out);
  };
  const std::string mast = "f 1 2 3\nv 0.35 0.5 -5\nv 0.35 0.5 5\n";
  for (const std::string options : {"", "--model-as points", "--model-as points --between-poses",
                                    "--clearance 0.2 --profile 0.2 --first-pose"}) {
    INFO(options);
    CHECK(verdict(mast + "l 4 5\n", options)["colliding_points"] == 1);
  }
  CHECK(verdict("l 1 2\nv 0.35 0.5 -5\nv 0.35 0.5 5\nl 4 5\n", "")["colliding_points"] == 1);
  CHECK(verdict("v 0.35 0.5 0.1\np 4 1\n", "--between-poses")["colliding_points"] == 1);
  const json loose = verdict(mast, "");
  CHECK(loose["colliding_points"] == 0);
  const auto& warnings = loose["warnings"];
  CHECK(std::ranges::any_of(warnings, [](const json& w) { return w["code"] == "loose-vertices"; }));
}

TEST_CASE("the surface below a height is cut off") {
  const Meshes meshes;
  const Outcome run = meshes.run("car.stl", "above.h5", "--model-unit mm --model-above 0.5 --json");
  REQUIRE(run.exit_code == 0);
  CHECK_THAT(run.err,
             Contains("2 of 12 triangles are below z = 0.5 m, and are left out; 8 are cut there"));
  Model cut = read_model(meshes.work.folder / "car.stl",
                         {.as = ModelAs::kSurface, .unit = kMetresPerMillimetre, .above = 0.5});
  double lowest = 1e9, area = 0;
  for (const auto& [i, j, k] : cut.triangles) {
    const Vec3 &a = cut.vertices[i], &b = cut.vertices[j], &c = cut.vertices[k];
    for (const Vec3& p : {a, b, c}) lowest = std::min(lowest, p.z);
    const Vec3 u{b.x - a.x, b.y - a.y, b.z - a.z}, v{c.x - a.x, c.y - a.y, c.z - a.z};
    area += std::sqrt(std::pow(u.y * v.z - u.z * v.y, 2) + std::pow(u.z * v.x - u.x * v.z, 2) +
                      std::pow(u.x * v.y - u.y * v.x, 2)) /
            2;
  }
  CHECK(lowest == 0.5);
  CHECK(area == Approx(4 * 1.8 + 2 * 0.9 * (4 + 1.8)));
  check_refused(meshes.run("car.stl", "none.h5", "--model-unit mm --model-above 9"), 3,
                "all of the model (12 triangles) is below z = 9 m");
}

TEST_CASE("the vertices alone are the model when asked, in the unit of the file") {
  const Meshes meshes;
  REQUIRE(meshes.model("--vertices --unit in -o " + meshes.work.path("v.ply")).exit_code == 0);
  const auto points = read_model_points(meshes.work.folder / "v.ply");
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
