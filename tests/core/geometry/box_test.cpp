#include "core/geometry/box.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/geometry/quantisation.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/scenes.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// A random point of the box, on its border in about half of the axes.
Vec3 point_of(Random& random, const Box& box) {
  Vec3 p = random_point(random, box);
  for (int k = 0; k < 3; ++k) {
    const std::uint64_t kind = below(random, 4);
    if (kind == 0) p[k] = box.lo[k];
    if (kind == 1) p[k] = box.hi[k];
    p[k] = std::clamp(p[k], box.lo[k], box.hi[k]);
  }
  return p;
}

Box random_box(Random& random, const Vec3& at, double size) {
  Box box{};
  for (int k = 0; k < 3; ++k) {
    box.lo[k] = at[k] + uniform(random, -size, size);
    box.hi[k] = below(random, 3) == 0 ? box.lo[k] : box.lo[k] + uniform(random, 0, size);
  }
  return box;
}

void nudge(Random& random, Vec3& p) {
  for (int k = 0; k < 3; ++k) {
    const std::uint64_t steps = below(random, 4);
    for (std::uint64_t i = 0; i < steps; ++i) p[k] = std::nextafter(p[k], i % 2 == 0 ? 1e9 : -1e9);
  }
}

}  // namespace

TEST_CASE("box bounds hold for the computed d2 itself, to the last bit") {
  Random random(1);
  std::uint64_t wrong = 0, tight = 0;
  for (int trial = 0; trial < 200'000; ++trial) {
    const double far = trial % 3 == 0 ? 0 : trial % 3 == 1 ? 1e3 : 5e6;
    const double size = std::exp(uniform(random, -20, 3));
    const Vec3 at{far, -far, far / 5e3};
    const Box box = random_box(random, at, size);
    Vec3 m = point_of(random, random_box(random, at, 2 * size));
    if (trial % 5 == 0) m = point_of(random, box);
    nudge(random, m);
    const double least = least_squared_distance(box, m);
    const double greatest = greatest_squared_distance(box, m);
    for (int i = 0; i < 8; ++i) {
      const double d2 = squared_distance(point_of(random, box), m);
      wrong += d2 < least;
      wrong += d2 > greatest;
      tight += d2 == least;
    }
  }
  check_equal(wrong, 0);
  CHECK(tight > 10'000);
}

TEST_CASE("box bounds are the distances to the nearest and the farthest corner") {
  Random random(2);
  for (int trial = 0; trial < 2'000; ++trial) {
    const Box box = random_box(random, {1, 2, 3}, 1);
    const Vec3 m = random_point(random, {{-2, -2, -2}, {5, 5, 5}});
    Vec3 nearest{};
    double farthest = 0;
    for (int k = 0; k < 3; ++k) nearest[k] = std::clamp(m[k], box.lo[k], box.hi[k]);
    for (int i = 0; i < 8; ++i) {
      const Vec3 corner{i & 1 ? box.hi.x : box.lo.x, i & 2 ? box.hi.y : box.lo.y,
                        i & 4 ? box.hi.z : box.lo.z};
      farthest = std::max(farthest, squared_distance(corner, m));
    }
    CHECK(least_squared_distance(box, m) == squared_distance(nearest, m));
    CHECK(greatest_squared_distance(box, m) == farthest);
  }
}

TEST_CASE("a box of one point has its distance") {
  Random random(3);
  for (int trial = 0; trial < 2'000; ++trial) {
    const Vec3 e = random_point(random, {{-5, -5, -5}, {5e6, 5, 5}});
    const Vec3 m = random_point(random, {{-5, -5, -5}, {5e6, 5, 5}});
    CHECK(least_squared_distance({e, e}, m) == squared_distance(e, m));
    CHECK(greatest_squared_distance({e, e}, m) == squared_distance(e, m));
  }
}

TEST_CASE("a box is never dismissed or taken for a point that is not a number") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Box box{{1, 1, 1}, {2, 2, 2}};
  CHECK_FALSE(least_squared_distance(box, Vec3{nan, 1, 1}) > 0.5);
  CHECK_FALSE(greatest_squared_distance(box, {nan, 1, 1}) < 100.0);
  const double infinity = std::numeric_limits<double>::infinity();
  CHECK(least_squared_distance(box, Vec3{infinity, 1, 1}) == infinity);
  CHECK(greatest_squared_distance(box, {-infinity, 1, 1}) == infinity);
}

