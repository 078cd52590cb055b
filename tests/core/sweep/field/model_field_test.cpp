#include "core/sweep/field/model_field.hpp"

#include <cmath>
#include <limits>
#include <memory>
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

const Box kPartOfField{{-0.6, -0.4, -0.3}, {0.7, 0.5, 0.2}};

template <typename Element>
double brute_squared(const std::vector<Element>& model, const Vec3& x) {
  double least = std::numeric_limits<double>::infinity();
  for (const Element& element : model) least = std::min(least, squared_distance(x, element));
  return least;
}

/// Points of an ellipsoid.
std::vector<Vec3> shell(std::size_t count, const Vec3& centre) {
  Random random(11);
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 v = random_direction(random);
    points.push_back(plus(centre, 1, {2 * v.x, v.y, v.z}));
  }
  return points;
}

std::vector<Triangle> triangles_at(const Surface& surface, const Vec3& at) {
  std::vector<Triangle> triangles;
  for (std::size_t i = 0; i < surface.triangles.size(); ++i) {
    const Triangle t = surface.at(i);
    triangles.emplace_back(plus(t.a, 1, at), plus(t.b, 1, at), plus(t.c, 1, at));
  }
  return triangles;
}

std::vector<Triangle> random_triangles(std::size_t count, const Vec3& at) {
  Random random(9);
  return triangles_at(random_surface(random, kPartOfField, count), at);
}

Vec3 place_on(Random& random, const Vec3& m) { return plus(m, 0, random_direction(random)); }
Vec3 place_on(Random& random, const Triangle& t) { return random_place_at(random, t); }

/// Checks that the tree finds the nearest element, and that lower bounds hold everywhere. Returns
/// how far the worst of them, within the band, is below the distance.
template <typename Element>
double check_field(const std::vector<Element>& model, double radius, double voxel) {
  const ModelTreeOf<Element> tree(model);
  const ModelField field(tree, radius, {.voxel = voxel, .reach = 3 * radius}, 1);
  Random random(7);
  const Box around = tree.box().grown(4 * radius);
  double worst = 0;
  std::uint64_t wrong = 0, near = 0;
  for (int i = 0; i < 6'000; ++i) {
    const Vec3 at = place_on(random, model[below(random, model.size())]);
    const Vec3 x = i % 3 == 0 ? random_point(random, around)
                   : i % 3 == 1
                       ? at
                       : plus(at, uniform(random, 0, 2 * radius), random_direction(random));
    const double squared = brute_squared(model, x);
    const ModelField::Bounds bounds = field.bounds(x);
    // The slack that the caller adds for roundings of positions.
    const double slack = 1e-12 * (std::abs(x.x) + std::abs(x.y) + std::abs(x.z) + radius);
    wrong += std::sqrt(bounds.squared_lower) > std::sqrt(squared) + slack;
    const auto nearest = tree.nearest(x, static_cast<std::uint32_t>(i) % tree.size());
    wrong += std::abs(std::sqrt(nearest.squared_distance) - std::sqrt(squared)) > slack;
    wrong += squared_distance(x, tree.element(nearest.element)) > nearest.squared_distance + slack;
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

}  // namespace

TEST_CASE("field bounds hold and are tight near the model") {
  CHECK(check_field(shell(2000, {0, 0, 0}), 0.1, 0.05) < 0.04);
  CHECK(check_field(shell(500, {0, 0, 0}), 0.2, 0.02) < 0.01);
  check_field(shell(500, {5e6, 2e6, 1e3}), 0.1, 0);
  check_field(shell(500, {0, 0, 0}), 0.01, 0.05);  // a radius below the voxel
  check_field(shell(500, {0, 0, 0}), 20, 0);       // and one larger than the model
  check_field<Vec3>({{1, 2, 3}}, 0.1, 0);
  check_field(std::vector<Vec3>(100, {1, 2, 3}), 0.1, 0);
  std::vector<Vec3> plane;
  for (int i = 0; i < 2500; ++i) plane.push_back({i % 50 * 0.02, i / 50 * 0.02, 0});
  check_field(plane, 0.1, 0);
  for (const std::size_t count : {1, 5, 30, 40}) {
    check_field(random_triangles(count, {count % 2 == 0 ? 1000.0 : 0.0, 0, 0}), 0.2, 0.15);
  }
  check_field(triangles_at(box_surface(kPartOfField), {1000, 0, 0}), 0.2, 0.15);
}

TEST_CASE("what lies within a distance is found up to the nearest point, and not below it") {
  const auto model = shell(3000, {1, 2, 3});
  const ModelTree tree(model);
  Random random(2);
  std::uint64_t wrong = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vec3 x = random_point(random, {{-3, -3, -3}, {7, 7, 7}});
    const double squared = brute_squared(model, x);
    const auto any = [](const Vec3&) { return true; };
    wrong += tree.nearest(x, static_cast<std::uint32_t>(i)).squared_distance != squared;
    wrong += !tree.ref().any_within(x, squared, any);
    wrong += tree.ref().any_within(x, std::nextafter(squared, 0), any);
  }
  check_equal(wrong, 0);
}

