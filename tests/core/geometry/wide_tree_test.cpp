#include "core/geometry/wide_tree.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <random>
#include <tuple>
#include <vector>

#include "core/geometry/triangle_box.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/random_triangles.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

bool less(const Vec3& a, const Vec3& b) {
  return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
}

/// The points that a search from a box visits, in order of the coordinates.
std::vector<Vec3> visited_from(const WideTree& tree, const Box& box, double squared_reach) {
  std::vector<Vec3> visited;
  tree.ref().any_nearest_first(
      box, [&] { return squared_reach; },
      [&](const PointPacket& packet, double(&out)[PointPacket::kMost]) {
        for (std::uint32_t i = 0; i < PointPacket::kMost; ++i) {
          out[i] = least_squared_distance(box, packet.point(i));
        }
      },
      [&](const PointPacket& packet, std::uint32_t i) {
        visited.push_back(packet.point(i));
        return false;
      });
  std::sort(visited.begin(), visited.end(), less);
  return visited;
}

std::vector<Vec3> random_points(std::size_t count, const Vec3& centre, double size) {
  std::mt19937_64 random(count);
  std::uniform_real_distribution<double> unit(-size / 2, size / 2);
  std::vector<Vec3> points(count);
  for (Vec3& p : points) {
    p = {centre.x + unit(random), centre.y + unit(random), centre.z + 0.1 * unit(random)};
  }
  return points;
}

/// Checks that a search visits each point within its reach as often as the tree holds it, and no
/// other.
void check(const std::vector<Vec3>& points, const Vec3& centre, double size) {
  const WideTree tree{ModelTree(points)};
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> unit(-size, size);
  for (int k = 0; k < 20; ++k) {
    const Vec3 lo{centre.x + unit(random), centre.y + unit(random), centre.z + unit(random)};
    const Box box{lo, {lo.x + size / 4, lo.y, lo.z + size / 100}};
    const double reach = k % 3 == 0 ? 0 : 0.5 * size / (k % 5 + 1);
    std::vector<Vec3> expected;
    std::copy_if(points.begin(), points.end(), std::back_inserter(expected),
                 [&](const Vec3& p) { return least_squared_distance(box, p) <= reach * reach; });
    std::sort(expected.begin(), expected.end(), less);
    CHECK(visited_from(tree, box, reach * reach) == expected);
  }
}

}  // namespace

TEST_CASE("a wide tree visits every point within reach once") {
  const std::size_t count = GENERATE(1, 2, 7, 8, 9, 16, 17, 63, 64, 65, 511, 513, 4097, 20000);
  check(random_points(count, {0, 0, 0}, 4), {0, 0, 0}, 4);
}

TEST_CASE("a wide tree far from the origin and of odd sizes") {
  check(random_points(3000, {4.5e6, -5.2e6, 300}, 5), {4.5e6, -5.2e6, 300}, 5);
  check(random_points(3000, {1e12, 0, -1e12}, 1), {1e12, 0, -1e12}, 1);
  check(random_points(3000, {0, 0, 0}, 1e-30), {0, 0, 0}, 1e-30);
  check(random_points(3000, {0, 0, 0}, 1e25), {0, 0, 0}, 1e25);
  for (const double size : {1e-19, 1e-21, 3e-22, 1e-22, 3e-23, 1e-23}) {
    check(random_points(3000, {0, 0, 0}, size), {0, 0, 0}, size);
  }
}

TEST_CASE("a wide tree of points at few places") {
  std::vector<Vec3> points(500, {1, 2, 3});
  points.resize(900, {1, 2.5, 3});
  check(points, {1, 2, 3}, 2);
  check_equal(visited_from(WideTree{ModelTree(points)}, {{1, 2, 3}, {1, 2, 3}}, 0).size(), 500);
}

TEST_CASE("a wide tree without points visits none and one without bounds visits all") {
  CHECK(visited_from(WideTree{}, {{0, 0, 0}, {1, 1, 1}}, 1).empty());
  const WideTree tree{ModelTree(random_points(100, {0, 0, 0}, 1))};
  const double infinity = std::numeric_limits<double>::infinity();
  check_equal(visited_from(tree, {{9, 9, 9}, {9, 9, 9}}, infinity).size(), 100);
  check_equal(visited_from(tree, {{9, 9, 9}, {9, 9, 9}}, std::nan("")).size(), 100);
  check_equal(visited_from(tree, {{1e30, 0, 0}, {1e30, 0, 0}}, 2e60).size(), 100);
}

