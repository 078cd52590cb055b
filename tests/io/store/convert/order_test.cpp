// The store's order of points, against a plain rewriting of the rule.
#include "io/files/xxh64.hpp"
#include "io/scans/point_reader.hpp"
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

// Files that are read in pieces, several at a time, and the memory or files in which points wait.
namespace {

/// A conversion of a LAS and a LAZ file of several pieces each, the LAZ with bytes behind its
/// points.
struct PiecedFiles : Conversion {
  PiecedFiles() {
    add_las("a.las", cube_cloud(150'000, -5000, 5000, 1));
    LazBytes compressed = laz_bytes(3, 150'000);
    compressed.chunks = {7001};
    add("b.laz", compressed.build());
  }
};

}  // namespace

TEST_CASE("pieces of a file hold its points and bytes in their order") {
  const PiecedFiles files;
  const auto& path = files.options.inputs[GENERATE(0u, 1u)];
  const auto reader = open_point_file(path);
  REQUIRE(reader->pieces() > 2);
  std::vector<Quantum> whole, parts;
  PointBatch batch;
  while (reader->read(batch)) whole.insert(whole.end(), batch.quanta.begin(), batch.quanta.end());
  const std::string bytes = bytes_of(path);
  std::uint64_t end = 0;
  for (std::size_t piece = 0; piece < reader->pieces(); ++piece) {
    PieceBytes from;
    reader->read_piece(piece, batch, &from);
    check_equal(batch.quanta.size(), reader->points_of_piece(piece));
    CHECK(batch.positions.empty());
    parts.insert(parts.end(), batch.quanta.begin(), batch.quanta.end());
    CHECK((piece == 0 || from.first == end));
    end = from.first + from.count;
    check_equal(std::memcmp(from.bytes.get(), bytes.data() + from.first, from.count), 0);
  }
  CHECK(parts == whole);
}

TEST_CASE("a store tells sizes and hashes of files read in pieces and of others") {
  PiecedFiles files;
  files.add_las("c.las", std::vector<Quantum>{});
  files.add("d.xyz", "1 2 3\n4 5 6\n");
  files.options.inputs[1] = files.options.inputs[0];
  const StoreReader store = files.store();
  std::vector<SourceFile> expected;
  for (const auto& input : files.options.inputs) {
    const std::string bytes = bytes_of(input);
    expected.push_back(
        {input.filename().string(), bytes.size(), xxh64(std::as_bytes(std::span(bytes)))});
  }
  CHECK(store.metadata().sources == expected);
}

TEST_CASE("points wait in files and the store is the same whatever the memory") {
  constexpr std::size_t kPoints = 1'000'000;
  Conversion conversion(1000);
  conversion.add_las("a.las", cube_cloud(kPoints, -5000, 5000, 1));
  conversion.options.memory_bytes = kLeastConversionMemory;
  CHECK(conversion.convert().temporary_bytes == kPoints * sizeof(DistributedPoint));
  const std::string bytes = bytes_of(conversion.options.output);
  conversion.options.memory_bytes = std::uint64_t{1} << 30;
  CHECK(conversion.convert().temporary_bytes == kPoints * sizeof(DistributedPoint));
  CHECK(bytes_of(conversion.options.output) == bytes);
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
