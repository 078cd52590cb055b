// Stores and results whose checksums hold, but which no Clearway wrote.
#include <hdf5.h>

#include "clearway/error.hpp"
#include "io/files/hdf5.hpp"
#include "support/catch.hpp"
#include "support/classed_scans.hpp"
#include "support/clouds.hpp"
#include "support/compare.hpp"
#include "support/leaks_of_hdf5.hpp"
#include "support/origins.hpp"
#include "support/result_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

struct SmallStore {
  SmallStore() {
    write_las(folder / "a.las", cube_cloud(300, -4000, 4000, 3));
    convert_quietly(conversion_of({folder / "a.las"}, path));
  }
  hdf5::Id open_to_change() const {
    return {H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose, "open"};
  }
  std::string refusal() const {
    try {
      const StoreReader store(path);
    } catch (const InputError& error) {
      return error.what();
    }
    return {};
  }

  ScratchFolder folder;
  std::filesystem::path path = folder / "a.h5";
};

/// Adds a dataset of these extents, chunked as given, in which nothing is written.
void put_empty_dataset(const hdf5::Id& file, const char* name, hid_t type, hsize_t rows,
                       hsize_t chunk_rows, bool checksum) {
  REQUIRE(H5Ldelete(file.get(), name, H5P_DEFAULT) >= 0);
  const hdf5::Id space(H5Screate_simple(1, &rows, nullptr), H5Sclose, name);
  const hdf5::Id list(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, name);
  hdf5::check(H5Pset_chunk(list.get(), 1, &chunk_rows), name);
  if (checksum) hdf5::check(H5Pset_fletcher32(list.get()), name);
  const hdf5::Id dataset(
      H5Dcreate2(file.get(), name, type, space.get(), H5P_DEFAULT, list.get(), H5P_DEFAULT),
      H5Dclose, name);
}

}  // namespace

TEST_CASE(
    "a dataset that declares more rows than the file holds is refused before memory is taken") {
  const SmallStore store;
  const hsize_t rows = GENERATE(hsize_t{1} << 20, hsize_t{1} << 40, (hsize_t{1} << 62) + 1);
  put_empty_dataset(store.open_to_change(), "cells/count", H5T_STD_U32LE, rows, 1024, true);
  CHECK_THAT(store.refusal(), Contains("cells") || Contains("count"));
  check_says(store.refusal(), store.path.string() + " ... room");
}

TEST_CASE("storage that Clearway does not write is refused") {
  const SmallStore store;
  SECTION("no checksum") {
    put_empty_dataset(store.open_to_change(), "cells/count", H5T_STD_U32LE, 5, 5, false);
    check_says(store.refusal(), "fletcher32");
  }
  SECTION("a chunk far larger than the dataset") {
    const hdf5::Id file = store.open_to_change();
    REQUIRE(H5Ldelete(file.get(), "sources/bytes", H5P_DEFAULT) >= 0);
    const hsize_t rows = 1, most = hsize_t{1} << 28;
    const hdf5::Id space(H5Screate_simple(1, &rows, &most), H5Sclose, "space");
    const hdf5::Id list(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, "list");
    hdf5::check(H5Pset_chunk(list.get(), 1, &most), "chunk");
    hdf5::check(H5Pset_fletcher32(list.get()), "checksum");
    H5Dclose(H5Dcreate2(file.get(), "sources/bytes", H5T_STD_U64LE, space.get(), H5P_DEFAULT,
                        list.get(), H5P_DEFAULT));
  }
  SECTION("numbers in another file") {
    const hdf5::Id file = store.open_to_change();
    REQUIRE(H5Ldelete(file.get(), "sources/bytes", H5P_DEFAULT) >= 0);
    const hsize_t rows = 1;
    const hdf5::Id space(H5Screate_simple(1, &rows, nullptr), H5Sclose, "space");
    const hdf5::Id list(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, "list");
    hdf5::check(H5Pset_external(list.get(), "/etc/passwd", 0, 8), "external");
    H5Dclose(H5Dcreate2(file.get(), "sources/bytes", H5T_STD_U64LE, space.get(), H5P_DEFAULT,
                        list.get(), H5P_DEFAULT));
  }
  check_says(store.refusal(), store.path.string());
}

