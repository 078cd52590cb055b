#include <hdf5.h>
#include <unistd.h>

#include <tuple>

#include "clearway/error.hpp"
#include "io/files/hdf5.hpp"
#include "io/store/store_reader.hpp"
#include "io/store/store_writer.hpp"
#include "support/catch.hpp"
#include "support/clouds.hpp"
#include "support/compare.hpp"
#include "support/leaks_of_hdf5.hpp"
#include "support/result_fixture.hpp"
#include "support/store_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// The content of a store, read and verified.
struct Content {
  explicit Content(const std::filesystem::path& path) {
    const StoreReader store(path);
    const auto faults = faults_of(store);
    if (!faults.empty()) throw InputError(faults[0]);
    const StoreMetadata& m = store.metadata();
    metadata = {m.point_count, m.input_points,    m.cell_points, m.points_hash,
                m.layout,      to_string(m.unit), m.crs_wkt};
    quantisation = m.quantisation;
    sources = m.sources;
    top.assign(store.top_tree().begin(), store.top_tree().end());
    fingerprint = store.fingerprint();
    points = stored_points(store);
  }
  friend bool operator==(const Content&, const Content&) = default;

  std::tuple<std::uint64_t, std::uint64_t, std::uint32_t, std::uint64_t, std::string, std::string,
             std::string>
      metadata;
  Quantisation quantisation;
  std::vector<SourceFile> sources;
  std::vector<TopNode> top;
  std::uint64_t fingerprint;
  std::vector<StoredPoint> points;
};

/// A store of a few cells.
struct ReadStore {
  explicit ReadStore(std::size_t points = 300) {
    write_las(folder / "a.las", cube_cloud(points, -4000, 4000, 3));
    convert_quietly(conversion_of({folder / "a.las"}, path));
  }

  ScratchFolder folder;
  std::filesystem::path path = folder / "a.h5";
};

