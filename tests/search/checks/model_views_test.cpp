#include "search/checks/facts/model_views.hpp"

#include "core/geometry/point_box.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// Points 0.1 apart on those parts of the sides of a cube of 2 for which `keep` holds.
template <typename Keep>
std::vector<Vec3> cube(Keep keep) {
  std::vector<Vec3> points;
  for (int i = 0; i <= 20; ++i) {
    for (int j = 0; j <= 20; ++j) {
      for (int k = 0; k <= 20; ++k) {
        const bool surface = i % 20 == 0 || j % 20 == 0 || k % 20 == 0;
        if (surface && keep(i, j, k)) points.push_back({i / 10.0, j / 10.0, k / 10.0});
      }
    }
  }
  return points;
}

ModelView view_of(const std::vector<Vec3>& points, int axis) {
  return {points, box_of(points), axis, 0.2};
}

}  // namespace

TEST_CASE("a closed cube is closed from all sides and encloses its middle") {
  const auto points = cube([](int, int, int) { return true; });
  for (int axis = 0; axis < 3; ++axis) {
    CAPTURE(axis);
    const ModelView view = view_of(points, axis);
    check_equal(view.open_share(), 0);
    CHECK(view.encloses({1, 1, 1}, 0.1));
    CHECK_FALSE(view.encloses({1, 1, 1}, 1.01));
    Vec3 near{1, 1, 1};
    near[axis] = 0.05;
    CHECK_FALSE(view.encloses(near, 0.1));
  }
}

TEST_CASE("a cube without two opposite sides is open along that axis alone") {
  for (int axis = 0; axis < 3; ++axis) {
    CAPTURE(axis);
    const auto points = cube([&](int i, int j, int k) {
      const int along[] = {i, j, k};
      const int a = along[(axis + 1) % 3], b = along[(axis + 2) % 3];
      return a % 20 == 0 || b % 20 == 0;
    });
    for (int other = 0; other < 3; ++other) {
      const ModelView view = view_of(points, other);
      CHECK((view.open_share() > 0.5) == (other == axis));
      CHECK(view.encloses({1, 1, 1}, 0.1) == (other != axis));
    }
  }
}

TEST_CASE("what is open to a side is no hole") {
  // The model is a gantry: two legs and a roof, seen from the front.
  const auto gantry = cube([](int, int j, int k) { return j % 20 == 0 || k == 20; });
  check_equal(view_of(gantry, 0).open_share(), 0);
  CHECK_FALSE(view_of(gantry, 2).encloses({1, 1, 1}, 0.1));
}

TEST_CASE("a view of few cells, of a line or of a point tells nothing") {
  const auto tube = cube([](int, int j, int k) { return j % 20 == 0 || k % 20 == 0; });
  check_equal(ModelView(tube, box_of(tube), 0, 0.5).open_share(), 0);
  for (const std::vector<Vec3>& points :
       {std::vector<Vec3>{{1, 2, 3}}, std::vector<Vec3>{{0, 0, 0}, {5, 0, 0}}}) {
    for (int axis = 0; axis < 3; ++axis) {
      check_equal(view_of(points, axis).open_share(), 0);
      CHECK_FALSE(view_of(points, axis).encloses(points[0], 0.1));
    }
  }
}