TEST_CASE("a wide tree of triangles leaves out none within reach of a hull") {
  Random random(11);
  std::uint64_t missed = 0, visited = 0, in_reach = 0;
  for (int scene = 0; scene < 60; ++scene) {
    // A bent patch, finely divided both ways or in long strips, anywhere and of any size.
    const double size = std::pow(10.0, uniform(random, -6, 4));
    const Vec3 at = plus({}, scene % 3 == 0 ? 1e4 * size : size, random_direction(random));
    const double length = scene % 2 == 0 ? size : 20 * size, bend = uniform(random, 0, 1);
    const Vec3 u = random_direction(random), beside = random_direction(random);
    const auto place = [&](double s, double t) {
      const Vec3 on = plus(plus(at, s * length, u), t * size, beside);
      return plus(on, bend * t * t * size, {0.3, -0.5, 0.8});
    };
    std::vector<Triangle> triangles;
    const int steps = 14;
    for (int i = 0; i < steps; ++i) {
      for (int j = 0; j < steps; ++j) {
        const double s = i / 14.0, t = j / 7.0 - 1, ds = 1 / 14.0, dt = 1 / 7.0;
        triangles.emplace_back(place(s, t), place(s + ds, t), place(s, t + dt));
        triangles.emplace_back(place(s + ds, t), place(s, t + dt), place(s + ds, t + dt));
      }
    }
    const TriangleTree model(triangles);
    const WideTreeOf<Triangle> tree(model);
    for (int k = 0; k < 40; ++k) {
      const double apart = size * std::pow(10.0, uniform(random, -2, 0.3));
      const Vec3 start = plus(place(uniform(random, 0, 1), uniform(random, -1, 1)), apart,
                              random_direction(random));
      const Vec3 way = plus({}, k % 4 == 0 ? 0 : uniform(random, 0, 1) * length,
                            k % 3 == 0 ? random_direction(random) : u);
      const Vec3 bent = plus({}, 0.05 * length_of(way), random_direction(random));
      const PlaceHull hull{{}, {start, plus(start, 1, way), plus(plus(start, 0.5, way), 1, bent)}};
      PlaceHull boxed = hull;
      boxed.box = {start, start};
      for (const Vec3& corner : hull.corner) {
        for (int axis = 0; axis < 3; ++axis) {
          boxed.box.lo[axis] = std::min(boxed.box.lo[axis], corner[axis]);
          boxed.box.hi[axis] = std::max(boxed.box.hi[axis], corner[axis]);
        }
      }
      const double reach = apart * uniform(random, 0.5, 1.5);
      std::vector<bool> seen(triangles.size(), false);
      tree.ref().any_nearest_first(
          boxed, [&] { return reach * reach; },
          [](const FloatPacket&, float(&out)[FloatPacket::kMost]) {
            std::fill(std::begin(out), std::end(out), 0.0F);
          },
          [&](const FloatPacket& packet, std::uint32_t i) {
            seen[packet.index[i]] = true;
            ++visited;
            return false;
          });
      for (int p = 0; p < 6; ++p) {
        double share[3] = {uniform(random, 0, 1), uniform(random, 0, 1), uniform(random, 0, 1)};
        const double sum = share[0] + share[1] + share[2];
        Vec3 y{};
        for (int c = 0; c < 3; ++c) y = plus(y, share[c] / sum, hull.corner[c]);
        for (std::uint32_t i = 0; i < model.size(); ++i) {
          const bool is_in_reach =
              squared_distance(y, model.element(i)) < reach * reach * (1 - 1e-9);
          in_reach += is_in_reach;
          missed += is_in_reach && !seen[i];
        }
      }
    }
  }
  check_equal(missed, 0);
  CHECK(in_reach > 10000);
  // Most triangles are left out, though their boxes overlap those of the hulls.
  CHECK(visited < 60ULL * 40 * 392 / 3);
}