namespace {

constexpr std::int64_t kLeast = std::numeric_limits<std::int32_t>::min();
constexpr std::int64_t kGreatest = std::numeric_limits<std::int32_t>::max();

std::int32_t between(Random& random, std::int64_t lo, std::int64_t hi) {
  return static_cast<std::int32_t>(
      lo + static_cast<std::int64_t>(below(random, static_cast<std::uint64_t>(hi - lo) + 1)));
}

QuantumBox random_cell(Random& random) {
  QuantumBox cell{};
  for (int k = 0; k < 3; ++k) {
    const std::int64_t extents[] = {0,     1,     2,         65534,     65535,
                                    65536, 65537, 1'000'000, kGreatest, kGreatest - kLeast};
    const std::int64_t extent = extents[below(random, std::size(extents))];
    cell.lo[k] = between(random, kLeast, kGreatest - extent);
    cell.hi[k] = static_cast<std::int32_t>(cell.lo[k] + extent);
  }
  return cell;
}

QuantumBox random_block(Random& random, const QuantumBox& cell) {
  QuantumBox block{};
  for (int k = 0; k < 3; ++k) {
    block.lo[k] = between(random, cell.lo[k], cell.hi[k]);
    if (below(random, 4) == 0) block.lo[k] = cell.lo[k];
    block.hi[k] = below(random, 4) == 0 ? block.lo[k] : between(random, block.lo[k], cell.hi[k]);
    if (below(random, 4) == 0) block.hi[k] = cell.hi[k];
  }
  return block;
}

}  // namespace

TEST_CASE("a decoded block box holds the block, lies in the cell and is tight") {
  Random random(1);
  std::uint64_t wrong = 0;
  for (int trial = 0; trial < 200'000; ++trial) {
    const QuantumBox cell = random_cell(random);
    const QuantumBox block = random_block(random, cell);
    const QuantumBox decoded = decode_block_box(cell, encode_block_box(cell, block));
    for (int k = 0; k < 3; ++k) {
      const std::int64_t extent = std::int64_t{cell.hi[k]} - cell.lo[k];
      const std::int64_t step = extent / 65535 + 1;
      wrong += decoded.lo[k] > block.lo[k] || decoded.hi[k] < block.hi[k];
      wrong += decoded.lo[k] < cell.lo[k] || decoded.hi[k] > cell.hi[k];
      wrong += std::int64_t{block.lo[k]} - decoded.lo[k] > step;
      wrong += std::int64_t{decoded.hi[k]} - block.hi[k] > step;
    }
  }
  check_equal(wrong, 0);
}

TEST_CASE("the larger of two block boxes by code is the larger when decoded") {
  // Uniting codes instead of boxes relies on this.
  Random random(3);
  std::uint64_t wrong = 0;
  for (int trial = 0; trial < 50'000; ++trial) {
    const QuantumBox cell = random_cell(random);
    BlockBox a{}, b{};
    for (int k = 0; k < 3; ++k) {
      a.lo[k] = a.hi[k] = static_cast<std::uint16_t>(below(random, 65536));
      b.lo[k] = b.hi[k] =
          static_cast<std::uint16_t>(std::min<std::uint64_t>(65535, a.lo[k] + below(random, 3)));
    }
    for (int k = 0; k < 3; ++k) {
      wrong += decode_block_box(cell, a).lo[k] > decode_block_box(cell, b).lo[k];
      wrong += decode_block_box(cell, a).hi[k] > decode_block_box(cell, b).hi[k];
    }
  }
  check_equal(wrong, 0);
}

TEST_CASE("the box of positions holds every position, whatever the scale") {
  Random random(4);
  std::uint64_t wrong = 0;
  for (int trial = 0; trial < 100'000; ++trial) {
    Quantisation quantisation{};
    for (int k = 0; k < 3; ++k) {
      quantisation.scale[k] = std::exp(uniform(random, -25, 3));
      quantisation.offset[k] = uniform(random, -1, 1) * std::exp(uniform(random, -5, 16));
    }
    const QuantumBox box = random_block(random, random_cell(random));
    const Box positions = position_box(quantisation, box);
    std::int32_t q[3];
    for (int k = 0; k < 3; ++k) q[k] = between(random, box.lo[k], box.hi[k]);
    const Vec3 p = position(quantisation, q[0], q[1], q[2]);
    for (int k = 0; k < 3; ++k) wrong += !(positions.lo[k] <= p[k] && p[k] <= positions.hi[k]);
  }
  check_equal(wrong, 0);
}

TEST_CASE("united boxes") {
  const QuantumBox a{{0, -5, 3}, {1, 5, 3}};
  const QuantumBox b{{-1, 0, 4}, {0, 9, 8}};
  const QuantumBox expected{{-1, -5, 3}, {1, 9, 8}};
  CHECK(a.united(b) == expected);
  CHECK(b.united(a) == expected);
  CHECK(a.united(a) == a);
}
