#include "io/store/convert/bin_counter.hpp"

#include <algorithm>

#include "support/catch.hpp"
#include "support/scenes.hpp"

using namespace clearway;

namespace {

/// Random points over the whole of int32, so that the lattice reaches as far as it can.
std::vector<LatticePoint> points_of(const Lattice& lattice, std::size_t count) {
  Random random(7);
  std::vector<LatticePoint> points;
  const auto any = [&] { return static_cast<std::int32_t>(static_cast<std::uint32_t>(random())); };
  for (std::size_t i = 0; i < count; ++i) points.push_back(lattice({any(), any(), any()}, i));
  points.push_back(lattice({INT32_MIN, INT32_MIN, INT32_MIN}, count));
  points.push_back(lattice({INT32_MAX, INT32_MAX, INT32_MAX}, count + 1));
  return points;
}

bool holds(const Bin& bin, const LatticePoint& point) {
  for (std::size_t k = 0; k < 4; ++k) {
    if (point[k] < bin.lo[k] || point[k] >= bin.hi[k]) return false;
  }
  return true;
}

void check_bins(const Lattice& lattice, std::size_t most_bins) {
  const std::vector<LatticePoint> points = points_of(lattice, 500);
  BinCounter first(4, most_bins);
  BinCounter second(4, most_bins);
  for (std::size_t i = 0; i < points.size(); ++i) (i % 3 == 0 ? first : second).add(points[i]);
  first.merge(second);
  const std::vector<Bin> bins = first.bins();
  CHECK(bins.size() <= most_bins);
  std::uint64_t counted = 0;
  for (const Bin& bin : bins) {
    const auto inside = std::count_if(points.begin(), points.end(),
                                      [&](const LatticePoint& p) { return holds(bin, p); });
    CHECK(bin.count == static_cast<std::uint64_t>(inside));
    counted += bin.count;
  }
  CHECK(counted == points.size());
}

}  // namespace

TEST_CASE("bins hold the points that they count") {
  for (const std::size_t most_bins : {1, 2, 30, 10000}) check_bins(Lattice(), most_bins);
}

TEST_CASE("bins of a regular lattice whose axes have different scales") {
  for (const std::array<std::uint64_t, 3>& cube : {std::array<std::uint64_t, 3>{1 << 20, 16, 1000},
                                                   {16, 16, std::uint64_t{1} << 32},
                                                   {(std::uint64_t{1} << 31) + 1, 17, 33}}) {
    check_bins(Lattice(cube), 10000);
  }
}
