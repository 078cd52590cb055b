#include "core/geometry/box.hpp"

#include <cmath>
#include <limits>

#include "core/geometry/quantisation.hpp"
#include "random_boxes.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"

using namespace clearway;
using namespace clearway::test;

TEST_CASE(
    "box bounds are the computed d2 of the nearest and the farthest corner, to the last bit") {
  Random random(1);
  std::uint64_t wrong = 0;
  for (int trial = 0; trial < 60'000; ++trial) {
    const double far = how_far(trial), size = std::exp(uniform(random, -20, 3));
    const Vec3 at{far, -far, far / 5e3};
    const Box box = random_box(random, at, size);
    Vec3 m = point_of(random, trial % 5 == 0 ? box : random_box(random, at, 2 * size));
    for (int k = 0; k < 3; ++k) {
      if (below(random, 2) == 0) m[k] = std::nextafter(m[k], below(random, 2) == 0 ? 1e9 : -1e9);
    }
    Vec3 nearest{};
    double farthest = 0;
    for (int k = 0; k < 3; ++k) nearest[k] = std::clamp(m[k], box.lo[k], box.hi[k]);
    for (int i = 0; i < 8; ++i) {
      const Vec3 corner{i & 1 ? box.hi.x : box.lo.x, i & 2 ? box.hi.y : box.lo.y,
                        i & 4 ? box.hi.z : box.lo.z};
      farthest = std::max(farthest, squared_distance(corner, m));
    }
    const double least = least_squared_distance(box, m);
    const double greatest = greatest_squared_distance(box, m);
    wrong += least != squared_distance(nearest, m) || greatest != farthest;
    const double between = squared_distance(point_of(random, box), m);
    wrong += between < least || between > greatest;
  }
  check_equal(wrong, 0);
}

TEST_CASE("a box is never dismissed or taken for a point that is not a number") {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  const Box box{{1, 1, 1}, {2, 2, 2}};
  CHECK_FALSE(least_squared_distance(box, Vec3{kNan, 1, 1}) > 0.5);
  CHECK_FALSE(greatest_squared_distance(box, {kNan, 1, 1}) < 100.0);
  CHECK(least_squared_distance(box, Vec3{kInfinite, 1, 1}) == kInfinite);
  CHECK(greatest_squared_distance(box, {-kInfinite, 1, 1}) == kInfinite);
}

namespace {

constexpr std::int64_t kLeast = std::numeric_limits<std::int32_t>::min();
constexpr std::int64_t kGreatest = std::numeric_limits<std::int32_t>::max();

std::int32_t between(Random& random, std::int64_t lo, std::int64_t hi) {
  return static_cast<std::int32_t>(
      lo + static_cast<std::int64_t>(below(random, static_cast<std::uint64_t>(hi - lo) + 1)));
}

QuantumBox random_cell(Random& random) {
  constexpr std::int64_t kExtents[] = {0,     1,     2,         65534,     65535,
                                       65536, 65537, 1'000'000, kGreatest, kGreatest - kLeast};
  QuantumBox cell{};
  for (int k = 0; k < 3; ++k) {
    const std::int64_t extent = kExtents[below(random, std::size(kExtents))];
    cell.lo[k] = between(random, kLeast, kGreatest - extent);
    cell.hi[k] = static_cast<std::int32_t>(cell.lo[k] + extent);
  }
  return cell;
}

QuantumBox random_block(Random& random, const QuantumBox& cell) {
  QuantumBox block{};
  for (int k = 0; k < 3; ++k) {
    block.lo[k] = below(random, 4) == 0 ? cell.lo[k] : between(random, cell.lo[k], cell.hi[k]);
    block.hi[k] = below(random, 4) == 0 ? block.lo[k] : between(random, block.lo[k], cell.hi[k]);
    if (below(random, 4) == 0) block.hi[k] = cell.hi[k];
  }
  return block;
}

}  // namespace

TEST_CASE("a decoded block box holds the block, lies in the cell, is tight and keeps the order") {
  Random random(1);
  std::uint64_t wrong = 0;
  for (int trial = 0; trial < 100'000; ++trial) {
    const QuantumBox cell = random_cell(random);
    const QuantumBox block = random_block(random, cell);
    const QuantumBox decoded = decode_block_box(cell, encode_block_box(cell, block));
    // Uniting codes instead of boxes relies on that a larger code is a larger side.
    BlockBox a{}, b{};
    for (int k = 0; k < 3; ++k) {
      a.lo[k] = a.hi[k] = static_cast<std::uint16_t>(below(random, 65536));
      b.lo[k] = b.hi[k] =
          static_cast<std::uint16_t>(std::min<std::uint64_t>(65535, a.lo[k] + below(random, 3)));
    }
    const QuantumBox less = decode_block_box(cell, a), more = decode_block_box(cell, b);
    for (int k = 0; k < 3; ++k) {
      const std::int64_t step = (std::int64_t{cell.hi[k]} - cell.lo[k]) / 65535 + 1;
      wrong += decoded.lo[k] > block.lo[k] || decoded.hi[k] < block.hi[k];
      wrong += decoded.lo[k] < cell.lo[k] || decoded.hi[k] > cell.hi[k];
      wrong += std::int64_t{block.lo[k]} - decoded.lo[k] > step;
      wrong += std::int64_t{decoded.hi[k]} - block.hi[k] > step;
      wrong += less.lo[k] > more.lo[k] || less.hi[k] > more.hi[k];
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
  const QuantumBox a{{0, -5, 3}, {1, 5, 3}}, b{{-1, 0, 4}, {0, 9, 8}};
  const QuantumBox expected{{-1, -5, 3}, {1, 9, 8}};
  CHECK(a.united(b) == expected);
  CHECK(b.united(a) == expected);
}
