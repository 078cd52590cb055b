#include "core/geometry/rigid.hpp"

#include <algorithm>
#include <cmath>

#include "core/geometry/predicate.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/scenes.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

struct Long3 {
  long double x, y, z;
};

long double length(const Long3& v) { return std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z); }

/// The rotated point R m, without the translation, with 64-bit mantissas.
Long3 rotate(const Pose& pose, const Long3& m) {
  const double* r = pose.rotation;
  return {r[0] * m.x + r[1] * m.y + r[2] * m.z, r[3] * m.x + r[4] * m.y + r[5] * m.z,
          r[6] * m.x + r[7] * m.y + r[8] * m.z};
}

long double distance(const Vec3& a, const Vec3& b) {
  return length({static_cast<long double>(a.x) - b.x, static_cast<long double>(a.y) - b.y,
                 static_cast<long double>(a.z) - b.z});
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
  Box box{};
  for (int k = 0; k < 3; ++k) {
    box.lo[k] = uniform(random, -far, far);
    box.hi[k] = below(random, 4) == 0 ? box.lo[k] : box.lo[k] + uniform(random, 0, size);
  }
  return box;
}

Vec3 random_point_of(Random& random, const Box& box) {
  Vec3 p = random_point(random, box);
  for (int k = 0; k < 3; ++k) {
    const std::uint64_t kind = below(random, 3);
    if (kind == 0) p[k] = box.lo[k];
    if (kind == 1) p[k] = box.hi[k];
    p[k] = std::clamp(p[k], box.lo[k], box.hi[k]);
  }
  return p;
}

}  // namespace

TEST_CASE("singular values of known matrices") {
  const Stretch rigid = stretch_of(rotation({0, 0, 1}, 0.3, {5, 6, 7}));
  CHECK(rigid.least == Approx(1).epsilon(1e-9));
  CHECK(rigid.greatest == Approx(1).epsilon(1e-9));
  CHECK(rigid.determinant == Approx(1).epsilon(1e-9));
  CHECK(is_rigid(rigid));

  const Stretch wide = stretch_of(stretched(rotation({0, 1, 0}, 2, {0, 0, 0}), {0.5, 3, 2}));
  CHECK(wide.least == Approx(0.5));
  CHECK(wide.greatest == Approx(3));
  CHECK(wide.determinant == Approx(3));
}

TEST_CASE("rigid is within 1e-4, and not mirrored") {
  const Pose turned = rotation({0.6, 0, 0.8}, 1, {1, 2, 3});
  CHECK(is_rigid(stretch_of(printed_with_six_digits(turned))));
  CHECK(is_rigid(stretch_of(stretched(turned, {1.00009, 0.99991, 1}))));
  CHECK_FALSE(is_rigid(stretch_of(stretched(turned, {1.00011, 1, 1}))));
  CHECK_FALSE(is_rigid(stretch_of(stretched(turned, {1, 0.99989, 1}))));
  CHECK_FALSE(is_rigid(stretch_of(stretched(turned, {1, 1, -1}))));
  CHECK_FALSE(is_rigid(stretch_of(stretched(turned, {0, 1, 1}))));
}

TEST_CASE("stretches bound what a matrix does to any direction") {
  Random random(1);
  std::uint64_t wrong = 0;
  for (int trial = 0; trial < 20'000; ++trial) {
    const Pose pose = random_pose(random, 1);
    const Stretch stretch = stretch_of(pose);
    const double bound = greatest_stretch_bound(pose);
    wrong += bound < stretch.greatest * (1 - 2e-12);
    wrong += bound > stretch.greatest * 1.7321;
    if (is_rigid(stretch)) wrong += bound > stretch.greatest * (1 + 1e-4);
    for (int i = 0; i < 5; ++i) {
      const Vec3 d = random_direction(random);
      const Long3 direction{d.x, d.y, d.z};
      const long double factor = length(rotate(pose, direction)) / length(direction);
      wrong += factor > bound || factor > stretch.greatest || factor < stretch.least;
    }
  }
  check_equal(wrong, 0);
}

