// No place of a surface is farther from a sample than the spacing; each sample lies on it.
#include "io/models/sample_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include "clearway/error.hpp"
#include "core/geometry/model_tree.hpp"
#include "support/bytes/mesh_bytes.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/surface_places.hpp"
#include "support/triangle_distance.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

double largest_coordinate(const TriangleMesh& mesh) {
  double largest = 0;
  for (const Vec3& v : mesh.vertices) {
    for (int k = 0; k < 3; ++k) largest = std::max(largest, std::abs(v[k]));
  }
  return largest;
}

/// Samples the mesh, checks cover, place and corners, and returns the samples.
std::vector<Vec3> checked_samples(const TriangleMesh& mesh, double spacing, int random = 60) {
  const std::vector<Vec3> points = sample_mesh(mesh, spacing, "mesh");
  const ModelTree tree(points);
  const double rounding = largest_coordinate(mesh) * 0x1p-48;
  double farthest = 0;
  for_places(mesh, random, [&](const Vec3& place) {
    farthest = std::max(farthest, std::sqrt(tree.nearest(place).squared_distance));
  });
  CHECK(farthest <= spacing + rounding);  // the places are rounded
  double off = 0;
  for (std::size_t i = 0; i < points.size(); i += 1 + points.size() / 500) {
    off = std::max(off, surface_distance(points[i], mesh));
  }
  CHECK(off <= 2 * rounding);  // the rounding of the sample and of the distance computed here
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t corner : triangle) {
      if (tree.nearest(mesh.vertices[corner]).squared_distance != 0) FAIL("a corner is missing");
    }
  }
  return points;
}

TriangleMesh triangle(const Vec3& a, const Vec3& b, const Vec3& c) {
  return {{a, b, c}, {{0, 1, 2}}};
}

}  // namespace

TEST_CASE("a cube is covered at any spacing, with few points") {
  for (const double spacing : {5.0, 0.9, 0.7, 0.5, 0.3, 0.11, 0.025}) {
    INFO(spacing);
    const auto points = checked_samples(unit_cube(), spacing);
    const double optimum = 6 * 2 / (3 * std::sqrt(3.0) * spacing * spacing);
    // No cover of a plane has fewer points than the optimum; the sides of 12 triangles cost more.
    CHECK(static_cast<double>(points.size()) <= 1.02 * optimum + 12 / spacing + 12);
  }
  check_equal(sample_mesh(unit_cube(), 1.5, "mesh").size(), 8);
}

TEST_CASE("triangles of every shape are covered") {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> coordinate(-1, 1);
  std::uniform_real_distribution<double> exponent(-9, 0);
  const auto corner = [&](double thin) {
    return Vec3{coordinate(random), coordinate(random) * thin, coordinate(random) * thin + 100};
  };
  for (int round = 0; round < 300; ++round) {
    const double thin = std::pow(10, exponent(random));
    const double spacing = std::pow(10, exponent(random) / 5);
    INFO(round << " thin " << thin << " spacing " << spacing);
    checked_samples(triangle(corner(thin), corner(thin), corner(thin)), spacing, 200);
  }
}

TEST_CASE("triangles without area and thin ones take points in a line, not in a square") {
  const std::tuple<TriangleMesh, double, std::size_t> rows[] = {
      {triangle({1, 2, 3}, {1, 2, 3}, {1, 2, 3}), 0.1, 1},
      {triangle({0, 0, 0}, {1, 1, 1}, {3, 3, 3}), 0.1, 30},
      {triangle({0, 0, 0}, {10, 0, 0}, {0, 0, 0}), 1, 7},
      {triangle({0, 0, 0}, {10, 0, 0}, {5, 1e-9, 0}), 1, 9},
      {triangle({0, 0, 0}, {100, 0, 0}, {50, 0.05, 0}), 0.1, 599}};
  for (const auto& [mesh, spacing, most] : rows) {
    CHECK(checked_samples(mesh, spacing).size() <= most);
  }
}

TEST_CASE("a grid of small triangles takes no more than its vertices") {
  TriangleMesh mesh;
  for (int y = 0; y <= 20; ++y) {
    for (int x = 0; x <= 20; ++x) mesh.vertices.push_back({x * 0.1, y * 0.1, 7});
  }
  for (std::uint32_t y = 0; y < 20; ++y) {
    for (std::uint32_t x = 0; x < 20; ++x) {
      const std::uint32_t at = y * 21 + x;
      mesh.triangles.push_back({at, at + 1, at + 22});
      mesh.triangles.push_back({at, at + 22, at + 21});
    }
  }
  check_equal(checked_samples(mesh, 0.0708).size(), 441);  // half a diagonal is 0.0707
  CHECK(checked_samples(mesh, 0.0706).size() > 441);
}

TEST_CASE("far from the origin the cover holds up to rounding") {
  TriangleMesh mesh = unit_cube();
  for (Vec3& v : mesh.vertices) v = {v.x + 5e5, v.y + 5.8e6, v.z + 100};
  checked_samples(mesh, 0.05);
}

TEST_CASE("vertices of no triangle are no samples, and equal ones are one") {
  TriangleMesh mesh = unit_cube();
  mesh.vertices.push_back({9, 9, 9});
  mesh.vertices.push_back({0, 0, -0.0});
  mesh.triangles.push_back({9, 1, 2});
  check_equal(sample_mesh(mesh, 2, "mesh").size(), 8);
}

TEST_CASE("a spacing that asks for too many points is refused with one that does") {
  const auto cube_at = [](double size, double x) {
    TriangleMesh mesh = unit_cube();
    for (Vec3& v : mesh.vertices) v = {v.x * size + x, v.y * size, v.z * size};
    return mesh;
  };
  const std::tuple<TriangleMesh, double, const char*> rows[] = {
      {unit_cube(), 1e-6, "1 x 1 x 1 m ... 50,000,000 ... spacing of 0.0005 m is possible"},
      {cube_at(4000, 0), 0.025, "4000 x 4000 x 4000 m"},
      {cube_at(4000, 1e9), 0.5, "too large for a spacing"},
      {unit_cube(), 1e-10, "expected one from"}};
  for (const auto& [mesh, spacing, words] : rows) {
    try {
      sample_mesh(mesh, spacing, "mesh");
      FAIL("nothing was refused");
    } catch (const Error& error) {
      check_says(error.what(), words);
      const bool has_spacing = error.remedy() == Remedy::kModelSpacing && error.amount() > 0;
      CHECK((!has_spacing || error.amount() > spacing));
    }
  }
}

TEST_CASE("lines alone have a spacing for about so many samples") {
  const TriangleMesh line = {{{0, 0, 0}, {0, 0, 10}}, {{0, 1, 1}, {1, 1, 1}}};
  const double spacing = spacing_for(line, 1000);
  const std::size_t samples = sample_mesh(line, spacing, "mesh").size();
  CHECK(samples > 100);
  CHECK(samples <= 32'000);
}
