#include "clearway/model.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "support/bytes/mesh_bytes.hpp"
#include "support/catch.hpp"
#include "tools/cli/support/hall.hpp"

using namespace clearway;
using namespace clearway::test;
using nlohmann::json;

TEST_CASE("a box and an outline are models that run takes, and a file keeps its meaning") {
  const Work work;
  const Outcome box = work.run("model box 4,180cm,1.4 -o box.off");
  check_says(box.err, "a closed solid of 8 corners and 12 triangles, 4 x 1.8 x 1.4 m ... 10.08 m3");
  work.put("half.csv", "height,half_width\n0,0.9\n1.4,0.9\n");
  const Outcome outline = work.succeed("model outline half.csv --mirror --x=-2,2 -o outline.ply");
  check_json(json_of(work.run("model outline.ply --json")),
             R"({"watertight": true, "triangles": 12})");
  const auto colliding = [&](const std::string& model) {
    const Outcome run = work.succeed(
        "run --env hall/site.h5 --model " + model +
        " --model-as solid --trajectory hall/trajectory.txt --radius 0.4 --json --force -o out.h5");
    return json_of(run)["colliding_points"].get<std::uint64_t>();
  };
  const std::uint64_t expected = colliding("box:4,1.8,1.4");
  CHECK(expected > 0);
  CHECK(colliding("box.off") == expected);
  CHECK(colliding("outline.ply") == expected);
  check_outcome(work.run("model"), 2);
  check_outcome(work.run("model box 1,2 -o no.off"), 2);
  check_says(work.run("model box 1,2,3 -o no.stl").err,
             "expected a name that ends in .off or .ply");
  check_says(work.run("model outline half.csv --mirror --x=2,-2 -o no.off").err,
             "half.csv: a solid from x = 2 to -2");
}

namespace {

/// A box of the size of the hall's vehicle, in millimetres.
std::string vehicle() {
  TriangleMesh mesh = unit_cube();
  for (Vec3& v : mesh.vertices) v = {4000 * v.x - 2000, 1800 * v.y - 900, 1400 * v.z};
  return binary_stl(mesh);
}

struct Meshes {
  Meshes() { work.put("car.stl", vehicle()); }

  Outcome model(const std::string& options) const { return work.run("model car.stl " + options); }
  /// Runs a search in the hall at a radius of 0.4 m.
  Outcome run(const std::string& model, const std::string& output,
              const std::string& options) const {
    return work.run("run --env hall/site.h5 --model " + model +
                    " --trajectory hall/trajectory.txt --radius 0.4 -o " + output + " " + options);
  }

  Work work;
};

}  // namespace

TEST_CASE("model says what a mesh is like, and samples nothing without a spacing") {
  const Meshes meshes;
  const json facts = json_of(require_success(meshes.model("--unit mm --json")));
  check_json(facts, R"({
    "kind": "mesh", "triangles": 12, "size": [4.0, 1.8, 1.4], "watertight": true, "open_edges": 0})");
  check_near(facts, "/area", 2 * (4 * 1.8 + 4 * 1.4 + 1.8 * 1.4));
  CHECK_FALSE(facts.contains("points"));
  check_says(meshes.model("--unit mm --spacing 0.5").out,
             "4.0000 1.8000 1.4000 m ... watertight        yes ... model points");
}

TEST_CASE("run of a mesh is run of the points that model wrote") {
  const Meshes meshes;
  require_success(meshes.model("--unit mm --spacing 0.1 -o car.ply"));
  const auto points = read_model_points(meshes.work.folder / "car.ply");
  CHECK(points == read_model_points(meshes.work.folder / "car.stl",
                                    {.spacing = 0.1, .unit = kMetresPerMillimetre}));
  // The default spacing is a quarter of the radius.
  const Outcome mesh =
      require_success(meshes.run("car.stl", "mesh.h5", "--model-as points --model-unit mm --json"));
  CHECK(json_of(mesh)["model_points"] == points.size());
  CHECK(json_of(mesh)["colliding_points"] > 0);
  check_says(mesh.err, "a mesh of 12 triangles, sampled to");
  const json told = json_of(mesh);
  for (const json& warning : told["warnings"]) {
    CHECK(warning["code"] != "");  // an empty code would be a note's
  }
  require_success(meshes.run("car.ply", "points.h5", ""));
  // The result of the mesh also has the warnings about the mesh.
  check_outcome(meshes.work.run("compare mesh.h5 points.h5"), 0);
}

