// A point that collides with the samples touches the surface; one that does not, but lies within
// the radius of the surface, is farther than radius - spacing.
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "core/geometry/predicate.hpp"
#include "core/geometry/rigid.hpp"
#include "io/models/sample_mesh.hpp"
#include "support/triangle_distance.hpp"

using namespace clearway;
using namespace clearway::test;

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
