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

ModelView view_of(const std::vector<Vec3>& points, int axis, double cell = 0.2) {
  return {points, box_of(points), axis, cell};
}

const Vec3 kMiddle{1, 1, 1};

}  // namespace

TEST_CASE("a model is open along an axis along which one sees through it, and closed from others") {
  for (int axis = 0; axis < 3; ++axis) {
    CAPTURE(axis);
    const auto closed = cube([](int, int, int) { return true; });
    const ModelView view = view_of(closed, axis);
    check_equal(view.open_share(), 0);
    CHECK(view.encloses(kMiddle, 0.1));
    CHECK_FALSE(view.encloses(kMiddle, 1.01));
    Vec3 near = kMiddle;
    near[axis] = 0.05;
    CHECK_FALSE(view.encloses(near, 0.1));
    const auto tube = cube([&](int i, int j, int k) {
      const int along[] = {i, j, k};
      return along[(axis + 1) % 3] % 20 == 0 || along[(axis + 2) % 3] % 20 == 0;
    });
    for (int other = 0; other < 3; ++other) {
      CHECK((view_of(tube, other).open_share() > 0.5) == (other == axis));
      CHECK(view_of(tube, other).encloses(kMiddle, 0.1) == (other != axis));
    }
    check_equal(view_of(tube, axis, 0.5).open_share(), 0);  // a view of few cells tells nothing
    for (const auto& points : {std::vector<Vec3>{{1, 2, 3}}, {{0, 0, 0}, {5, 0, 0}}}) {
      check_equal(view_of(points, axis).open_share(), 0);
      CHECK_FALSE(view_of(points, axis).encloses(points[0], 0.1));
    }
  }
}

TEST_CASE("what is open to a side is no hole") {
  // The model is a gantry: two legs and a roof, seen from the front.
  const auto gantry = cube([](int, int j, int k) { return j % 20 == 0 || k == 20; });
  check_equal(view_of(gantry, 0).open_share(), 0);
  CHECK_FALSE(view_of(gantry, 2).encloses(kMiddle, 0.1));
}
