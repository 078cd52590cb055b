#include "core/sweep/field/field_lanes.hpp"

#include <bit>
#include <cmath>

#include "core/geometry/triangle_box.hpp"
#include "core/sweep/field/model_field.hpp"
#include "core/trajectory/motion_tree.hpp"
#include "core/util/lane_bits.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/surface_scene.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// Looks up random points in lanes and one by one. Some of them lie near the model, some beyond the
/// bricks and some outside of the lattice, which coordinates without a value do as well.
void check_lanes(const ModelField& field, const Box& box) {
  const std::vector<Pose> poses = {translation({0, 0, 0}),
                                   {{0, -1, 0, 1, 0, 0, 0, 0, 1}, {3, -2, 0.5}}};
  const MotionTree motion(poses, box, false);
  const ModelFieldRef ref = field.ref();
  FieldLanes lanes(ref);
  Random random(5);
  std::uint64_t wrong = 0, far = 0, near = 0;
  for (int round = 0; round < 400; ++round) {
    const InversePose& back = motion.inverse_pose(round % 2);
    const std::uint32_t count = 1 + round % FieldLanes::kMost;
    const double size = round % 5 == 0 ? 30 : round % 5 == 1 ? 3 : 0.7;
    const Box around = Box{box.centre(), box.centre()}.grown(size);
    lanes.clear();
    std::vector<Vec3> points;
    for (std::uint32_t i = 0; i < count; ++i) {
      Vec3 x = random_point(random, around);
      if (round % 7 == 0 && i % 9 == 0) x.x = i % 2 == 0 ? std::nan("") : 1e300;
      lanes.add(points.emplace_back(transform(poses[round % 2], x)));
    }
    check_equal(lanes.count(), count);
    lanes.look_up(back);
    const double reach = uniform(random, 0.25, 0.75);
    const std::uint64_t within = lanes.within(back.least, reach);
    for (std::uint32_t i = 0; i < count; ++i) {
      const ModelFieldRef::Bounds bounds = ref.bounds(back.apply(points[i]));
      const double lower = lanes.squared_lower(i);
      wrong +=
          lower != bounds.squared_lower && !(std::isnan(lower) && std::isnan(bounds.squared_lower));
      wrong += lanes.near(i) != bounds.near;
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

TEST_CASE("many places are looked up as one by one, in fields of points and of a surface") {
  std::vector<Vec3> rod;
  for (int i = 0; i < 200; ++i) rod.push_back({0.02 * i, 0.3 * std::sin(0.1 * i), 1});
  const ModelTree tree(rod);
  for (const bool by_need : {false, true}) {
    for (const double reach : {0.0, 2.0}) {
      CAPTURE(by_need, reach);
      check_lanes(ModelField(tree, 0.2, {.reach = reach, .by_need = by_need}, 1), tree.box());
    }
  }
  const Surface box = box_surface({{0, 0, 0}, {4, 2, 1.5}});
  const TriangleTree surface(triangles_of({box.vertices, box.triangles}));
  check_lanes(ModelField(surface, 0.2, {.by_need = true}, 1), surface.box());
}

TEST_CASE("bytes are packed into bits") {
  Random random(1);
  for (int round = 0; round < 100; ++round) {
    const std::uint64_t bits = round == 0 ? 0 : round == 1 ? ~std::uint64_t{0} : random();
    std::uint8_t flags[64];
    for (int i = 0; i < 64; ++i) flags[i] = bits >> i & 1;
    std::uint64_t again = 0;
    for_each_bit(packed_bits(flags), [&](std::uint32_t i) { again |= std::uint64_t{1} << i; });
    check_equal(again, bits);
  }
}
