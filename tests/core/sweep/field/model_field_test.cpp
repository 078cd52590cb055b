#include "core/sweep/field/model_field.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <thread>

#include "core/geometry/predicate.hpp"
#include "core/sweep/field/brick_nearest.hpp"
#include "core/sweep/field/brick_triangles.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/surface_scene.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

double brute_squared(const std::vector<Vec3>& model, const Vec3& x) {
  double least = std::numeric_limits<double>::infinity();
  for (const Vec3& m : model) least = std::min(least, squared_distance(m, x));
  return least;
}

/// Checks that lower bounds hold everywhere. Returns how far the worst of them, within the band, is
/// below the distance.
double check_field(const std::vector<Vec3>& model, double radius, double voxel) {
  const ModelTree tree(model);
  const ModelField field(tree, radius, {.voxel = voxel}, 1);
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> unit(0, 1);
  const Box& box = tree.box();
  double worst = 0;
  std::uint64_t wrong = 0, near = 0;
  for (int i = 0; i < 20'000; ++i) {
    Vec3 x;
    const Vec3& m = model[i % model.size()];
    for (int k = 0; k < 3; ++k) {
      const double wide = box.hi[k] - box.lo[k] + 8 * radius;
      x[k] = i % 2 == 0 ? box.lo[k] + (unit(random) * 2 - 0.5) * wide
                        : m[k] + (unit(random) - 0.5) * 4 * radius;
    }
    const double squared = brute_squared(model, x);
    const ModelField::Bounds bounds = field.bounds(x);
    // The slack that the caller adds for roundings of positions.
    const double slack = 1e-12 * (std::abs(x.x) + std::abs(x.y) + std::abs(x.z) + radius);
    wrong += std::sqrt(bounds.squared_lower) > std::sqrt(squared) + slack;
    if (squared < radius * radius) {
      ++near;
      wrong += bounds.near == ModelField::kNone;
      worst = std::max(worst, std::sqrt(squared) - std::sqrt(bounds.squared_lower));
    }
  }
  check_equal(wrong, 0);
  CHECK(near > 100);
  return worst;
}

std::vector<Vec3> shell(std::size_t count, const Vec3& centre) {
  std::mt19937_64 random(11);
  std::normal_distribution<double> normal;
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 v{normal(random), normal(random), normal(random)};
    const double scale = 1 / std::sqrt(squared_length(v.x, v.y, v.z));
    points.push_back({centre.x + 2 * v.x * scale, centre.y + v.y * scale, centre.z + v.z * scale});
  }
  return points;
}

}  // namespace

TEST_CASE("the nearest model point is the one that brute force finds") {
  const auto model = shell(3000, {1, 2, 3});
  const ModelTree tree(model);
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> unit(-3, 7);
  bool equal = true;
  for (int i = 0; i < 2000; ++i) {
    const Vec3 x{unit(random), unit(random), unit(random)};
    const ModelTree::Nearest nearest = tree.nearest(x, static_cast<std::uint32_t>(i) % 3000);
    equal &= nearest.squared_distance == brute_squared(model, x) &&
             squared_distance(tree.element(nearest.element), x) == nearest.squared_distance;
    const double squared_radius = nearest.squared_distance;
    equal &= tree.ref().any_within(x, squared_radius, [](const Vec3&) { return true; });
    equal &= !tree.ref().any_within(x, std::nextafter(squared_radius, 0),
                                    [](const Vec3&) { return true; });
  }
  CHECK(equal);
}

TEST_CASE("field bounds hold and are tight near the model") {
  SECTION("a shell, voxel of half the radius") {
    CHECK(check_field(shell(2000, {0, 0, 0}), 0.1, 0.05) < 0.04);
  }
  SECTION("a shell far from its origin") { check_field(shell(500, {5e6, 2e6, 1e3}), 0.1, 0); }
  SECTION("a fine voxel") { CHECK(check_field(shell(500, {0, 0, 0}), 0.2, 0.02) < 0.01); }
  SECTION("a radius below the voxel") { check_field(shell(500, {0, 0, 0}), 0.01, 0.05); }
  SECTION("a radius larger than the model") { check_field(shell(500, {0, 0, 0}), 20, 0); }
  SECTION("one point") { check_field({{1, 2, 3}}, 0.1, 0); }
  SECTION("duplicates") { check_field(std::vector<Vec3>(100, {1, 2, 3}), 0.1, 0); }
  SECTION("a plane") {
    std::vector<Vec3> plane;
    for (int i = 0; i < 2500; ++i) plane.push_back({i % 50 * 0.02, i / 50 * 0.02, 0});
    check_field(plane, 0.1, 0);
  }
}

TEST_CASE("a field made by need is the whole one") {
  const auto model = shell(2000, {1, 2, 3});
  const ModelTree tree(model);
  const double reach = GENERATE(0.0, 0.5);
  const ModelField whole(tree, 0.1, {.reach = reach}, 2);
  const ModelField by_need(tree, 0.1, {.reach = reach, .by_need = true}, 2);
  const ModelFieldRef as_made = by_need.ref_as_made();
  std::uint64_t coarser = 0;
  const auto differences = [&](unsigned seed) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    std::uint64_t differing = 0;
    for (int i = 0; i < 5000; ++i) {
      const Vec3& m = model[static_cast<std::size_t>(i) % model.size()];
      const Vec3 x{m.x + 0.2 * normal(random), m.y + 0.2 * normal(random),
                   m.z + 0.2 * normal(random)};
      const ModelField::Bounds a = whole.bounds(x);
      if (seed == 0) {
        const double bound = as_made.bounds(x).squared_lower;
        differing += bound > brute_squared(model, x) + 1e-9;
        coarser += bound < a.squared_lower;
        continue;
      }
      const ModelField::Bounds b = by_need.bounds(x);
      differing += a.squared_lower != b.squared_lower || a.near != b.near;
    }
    return differing;
  };
  check_equal(differences(0), 0);
  CHECK(coarser > 1000);
  std::uint64_t differing[4];
  std::vector<std::thread> threads;
  for (unsigned i = 0; i < 4; ++i) {
    threads.emplace_back([&, i] { differing[i] = differences(1 + i); });
  }
  for (std::thread& thread : threads) thread.join();
  for (const std::uint64_t of_thread : differing) check_equal(of_thread, 0);
}

