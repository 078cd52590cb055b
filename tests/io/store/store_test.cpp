// Stores as they are read, and files that are none.
#include <hdf5.h>

#include "io/store/store_writer.hpp"
#include "support/catch.hpp"
#include "support/change_hdf5.hpp"
#include "support/clouds.hpp"
#include "support/compare.hpp"
#include "support/result_fixture.hpp"
#include "support/store_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// A store of a few cells.
struct ReadStore : Conversion {
  explicit ReadStore(std::size_t points) {
    add_las("a.las", cube_cloud(points, -4000, 4000, 3));
    convert();
  }
};

/// A store of two scans, of 100 and of 250 points.
struct TwoScans : ReadStore {
  TwoScans() : ReadStore(100) {
    add_las("b.las", cube_cloud(250, -4000, 4000, 4));
    convert();
  }
};

std::string refusal_of_store(const std::filesystem::path& path) {
  try {
    StoreReader{path};
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

}  // namespace

TEST_CASE("a damaged chunk is named when its cell is read") {
  const ReadStore small(300);
  std::string bytes = bytes_of(small.options.output);
  bytes[StoreReader(small.options.output).index().address[4 * 2 + 1] + 30] ^= 4;
  put_bytes(small.options.output, bytes);
  const StoreReader store(small.options.output);
  CHECK_NOTHROW(store.coordinates(1));
  // A block is read first, so that no other call has checked the cell before.
  const std::string refusal = small.options.output.string() + " ... cell 2 ... 'y' ... damaged";
  check_refused<InputError>([&] { return store.coordinates_of_block(2); }, refusal);
  check_refused<InputError>([&] { return store.coordinates(2); }, refusal);
  CHECK_NOTHROW(store.sources(2));
  check_equal(faults_of(store).size(), 1);
}

TEST_CASE("a store that another tool copied is refused with advice") {
  const ReadStore store(300);
  const auto path = store.options.output;
  const std::string repack =
      "h5repack '" + path.string() + "' '" + (store.folder / "packed.h5").string() + "'";
  if (std::system("command -v h5repack >/dev/null") == 0) {
    REQUIRE(std::system(repack.c_str()) == 0);
    check_says(refusal_of_store(store.folder / "packed.h5"), "Another tool");
  }
  {
    const hdf5::Id file = open_to_change(path);
    const auto copied =
        H5Ocopy(file.get(), "points/x", file.get(), "moved", H5P_DEFAULT, H5P_DEFAULT);
    hdf5::check(copied, "copy");
    hdf5::check(H5Ldelete(file.get(), "points/x", H5P_DEFAULT), "delete");
    const auto moved =
        H5Lmove(file.get(), "moved", file.get(), "points/x", H5P_DEFAULT, H5P_DEFAULT);
    hdf5::check(moved, "move");
  }
  check_says(refusal_of_store(path), "Another tool ... convert the scans again");
}

TEST_CASE("a file that is no store, or no whole one, is refused") {
  const ScratchFolder folder;
  put_bytes(folder / "text.h5", "no HDF5 file");
  put_bytes(folder / "empty.h5", "");
  const ResultHeader header = sample_header(false);
  write_result(folder / "result.h5", header, sample_rows(header, 10));
  hdf5::create_file(folder / "other.h5");
  const StoreMetadata metadata{.point_count = 100,
                               .input_points = 100,
                               .cell_points = 64,
                               .quantisation = kMillimetres,
                               .layout = "adaptive",
                               .crs_wkt = {},
                               .sources = {}};
  { StoreWriter(folder / "begun.h5", metadata, 2); }
  for (const auto& [file, words] : {std::pair("text.h5", "text.h5 ... not an HDF5 file"),
                                    {"empty.h5", "not an HDF5 file"},
                                    {"result.h5", "not a store"},
                                    {"other.h5", "not a store"},
                                    {"begun.h5", "unfinished"}}) {
    check_says(refusal_of_store(folder / file), words);
  }
  CHECK_THROWS_AS(StoreReader(folder / "none.h5"), ResourceError);
}

TEST_CASE("the fingerprint tells stores apart, not names") {
  const auto fingerprint = [](std::size_t points) {
    return StoreReader(ReadStore(points).options.output).fingerprint();
  };
  CHECK(fingerprint(300) == fingerprint(300));
  CHECK(fingerprint(300) != fingerprint(301));
}

TEST_CASE("a store counts the cells that were touched, and every byte that it hands out") {
  const ReadStore small(300);
  const StoreReader store(small.options.output);
  check_equal(store.cells_touched(), 0);
  store.coordinates(3);
  store.coordinates(3);
  store.coordinates(0);
  store.peek(1);
  store.position_of(2, 5);
  check_equal(store.cells_touched(), 2);
  CHECK(store.bytes_read().coordinates == 2 * store.packed_bytes(3) + store.packed_bytes(0) +
                                              store.packed_bytes(1) + 3 * sizeof(std::int32_t));
  check_equal(store.bytes_read().sources, 0);
  const auto& bytes = store.index().bytes;
  store.sources(3);
  store.sources(3);
  store.source_of(0, 7);
  CHECK(store.bytes_read().sources == 2 * bytes[4 * 3 + 3] + sizeof(std::uint64_t));
  check_equal(store.bytes_read().classes + store.bytes_read().origins, 0);
}

TEST_CASE("a store of several scans knows how many points each has, as that of one does") {
  const TwoScans scans;
  check_equal(faults_of(StoreReader(scans.options.output)), {});
  const StoreMetadata two = StoreReader(scans.options.output).metadata();
  check_equal(two.source_points, {100, 250});
  check_equal(two.points_of_source(1), 250u);
  const StoreMetadata one = StoreReader(ReadStore(100).options.output).metadata();
  CHECK(one.source_points.empty());
  check_equal(one.points_of_source(0), 100u);
  // Version 0.1.0 wrote no such dataset.
  remove_link(scans.options.output, "/sources/points");
  CHECK_FALSE(StoreReader(scans.options.output).metadata().points_of_source(0));
}

TEST_CASE("counts of points that do not add up are refused") {
  using Counts = std::vector<std::uint64_t>;
  const TwoScans scans;
  for (const Counts& counts : {Counts{100, 251}, {350}, {0, 0}, {351, ~0ull}}) {
    replace_dataset(scans.options.output, "/sources/points", counts);
    check_says(refusal_of_store(scans.options.output), "points'");
  }
}