TEST_CASE("run searches a closed mesh as a solid, an open one as its surface, and says why") {
  const Meshes meshes;
  const auto searched = [&](const std::string& model, const std::string& options) {
    const Outcome run =
        require_success(meshes.run(model, "auto.h5", options + " --force --json --first-pose"));
    return std::pair(json_of(run)["model_as"].get<std::string>(), run.err);
  };
  const auto [closed, why_closed] = searched("car.stl", "--model-unit mm");
  CHECK(closed == "solid");
  check_says(why_closed, "it is closed, so it is searched as a solid");
  require_success(
      meshes.run("car.stl", "told.h5", "--model-unit mm --model-as solid --first-pose"));
  check_same(meshes.work.bytes("told.h5"), meshes.work.bytes("auto.h5"));
  CHECK(searched("box:4,1.8,1.4", "").first == "solid");
  std::string box =
      "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
      "f 4 3 2 1\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
  meshes.work.put("crate.obj", box);  // without a lid
  const auto [open, why_open] = searched("crate.obj", "");
  CHECK(open == "surface");
  check_says(why_open,
             "searched as a surface, which has no inside, because it is not closed: 4 edges are of "
             "one triangle only (an open border), the first from (0, 0, 1) to (1, 0, 1)");
  meshes.work.put("both.obj", box + "f 5 6 7 8\nv 5 0 0\nv 6 0 0\nv 5 1 0\nf 9 10 11\n");
  check_says(searched("both.obj", "").second, "because 1 of its 2 parts is not closed: 3 edges");
  CHECK(searched("car.stl", "--model-unit mm --model-as surface").first == "surface");
  CHECK(searched("car.stl", "--model-unit mm --model-spacing 0.1").first == "points");
  check_refused(meshes.run("car.stl", "no.h5", "--model-unit mm --engine kdtree"), 2, "kdtree");
}

TEST_CASE("run of a mesh searches its surface") {
  const Meshes meshes;
  const Outcome run = require_success(meshes.run(
      "car.stl", "surface.h5", "--model-unit mm --model-as surface --first-pose --json"));
  const json told = json_of(run);
  check_json(told, R"({
    "model_as": "surface", "model_points": 8, "model_triangles": 12, "engine": "sweep"})");
  CHECK(told["searches"] == told["poses"].get<std::uint64_t>() * 12);
  check_says(run.err, "12 triangles, searched as it is");
  check_json(json_of(meshes.work.run("info surface.h5 --json")),
             R"({"model_as": "surface", "model_triangles": 12})");
  // Samples lie on the surface, so what touches a sample touches the surface. No place of the
  // surface is far from a sample.
  const auto count = [&](const std::string& output, const std::string& options) {
    const Outcome points =
        require_success(meshes.run("car.stl", output, "--model-unit mm --json " + options));
    check_json(json_of(points), R"({"model_as": "points"})");
    return json_of(points)["colliding_points"].get<std::uint64_t>();
  };
  const std::uint64_t hits = told["colliding_points"];
  CHECK(hits >= count("coarse.h5", "--model-as points"));
  const std::uint64_t fine = count("fine.h5", "--model-spacing 0.02");
  CHECK(hits >= fine);
  CHECK(hits - fine < hits / 20);
  // The same search gives the same result in parts, and with the same identity of its journal.
  const std::string again = "--model-unit mm --model-as surface --first-pose ";
  require_success(meshes.run("car.stl", "part1.h5", again + "--shard 1/2"));
  require_success(meshes.run("car.stl", "part2.h5", again + "--shard 2/2"));
  require_success(meshes.work.run("merge part1.h5 part2.h5 -o merged.h5"));
  check_same(meshes.work.bytes("merged.h5"), meshes.work.bytes("surface.h5"));
  check_outcome(meshes.run("car.stl", "surface.h5", again + "--resume"), 0);
  check_refused(meshes.run("car.stl", "surface.h5",
                           "--model-unit mm --first-pose --model-as points --resume"),
                2, "surface.h5");
}

