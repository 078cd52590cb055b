#include <cmath>

#include "core/geometry/predicate.hpp"
#include "scene/path.hpp"
#include "scene/scanning/roughness.hpp"
#include "scene/scene.hpp"
#include "scene/vector.hpp"
#include "scene/vehicles/mesh.hpp"
#include "support/catch.hpp"

using namespace clearway;
using namespace clearway::scene;

TEST_CASE("sine and cosine agree with the library's") {
  double worst = 0;
  for (int i = -20000; i <= 20000; ++i) {
    const double angle = 0.00137 * i * std::abs(i) / 10;
    const SineCosine own = sine_cosine(angle);
    worst = std::max(
        {worst, std::abs(own.sine - std::sin(angle)), std::abs(own.cosine - std::cos(angle))});
  }
  CHECK(worst < 2e-10);
}

TEST_CASE("random numbers fill 0 to 1 evenly and differ by seed and stream") {
  const Random random(1, 2);
  double sum = 0, square = 0, normal = 0, normal_square = 0;
  constexpr int kCount = 100000;
  for (int i = 0; i < kCount; ++i) {
    const double u = random.unit(i);
    REQUIRE((u >= 0 && u < 1));
    sum += u;
    square += u * u;
    const double n = Random::to_normal(random.bits(i));
    normal += n;
    normal_square += n * n;
  }
  CHECK(sum / kCount == Approx(0.5).margin(0.005));
  CHECK(square / kCount == Approx(1 / 3.0).margin(0.005));
  CHECK(normal / kCount == Approx(0).margin(0.02));
  CHECK(normal_square / kCount == Approx(1).margin(0.02));
  CHECK(random.bits(5) != Random(2, 2).bits(5));
  CHECK(random.bits(5) != Random(1, 3).bits(5));
}

TEST_CASE("value noise is continuous and stays within one") {
  double greatest = 0, step = 0;
  for (int i = 0; i < 20000; ++i) {
    const double x = -3 + 0.001 * i, y = 1.7 - 0.0007 * i, z = -2.2 + 0.0013 * i;
    const double here = value_noise(9, x, y, z);
    greatest = std::max(greatest, std::abs(here));
    step = std::max(step, std::abs(here - value_noise(9, x + 1e-7, y - 1e-7, z + 1e-7)));
  }
  CHECK(greatest <= 1);
  CHECK(greatest > 0.5);
  CHECK(step < 1e-5);
}

TEST_CASE("a path of constant curvature is a circle") {
  constexpr double kRadius = 20;
  const PathPiece pieces[] = {{0.1, 1 / kRadius}, {2 * kPi * kRadius - 0.1, 1 / kRadius}};
  const Path path = Path::from_pieces(pieces, 0.01);
  const Vec3 centre = path.to_world({0.1, kRadius, 0});
  for (double s = 1; s < path.length(); s += 3.7) {
    const Vec3 p = path.at(s).position;
    CHECK(std::hypot(p.x - centre.x, p.y - centre.y) == Approx(kRadius).margin(0.01));
    CHECK(p.z == Approx(0.01 * s).margin(1e-9));
    const Vec3 inside = path.to_world({s, 5, 2});
    CHECK(std::hypot(inside.x - centre.x, inside.y - centre.y) == Approx(15).margin(0.01));
    CHECK(inside.z == Approx(p.z + 2));
  }
}

TEST_CASE("an open path goes on straight, a closed one around") {
  const PathPiece pieces[] = {{10, 0}, {5, 0.1}};
  const Path open = Path::from_pieces(pieces, 0);
  CHECK(open.at(-4).position.x == Approx(-4));
  const Vec3 end = open.at(open.length()).position, beyond = open.at(open.length() + 3).position;
  CHECK(length(beyond - end) == Approx(3).margin(1e-3));
  const Vec3 control[] = {{0, 0, 0}, {30, 0, 1}, {30, 30, 0}, {0, 30, -1}};
  const Path loop = Path::closed_spline(control);
  CHECK(loop.closed());
  CHECK(length(loop.at(loop.length() + 2).position - loop.at(2).position) < 1e-9);
  for (double s = 0; s < loop.length(); s += 0.7) {
    CHECK(length(loop.at(s + 0.7).position - loop.at(s).position) == Approx(0.7).margin(2e-3));
    CHECK(length(loop.at(s + 1e-9).position - loop.at(s).position) < 1e-6);
  }
}

TEST_CASE("a pose along a direction keeps its model upright") {
  const Pose pose = pose_along({1, 2, 3}, {3, 4, 0}, {});
  const Vec3 ahead = transform(pose, {1, 0, 0}), above = transform(pose, {0, 0, 1});
  CHECK(ahead.x == Approx(1.6));
  CHECK(ahead.y == Approx(2.8));
  CHECK(above.z == Approx(4));
  const Pose turned = pose_along({0, 0, 0}, {1, 0, 0}, {.yaw = 0.1, .pitch = 0.2, .roll = 0.3});
  CHECK(turned.rotation[3] > 0);  // turned to the left
  CHECK(turned.rotation[6] > 0);  // nose up
  CHECK(turned.rotation[7] > 0);  // the left side is up
}

TEST_CASE("a mesh is sampled by area and density") {
  Mesh mesh;
  mesh.add_quad({0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0});
  mesh.add_quad({5, 0, 0}, {8, 0, 0}, {8, 1, 0}, {5, 1, 0});
  const auto even = sample_mesh(
      mesh, 4000, 0, [](const Vec3&) { return 1.0; }, Random(1, 1));
  REQUIRE(even.size() == 4000);
  int small = 0;
  for (const Vec3& p : even) {
    CHECK(p.z == 0);
    if (p.x <= 1) ++small;
  }
  CHECK(small == Approx(1000).margin(2));
  const auto weighted = sample_mesh(
      mesh, 4000, 0.01, [](const Vec3& p) { return p.x < 2 ? 9.0 : 1.0; }, Random(1, 1));
  CHECK(std::count_if(weighted.begin(), weighted.end(), [](const Vec3& p) { return p.x < 2; }) ==
        Approx(3000).margin(2));
}
