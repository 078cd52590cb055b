#include "core/sweep/field/field_lanes.hpp"

#include <cmath>
#include <random>

#include "core/sweep/field/model_field.hpp"
#include "core/trajectory/motion_tree.hpp"
#include "core/util/lane_bits.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/surface_scene.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

constexpr double kRadius = 0.2;

std::vector<Vec3> rod() {
  std::vector<Vec3> points;
  for (int i = 0; i < 200; ++i) points.push_back({0.02 * i, 0.3 * std::sin(0.1 * i), 1});
  return points;
}

/// Looks up random points in lanes and one by one. Some of them lie near the model, some beyond the
/// bricks and some outside of the lattice, which coordinates without a value do as well.
void check_lanes(const ModelField& field, const Box& box) {
  const std::vector<Pose> poses = {{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}},
                                   {{0, -1, 0, 1, 0, 0, 0, 0, 1}, {3, -2, 0.5}}};
  const MotionTree motion(poses, box, false);
  const ModelFieldRef ref = field.ref();
  FieldLanes lanes(ref);
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::uint64_t wrong = 0, far = 0, near = 0;
  for (int round = 0; round < 400; ++round) {
    const InversePose& back = motion.inverse_pose(round % 2);
    const std::uint32_t count = 1 + round % FieldLanes::kMost;
    const double size = round % 5 == 0 ? 30 : round % 5 == 1 ? 3 : 0.7;
    lanes.clear();
    std::vector<Vec3> points;
    for (std::uint32_t i = 0; i < count; ++i) {
      const Vec3 centre = box.centre();
      Vec3 x{centre.x + size * unit(random), centre.y + size * unit(random),
             centre.z + size * unit(random)};
      if (round % 7 == 0 && i % 9 == 0) x.x = i % 2 == 0 ? std::nan("") : 1e300;
      points.push_back(transform(poses[round % 2], x));
      lanes.add(points.back());
    }
    check_equal(lanes.count(), count);
    lanes.look_up(back);
    const double reach = 0.25 + 0.5 * std::abs(unit(random));
    const std::uint64_t within = lanes.within(back.least, reach);
    for (std::uint32_t i = 0; i < count; ++i) {
      const Vec3 x = back.apply(points[i]);
      const ModelFieldRef::Bounds bounds = ref.bounds(x);
      const bool same_bound =
          lanes.squared_lower(i) == bounds.squared_lower ||
          (std::isnan(lanes.squared_lower(i)) && std::isnan(bounds.squared_lower));
      wrong += !same_bound || lanes.near(i) != bounds.near;
      const bool is_far = farther(back.least, bounds.squared_lower, reach);
      wrong += is_far == ((within >> i & 1) != 0);
      (is_far ? far : near) += 1;
    }
    if (count < 64) wrong += within >> count != 0;
    check_equal(lanes.within(back.least, 1e200), ~std::uint64_t{0} >> (64 - count));
  }
  check_equal(wrong, 0);
  CHECK(far > 1000);
  CHECK(near > 1000);
}

}  // namespace

TEST_CASE("many places are looked up as one by one") {
  const ModelTree tree(rod());
  for (const bool by_need : {false, true}) {
    for (const double reach : {0.0, 2.0}) {
      CAPTURE(by_need, reach);
      check_lanes(ModelField(tree, kRadius, {.reach = reach, .by_need = by_need}, 1), tree.box());
    }
  }
}

TEST_CASE("many places are looked up as one by one in a field of a surface") {
  const Surface surface = box_surface({{0, 0, 0}, {4, 2, 1.5}});
  std::vector<Triangle> model;
  for (std::size_t i = 0; i < surface.triangles.size(); ++i) model.push_back(surface.at(i));
  const TriangleTree tree(model);
  check_lanes(ModelField(tree, kRadius, {.by_need = true}, 1), tree.box());
}

TEST_CASE("bytes are packed into bits") {
  std::mt19937_64 random(1);
  for (int round = 0; round < 100; ++round) {
    const std::uint64_t bits = round == 0 ? 0 : round == 1 ? ~std::uint64_t{0} : random();
    std::uint8_t flags[64];
    for (int i = 0; i < 64; ++i) flags[i] = bits >> i & 1;
    std::uint64_t again = 0;
    for_each_bit(packed_bits(flags), [&](std::uint32_t i) { again |= std::uint64_t{1} << i; });
    check_equal(again, bits);
  }
}
