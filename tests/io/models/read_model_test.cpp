#include <algorithm>
#include <cmath>

#include "clearway/error.hpp"
#include "clearway/model.hpp"
#include "clearway/query.hpp"
#include "support/bytes/las_bytes.hpp"
#include "support/bytes/mesh_bytes.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/scratch_folder.hpp"

using namespace clearway;
using namespace clearway::test;

TEST_CASE("a model of points is read, with integers placed by scale and offset") {
  const ScratchFolder scratch;
  CHECK(read_model_points(scratch.write("a.las", LasBytes().build()))[0] ==
        Vec3{1 * 0.001 + 100, 2 * 0.01 - 200, 3 * 0.1});
  check_equal(read_model_points(scratch.write("a.xyz", "1 2 3\n")), {{1, 2, 3}});
  check_refused<InputError>([&] { read_model_points(scratch.write("a.xyz", "# none\n")); },
                            "no points");
  check_refused<InputError>([&] { read_model_points(scratch.write("a.xyz", "1 2 3\n1 nan 3\n")); },
                            "model point 1 ... finite");
}

TEST_CASE("a unit that the file or the caller names is converted into the environment's") {
  const ScratchFolder scratch;
  LasBytes las;
  las.vlrs = {{"LASF_Projection", 2112, "LOCAL_CS[\"feet\",UNIT[\"foot\",0.3048]]"}};
  const auto feet = scratch.write("a.las", las.build());
  const double x = 1 * 0.001 + 100;
  std::vector<Message> messages;
  CHECK(read_model_points(feet, &messages)[0].x == x * 0.3048);
  REQUIRE(messages.size() == 1);
  CHECK(messages[0].severity == Message::Severity::kNote);
  check_says(messages[0].text, "its unit is 0.3048 m");
  CHECK(read_model_points(feet, {.environment_unit = 0.3048})[0].x == x);
  CHECK(read_model_points(feet, {.unit = 1})[0].x == x);

  const auto unknown = scratch.write("a.xyz", "914.4 2 3\n");
  check_equal(read_model_points(unknown, {.environment_unit = 0.3048})[0].x, 914.4);
  check_equal(read_model_points(unknown, {.unit = 0.001})[0].x, 0.9144);
  check_near(read_model_points(unknown, {.unit = 0.001, .environment_unit = 0.3048})[0].x, 3, 1e-9);
  CHECK_THROWS_AS(read_model_points(unknown, {.unit = -1}), UsageError);
  CHECK_THROWS_AS(read_model_points(unknown, {.environment_unit = 0}), UsageError);
}

TEST_CASE("a mesh is its surface unless points are asked for, and then has a spacing") {
  const ScratchFolder scratch;
  const auto plate =
      scratch.write("plate.off", "OFF\n4 2 0\n0 0 0\n4 0 0\n4 3 0\n0 3 0\n3 0 1 2\n3 0 2 3\n");
  check_equal(read_model(plate).triangles.size(), 2);
  check_equal(read_model(plate, {.radius = 0.1}).triangles.size(), 2);
  check_equal(read_model(plate).spacing, 0);
  const std::pair<ModelOptions, double> rows[] = {
      {{.as = ModelAs::kPoints, .radius = 0.1}, 0.025},
      {{.as = ModelAs::kPoints, .spacing = 0.5, .radius = 0.1}, 0.5},
      {{.spacing = 0.5}, 0.5},
      {{.vertices_only = true}, 2.5}};  // the middle of the diagonal
  for (const auto& [options, spacing] : rows) {
    const Model shape = read_model(plate, options);
    CHECK(shape.triangles.empty());
    check_near(shape.spacing, spacing, 1e-12);
  }
  CHECK_THROWS_AS(read_model(plate, {.as = ModelAs::kPoints}), InputError);
  for (const ModelAs as : {ModelAs::kSurface, ModelAs::kSolid}) {
    CHECK_THROWS_AS(read_model(plate, {.as = as, .spacing = 0.5}), UsageError);
    CHECK_THROWS_AS(read_model(plate, {.as = as, .vertices_only = true}), UsageError);
  }
  check_equal(read_model(scratch.write("a.xyz", "1 2 3\n"), {.spacing = 0.5}).spacing, 0);
  Query query;
  query.model = read_model(plate, {.spacing = 0.5});
  query.bodies.resize(1);
  query.bodies[0].model = read_model(plate, {.spacing = 0.75});
  check_equal(model_spacing(query), 0.75);
}

