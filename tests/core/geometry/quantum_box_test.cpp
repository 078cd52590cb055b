#include <algorithm>
#include <catch2/catch.hpp>
#include <limits>

#include "core/geometry/quantisation.hpp"
#include "support/scenes.hpp"

using namespace clearway;

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
  CHECK(wrong == 0);
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
  CHECK(wrong == 0);
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
  CHECK(wrong == 0);
}

TEST_CASE("united boxes") {
  const QuantumBox a{{0, -5, 3}, {1, 5, 3}};
  const QuantumBox b{{-1, 0, 4}, {0, 9, 8}};
  const QuantumBox expected{{-1, -5, 3}, {1, 9, 8}};
  CHECK(a.united(b) == expected);
  CHECK(b.united(a) == expected);
  CHECK(a.united(a) == a);
}
