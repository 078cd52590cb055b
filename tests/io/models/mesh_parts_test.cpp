// Which parts of a mesh are solid (docs/design/solids.md).
#include "io/files/input_error.hpp"
#include "io/models/mesh_facts.hpp"
#include "io/models/sample_mesh.hpp"
#include "support/bytes/mesh_bytes.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// A unit cube moved by `offset`, with vertices of its own.
void add_cube(TriangleMesh& mesh, const Vec3& offset) {
  const TriangleMesh cube = unit_cube();
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (const Vec3& v : cube.vertices) {
    mesh.vertices.push_back({v.x + offset.x, v.y + offset.y, v.z + offset.z});
  }
  for (const auto& [a, b, c] : cube.triangles) {
    mesh.triangles.push_back({a + first, b + first, c + first});
  }
}

std::uint64_t faults(const MeshParts& parts, EdgeFault fault) {
  return parts.faulty[static_cast<std::size_t>(fault)].count;
}

std::string refusal_of(const TriangleMesh& mesh) {
  try {
    parts_with_solids(mesh, "car.stl");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("a closed part is a solid beside an open one") {
  TriangleMesh mesh;
  add_cube(mesh, {0, 0, 0});
  add_cube(mesh, {3, 0, 0});
  mesh.triangles.pop_back();
  const MeshParts parts = find_parts(mesh);
  check_equal(parts.solids, 1);
  check_equal(parts.surface_parts, 1);
  check_equal(parts.surface_triangles, 11);
  for (std::size_t i = 0; i < 12; ++i) check_equal(parts.solid_of[i], 0);
  for (std::size_t i = 12; i < 23; ++i) CHECK(parts.solid_of[i] == kNoSolid);
  check_equal(faults(parts, EdgeFault::kOpen), 3);
  CHECK(summary_of(parts) ==
        "1 closed parts of 12 triangles are solid; 11 other triangles are surface, in 1 open "
        "parts");
  CHECK(refusal_of(mesh).empty());
}

TEST_CASE("vertices are merged by value and both zeros are one") {
  TriangleMesh soup;
  const TriangleMesh cube = unit_cube();
  for (const auto& triangle : cube.triangles) {
    const auto first = static_cast<std::uint32_t>(soup.vertices.size());
    for (const std::uint32_t corner : triangle) {
      Vec3 v = cube.vertices[corner];
      if (v.x == 0 && soup.vertices.size() % 2 == 0) v.x = -0.0;
      soup.vertices.push_back(v);
    }
    soup.triangles.push_back({first, first + 1, first + 2});
  }
  const MeshParts parts = find_parts(soup);
  check_equal(parts.solids, 1);
  check_equal(parts.mesh.vertices.size(), 8);
}

TEST_CASE("parts that touch in a corner are two and those that share an edge are one") {
  TriangleMesh mesh;
  add_cube(mesh, {0, 0, 0});
  SECTION("a corner") {
    add_cube(mesh, {1, 1, 1});
    check_equal(find_parts(mesh).solids, 2);
  }
  SECTION("an edge") {
    add_cube(mesh, {1, 1, 0});
    const MeshParts parts = find_parts(mesh);
    check_equal(parts.solids, 0);
    check_equal(parts.surface_parts, 1);
    check_equal(faults(parts, EdgeFault::kCrowded), 1);
  }
}

TEST_CASE("triangles that occur twice are left out and flat ones are surface") {
  TriangleMesh mesh;
  add_cube(mesh, {0, 0, 0});
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
  TriangleMesh mesh;
  add_cube(mesh, {0, 0, 0});
  mesh.triangles.resize(GENERATE(1U, 2U, 12U));
  const auto once = mesh.triangles;
  for (const auto& [a, b, c] : once) mesh.triangles.push_back({a, c, b});
  const MeshParts parts = find_parts(mesh);
  check_equal(parts.solids, 0);
  check_equal(parts.duplicates, 0);
  CHECK(parts.surface_triangles == mesh.triangles.size());
}

TEST_CASE("a part turned inwards and a cavity are solids") {
  TriangleMesh mesh;
  add_cube(mesh, {0, 0, 0});
  add_cube(mesh, {0, 0, 0});
  for (std::size_t v = 8; v < 16; ++v) {
    for (int k = 0; k < 3; ++k) mesh.vertices[v][k] = 0.25 + 0.5 * mesh.vertices[v][k];
  }
  for (std::size_t t = 12; t < 24; ++t) std::swap(mesh.triangles[t][0], mesh.triangles[t][1]);
  check_equal(find_parts(mesh).solids, 2);
}

TEST_CASE("a mesh without a solid is refused with the edges that break it") {
  TriangleMesh mesh;
  add_cube(mesh, {0, 0, 0});
  SECTION("open") {
    mesh.triangles.pop_back();
    const std::string text = refusal_of(mesh);
    check_equal(text.find("car.stl: none of its 1 parts is closed"), 0);
    CHECK(text.find("3 edges are each of one triangle only (an open border), the first from (") !=
          std::string::npos);
  }
  SECTION("crowded") {
    add_cube(mesh, {0, 1, 1});
    CHECK(refusal_of(mesh).find("1 edge is of more than two triangles, from (1, 1, 1) to (0, 1, "
                                "1)") != std::string::npos);
  }
  SECTION("turned") {
    std::swap(mesh.triangles[0][0], mesh.triangles[0][1]);
    CHECK(refusal_of(mesh).find("3 edges are each of two triangles that run the same way") !=
          std::string::npos);
  }
  SECTION("without triangles") {
    mesh.triangles.clear();
    CHECK(refusal_of(mesh).find("none of its 0 parts is closed") != std::string::npos);
  }
}

TEST_CASE("a cube is watertight, without a triangle, or with one turned or repeated, it is not") {
  TriangleMesh mesh = unit_cube();
  MeshFacts facts = facts_of(mesh);
  check_equal(facts.area, 6);
  CHECK(facts.watertight());
  check_equal(facts.edges, 18);
  check_equal(facts.parts, 1);
  SECTION("open") {
    mesh.triangles.pop_back();
    facts = facts_of(mesh);
    check_equal(facts.open_edges, 3);
  }
  SECTION("turned") {
    std::swap(mesh.triangles[0][0], mesh.triangles[0][1]);
    facts = facts_of(mesh);
    check_equal(facts.flipped_edges, 3);
  }
  SECTION("repeated") {
    mesh.triangles.push_back(mesh.triangles[0]);
    facts = facts_of(mesh);
    check_equal(facts.crowded_edges, 3);
  }
  CHECK_FALSE(facts.watertight());
}

TEST_CASE("parts share no vertex, vertices at one place are one") {
  TriangleMesh mesh = unit_cube();
  const TriangleMesh other = unit_cube();
  for (const Vec3& v : other.vertices) mesh.vertices.push_back({v.x + 1, v.y + 1, v.z + 1});
  for (const auto& [a, b, c] : other.triangles) mesh.triangles.push_back({a + 8, b + 8, c + 8});
  check_equal(facts_of(mesh).parts, 1);  // the triangles touch in a corner
  for (std::size_t i = 8; i < 16; ++i) mesh.vertices[i].x += 0.5;
  check_equal(facts_of(mesh).parts, 2);
  CHECK(facts_of(mesh).watertight());
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
