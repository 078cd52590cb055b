// No place of a surface is farther from a sample than the spacing; each sample lies on it.
#include "io/models/sample_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include "clearway/error.hpp"
#include "core/geometry/model_tree.hpp"
#include "core/geometry/predicate.hpp"
#include "core/geometry/rigid.hpp"
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

TEST_CASE("triangles without area are covered as segments or points") {
  check_equal(sample_mesh(triangle({1, 2, 3}, {1, 2, 3}, {1, 2, 3}), 0.1, "mesh").size(), 1);
  const auto line = checked_samples(triangle({0, 0, 0}, {1, 1, 1}, {3, 3, 3}), 0.1);
  CHECK(line.size() <= 30);
  CHECK(checked_samples(triangle({0, 0, 0}, {10, 0, 0}, {0, 0, 0}), 1).size() <= 7);
  CHECK(checked_samples(triangle({0, 0, 0}, {10, 0, 0}, {5, 1e-9, 0}), 1).size() <= 9);
}

TEST_CASE("a thin triangle takes points in a line, not in a square") {
  const auto points = checked_samples(triangle({0, 0, 0}, {100, 0, 0}, {50, 0.05, 0}), 0.1);
  CHECK(points.size() < 600);
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

TEST_CASE("the same mesh gives the same samples") {
  CHECK(sample_mesh(unit_cube(), 0.05, "mesh") == sample_mesh(unit_cube(), 0.05, "mesh"));
}

TEST_CASE("a spacing that asks for too many points is refused with one that does") {
  const auto refusal = [](const TriangleMesh& mesh, double spacing) -> std::string {
    try {
      sample_mesh(mesh, spacing, "mesh");
    } catch (const Error& error) {
      if (error.remedy() == Remedy::kModelSpacing && error.amount() > 0) {
        CHECK(error.amount() > spacing);
      }
      return error.what();
    }
    return {};
  };
  check_says(refusal(unit_cube(), 1e-6),
             "1 x 1 x 1 m ... 50,000,000 ... spacing of 0.0005 m is possible");
  TriangleMesh millimetres = unit_cube();
  for (Vec3& v : millimetres.vertices) v = {v.x * 4000, v.y * 4000, v.z * 4000};
  check_says(refusal(millimetres, 0.025), "4000 x 4000 x 4000 m");
  for (Vec3& v : millimetres.vertices) v.x += 1e9;
  check_says(refusal(millimetres, 0.5), "too large for a spacing");
  check_says(refusal(unit_cube(), 1e-10), "expected one from");
}

TEST_CASE("lines alone have a spacing for about so many samples") {
  const TriangleMesh line = {{{0, 0, 0}, {0, 0, 10}}, {{0, 1, 1}, {1, 1, 1}}};
  const double spacing = spacing_for(line, 1000);
  const std::size_t samples = sample_mesh(line, spacing, "mesh").size();
  CHECK(samples > 100);
  CHECK(samples <= 32'000);
}

// A point that collides with the samples touches the surface; one that does not, but lies within
// the radius of the surface, is farther than radius - spacing.
namespace {

/// A bent, closed body of triangles of very different size: a ball of few triangles, stretched,
/// with a spike.
TriangleMesh body() {
  TriangleMesh mesh;
  constexpr std::uint32_t kRings = 5, kSectors = 7;
  for (std::uint32_t r = 0; r <= kRings; ++r) {
    for (std::uint32_t s = 0; s < kSectors; ++s) {
      const double u = 3.14159 * r / kRings, v = 6.28318 * s / kSectors;
      mesh.vertices.push_back(
          {2 * std::sin(u) * std::cos(v), std::sin(u) * std::sin(v), 0.5 * std::cos(u)});
    }
  }
  for (std::uint32_t r = 0; r < kRings; ++r) {
    for (std::uint32_t s = 0; s < kSectors; ++s) {
      const std::uint32_t a = r * kSectors + s, b = r * kSectors + (s + 1) % kSectors;
      mesh.triangles.push_back({a, b, a + kSectors});
      mesh.triangles.push_back({b, b + kSectors, a + kSectors});
    }
  }
  mesh.vertices.push_back({5, 0.1, 0});
  mesh.triangles.push_back({14, 15, static_cast<std::uint32_t>(mesh.vertices.size() - 1)});
  return mesh;
}

Pose turned(double angle, const Vec3& way) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {{c, -s, 0, s, c, 0, 0, 0, 1}, {way.x, way.y, way.z}};
}

TriangleMesh moved(const TriangleMesh& mesh, const Pose& pose) {
  TriangleMesh out = mesh;
  for (Vec3& v : out.vertices) v = transform(pose, v);
  return out;
}

}  // namespace

TEST_CASE("samples find what touches the surface, but for a shell of one spacing") {
  const double radius = 0.3;
  const double spacing = GENERATE(0.3, 0.075, 0.02);
  const TriangleMesh mesh = body();
  const std::vector<Vec3> samples = sample_mesh(mesh, spacing, "mesh");
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> x(-4, 6), y(-3, 3), z(-1.5, 1.5);
  int hits = 0, missed = 0;
  for (const double angle : {0.0, 0.7, 2.9}) {
    const Pose pose = turned(angle, {angle, 1, -0.2});
    const TriangleMesh surface = moved(mesh, pose);
    std::vector<Vec3> placed;
    for (const Vec3& sample : samples) placed.push_back(transform(pose, sample));
    for (int i = 0; i < 3000; ++i) {
      const Vec3 e{x(random), y(random), z(random)};
      bool hit = false;
      for (const Vec3& m : placed) hit = hit || collides(e, m, radius);
      const double distance = surface_distance(e, surface);
      if (hit && !(distance < radius + 1e-13)) FAIL("a false hit at " << distance);
      if (!hit && distance <= radius - spacing) FAIL("a miss at " << distance);
      hits += hit ? 1 : 0;
      missed += !hit && distance < radius ? 1 : 0;
    }
  }
  CHECK(hits > 300);
  CHECK((spacing < 0.1 || missed > 0));  // at such a spacing some points are missed
}
