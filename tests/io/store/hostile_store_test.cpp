// Stores that are damaged, and stores whose checksums hold, but which no Clearway wrote.
#include <hdf5.h>

#include <functional>

#include "support/bytes/las_bytes.hpp"
#include "support/catch.hpp"
#include "support/change_header.hpp"
#include "support/clouds.hpp"
#include "support/compare.hpp"
#include "support/leaks_of_hdf5.hpp"
#include "support/store_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// Everything that a store holds, once it is found sound.
struct Content {
  explicit Content(const std::filesystem::path& path) {
    const StoreReader store(path);
    const auto faults = faults_of(store);
    if (!faults.empty()) throw InputError(faults[0]);
    const StoreMetadata& m = store.metadata();
    numbers = {m.point_count, m.input_points, m.cell_points, m.points_hash, store.fingerprint()};
    texts = {m.layout, m.options, to_string(m.unit), m.crs_wkt, codes_of(m.warnings)};
    lengths = {m.height_unit, m.steps[0], m.steps[1], m.steps[2]};
    quantisation = m.quantisation;
    sources = m.sources;
    source_points = m.source_points;
    classes = m.classes;
    origins = m.origins;
    withheld = m.withheld;
    near = m.near;
    top.assign(store.top_tree().begin(), store.top_tree().end());
    points = stored_points(store);
    if (classes) class_of = classes_by_source(store);
    if (origins) origin_of = origins_by_source(store);
  }
  friend bool operator==(const Content&, const Content&) = default;

  std::vector<std::uint64_t> numbers;
  std::vector<std::string> texts;
  std::vector<double> lengths;
  Quantisation quantisation;
  std::vector<SourceFile> sources;
  std::vector<std::uint64_t> source_points;
  std::optional<StoreClasses> classes;
  std::optional<StoreOrigins> origins;
  std::optional<StoreWithheld> withheld;
  std::optional<StoreCorridor> near;
  std::vector<TopNode> top;
  std::vector<StoredPoint> points;
  std::vector<std::uint8_t> class_of;
  std::vector<std::optional<OriginQuanta>> origin_of;
};

/// The content of a file, or nothing where it is refused.
std::optional<Content> content_of(const std::filesystem::path& path) {
  try {
    return Content(path);
  } catch (const InputError&) {
    return std::nullopt;
  }
}

/// Two scans near a path, with classes, withheld points and origins, of which a warning is given.
struct WholeScans : Conversion {
  WholeScans() {
    LasBytes las;
    las.minor = 4;
    las.format = 6;
    las.scale = {0.001, 0.001, 0.001};
    las.points = cube_cloud(100, -4000, 4000, 3);
    for (std::size_t i = 0; i < las.points.size(); ++i) {
      las.bytes_of_class.push_back(static_cast<std::uint8_t>(i % 9));
      las.bytes_of_flags.push_back(i % 11 == 1 ? 4 : 0);
    }
    add("a.las", las.build());
    add("b.las", las.build());
    options.origins = folder.write("o.csv", "first,x,y,z\n0,1,2,3\n50,4,5,6\n100,-1,0,9\n");
    options.near = folder.write("path.txt", "1 0 0 100 0 1 0 -200 0 0 1 0 0 0 0 1\n");
    options.within = 5;
  }
};

struct WholeStore : WholeScans {
  WholeStore() { REQUIRE(content.points.size() > 64); }

  std::string bytes = converted_bytes();
  Content content{options.output};
};

}  // namespace

TEST_CASE(
    "a store with a changed byte, a stretch of zeros or a lost end is refused, or is the same") {
  const LeaksOfHdf5 leaks;
  const WholeStore store;
  const std::string& bytes = store.bytes;
  std::size_t refused = 0, tried = 0;
  const auto check = [&](const std::string& changed, std::size_t at) {
    put_bytes(store.options.output, changed);
    const std::optional<Content> content = content_of(store.options.output);
    refused += content ? 0 : 1;
    ++tried;
    if (content && *content != store.content)
      FAIL_CHECK("a change at byte " << at << " is not seen");
  };
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    std::string changed = bytes;
    changed[at] = static_cast<char>(bytes[at] ^ (at % 3 == 0 ? 0xff : 1 << (at % 8)));
    check(changed, at);
  }
  CHECK(refused > tried / 3);
  for (const std::size_t length : {64, 512, 4096}) {
    for (std::size_t at = 0; at < bytes.size(); at += length / 2) {
      const std::size_t zeros = std::min(length, bytes.size() - at);
      check(std::string(bytes).replace(at, zeros, zeros, '\0'), at);
    }
  }
  refused = tried = 0;
  for (std::size_t size = 0; size < bytes.size(); size += size < 100 ? 1 : 97) {
    check(bytes.substr(0, size), size);
  }
  check(bytes.substr(0, bytes.size() - 1), bytes.size() - 1);
  CHECK(refused == tried);
  put_bytes(store.options.output, bytes);
  CHECK(content_of(store.options.output) == store.content);
}

