// Stores as they are read, and files that are none.
#include <hdf5.h>

#include "io/store/store_writer.hpp"
#include "support/catch.hpp"
#include "support/change_header.hpp"
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
  bytes[StoreReader(small.options.output).chunks().of(kY, 2).address + 30] ^= 4;
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
                                    {"begun.h5", "not complete ... convert again"}}) {
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
  const auto& bytes = store.chunks()[0].bytes;
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
  change_header(scans.options.output, [](Json& header) { header.erase("source_points"); });
  CHECK_FALSE(StoreReader(scans.options.output).metadata().points_of_source(0));
}

TEST_CASE("a scan whose name is not UTF-8 is known again") {
  Conversion scan;
  scan.add_las(
      "f\xfc"
      "nf.las",
      cube_cloud(100, -4000, 4000, 3));
  scan.convert();
  check_equal(StoreReader(scan.options.output).metadata().sources[0].name, "f\xef\xbf\xbdnf.las");
  CHECK(is_converted_by(scan.options));
}

TEST_CASE("facts of a store that contradict each other are refused, though their hash is right") {
  const TwoScans scans;
  const auto path = scans.options.output;
  const std::string bytes = bytes_of(path);
  using Counts = std::vector<std::uint64_t>;
  const auto check = [&](const char* fact, const Json& value) {
    INFO(fact << ": " << value);
    put_bytes(path, bytes);
    change_header(path, [&](Json& header) { header[fact] = value; });
    check_says(refusal_of_store(path), std::string(fact));
  };
  for (const Counts& counts : {Counts{100, 251}, {350}, {0, 0}, {351, ~0ull}}) {
    check("source_points", counts);
  }
  check("scale", {1, 0, 1});
  check("scale", {1, nullptr, 1});
  check("offset", {1, 2});
  check("steps", {0, 0, -1});
  check("cell_points", 0);
  check("cell_points", (1 << 20) + 1);
  check("cell_points", -1);
  check("input_points", 349);
  check("points_hash", 1.5);
  check("sources", "a.las");
  check("warnings", nullptr);
  check("dates", {{"first", "2024-05-31"}, {"last", "yesterday"}});
  check("withheld", {{"points", 1}, {"kept", false}});
  check("near", {{"within", -1}});
  check("classes", {{"hash", 1}, {"points", Counts(256, 1)}});
  check("origins", {{"hash", 1}, {"rest_on", {{{"what", "poses"}, {"points", 351}}}}});
  for (const char* fact : {"point_count", "layout", "options", "crs_wkt", "length_unit"}) {
    put_bytes(path, bytes);
    change_header(path, [&](Json& header) { header.erase(fact); });
    check_says(refusal_of_store(path), std::string(fact));
  }
}

TEST_CASE("an index that contradicts itself is refused, though its hashes are right") {
  const ReadStore store(300);
  const auto path = store.options.output;
  const std::string bytes = bytes_of(path);
  const auto check = [&]<typename Value>(const std::string& words, const char* column,
                                         std::size_t at, Value value) {
    INFO(words);
    put_bytes(path, bytes);
    std::vector<Value> values = values_of_column<Value>(path, column);
    values.at(at) = value;
    change_column(path, column, values);
    check_says(refusal_of_store(path), words);
  };
  check("cell 1 has 0 points", "cells/count", 1, std::uint32_t{0});
  check("cell 1 has 65 points", "cells/count", 1, std::uint32_t{65});
  check("its cells hold 299 points, expected 300", "cells/count", 0, std::uint32_t{63});
  check("cell 2 has an inverted box", "cells/box", 12, std::int32_t{1 << 30});
  check("past the end of the file", "cells/address", 7, std::uint64_t{1} << 40);
  check("past the end of the file", "cells/bytes", 7, ~std::uint32_t{0});
  check("Another tool", "cells/address", 0, std::uint64_t{64});
  put_bytes(path, bytes);
  auto sizes = values_of_column<std::uint32_t>(path, "cells/bytes");
  sizes.resize(sizes.size() - 4);
  change_column(path, "cells/bytes", sizes);
  check_says(refusal_of_store(path), "other cells than it counts");
}