TEST_CASE("run of a solid finds what is inside") {
  const Meshes meshes;
  const std::string options = "--model-unit mm --clearance 0.5 --profile 0.5 --first-pose --json ";
  const Outcome surface = meshes.run("car.stl", "surface.h5", options + "--model-as surface");
  const Outcome solid =
      require_success(meshes.run("car.stl", "solid.h5", options + "--model-as solid"));
  const json told = json_of(solid);
  check_json(told, R"({"model_as": "solid", "model_solids": 1})");
  CHECK(told["colliding_points"] >= json_of(surface)["colliding_points"]);
  check_says(solid.err, "1 closed parts of 12 triangles are solid");
  check_says(solid.err, "the greatest depth inside the model is");
  const auto inside = told["points_inside"].get<std::uint64_t>();
  const auto depth = told["greatest_depth"].get<double>();
  CHECK(inside > 0);
  CHECK(inside <= told["colliding_points"]);
  CHECK(depth > 0);
  CHECK(depth <= 0.7);  // half the height of the box
  CHECK(told["least_clearance"]["distance"] == -depth);
  CHECK(told["least_profile"]["distance"] == -depth);
  check_json(json_of(surface), R"({"points_inside": null, "greatest_depth": null})");
  check_outcome(meshes.work.run("verify solid.h5"), 0);
  const json info = json_of(meshes.work.run("info --json solid.h5"));
  check_json(info, R"({"model_as": "solid"})");
  CHECK(info["points_inside"] == inside);
  CHECK(info["greatest_depth"] == depth);
  // The search gives the same in parts.
  const std::string shard = "--model-as solid " + options + "--shard ";
  require_success(meshes.run("car.stl", "part1.h5", shard + "1/2"));
  require_success(meshes.run("car.stl", "part2.h5", shard + "2/2"));
  const Outcome merged = meshes.work.succeed("merge --json part1.h5 part2.h5 -o merged.h5");
  CHECK(json_of(merged)["points_inside"] == inside);
  CHECK(json_of(merged)["greatest_depth"] == depth);
  check_same(meshes.work.bytes("merged.h5"), meshes.work.bytes("solid.h5"));
}

TEST_CASE("conflicts of a solid tell its depth") {
  const Meshes meshes;
  const Outcome run = require_success(
      meshes.run("car.stl", "solid.h5",
                 "--model-as solid --model-unit mm --clearance 0.2 --first-pose --json"));
  const json told = json_of(run);
  const auto conflicts = [&](const std::string& output) {
    return meshes.work.run(
        "conflicts solid.h5 --trajectory hall/trajectory.txt --min-points 1 -o " + output);
  };
  check_says(require_success(conflicts("listed.json")).out, "depth ... inside");
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
    check_outcome(conflicts(name), 0);
  }
}