std::string refusal(const std::filesystem::path& path) {
  try {
    Content{path};
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

/// A file whose bytes can be changed one at a time.
class Patch {
 public:
  explicit Patch(const std::filesystem::path& path) : bytes_(bytes_of(path)) {
    // The file is changed in place, because a file system may sync a file that is written anew.
    file_ = std::fopen(path.c_str(), "r+b");
    if (file_ == nullptr) throw std::runtime_error("cannot open for patching");
  }
  ~Patch() { std::fclose(file_); }

  std::size_t size() const { return bytes_.size(); }
  void flip(std::size_t at, unsigned char bits) { put(at, static_cast<char>(bytes_[at] ^ bits)); }
  void restore(std::size_t at) { put(at, bytes_[at]); }

 private:
  void put(std::size_t at, char byte) {
    if (::pwrite(::fileno(file_), &byte, 1, static_cast<off_t>(at)) != 1) {
      throw std::runtime_error("cannot patch");
    }
  }

  std::string bytes_;
  std::FILE* file_;
};

}  // namespace

TEST_CASE("a flipped byte of a store is refused or changes nothing") {
  const LeaksOfHdf5 leaks;
  const ReadStore store;
  const Content original(store.path);
  Patch patch(store.path);
  std::size_t refused = 0, harmless = 0, wrong = 0;
  for (std::size_t at = 0; at < patch.size(); ++at) {
    patch.flip(at, static_cast<unsigned char>(at % 3 == 0 ? 0xff : 1 << (at % 8)));
    try {
      if (Content(store.path) == original) {
        ++harmless;
      } else {
        ++wrong;
        UNSCOPED_INFO("byte " << at);
      }
    } catch (const InputError&) {
      ++refused;
    }
    patch.restore(at);
  }
  INFO(patch.size() << " bytes, " << refused << " refused, " << harmless << " harmless");
  check_equal(wrong, 0);
  CHECK(refused > patch.size() / 3);
  CHECK(Content(store.path) == original);
}

TEST_CASE("a store cut anywhere is refused") {
  const LeaksOfHdf5 leaks;
  const ReadStore store;
  const std::string bytes = bytes_of(store.path);
  for (std::size_t size = 0; size < bytes.size(); size += size < 100 ? 1 : 97) {
    put_bytes(store.folder / "cut.h5", bytes.substr(0, size));
    CAPTURE(size);
    CHECK_FALSE(refusal(store.folder / "cut.h5").empty());
  }
  put_bytes(store.folder / "cut.h5", bytes.substr(0, bytes.size() - 1));
  CHECK_FALSE(refusal(store.folder / "cut.h5").empty());
}

TEST_CASE("a damaged chunk is named when its cell is read") {
  const ReadStore small;
  const Content original(small.path);
  std::uint64_t at;
  {
    const StoreReader store(small.path);
    at = store.index().address[4 * 2 + 1] + 30;
  }
  Patch(small.path).flip(at, 4);
  const StoreReader store(small.path);
  CHECK_NOTHROW(store.coordinates(1));
  check_refused<InputError>([&] { return store.coordinates(2); },
                            std::string(small.path.string()) + " ... cell 2 ... 'y' ... damaged");
  CHECK_NOTHROW(store.sources(2));
  check_equal(faults_of(store).size(), 1);
}

TEST_CASE("a store that another tool copied is refused with advice") {
  const ReadStore store;
  const auto copy = store.folder / "copy.h5";
  {
    const hdf5::Id from(H5Fopen(store.path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose, "from");
    const hdf5::Id to(H5Fcreate(copy.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose,
                      "to");
    for (const char* group : {"blocks", "cells", "points", "sources", "tree"}) {
      hdf5::check(H5Ocopy(from.get(), group, to.get(), group, H5P_DEFAULT, H5P_DEFAULT), "copy");
    }
    const auto copy_attribute = [](hid_t source, const char* name, const H5A_info_t*,
                                   void* target) -> herr_t {
      const hdf5::Id attribute(H5Aopen(source, name, H5P_DEFAULT), H5Aclose, name);
      const hdf5::Id type(H5Aget_type(attribute.get()), H5Tclose, name);
      const hdf5::Id space(H5Aget_space(attribute.get()), H5Sclose, name);
      const hdf5::Id added(H5Acreate2(static_cast<hdf5::Id*>(target)->get(), name, type.get(),
                                      space.get(), H5P_DEFAULT, H5P_DEFAULT),
                           H5Aclose, name);
      std::vector<char> value(H5Aget_storage_size(attribute.get()) + 1);
      hdf5::check(H5Aread(attribute.get(), type.get(), value.data()), name);
      return H5Awrite(added.get(), type.get(), value.data());
    };
    hdf5::check(H5Aiterate2(from.get(), H5_INDEX_NAME, H5_ITER_INC, nullptr, copy_attribute,
                            const_cast<hdf5::Id*>(&to)),
                "attributes");
  }
  check_says(refusal(copy), "Another tool ... convert the scans again");
  const std::string repack =
      "h5repack '" + store.path.string() + "' '" + (store.folder / "packed.h5").string() + "'";
  if (std::system("command -v h5repack >/dev/null") == 0) {
    REQUIRE(std::system(repack.c_str()) == 0);
    check_says(refusal(store.folder / "packed.h5"), "Another tool");
  }
}

TEST_CASE("a file that is no store is refused") {
  const ScratchFolder folder;
  put_bytes(folder / "text.h5", "no HDF5 file");
  check_says(refusal(folder / "text.h5"), "text.h5 ... not an HDF5 file");
  put_bytes(folder / "empty.h5", "");
  check_says(refusal(folder / "empty.h5"), "not an HDF5 file");
  const ResultHeader header = sample_header(false);
  write_result(folder / "result.h5", header, sample_rows(header, 10));
  check_says(refusal(folder / "result.h5"), "not a store");
  hdf5::create_file(folder / "other.h5");
  check_says(refusal(folder / "other.h5"), "not a store");
}

TEST_CASE("an unfinished store is refused") {
  const ScratchFolder folder;
  const StoreMetadata metadata{.point_count = 100,
                               .input_points = 100,
                               .cell_points = 64,
                               .quantisation = kMillimetres,
                               .layout = "adaptive",
                               .crs_wkt = {},
                               .sources = {}};
  { StoreWriter(folder / "a.h5", metadata, 2); }
  check_says(refusal(folder / "a.h5"), "unfinished");
}

TEST_CASE("a missing store is no malformed one") {
  CHECK_THROWS_AS(StoreReader(ScratchFolder() / "none.h5"), ResourceError);
}

TEST_CASE("the fingerprint tells stores apart, not names") {
  const ReadStore a, same, other(301);
  CHECK(StoreReader(a.path).fingerprint() == StoreReader(same.path).fingerprint());
  CHECK(StoreReader(a.path).fingerprint() != StoreReader(other.path).fingerprint());
}

TEST_CASE("a store counts the cells that were touched, and every byte that it hands out") {
  const ReadStore small;
  const StoreReader store(small.path);
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

namespace {

using Counts = std::vector<std::uint64_t>;

/// Two scans, of 100 and of 250 points.
struct TwoScans {
  TwoScans() {
    write_las(folder / "a.las", cube_cloud(100, -4000, 4000, 3));
    write_las(folder / "b.las", cube_cloud(250, -4000, 4000, 4));
    convert_quietly(conversion_of({folder / "a.las", folder / "b.las"}, folder / "site.h5"));
  }
  ScratchFolder folder;
};

}  // namespace

TEST_CASE("a store of several scans knows how many points each has") {
  const TwoScans scans;
  const StoreReader store(scans.folder / "site.h5");
  CHECK(store.metadata().source_points == Counts{100, 250});
  check_equal(store.metadata().points_of_source(1), 250u);
  CHECK(faults_of(store).empty());
}

TEST_CASE("a store of one scan has no such dataset, but the answer") {
  const ScratchFolder folder;
  write_las(folder / "a.las", cube_cloud(100, -4000, 4000, 3));
  convert_quietly(conversion_of({folder / "a.las"}, folder / "site.h5"));
  const StoreReader store(folder / "site.h5");
  CHECK(store.metadata().source_points.empty());
  check_equal(store.metadata().points_of_source(0), 100u);
}

TEST_CASE("a store of several scans without the dataset, as 0.1.0 made it, is read") {
  const TwoScans scans;
  const auto path = scans.folder / "site.h5";
  {
    const hdf5::Id file(H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose, "open");
    REQUIRE(H5Ldelete(file.get(), "/sources/points", H5P_DEFAULT) >= 0);
  }
  const StoreReader store(path);
  CHECK_FALSE(store.metadata().points_of_source(0));
}

TEST_CASE("counts of points that do not add up are refused") {
  const TwoScans scans;
  const auto path = scans.folder / "site.h5";
  const auto counts = GENERATE(Counts{100, 251}, Counts{350}, Counts{0, 0}, Counts{351, ~0ull});
  {
    const hdf5::Id file(H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose, "open");
    REQUIRE(H5Ldelete(file.get(), "/sources/points", H5P_DEFAULT) >= 0);
    hdf5::write_dataset<std::uint64_t>(file, "/sources/points", counts);
  }
  check_refused([&] { return StoreReader(path); }, "points'");
}