TEST_CASE("links lead nowhere") {
  const SmallStore store, other;
  const std::string name = GENERATE("cells", "cells/count", "points/x", "sources", "blocks/box");
  CAPTURE(name);
  {
    const hdf5::Id file = store.open_to_change();
    REQUIRE(H5Ldelete(file.get(), name.c_str(), H5P_DEFAULT) >= 0);
    if (GENERATE(true, false)) {
      hdf5::check(H5Lcreate_external(other.path.c_str(), name.c_str(), file.get(), name.c_str(),
                                     H5P_DEFAULT, H5P_DEFAULT),
                  "link");
    } else {
      hdf5::check(H5Lcreate_soft("/tree/nodes", file.get(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT),
                  "link");
    }
  }
  check_says(store.refusal(), "found a link");
}

TEST_CASE("HDF5 does not see a superblock that is not Clearway's") {
  const SmallStore store;
  std::string bytes = bytes_of(store.path);
  SECTION("another version") {
    bytes[8] = 0;
    put_bytes(store.path, bytes);
    check_says(store.refusal(), "superblock of version 0");
  }
  SECTION("open when its writer was killed") {
    bytes[11] = 1;
    put_bytes(store.path, bytes);
    check_says(store.refusal(), "not closed");
  }
  SECTION("bytes behind the end") {
    put_bytes(store.path, bytes + "x");
    check_says(store.refusal(), "expected " + std::to_string(bytes.size()));
  }
  SECTION("a block of another program before it") {
    put_bytes(store.path, std::string(512, 'x') + bytes);
    check_says(store.refusal(), "not an HDF5 file");
  }
}

TEST_CASE("any stretch of a store or result that turns to zeros is noticed or changes nothing") {
  const LeaksOfHdf5 leaks;
  const SmallStore store;
  const std::uint64_t fingerprint = StoreReader(store.path).fingerprint();
  const auto points = stored_points(StoreReader(store.path));
  const std::string bytes = bytes_of(store.path);
  const std::size_t length = GENERATE(64, 512, 4096);
  for (std::size_t at = 0; at < bytes.size(); at += length / 4) {
    std::string zeroed = bytes;
    const std::size_t end = std::min(bytes.size(), at + length);
    std::fill(zeroed.begin() + static_cast<std::ptrdiff_t>(at),
              zeroed.begin() + static_cast<std::ptrdiff_t>(end), '\0');
    put_bytes(store.path, zeroed);
    INFO("bytes " << at << " to " << end);
    try {
      const StoreReader read(store.path);
      const auto read_points = stored_points(read);
      CHECK(read.fingerprint() == fingerprint);
      CHECK((read_points == points));
    } catch (const InputError&) {
    }
  }
}

TEST_CASE("rows of a result that turn to zeros, checksum and all, are noticed") {
  const LeaksOfHdf5 leaks;
  const ScratchFolder folder;
  ResultHeader header = sample_header(true);
  header.clearance = 0.5;
  const Collisions rows = sample_rows(header, 50);
  const Clearances clearance_rows = sample_clearances(header, 50);
  write_result(folder / "out.h5", header, rows, 1000, clearance_rows);
  const std::string bytes = bytes_of(folder / "out.h5");
  std::size_t noticed = 0;
  for (std::size_t at = 0; at < bytes.size(); at += 16) {
    std::string zeroed = bytes;
    const std::size_t end = std::min(bytes.size(), at + 1400);
    std::fill(zeroed.begin() + static_cast<std::ptrdiff_t>(at),
              zeroed.begin() + static_cast<std::ptrdiff_t>(end), '\0');
    put_bytes(folder / "out.h5", zeroed);
    INFO("bytes " << at << " to " << end);
    try {
      const ResultReader reader(folder / "out.h5");
      const Collisions read = read_rows(reader);
      RowStream<Clearances> clearances(reader);
      Clearances near, none;
      clearances.read(near);
      clearances.read(none);  // the hash is checked at the end
      CHECK(near.pose == clearance_rows.pose);
      CHECK(near.xyz == clearance_rows.xyz);
      CHECK(same_rows(read, rows));
    } catch (const InputError&) {
      ++noticed;
    }
  }
  CHECK(noticed > 100);
}

// Stores with classes, damaged byte by byte.

TEST_CASE("damaged classes are refused, by who asks for them and by verify") {
  const ScratchFolder folder;
  const auto points = cube_cloud(300, -4000, 4000, 3);
  write_classed(folder / "a.las", points, random_classes(points.size(), 9));
  convert_quietly(conversion_of({folder / "a.las"}, folder / "a.h5"));
  const auto expected = classes_by_source(StoreReader(folder / "a.h5"));
  const std::string bytes = bytes_of(folder / "a.h5");
  const LeaksOfHdf5 of_damaged_files;
  std::uint64_t unseen = 0;
  for (std::size_t at = 0; at < bytes.size(); at += 3) {
    std::string changed = bytes;
    changed[at] = static_cast<char>(changed[at] ^ 0x10);
    put_bytes(folder / "b.h5", changed);
    try {
      const StoreReader store(folder / "b.h5");
      if (!faults_of(store).empty()) continue;
      // A change that is not noticed must not change what is read.
      unseen += !store.has_classes() || classes_by_source(store) != expected;
    } catch (const InputError&) {
    }
  }
  check_equal(unseen, 0);
}

// Stores with origins, damaged byte by byte.

TEST_CASE("damaged origins are refused, by who asks for them and by verify") {
  const ScratchFolder folder;
  const auto points = cube_cloud(300, -4000, 4000, 3);
  write_las(folder / "a.las", points, {{0.001, 0.001, 0.001}, {0, 0, 0}});
  put_bytes(folder / "o.csv", "first,x,y,z\n0,1,2,3\n100,4,5,6\n200,-1,0,9\n");
  ConversionOptions options = conversion_of({folder / "a.las"}, folder / "a.h5");
  options.origins = folder / "o.csv";
  convert_quietly(options);
  const StoreReader sound(folder / "a.h5");
  const auto expected = origins_by_source(sound);
  const std::string bytes = bytes_of(folder / "a.h5");
  const LeaksOfHdf5 of_damaged_files;
  std::uint64_t unseen = 0, refused = 0;
  for (std::size_t at = 0; at < bytes.size(); at += 3) {
    std::string changed = bytes;
    changed[at] = static_cast<char>(changed[at] ^ 0x10);
    put_bytes(folder / "b.h5", changed);
    try {
      const StoreReader store(folder / "b.h5");
      if (!faults_of(store).empty()) {
        ++refused;
        continue;
      }
      // A change that is not noticed must not change what is read.
      unseen += !store.has_origins() || origins_by_source(store) != expected ||
                store.metadata().origins != sound.metadata().origins;
    } catch (const InputError&) {
      ++refused;
    }
  }
  check_equal(unseen, 0);
  CHECK(refused > 0);
}