TEST_CASE("what has no surface is refused and points are named") {
  const Meshes meshes;
  const auto refused = [&](const std::string& options, const std::string& words) {
    for (const std::string kind : {"--model-as surface ", "--model-as solid ", ""}) {
      INFO(kind << options);
      const Outcome run = meshes.run("car.stl", "no.h5", kind + "--model-unit mm " + options);
      check_refused(run, 2, words + " ... --model-as points searches points of it");
    }
  };
  refused("--engine kdtree", "engine kdtree searches models of points");
  refused("--engine grid --device cpu", "engine grid searches models of points");
  refused("--between-poses", "motion between poses is searched for models of points");
  for (const std::string options : {"--model-spacing 0.1", "--model-vertices"}) {
    check_refused(meshes.run("car.stl", "no.h5",
                             "--model-as surface --model-unit mm " + std::string(options)),
                  2, "a surface is searched as it is");
  }
  meshes.work.put("car.xyz", "1 0 0\n0 1 0\n1 0 0\n");
  check_refused(meshes.run("car.xyz", "no.h5", "--model-as surface"), 3, "has no triangles");
  // Points are searched by every engine, in whatever way they are asked for.
  for (const char* points : {"--model-as points", "--model-spacing 0.1", "--model-vertices"}) {
    for (const std::string options :
         {"--engine kdtree", "--engine grid --device cpu", "--between-poses"}) {
      const Outcome run =
          meshes.run("car.stl", "some.h5",
                     "--force --model-unit mm --json " + std::string(points) + " " + options);
      INFO(points << " " << options);
      require_success(run);
      check_json(json_of(run), R"({"model_as": "points"})");
      CHECK(json_of(run)["model_spacing"] > 0);
    }
  }
}

namespace {

/// A plate of two triangles, and one point of the environment that is 0.099 m above it, where no
/// sample of its surface is near.
struct Plate {
  Plate() {
    work.put("plate.off", "OFF\n4 2 0\n-3 -2 0\n3 -2 0\n3 2 0\n-3 2 0\n3 0 1 2\n3 0 2 3\n");
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
    work.put("scan.xyz", std::to_string(place.x) + " 0.5 0.099\n");
    work.put("path.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 1 0 0 0 0 1 0\n");
    work.succeed("convert scan.xyz --scale 0.001 -o site.h5");
  }

  Outcome run(const std::string& options, const std::string& output = "out.h5") const {
    return work.run("run --env site.h5 --model plate.off --trajectory path.txt --radius 0.1 -o " +
                    output + " " + options);
  }

  Work work;
};

}  // namespace

TEST_CASE("a plate that is hit between its samples is never silently clear") {
  const Plate plate;
  for (const char* options : {"--between-poses", "--engine kdtree", "--engine grid --device cpu"}) {
    INFO(options);
    check_refused(plate.run("--force " + std::string(options)), 2, "--model-as points");
    const Outcome points =
        require_success(plate.run("--force --model-as points " + std::string(options)));
    check_says(points.out,
               "clear ... no place of its surface is farther than 0.025 m ... as close as 0.075 m");
    const Outcome again =
        require_success(plate.run("--resume --json --model-as points " + std::string(options)));
    check_json(json_of(again), R"({"was_finished": true, "model_spacing": 0.025})");
    check_says(again.err, "farther than 0.025 m");
    check_json(json_of(plate.work.run("info --json out.h5")), R"({"model_spacing": 0.025})");
  }
  check_says(plate.run("--force --model-vertices").out, "clear ... may touch");
  check_json(json_of(check_outcome(plate.run("--force --json --fail-on-collision"), 1)),
             R"({"verdict": "conflict", "model_spacing": null})");
}

TEST_CASE("the spacing of a sampled mesh goes with its points and its parts") {
  const Plate plate;
  const Work& work = plate.work;
  work.succeed("model plate.off --spacing 0.025 -o plate.ply");
  const Outcome run = work.run(
      "run --env site.h5 --model plate.ply --trajectory path.txt --radius 0.1 -o points.h5");
  check_says(run.out, "farther than 0.025 m");
  require_success(plate.run("--model-as points", "sampled.h5"));
  check_same(work.bytes("points.h5"), work.bytes("sampled.h5"));
  require_success(plate.run("--model-as points --shard 1/2", "one.h5"));
  require_success(plate.run("--model-as points --shard 2/2", "two.h5"));
  const Outcome merged = work.run("merge one.h5 two.h5 -o merged.h5");
  check_says(merged.out, "clear ... farther than 0.025 m");
  check_same(work.bytes("merged.h5"), work.bytes("sampled.h5"));
  // The report samples the model as the run did, and says so.
  require_success(plate.run("--model-spacing 0.03 --first-pose", "three.h5"));
  check_json(json_of(work.succeed("report three.h5 --env site.h5 --model plate.off --trajectory "
                                  "path.txt --json -o page.html")),
             R"({"inputs": {"model": {"spacing": 0.03}}})");
}