TEST_CASE("the stretch bound of extreme matrices is never too small") {
  const Pose zero{{}, {}};
  CHECK(greatest_stretch_bound(zero) >= 0);
  CHECK(greatest_stretch_bound(zero) < 1e-100);
  Pose tiny{{}, {}};
  tiny.rotation[0] = 1e-200;
  CHECK(greatest_stretch_bound(tiny) >= 1e-200);
  Pose huge{{}, {}};
  huge.rotation[0] = huge.rotation[4] = 1e200;
  huge.rotation[1] = -1e200;
  CHECK(greatest_stretch_bound(huge) == std::numeric_limits<double>::infinity());
}

TEST_CASE("the rounding of a transform is bounded") {
  Random random(2);
  std::uint64_t wrong = 0;
  long double nearest = 0;  // the largest share of the bound that was reached
  for (int trial = 0; trial < 200'000; ++trial) {
    const double far = trial % 3 == 0 ? 1 : trial % 3 == 1 ? 1e3 : 5e6;
    const Pose pose = random_pose(random, far);
    const Box box = random_model_box(random);
    Vec3 reach{};
    for (int k = 0; k < 3; ++k) reach[k] = std::max(std::abs(box.lo[k]), std::abs(box.hi[k]));
    const Vec3 m = random_point_of(random, box);
    const Vec3 moved = transform(pose, m);
    const Long3 turned = rotate(pose, {m.x, m.y, m.z});
    const long double exact[3] = {turned.x + pose.translation[0], turned.y + pose.translation[1],
                                  turned.z + pose.translation[2]};
    const double bound = transform_rounding(reach, pose);
    for (int k = 0; k < 3; ++k) {
      const long double error = std::abs(exact[k] - moved[k]);
      wrong += error > bound;
      nearest = std::max(nearest, error / bound);
    }
  }
  check_equal(wrong, 0);
  CHECK(nearest > 0.15L);
  CHECK(nearest < 1.0L);
}

TEST_CASE("no model point moves more than the displacement bound") {
  Random random(3);
  std::uint64_t wrong = 0, tight = 0;
  for (int trial = 0; trial < 100'000; ++trial) {
    const double far = trial % 3 == 0 ? 1 : trial % 3 == 1 ? 1e3 : 5e6;
    const Pose a = random_pose(random, far);
    Pose b = below(random, 3) == 0 ? random_pose(random, far) : a;
    for (double& p : b.translation) p += uniform(random, -1, 1) * std::exp(uniform(random, -25, 1));
    if (below(random, 2) == 0) {
      for (double& r : b.rotation) r += uniform(random, -1e-6, 1e-6);
    }
    const Box box = random_model_box(random);
    const double bound = displacement_bound(box, a, b);
    CHECK(bound >= 0);
    for (int i = 0; i < 8; ++i) {
      const Vec3 m = random_point_of(random, box);
      const long double moved = distance(transform(a, m), transform(b, m));
      wrong += moved > bound;
      tight += moved > 0.9L * bound;
    }
  }
  check_equal(wrong, 0);
  CHECK(tight > 50'000);
}

TEST_CASE("the displacement between equal poses is rounding only") {
  const Pose pose = rotation({0, 0, 1}, 1, {5e6, 2e6, 1e3});
  const double bound = displacement_bound({{-2, -2, -2}, {2, 2, 2}}, pose, pose);
  CHECK(bound >= 0);
  CHECK(bound < 1e-7);
}

TEST_CASE("displacements that overflow are unbounded, not nothing") {
  Pose far = translation({1e308, 0, 0});
  far.rotation[0] = far.rotation[1] = 1e308;
  const Box box{{5, 5, 0}, {6, 6, 0}};
  CHECK(displacement_bound(box, far, translation({0, 0, 0})) ==
        std::numeric_limits<double>::infinity());
  CHECK(displacement_bound(box, translation({0, 0, 0}), far) ==
        std::numeric_limits<double>::infinity());
}
