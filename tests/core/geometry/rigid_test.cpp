#include "core/geometry/rigid.hpp"

#include <cmath>

#include "core/geometry/predicate.hpp"
#include "random_boxes.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

struct Long3 {
  long double x, y, z;
};

long double norm(const Long3& v) { return std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z); }

/// The rotated point R m, without the translation, with 64-bit mantissas.
Long3 rotate(const Pose& pose, const Vec3& m) {
  const auto row = [&](int k) {
    const double* const r = pose.rotation + 3 * k;
    return static_cast<long double>(r[0]) * m.x + static_cast<long double>(r[1]) * m.y +
           static_cast<long double>(r[2]) * m.z;
  };
  return {row(0), row(1), row(2)};
}

Pose random_pose(Random& random, double far) {
  Pose pose = random_rotation(random, random_point(random, {{-far, -far, -far}, {far, far, far}}));
  const std::uint64_t kind = below(random, 4);
  if (kind == 0) pose = printed_with_six_digits(pose);
  if (kind == 1) pose = stretched(pose, {uniform(random, 0, 3), uniform(random, -3, 3), 1});
  return pose;
}

Box random_model_box(Random& random) {
  const double size = std::exp(uniform(random, -4, 3));
  const double far = below(random, 3) == 0 ? 1e4 : size;
  return random_box(random, random_point(random, {{-far, -far, -far}, {far, far, far}}), size);
}

}  // namespace

TEST_CASE("stretches of known matrices; rigid is within 1e-4, and not mirrored") {
  struct Row {
    Vec3 by;
    bool is_rigid;
  };
  const Pose turned = rotation({0.6, 0, 0.8}, 1, {1, 2, 3});
  for (const Row& row : {Row{{1, 1, 1}, true}, Row{{1.00009, 0.99991, 1}, true},
                         Row{{1.00011, 1, 1}, false}, Row{{1, 0.99989, 1}, false},
                         Row{{1, 1, -1}, false}, Row{{0, 1, 1}, false}, Row{{0.5, 3, 2}, false}}) {
    const Stretch stretch = stretch_of(stretched(turned, row.by));
    const auto& [x, y, z] = row.by;
    CAPTURE(x, y, z);
    CHECK(is_rigid(stretch) == row.is_rigid);
    check_near(stretch.least, std::min({x, y, std::abs(z)}), 1e-6);
    check_near(stretch.greatest, std::max({x, y, std::abs(z)}), 1e-9);
    check_near(stretch.determinant, x * y * z, 1e-9);
  }
  CHECK(is_rigid(stretch_of(printed_with_six_digits(turned))));
}

TEST_CASE("stretches bound what a matrix does to any direction") {
  Random random(1);
  std::uint64_t wrong = 0;
  for (int trial = 0; trial < 20'000; ++trial) {
    const Pose pose = random_pose(random, 1);
    const Stretch stretch = stretch_of(pose);
    const double bound = greatest_stretch_bound(pose);
    wrong += bound < stretch.greatest * (1 - 2e-12);
    wrong += bound > stretch.greatest * (is_rigid(stretch) ? 1 + 1e-4 : 1.7321);
    for (int i = 0; i < 5; ++i) {
      const Vec3 d = random_direction(random);
      const long double factor = norm(rotate(pose, d)) / norm({d.x, d.y, d.z});
      wrong += factor > bound || factor > stretch.greatest || factor < stretch.least;
    }
  }
  check_equal(wrong, 0);
}

TEST_CASE("bounds of extreme matrices are never too small") {
  Pose pose{{}, {}};
  CHECK(greatest_stretch_bound(pose) >= 0);
  CHECK(greatest_stretch_bound(pose) < 1e-100);
  pose.rotation[0] = 1e-200;
  CHECK(greatest_stretch_bound(pose) >= 1e-200);
  pose.rotation[0] = pose.rotation[4] = 1e200;
  pose.rotation[1] = -1e200;
  CHECK(greatest_stretch_bound(pose) == std::numeric_limits<double>::infinity());
  Pose far = translation({1e308, 0, 0});
  far.rotation[0] = far.rotation[1] = 1e308;
  const Box box{{5, 5, 0}, {6, 6, 0}};
  for (const auto& [a, b] : {std::pair(far, translation({})), std::pair(translation({}), far)}) {
    CHECK(displacement_bound(box, a, b) == std::numeric_limits<double>::infinity());
  }
}

TEST_CASE("the rounding of a transform is bounded") {
  Random random(2);
  std::uint64_t wrong = 0;
  long double nearest = 0;  // the largest share of the bound that was reached
  for (int trial = 0; trial < 200'000; ++trial) {
    const Pose pose = random_pose(random, how_far(trial));
    const Box box = random_model_box(random);
    Vec3 reach{};
    for (int k = 0; k < 3; ++k) reach[k] = std::max(std::abs(box.lo[k]), std::abs(box.hi[k]));
    const Vec3 m = point_of(random, box), moved = transform(pose, m);
    const Long3 turned = rotate(pose, m);
    const long double exact[3] = {turned.x, turned.y, turned.z};
    const double bound = transform_rounding(reach, pose);
    for (int k = 0; k < 3; ++k) {
      const long double error = std::abs(exact[k] + pose.translation[k] - moved[k]);
      wrong += error > bound;
      nearest = std::max(nearest, error / bound);
    }
  }
  check_equal(wrong, 0);
  CHECK(nearest > 0.15L);
}

TEST_CASE("no model point moves more than the displacement bound") {
  Random random(3);
  std::uint64_t wrong = 0, tight = 0;
  for (int trial = 0; trial < 100'000; ++trial) {
    const double far = how_far(trial);
    const Pose a = random_pose(random, far);
    Pose b = below(random, 3) == 0 ? random_pose(random, far) : a;
    for (double& p : b.translation) p += uniform(random, -1, 1) * std::exp(uniform(random, -25, 1));
    if (below(random, 2) == 0) {
      for (double& r : b.rotation) r += uniform(random, -1e-6, 1e-6);
    }
    const Box box = random_model_box(random);
    const double bound = displacement_bound(box, a, b);
    wrong += !(bound >= 0);
    for (int i = 0; i < 8; ++i) {
      const Vec3 m = point_of(random, box), at = transform(a, m), to = transform(b, m);
      const long double moved =
          norm({static_cast<long double>(at.x) - to.x, static_cast<long double>(at.y) - to.y,
                static_cast<long double>(at.z) - to.z});
      wrong += moved > bound;
      tight += moved > 0.9L * bound;
    }
  }
  check_equal(wrong, 0);
  CHECK(tight > 50'000);
  const Pose pose = rotation({0, 0, 1}, 1, {5e6, 2e6, 1e3});  // equal poses: rounding only
  CHECK(displacement_bound({{-2, -2, -2}, {2, 2, 2}}, pose, pose) < 1e-7);
}