TEST_CASE("a field made by need is the whole one") {
  const auto model = shell(2000, {1, 2, 3});
  const ModelTree tree(model);
  const double reach = GENERATE(0.0, 0.5);
  const ModelField whole(tree, 0.1, {.reach = reach}, 2);
  const ModelField by_need(tree, 0.1, {.reach = reach, .by_need = true}, 2);
  const ModelFieldRef as_made = by_need.ref_as_made();
  const auto count = [&](unsigned seed, const auto& is_counted) {
    Random random(seed);
    std::uint64_t counted = 0;
    for (std::size_t i = 0; i < 5000; ++i) {
      const Vec3 x =
          plus(model[i % model.size()], uniform(random, 0, 0.6), random_direction(random));
      counted += is_counted(x);
    }
    return counted;
  };
  check_equal(count(0,
                    [&](const Vec3& x) {
                      return as_made.bounds(x).squared_lower > brute_squared(model, x) + 1e-9;
                    }),
              0);
  CHECK(count(0, [&](const Vec3& x) {
          return as_made.bounds(x).squared_lower < whole.bounds(x).squared_lower;
        }) > 1000);
  std::uint64_t differing[4];
  std::vector<std::thread> threads;
  for (unsigned i = 0; i < 4; ++i) {
    threads.emplace_back([&, i] {
      differing[i] = count(1 + i, [&](const Vec3& x) {
        const ModelField::Bounds a = whole.bounds(x), b = by_need.bounds(x);
        return a.squared_lower != b.squared_lower || a.near != b.near;
      });
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const std::uint64_t of_thread : differing) check_equal(of_thread, 0);
}

namespace {

/// Checks the distances and elements that a finder gives the nodes of a brick around `at`.
/// is_right(node, least, found, element): the least squared distance, and what was found.
template <typename Finder, typename Tree, typename IsRight>
void check_brick(const Tree& tree, const Vec3& at, double voxel, const IsRight& is_right) {
  const auto finder = std::make_unique<Finder>(tree);
  std::vector<float> squared(ModelFieldRef::kBrickNodes);
  std::vector<std::uint32_t> nearest(ModelFieldRef::kBrickNodes);
  const Vec3 corner = plus(at, -voxel, {3, 5, 4.5});
  finder->find(corner, voxel, squared.data(), nearest.data());
  std::uint64_t wrong = 0;
  for (std::uint32_t i = 0; i < ModelFieldRef::kBrickNodes; ++i) {
    constexpr std::uint32_t kRow = ModelFieldRef::kRow;
    const Vec3 node{corner.x + i % kRow * voxel, corner.y + i / kRow % kRow * voxel,
                    corner.z + i / kRow / kRow * voxel};
    wrong += !is_right(tree.nearest(node).squared_distance, squared[i],
                       squared_distance(node, tree.element(nearest[i])));
  }
  CAPTURE(at.x, voxel, tree.size());
  check_equal(wrong, 0);
}

}  // namespace

TEST_CASE("the nodes of a brick have the model points and triangles that the tree finds") {
  for (const auto& model : {shell(3000, {0, 0, 0}), shell(100'000, {0, 0, 0}),  // dense beside it
                            shell(3000, {5e5, -2e5, 100}), std::vector<Vec3>{{0.1, 0.2, 0.3}},
                            std::vector<Vec3>(5000, {0.1, 0.2, 0.3})}) {
    const ModelTree tree(model);
    for (const double voxel : {0.01, 0.1, 1.0}) {
      check_brick<BrickNearest>(tree, model[model.size() / 2], voxel,
                                [](double least, float found, double element) {
                                  return found == rounded_down(least) && element == least;
                                });
    }
  }
  const Triangle one{{0.1, 0, 0}, {0, 0.2, 0}, {0, 0, 0.1}};
  for (const auto& model :
       {random_triangles(60, {0, 0, 0}), random_triangles(5000, {0, 0, 0}),
        random_triangles(60, {5e5, -2e5, 100}), triangles_at(box_surface(kPartOfField), {0, 0, 0}),
        random_triangles(1, {0, 0, 0}), std::vector<Triangle>(5000, one)}) {
    const TriangleTree tree(model);
    for (const double voxel : {1e-3, 0.01, 0.1, 1.0}) {
      check_brick<BrickTriangles>(
          tree, model[model.size() / 2].a, voxel, [](double squared, float found, double element) {
            const double least = std::sqrt(squared), of_node = std::sqrt(double{found});
            const double error = 2 * triangle_error(least, 2);
            return of_node <= least + error && of_node >= least * (1 - 1e-6) - error &&
                   std::sqrt(element) <= least + error;
          });
    }
  }
}

TEST_CASE("a field keeps within its memory by larger voxels") {
  const ModelTree tree(shell(2000, {0, 0, 0}));
  for (const double voxel : {0.0, 1e-3, 1e-9}) {
    CAPTURE(voxel);
    const ModelField small(tree, 0.01, {.voxel = voxel, .most_bytes = 1 << 20}, 1);
    CHECK(small.allocated_bytes() < 3 << 20);
    CHECK(small.voxel() > 0.005);
  }
}