namespace {

using Change = std::function<void(const std::filesystem::path&)>;

/// Replaces a dataset by one in which nothing is written. rows: its extent, which may grow to
/// `most`. set: its properties.
Change empty_dataset(const char* name, hid_t type, hsize_t rows, hsize_t most,
                     const std::function<void(hid_t list)>& set) {
  return [=](const std::filesystem::path& path) {
    remove_link(path, name);
    const hdf5::Id space(H5Screate_simple(1, &rows, &most), H5Sclose, name);
    const hdf5::Id list(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, name);
    set(list.get());
    const hdf5::Id file = open_to_change(path);
    H5Dclose(H5Dcreate2(file.get(), name, type, space.get(), H5P_DEFAULT, list.get(), H5P_DEFAULT));
  };
}

std::function<void(hid_t)> chunks_of(hsize_t rows, bool checksum = true) {
  return [=](hid_t list) {
    hdf5::check(H5Pset_chunk(list, 1, &rows), "chunk");
    if (checksum) hdf5::check(H5Pset_fletcher32(list), "checksum");
  };
}

Change link_instead(const std::string& name, bool external) {
  return [=](const std::filesystem::path& path) {
    remove_link(path, name);
    const hdf5::Id file = open_to_change(path);
    const auto added = external ? H5Lcreate_external(path.c_str(), "/tree/nodes", file.get(),
                                                     name.c_str(), H5P_DEFAULT, H5P_DEFAULT)
                                : H5Lcreate_soft("/tree/nodes", file.get(), name.c_str(),
                                                 H5P_DEFAULT, H5P_DEFAULT);
    hdf5::check(added, "link");
  };
}

Change other_bytes(const std::function<std::string(std::string)>& change) {
  return [=](const std::filesystem::path& path) { put_bytes(path, change(bytes_of(path))); };
}

}  // namespace

TEST_CASE("a store that HDF5 can read, but Clearway did not write, is refused with the reason") {
  const WholeStore store;
  const auto check = [&](const std::string& words, const Change& change) {
    INFO(words);
    put_bytes(store.options.output, store.bytes);
    change(store.options.output);
    check_refused<InputError>([&] { StoreReader{store.options.output}; },
                              store.options.output.string() + " ... " + words);
  };
  // More rows than the file holds are refused before memory is taken.
  for (const hsize_t rows : {hsize_t{1} << 20, hsize_t{1} << 40, (hsize_t{1} << 62) + 1}) {
    check("room", empty_dataset("cells/count", H5T_STD_U32LE, rows, rows, chunks_of(1024)));
  }
  put_bytes(store.options.output, store.bytes);
  const hsize_t cells = StoreReader(store.options.output).cells().size();
  check("not where it was written",
        empty_dataset("classes/bytes", H5T_STD_U32LE, cells, cells, chunks_of(cells, false)));
  const hsize_t large = hsize_t{1} << 28;
  check("chunks of rows",
        empty_dataset("classes/bytes", H5T_STD_U32LE, cells, large, chunks_of(large)));
  check("chunks of rows",
        empty_dataset("classes/bytes", H5T_STD_U32LE, cells, cells, [](hid_t list) {
          hdf5::check(H5Pset_external(list, "/etc/passwd", 0, 16), "external");
        }));
  for (const char* name : {"cells", "cells/count", "points/x", "header", "blocks/xxh64"}) {
    for (const bool external : {false, true}) check("found a link", link_instead(name, external));
  }
  for (const char* column : {"classes/address", "origins/xxh64"}) {
    check("other cells than it counts",
          [&](const auto& path) { change_column(path, column, std::vector<std::uint64_t>{}); });
  }
  check("superblock of version 0", other_bytes([](std::string bytes) {
          bytes[8] = 0;
          return bytes;
        }));
  // Open when its writer was killed.
  check("not closed", other_bytes([](std::string bytes) {
          bytes[11] = 1;
          return bytes;
        }));
  check("expected " + std::to_string(store.bytes.size()),
        other_bytes([](const std::string& bytes) { return bytes + "x"; }));
  check("not an HDF5 file",
        other_bytes([](const std::string& bytes) { return std::string(512, 'x') + bytes; }));
}
