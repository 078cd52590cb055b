#include <catch2/catch.hpp>

#include "io/models/mesh_facts.hpp"
#include "io/models/sample_mesh.hpp"
#include "support/bytes/mesh_bytes.hpp"

using namespace clearway;
using namespace clearway::test;

TEST_CASE("a cube is watertight, without a triangle, or with one turned or repeated, it is not") {
  TriangleMesh mesh = unit_cube();
  MeshFacts facts = facts_of(mesh);
  CHECK(facts.area == 6);
  CHECK(facts.watertight());
  CHECK(facts.edges == 18);
  CHECK(facts.parts == 1);
  SECTION("open") {
    mesh.triangles.pop_back();
    facts = facts_of(mesh);
    CHECK(facts.open_edges == 3);
  }
  SECTION("turned") {
    std::swap(mesh.triangles[0][0], mesh.triangles[0][1]);
    facts = facts_of(mesh);
    CHECK(facts.flipped_edges == 3);
  }
  SECTION("repeated") {
    mesh.triangles.push_back(mesh.triangles[0]);
    facts = facts_of(mesh);
    CHECK(facts.crowded_edges == 3);
  }
  CHECK_FALSE(facts.watertight());
}

TEST_CASE("parts share no vertex, vertices at one place are one") {
  TriangleMesh mesh = unit_cube();
  const TriangleMesh other = unit_cube();
  for (const Vec3& v : other.vertices) mesh.vertices.push_back({v.x + 1, v.y + 1, v.z + 1});
  for (const auto& [a, b, c] : other.triangles) mesh.triangles.push_back({a + 8, b + 8, c + 8});
  CHECK(facts_of(mesh).parts == 1);  // the triangles touch in a corner
  for (std::size_t i = 8; i < 16; ++i) mesh.vertices[i].x += 0.5;
  CHECK(facts_of(mesh).parts == 2);
  CHECK(facts_of(mesh).watertight());
  mesh.triangles.push_back({0, 0, 1});
  CHECK(facts_of(mesh).flat_triangles == 1);
  CHECK(facts_of(mesh).watertight());
}

TEST_CASE("gaps of points leave repeated ones out") {
  const Vec3 points[] = {{0, 0, 0}, {1, 0, 0}, {1, 0, 0}, {1, 2, 0}, {100, 0, 0}, {1, 0, 0.5}};
  const PointGaps gaps = gaps_of(points);
  CHECK(gaps.repeated == 1);
  CHECK(gaps.median == 1);  // 0.5, 0.5, 1, 2, 99
  CHECK(gaps.largest == 99);
  CHECK(gaps_of(std::span(points, 1)).largest == 0);
  CHECK(gaps_of(std::span(points + 1, 2)).repeated == 1);
}