TEST_CASE("samples of a mesh keep their spacing") {
  const ScratchFolder scratch;
  const auto file = scratch.write("samples.ply",
                                  "ply\nformat ascii 1.0\ncomment clearway model spacing 0.5\n"
                                  "element vertex 1\nproperty double x\nproperty double y\n"
                                  "property double z\nend_header\n1 2 3\n");
  check_equal(read_model(file).spacing, 0.5);
  check_near(read_model(file, {.unit = 0.001}).spacing, 0.0005, 1e-15);
}

TEST_CASE("lines and single points of a mesh are part of every kind of model") {
  const ScratchFolder scratch;
  const std::string mast = "v 0 0 0\nv 4 0 0\nv 4 3 0\nv 1 1 0\nv 1 1 5\nv 2 2 2\n";
  std::vector<Message> told;
  const auto file = scratch.write("mast.obj", mast + "f 1 2 3\nl 4 5\np 6\n");
  const Model surface = read_model(file, {}, &told);
  check_equal(surface.triangles.size(), 3);
  check_equal(surface.vertices.size(), 6);
  REQUIRE(told.size() == 2);
  check_says(told[0].text, "1 triangle, 1 line segment and 1 single point");
  check_says(told[1].text, "searched as a surface, which has no inside, because it is not closed");
  const Model points = read_model(file, {.spacing = 0.25});
  for (const Vec3& place : {Vec3{1, 1, 5}, Vec3{1, 1, 3.3}, Vec3{2, 2, 2}}) {
    CHECK(std::ranges::any_of(points.vertices, [&](const Vec3& p) {
      return std::hypot(p.x - place.x, p.y - place.y, p.z - place.z) <= 0.25;
    }));
  }
  check_equal(read_model(file, {.vertices_only = true}).vertices.size(), 6);
  check_near(read_model(file, {.vertices_only = true}).spacing, 2.5, 1e-12);

  told.clear();
  check_equal(
      read_model(scratch.write("lines.obj", mast + "l 4 5 6\n"), {}, &told).triangles.size(), 2);
  REQUIRE(told.size() == 3);
  check_equal(told[1].code, "loose-vertices");
  CHECK(told[1].severity == Message::Severity::kWarning);
  check_says(told[1].text, "3 vertices belong to no face, line or point");
  check_equal(told[1].numbers.at(0).second, 3);
  told.clear();
  const auto dots = scratch.write("dots.obj", mast + "p 1 2 6\n");
  check_equal(read_model(dots, {}, &told).vertices, {{0, 0, 0}, {4, 0, 0}, {2, 2, 2}});
  check_equal(told.at(0).code, "loose-vertices");
  check_equal(read_model(dots, {.vertices_only = true}).vertices.size(), 6);
}

TEST_CASE("a mast beside a closed part leaves it solid") {
  const ScratchFolder scratch;
  const auto file = scratch.write("cube.obj", obj_text(unit_cube()) + "v 1 1 4\nl 7 9\np 9\n");
  const Model solid = read_model(file, {.as = ModelAs::kSolid});
  REQUIRE(solid.solid_of.size() == 14);
  for (std::size_t i = 0; i < 14; ++i) CHECK(solid.solid_of[i] == (i < 12 ? 0 : kNoSolid));
}

TEST_CASE("a box is a model without a file, in metres or in named units") {
  const Model box = read_model("box:30,5,4.3", {.as = ModelAs::kSolid});
  check_equal(box.vertices.size(), 8);
  check_equal(box.triangles.size(), 12);
  check_equal(box.solid_count(), 1);
  CHECK(box.vertices[0] == Vec3{-15, -2.5, 0});
  CHECK(read_model("box:3000cm,5 m,4.3", {.as = ModelAs::kSolid}) == box);
  const Model feet = read_model("box:30,5,4.3", {.environment_unit = kMetresPerFoot});
  check_near(feet.vertices[0].x, -15 / 0.3048, 1e-12);
  for (const char* text : {"box:", "box:1,2", "box:1,2,3,4", "box:1,2,0", "box:1,2,-3", "box:a,b,c",
                           "box:1,,2", "box:1,2,3,", "box:1,2,inf"}) {
    CAPTURE(text);
    check_refused([&] { return read_model(text); }, "expected a box as box:LENGTH,WIDTH,HEIGHT");
  }
}
