// Which parts of a mesh are solid (docs/design/model.md).
#include "io/files/input_error.hpp"
#include "io/models/mesh_facts.hpp"
#include "io/models/sample_mesh.hpp"
#include "support/bytes/mesh_bytes.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// Unit cubes with vertices of their own at these places.
TriangleMesh cubes_at(const std::vector<Vec3>& places) {
  TriangleMesh mesh;
  const TriangleMesh cube = unit_cube();
  for (const Vec3& at : places) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const Vec3& v : cube.vertices) {
      mesh.vertices.push_back({v.x + at.x, v.y + at.y, v.z + at.z});
    }
    for (const auto& [a, b, c] : cube.triangles) {
      mesh.triangles.push_back({a + first, b + first, c + first});
    }
  }
  return mesh;
}

std::uint64_t faults(const MeshParts& parts, EdgeFault fault) {
  return parts.faulty[static_cast<std::size_t>(fault)].count;
}

}  // namespace

TEST_CASE("a closed part is a solid beside an open one") {
  TriangleMesh mesh = cubes_at({{0, 0, 0}, {3, 0, 0}});
  mesh.triangles.pop_back();
  const MeshParts parts = find_parts(mesh);
  check_equal(parts.solids, 1);
  check_equal(parts.surface_parts, 1);
  check_equal(parts.surface_triangles, 11);
  for (std::size_t i = 0; i < 23; ++i) CHECK(parts.solid_of[i] == (i < 12 ? 0 : kNoSolid));
  check_equal(faults(parts, EdgeFault::kOpen), 3);
  check_equal(summary_of(parts),
              "1 closed parts of 12 triangles are solid; 11 other triangles are surface, in 1 open "
              "parts");
  CHECK_NOTHROW(parts_with_solids(mesh, "car.stl"));
}

TEST_CASE("vertices are merged by value and both zeros are one") {
  TriangleMesh soup;
  const TriangleMesh cube = unit_cube();
  for (const auto& triangle : cube.triangles) {
    const auto first = static_cast<std::uint32_t>(soup.vertices.size());
    for (const std::uint32_t corner : triangle) {
      Vec3& v = soup.vertices.emplace_back(cube.vertices[corner]);
      if (v.x == 0 && soup.vertices.size() % 2 == 1) v.x = -0.0;
    }
    soup.triangles.push_back({first, first + 1, first + 2});
  }
  const MeshParts parts = find_parts(soup);
  check_equal(parts.solids, 1);
  check_equal(parts.mesh.vertices.size(), 8);
}

TEST_CASE("parts that touch in a corner are two and those that share an edge are one") {
  check_equal(find_parts(cubes_at({{0, 0, 0}, {1, 1, 1}})).solids, 2);
  const MeshParts parts = find_parts(cubes_at({{0, 0, 0}, {1, 1, 0}}));
  check_equal(parts.solids, 0);
  check_equal(parts.surface_parts, 1);
  check_equal(faults(parts, EdgeFault::kCrowded), 1);
}

TEST_CASE("triangles that occur twice are left out and flat ones are surface") {
  TriangleMesh mesh = unit_cube();
  const auto [a, b, c] = mesh.triangles[5];
  mesh.triangles.insert(mesh.triangles.begin(), {b, c, a});
  mesh.triangles.push_back({a, a, b});
  const MeshParts parts = find_parts(mesh);
  check_equal(parts.duplicates, 1);
  check_equal(parts.flat, 1);
  check_equal(parts.solids, 1);
  check_equal(parts.mesh.triangles.size(), 13);
  check_equal(parts.surface_triangles, 1);
  check_equal(parts.surface_parts, 0);
}

TEST_CASE("two-sided sheets have no inside") {
  TriangleMesh mesh = unit_cube();
  mesh.triangles.resize(GENERATE(1U, 2U, 12U));
  const auto once = mesh.triangles;
  for (const auto& [a, b, c] : once) mesh.triangles.push_back({a, c, b});
  const MeshParts parts = find_parts(mesh);
  check_equal(parts.solids, 0);
  check_equal(parts.duplicates, 0);
  check_equal(parts.surface_triangles, mesh.triangles.size());
}

TEST_CASE("a part turned inwards and a cavity are solids") {
  TriangleMesh mesh = cubes_at({{0, 0, 0}, {0, 0, 0}});
  for (std::size_t v = 8; v < 16; ++v) {
    for (int k = 0; k < 3; ++k) mesh.vertices[v][k] = 0.25 + 0.5 * mesh.vertices[v][k];
  }
  for (std::size_t t = 12; t < 24; ++t) std::swap(mesh.triangles[t][0], mesh.triangles[t][1]);
  check_equal(find_parts(mesh).solids, 2);
}

TEST_CASE("a cube without a triangle, or with one turned or repeated, is neither solid nor tight") {
  const MeshFacts whole = facts_of(unit_cube());
  check_equal(whole.area, 6);
  CHECK(whole.watertight());
  check_equal(whole.edges, 18);
  check_equal(whole.parts, 1);
  TriangleMesh open = unit_cube(), turned = unit_cube(), repeated = unit_cube(), none = unit_cube();
  open.triangles.pop_back();
  check_equal(facts_of(open).open_edges, 3);
  std::swap(turned.triangles[0][0], turned.triangles[0][1]);
  check_equal(facts_of(turned).flipped_edges, 3);
  repeated.triangles.push_back(repeated.triangles[0]);
  check_equal(facts_of(repeated).crowded_edges, 3);
  for (const TriangleMesh& mesh : {open, turned, repeated}) {
    CHECK_FALSE(facts_of(mesh).watertight());
  }
  none.triangles.clear();
  const std::pair<TriangleMesh, const char*> rows[] = {
      {open,
       "car.stl: none of its 1 parts is closed ... 3 edges are each of one triangle only (an open "
       "border), the first from ("},
      {cubes_at({{0, 0, 0}, {0, 1, 1}}),
       "1 edge is of more than two triangles, from (1, 1, 1) to (0, 1, 1)"},
      {turned, "3 edges are each of two triangles that run the same way"},
      {none, "none of its 0 parts is closed"}};
  for (const auto& [mesh, words] : rows) {
    check_refused<InputError>([&] { parts_with_solids(mesh, "car.stl"); }, words);
  }
}

TEST_CASE("parts share no vertex, vertices at one place are one") {
  CHECK(facts_of(cubes_at({{0, 0, 0}, {1, 1, 1}})).parts == 1);  // they touch in a corner
  TriangleMesh mesh = cubes_at({{0, 0, 0}, {1.5, 1, 1}});
  check_equal(facts_of(mesh).parts, 2);
  mesh.triangles.push_back({0, 0, 1});
  check_equal(facts_of(mesh).flat_triangles, 1);
  CHECK(facts_of(mesh).watertight());
}

TEST_CASE("gaps of points leave repeated ones out") {
  const Vec3 points[] = {{0, 0, 0}, {1, 0, 0}, {1, 0, 0}, {1, 2, 0}, {100, 0, 0}, {1, 0, 0.5}};
  const PointGaps gaps = gaps_of(points);
  check_equal(gaps.repeated, 1);
  check_equal(gaps.median, 1);  // 0.5, 0.5, 1, 2, 99
  check_equal(gaps.largest, 99);
  check_equal(gaps_of(std::span(points, 1)).largest, 0);
  check_equal(gaps_of(std::span(points + 1, 2)).repeated, 1);
}
