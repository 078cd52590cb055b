// The predicate for triangles against exact arithmetic (CGAL), within the bound of
// docs/design/numerics.md ("Triangles").
#include <CGAL/Exact_rational.h>
#include <CGAL/Simple_cartesian.h>

#include <cmath>

#include "core/geometry/triangle.hpp"
#include "support/catch.hpp"
#include "support/random_triangles.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

using Exact = CGAL::Exact_rational;
using TriangleKernel = CGAL::Simple_cartesian<Exact>;

TriangleKernel::Point_3 exact_point(const Vec3& p) { return {p.x, p.y, p.z}; }

Exact squared_exact(const Vec3& e, const Triangle& t) {
  const TriangleKernel::Point_3 a = exact_point(t.a), b = exact_point(t.b), c = exact_point(t.c),
                                p = exact_point(e);
  if (!CGAL::collinear(a, b, c)) {
    return CGAL::squared_distance(p, TriangleKernel::Triangle_3(a, b, c));
  }
  const auto edge = [&](const TriangleKernel::Point_3& from, const TriangleKernel::Point_3& to) {
    return from == to ? CGAL::squared_distance(p, from)
                      : CGAL::squared_distance(p, TriangleKernel::Segment_3(from, to));
  };
  return std::min({edge(a, b), edge(b, c), edge(c, a)});
}

/// About |root of d2 - exact distance| over the bound; above 1 only where the bound is violated.
double share_of_bound(double d2, const Exact& squared, const Triangle& t) {
  const double distance = std::sqrt(d2);
  const double root = std::sqrt(CGAL::to_double(squared));
  const double bound = triangle_error(root, longest_edge(t));
  const Exact d(distance), most(bound);
  const bool holds =
      (d <= most || (d - most) * (d - most) <= squared) && squared <= (d + most) * (d + most);
  return holds ? std::min(1.0, std::abs(distance - root) / bound) : 2;
}

}  // namespace

TEST_CASE("distances to triangles are within their bound of the exact ones") {
  double worst = 0;
  for (std::uint64_t seed = 1; seed <= 20'000; ++seed) {
    Random random(seed);
    const Triangle t = random_triangle(random);
    for (int i = 0; i < 3; ++i) {
      const Vec3 e = random_place_at(random, t);
      const Exact squared = squared_exact(e, t);
      const double share = share_of_bound(squared_distance(e, t), squared, t);
      CAPTURE(seed, i, share);
      if (share > 1) FAIL_CHECK("beyond the bound");
      worst = std::max(worst, share);
    }
  }
  CHECK(worst > 0.1);  // errors do occur, so that the check means something
}