TEST_CASE("a mast that is drawn as a line, or as points, collides") {
  const Plate plate;
  const Work& work = plate.work;
  const std::string start = "v -3 -2 -5\nv 3 -2 -5\nv 3 2 -5\n";
  const auto verdict = [&](const std::string& mesh, const std::string& options) {
    work.put("mast.obj", start + mesh);
    return json_of(
        work.succeed("run --force --json --env site.h5 --model mast.obj --trajectory path.txt "
                     "--radius 0.1 -o mast.h5 " +
                     options));
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
  check_json(loose, R"({"colliding_points": 0})");
  const auto& warnings = loose["warnings"];
  CHECK(std::ranges::any_of(warnings, [](const json& w) { return w["code"] == "loose-vertices"; }));
}

TEST_CASE("the vertices alone are the model when asked, in the unit of the file") {
  const Meshes meshes;
  require_success(meshes.model("--vertices --unit in -o v.ply"));
  const auto points = read_model_points(meshes.work.folder / "v.ply");
  CHECK(points.size() == 8);
  for (const Vec3& p : points) CHECK((p.x == 2000 * 0.0254 || p.x == -2000 * 0.0254));
  check_json(json_of(require_success(
                 meshes.run("car.stl", "v.h5", "--model-vertices --model-unit mm --json"))),
             R"({"model_points": 8})");
  meshes.work.put("car.xyz", "1000 0 0\n0 1000 0\n1000 0 0\n");
  const Outcome cloud = meshes.work.run("model car.xyz --unit mm --json");
  check_json(json_of(cloud), R"({"kind": "points", "repeated_points": 1})");
  check_near(json_of(cloud), "/largest_gap", std::sqrt(2.0));
}

TEST_CASE("model refuses what it cannot do, and leaves no output") {
  const Meshes meshes;
  const std::string out = " -o car.ply";
  check_cases([&](const std::string& more) { return meshes.model(more); },
              {
                  {out, 3, "--model-spacing METRES"},
                  {"--spacing 0.001" + out, 3,
                   "4000 x 1800 x 1400 m ... --model-spacing 1  ... --model-unit"},
                  {"--unit yard", 2, "yard"},
                  {"--spacing 0.1 --vertices", 2, "--vertices"},
              });
  CHECK_FALSE(meshes.work.has("car.ply"));
  meshes.work.put("car.ply", "mine");
  check_refused(meshes.model("--unit mm --spacing 1" + out), 2, "--force");
  check_same(meshes.work.bytes("car.ply"), "mine");
  check_outcome(meshes.model("--unit mm --spacing 1 --force" + out), 0);
  check_refused(meshes.model("--force --spacing 1 -o car.stl"), 2, "car.stl");
  check_same(meshes.work.bytes("car.stl"), vehicle());
  check_refused(meshes.work.run("convert car.stl -o a.h5"), 3, "clearway model");
}

TEST_CASE("trajectory takes the box of a mesh in its unit") {
  const Meshes meshes;
  const auto resample = [&](const std::string& options) {
    return meshes.work.run(
        "trajectory resample hall/trajectory.txt --max-motion 0.2 --force -o t.txt --model car.stl "
        "--json " +
        options);
  };
  const Outcome metres = require_success(resample("--model-unit mm"));
  CHECK(json_of(metres)["largest_motion_after"] <= 0.2);
}
