// The store's order of points, against a plain rewriting of the rule.
#include "io/files/xxh64.hpp"
#include "io/store/convert/distribute.hpp"
#include "io/store/convert/split_tree.hpp"
#include "support/bytes/laz/laz_samples.hpp"
#include "support/catch.hpp"
#include "support/clouds.hpp"
#include "support/compare.hpp"
#include "support/store_order.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

void check_order(const std::vector<Quantum>& points, std::uint32_t cell_points,
                 const Quantisation& quantisation) {
  Conversion conversion(cell_points);
  conversion.add_las("a.las", points, quantisation);
  const StoreReader store = conversion.store();
  CHECK(store.quantisation() == quantisation);
  std::vector<StoredPoint> ordered(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) ordered[i] = {i, points[i]};
  order_plainly(ordered, cell_points, quantisation);
  CHECK(stored_points(store) == ordered);
  CHECK(structure_faults(store).empty());
  check_equal(store.cells().size(), (points.size() + cell_points - 1) / cell_points);
}

}  // namespace

TEST_CASE("points stand in the order of the rule") {
  const Quantisation unlike{{0.001, 0.01, 0.0025}, {5e6, -2e6, 0.5}};
  std::uint64_t seed = 1;
  for (const std::size_t count : {1u, 2u, 64u, 65u, 1000u, 5003u, 20011u}) {
    for (const auto& [name, points] : hard_clouds(count, seed++)) {
      CAPTURE(name, count);
      check_order(points, count % 2 == 0 ? 64 : 1000, count % 3 == 0 ? unlike : kMillimetres);
    }
  }
}

TEST_CASE("points stand in the order of the rule for every size of cell, and in large buckets") {
  const auto points = hard_clouds(9000, 77)[6].points;
  for (const std::uint32_t cell_points : {64u, 65u, 100u, 1000u, 8999u, 9000u, 65536u, 1u << 20}) {
    CAPTURE(cell_points);
    check_order(points, cell_points, kMillimetres);
  }
  check_order(cube_cloud(150000, -2000, 2000, 9), 1000, kMillimetres);
}

TEST_CASE("a store tells sizes and hashes of files read in pieces and of others") {
  Conversion conversion;
  LazBytes laz = laz_bytes(3, 150'000);
  laz.chunks = {7001};
  const auto& [sx, sy, sz] = laz.las.scale;
  const auto& [x, y, z] = laz.las.offset;
  const Quantisation steps{{sx, sy, sz}, {x, y, z}};
  conversion.add_las("a.las", cube_cloud(150'000, -5000, 5000, 1), steps);
  conversion.add("b.laz", laz.build());  // with bytes behind its points
  conversion.add_las("c.las", std::vector<Quantum>{}, steps);
  conversion.add("d.xyz", "1 2 3\n4 5 6\n");
  conversion.options.cell_points = 10'000;
  const StoreReader store = conversion.store();
  std::vector<SourceFile> expected;
  for (const auto& input : conversion.options.inputs) {
    const std::string bytes = bytes_of(input);
    expected.push_back(
        {input.filename().string(), bytes.size(), xxh64(std::as_bytes(std::span(bytes)))});
  }
  CHECK(store.metadata().sources == expected);
  check_equal(store.metadata().source_points, {150'000, 150'000, 0, 2});
}

// Clouds of several buckets, and bins that hold more than a bucket.
namespace {

/// A cloud with more than a bucket's points in one place, more than a bucket's in one bin of the
/// counting grid, and sparse points over the whole range, which keep that grid coarse; all are
/// shuffled together.
std::vector<Quantum> lopsided_cloud() {
  std::vector<Quantum> points = cube_cloud(150'000, -2147483648LL, 2147483647LL, 1);
  const auto dense = cube_cloud(kBucketPoints + 100'000, 1'000'000, 1'200'000, 2);
  points.insert(points.end(), dense.begin(), dense.end());
  points.insert(points.end(), kBucketPoints + 50'000, Quantum{-5, 6, -7});
  std::shuffle(points.begin(), points.end(), std::mt19937_64(3));
  return points;
}

}  // namespace

TEST_CASE("bins that hold more than a bucket are refined, whatever threads and memory") {
  const auto points = lopsided_cloud();
  Conversion conversion(65536);
  conversion.add_las("a.las", points);
  conversion.options.threads = 1;
  conversion.options.memory_bytes = kLeastConversionMemory;
  {
    const StoreReader store = conversion.store();
    CHECK(store.top_tree().size() >= 5);
    CHECK(points_by_source(store) == points);
    CHECK(structure_faults(store).empty());
  }
  const std::string bytes = bytes_of(conversion.options.output);
  for (const auto& [threads, mebibytes] : {std::pair{2, 512}, {4, 4096}}) {
    conversion.options.threads = threads;
    conversion.options.memory_bytes = std::uint64_t(mebibytes) << 20;
    CHECK(conversion.converted_bytes() == bytes);
  }
}

TEST_CASE("cubes with more than a bucket's points are split further, none is shared") {
  auto points = cube_cloud(kBucketPoints + 1000, -16, 15, 5);
  const auto around = cube_cloud(300'000, -200, 200, 6);
  points.insert(points.end(), around.begin(), around.end());
  Conversion conversion(1000);
  conversion.add_las("a.las", points);
  conversion.options.regular_size = 0.050;
  const StoreReader store = conversion.store();
  CHECK(points_by_source(store) == points);
  CHECK(structure_faults(store).empty());
  for (const Cell& cell : store.cells()) {
    for (int k = 0; k < 3; ++k) {
      CHECK(std::floor(cell.box.lo[k] / 50.0) == std::floor(cell.box.hi[k] / 50.0));
    }
  }
}
