#include "core/geometry/wide_tree.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "core/geometry/point_box.hpp"
#include "core/geometry/triangle_box.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/random_triangles.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

std::vector<Vec3> sorted(std::vector<Vec3> points) {
  std::ranges::sort(points, {}, [](const Vec3& p) { return std::tuple(p.x, p.y, p.z); });
  return points;
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
  return sorted(visited);
}

Box flat_box(const Vec3& centre, double size) {
  const Vec3 half{size / 2, size / 2, size / 20};
  return {plus(centre, -1, half), plus(centre, 1, half)};
}

/// Checks that a search visits each point within its reach as often as the tree holds it, and no
/// other.
void check_visits(const std::vector<Vec3>& points, const Vec3& centre, double size) {
  CAPTURE(points.size(), centre.x, size);
  const WideTree tree{ModelTree(points)};
  Random random(7);
  for (int k = 0; k < 20; ++k) {
    const Vec3 half{size, size, size};
    const Vec3 lo = random_point(random, {plus(centre, -1, half), plus(centre, 1, half)});
    const Box box{lo, {lo.x + size / 4, lo.y, lo.z + size / 100}};
    const double reach = k % 3 == 0 ? 0 : 0.5 * size / (k % 5 + 1);
    std::vector<Vec3> expected;
    std::ranges::copy_if(points, std::back_inserter(expected), [&](const Vec3& p) {
      return least_squared_distance(box, p) <= reach * reach;
    });
    CHECK(visited_from(tree, box, reach * reach) == sorted(expected));
  }
}

}  // namespace

TEST_CASE("a wide tree visits every point within reach once") {
  Random random(1);
  for (const std::size_t count : {1, 2, 7, 8, 9, 16, 17, 63, 64, 65, 511, 513, 4097, 20000}) {
    check_visits(random_points(random, flat_box({0, 0, 0}, 4), count), {0, 0, 0}, 4);
  }
  const auto check_at = [&](const Vec3& centre, double size) {
    check_visits(random_points(random, flat_box(centre, size), 3000), centre, size);
  };
  check_at({4.5e6, -5.2e6, 300}, 5);
  check_at({1e12, 0, -1e12}, 1);
  for (const double size : {1e25, 1e-19, 1e-21, 3e-22, 1e-22, 3e-23, 1e-23, 1e-30}) {
    check_at({0, 0, 0}, size);
  }
  std::vector<Vec3> duplicates(500, {1, 2, 3});
  duplicates.resize(900, {1, 2.5, 3});
  check_visits(duplicates, {1, 2, 3}, 2);
  const Box at_first{duplicates[0], duplicates[0]};
  check_equal(visited_from(WideTree{ModelTree(duplicates)}, at_first, 0).size(), 500);
}

TEST_CASE("a wide tree without points visits none and one without bounds visits all") {
  CHECK(visited_from(WideTree{}, {{0, 0, 0}, {1, 1, 1}}, 1).empty());
  Random random(2);
  const WideTree tree{ModelTree(random_points(random, flat_box({0, 0, 0}, 1), 100))};
  const Box near{{9, 9, 9}, {9, 9, 9}}, far{{1e30, 0, 0}, {1e30, 0, 0}};
  check_equal(visited_from(tree, near, std::numeric_limits<double>::infinity()).size(), 100);
  check_equal(visited_from(tree, near, std::nan("")).size(), 100);
  check_equal(visited_from(tree, far, 2e60).size(), 100);
}

namespace {

/// A bent patch, finely divided both ways or in long strips, anywhere and of any size.
struct Patch {
  Patch(Random& random, int scene)
      : size(std::pow(10.0, uniform(random, -6, 4))),
        length(scene % 2 == 0 ? size : 20 * size),
        bend(uniform(random, 0, 1)),
        at(plus({}, scene % 3 == 0 ? 1e4 * size : size, random_direction(random))),
        along(random_direction(random)),
        beside(random_direction(random)) {
    constexpr double kStep = 1 / 14.0;
    for (int i = 0; i < 14 * 14; ++i) {
      const double s = i / 14 * kStep, t = 2 * (i % 14) * kStep - 1;
      triangles.emplace_back(place(s, t), place(s + kStep, t), place(s, t + 2 * kStep));
      triangles.emplace_back(place(s + kStep, t), place(s, t + 2 * kStep),
                             place(s + kStep, t + 2 * kStep));
    }
  }

  Vec3 place(double s, double t) const {
    const Vec3 on = plus(plus(at, s * length, along), t * size, beside);
    return plus(on, bend * t * t * size, {0.3, -0.5, 0.8});
  }

  double size, length, bend;
  Vec3 at, along, beside;
  std::vector<Triangle> triangles;
};

}  // namespace

TEST_CASE("a wide tree of triangles leaves out none within reach of a hull") {
  Random random(11);
  std::uint64_t missed = 0, visited = 0, in_reach = 0;
  for (int scene = 0; scene < 60; ++scene) {
    const Patch patch(random, scene);
    const TriangleTree model(patch.triangles);
    const WideTreeOf<Triangle> tree(model);
    for (int k = 0; k < 40; ++k) {
      const double apart = patch.size * std::pow(10.0, uniform(random, -2, 0.3));
      const Vec3 start = plus(patch.place(uniform(random, 0, 1), uniform(random, -1, 1)), apart,
                              random_direction(random));
      const Vec3 way = plus({}, k % 4 == 0 ? 0 : uniform(random, 0, 1) * patch.length,
                            k % 3 == 0 ? random_direction(random) : patch.along);
      const Vec3 bent = plus({}, 0.05 * length_of(way), random_direction(random));
      PlaceHull hull{{}, {start, plus(start, 1, way), plus(plus(start, 0.5, way), 1, bent)}};
      hull.box = box_of(std::span<const Vec3>(hull.corner));
      const double reach = apart * uniform(random, 0.5, 1.5);
      std::vector<bool> seen(patch.triangles.size(), false);
      tree.ref().any_nearest_first(
          hull, [&] { return reach * reach; },
          [](const FloatPacket&, float(&out)[FloatPacket::kMost]) { std::ranges::fill(out, 0.0F); },
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