TEST_CASE("the nodes of a brick have the model points that the tree finds") {
  std::vector<Vec3> model;
  SECTION("a shell") { model = shell(3000, {0, 0, 0}); }
  SECTION("dense beside the brick") { model = shell(100'000, {0, 0, 0}); }
  SECTION("far from the origin") { model = shell(3000, {5e5, -2e5, 100}); }
  SECTION("one point") { model = {{0.1, 0.2, 0.3}}; }
  SECTION("duplicates") { model.assign(5000, {0.1, 0.2, 0.3}); }
  const ModelTree tree(model);
  const auto nearest = std::make_unique<BrickNearest>(tree);
  std::vector<float> squared(ModelFieldRef::kBrickNodes);
  std::vector<std::uint32_t> point(ModelFieldRef::kBrickNodes);
  for (const double voxel : {0.01, 0.1, 1.0}) {
    const Vec3& at = model[model.size() / 2];
    const Vec3 corner{at.x - 3 * voxel, at.y - 5 * voxel, at.z - 4.5 * voxel};
    nearest->find(corner, voxel, squared.data(), point.data());
    std::uint64_t differing = 0;
    for (std::uint32_t i = 0; i < ModelFieldRef::kBrickNodes; ++i) {
      constexpr std::uint32_t kRow = ModelFieldRef::kRow;
      const Vec3 node{corner.x + i % kRow * voxel, corner.y + i / kRow % kRow * voxel,
                      corner.z + i / kRow / kRow * voxel};
      const double least = tree.nearest(node).squared_distance;
      differing += squared[i] != rounded_down(least) ||
                   squared_distance(tree.element(point[i]), node) != least;
    }
    check_equal(differing, 0);
  }
}

TEST_CASE("the nodes of a brick are as far from triangles as the tree says") {
  Random random(9);
  const Box part{{-0.6, -0.4, -0.3}, {0.7, 0.5, 0.2}};
  std::vector<Triangle> model;
  const auto add = [&](const test::Surface& surface, const Vec3& at) {
    for (std::size_t i = 0; i < surface.triangles.size(); ++i) {
      Triangle t = surface.at(i);
      for (Vec3* corner : {&t.a, &t.b, &t.c}) *corner = test::plus(*corner, 1, at);
      model.push_back(t);
    }
  };
  SECTION("of every shape") { add(test::random_surface(random, part, 60), {0, 0, 0}); }
  SECTION("dense beside the brick") { add(test::random_surface(random, part, 5000), {0, 0, 0}); }
  SECTION("far from the origin") { add(test::random_surface(random, part, 60), {5e5, -2e5, 100}); }
  SECTION("large ones") { add(test::box_surface(part), {0, 0, 0}); }
  SECTION("one") { add(test::random_surface(random, part, 1), {0, 0, 0}); }
  SECTION("duplicates") { model.assign(5000, Triangle{{0.1, 0, 0}, {0, 0.2, 0}, {0, 0, 0.1}}); }
  const TriangleTree tree(model);
  const auto finder = std::make_unique<BrickTriangles>(tree);
  std::vector<float> squared(ModelFieldRef::kBrickNodes);
  std::vector<std::uint32_t> nearest(ModelFieldRef::kBrickNodes);
  for (const double voxel : {1e-3, 0.01, 0.1, 1.0}) {
    const Vec3& at = model[model.size() / 2].a;
    const Vec3 corner{at.x - 3 * voxel, at.y - 5 * voxel, at.z - 4.5 * voxel};
    finder->find(corner, voxel, squared.data(), nearest.data());
    std::uint64_t too_far = 0, too_near = 0, others = 0;
    for (std::uint32_t i = 0; i < ModelFieldRef::kBrickNodes; ++i) {
      constexpr std::uint32_t kRow = ModelFieldRef::kRow;
      const Vec3 node{corner.x + i % kRow * voxel, corner.y + i / kRow % kRow * voxel,
                      corner.z + i / kRow / kRow * voxel};
      const double least = std::sqrt(tree.nearest(node).squared_distance);
      const double of_node = std::sqrt(static_cast<double>(squared[i]));
      const double error = 2 * test::triangle_error(least, 2);
      too_far += of_node > least + error;
      too_near += of_node < least * (1 - 1e-6) - error;
      others += !(std::sqrt(squared_distance(node, tree.element(nearest[i]))) <= least + error);
    }
    check_equal(too_far, 0);
    check_equal(too_near, 0);
    check_equal(others, 0);
  }
}

TEST_CASE("a field keeps within its memory by larger voxels") {
  const auto model = shell(2000, {0, 0, 0});
  const ModelTree tree(model);
  for (const double voxel : {0.0, 1e-3, 1e-9}) {
    CAPTURE(voxel);
    const ModelField small(tree, 0.01, {.voxel = voxel, .most_bytes = 1 << 20}, 1);
    CHECK(small.allocated_bytes() < 3 << 20);
    CHECK(small.voxel() > 0.005);
  }
}
