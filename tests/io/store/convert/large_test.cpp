// Clouds of several buckets, and bins that hold more than a bucket.
#include <catch2/catch.hpp>

#include "io/store/convert/split_tree.hpp"
#include "support/clouds.hpp"
#include "support/store_order.hpp"

using namespace clearway;
using namespace clearway::test;

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

ConversionOptions with_budget(ConversionOptions options, int threads, std::uint64_t mebibytes) {
  options.threads = threads;
  options.memory_bytes = mebibytes << 20;
  return options;
}

}  // namespace

TEST_CASE("bins that hold more than a bucket are refined, whatever threads and memory") {
  const auto points = lopsided_cloud();
  const ScratchFolder folder;
  write_las(folder / "a.las", points);
  const auto options = conversion_of({folder / "a.las"}, folder / "a.h5", 65536);
  convert_quietly(with_budget(options, 1, kLeastConversionMemory >> 20));
  {
    const StoreReader store(folder / "a.h5");
    CHECK(store.top_tree().size() >= 5);
    CHECK(points_by_source(store) == points);
    CHECK(structure_faults(store).empty());
    CHECK(faults_of(store).empty());
  }
  const std::string bytes = bytes_of(folder / "a.h5");
  convert_quietly(with_budget(options, 2, 512));
  CHECK(bytes_of(folder / "a.h5") == bytes);
  convert_quietly(with_budget(options, 4, 4096));
  CHECK(bytes_of(folder / "a.h5") == bytes);
}

TEST_CASE("cubes with more than a bucket's points are split further, none is shared") {
  auto points = cube_cloud(kBucketPoints + 1000, -16, 15, 5);
  const auto around = cube_cloud(300'000, -200, 200, 6);
  points.insert(points.end(), around.begin(), around.end());
  const ScratchFolder folder;
  write_las(folder / "a.las", points);
  auto options = conversion_of({folder / "a.las"}, folder / "a.h5", 1000);
  options.regular_size = 0.050;
  convert_quietly(options);
  const StoreReader store(folder / "a.h5");
  CHECK(points_by_source(store) == points);
  CHECK(structure_faults(store).empty());
  for (const Cell& cell : store.cells()) {
    for (int k = 0; k < 3; ++k) {
      CHECK(std::floor(cell.box.lo[k] / 50.0) == std::floor(cell.box.hi[k] / 50.0));
    }
  }
}
