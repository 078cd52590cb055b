#include <catch2/catch.hpp>
#include <cmath>

#include "io/models/mesh/mesh_builder.hpp"
#include "support/triangle_distance.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

double area_of(const std::vector<Vec3>& corners, const CutPolygon& cut) {
  double area = 0;
  for (const auto& [a, b, c] : cut.triangles) {
    const Vec3 normal = cross(minus(corners[b], corners[a]), minus(corners[c], corners[a]));
    area += std::sqrt(dot(normal, normal)) / 2;
  }
  return area;
}

/// Whether a place lies in one of the polygon's triangles.
bool covers(const std::vector<Vec3>& corners, const CutPolygon& cut, const Vec3& place) {
  for (const auto& [a, b, c] : cut.triangles) {
    if (triangle_distance(place, corners[a], corners[b], corners[c]) < 1e-12) return true;
  }
  return false;
}

}  // namespace

TEST_CASE("a convex polygon is cut as a fan") {
  std::vector<Vec3> corners;
  for (int i = 0; i < 100; ++i) corners.push_back({std::cos(i * 0.0628), 5, std::sin(i * 0.0628)});
  const CutPolygon cut = cut_polygon(corners);
  CHECK(cut.triangles.size() == 98);
  CHECK(is_fan(corners));
  CHECK(cut.bend < 1e-12);
  CHECK(area_of(corners, cut) == Approx(3.1390).epsilon(1e-3));
}

TEST_CASE("a polygon that is not convex keeps its notch, whatever corner comes first") {
  // The polygon is an L in the tilted plane z = x + y.
  const std::vector<Vec3> shape{{0, 0, 0}, {3, 0, 3}, {3, 1, 4}, {1, 1, 2}, {1, 3, 4}, {0, 3, 3}};
  for (std::size_t first = 0; first < shape.size(); ++first) {
    for (const bool turned : {false, true}) {
      std::vector<Vec3> corners;
      for (std::size_t i = 0; i < shape.size(); ++i) corners.push_back(shape[(first + i) % 6]);
      if (turned) std::reverse(corners.begin(), corners.end());
      const CutPolygon cut = cut_polygon(corners);
      CHECK_FALSE(cut.crossing);
      CHECK(cut.triangles.size() == 4);
      CHECK(area_of(corners, cut) == Approx(5 * std::sqrt(3.0)));
      CHECK(covers(corners, cut, {2.9, 0.5, 3.4}));
      CHECK_FALSE(covers(corners, cut, {2, 2, 4}));
    }
  }
}

TEST_CASE("an outline with a hole on a bridge keeps its hole") {
  const std::vector<Vec3> corners{{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}, {0, 0, 0},
                                  {1, 1, 0}, {1, 3, 0}, {3, 3, 0}, {3, 1, 0}, {1, 1, 0}};
  const CutPolygon cut = cut_polygon(corners);
  CHECK_FALSE(cut.crossing);
  CHECK(area_of(corners, cut) == Approx(12));
  CHECK_FALSE(covers(corners, cut, {2, 2, 0}));
  CHECK(covers(corners, cut, {3.5, 2, 0}));
}

TEST_CASE("a bent polygon says by how much, a crossing one that it crosses") {
  const std::vector<Vec3> bent{{0, 0, 0}, {1, 0, 0.1}, {1, 1, 0}, {0, 1, 0.1}};
  CHECK(cut_polygon(bent).bend == Approx(0.05));
  const std::vector<Vec3> bow{{0, 0, 0}, {2, 2, 0}, {2, 0, 0}, {0, 1, 0}, {1, 3, 0}, {0, 3, 0}};
  const CutPolygon cut = cut_polygon(bow);
  CHECK(cut.crossing);
  CHECK(cut.triangles.size() == 4);
}

TEST_CASE("polygons without area are cut without harm") {
  const std::vector<Vec3> line{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {3, 3, 3}};
  CHECK(cut_polygon(line).triangles.size() == 2);
  CHECK(cut_polygon(std::vector<Vec3>(5, Vec3{1, 2, 3})).triangles.size() == 3);
  const std::vector<Vec3> huge{{1e300, 0, 0}, {0, 1e300, 0}, {0, 0, 1e300}, {1e300, 1, 1}};
  CHECK(cut_polygon(huge).triangles.size() == 2);
}
