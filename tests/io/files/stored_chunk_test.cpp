#include "io/files/fletcher32.hpp"
#include "io/files/stored_chunk.hpp"

#include <cstring>
#include <random>
#include <vector>

#include "io/files/hdf5.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/result_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

template <typename Value>
std::vector<Value> values_of(const std::string& kind, std::size_t count) {
  std::vector<Value> values(count);
  std::mt19937 random(7);
  for (std::size_t i = 0; i < count; ++i) {
    if (kind == "random") values[i] = static_cast<Value>(random());
    if (kind == "all bits") values[i] = static_cast<Value>(~Value{0});
    if (kind == "one bit") values[i] = i == count / 2 ? 1 : 0;
    if (kind == "sum of 65535") values[i] = static_cast<Value>(i == 0 ? 0xfffe0001 : 0);
  }
  return values;
}

/// Checks that chunks which HDF5 wrote have our checksum, and would not have it with another bit.
template <typename Value>
void check_checksums(const std::string& kind, std::size_t count) {
  CAPTURE(kind, count, sizeof(Value));
  const ScratchFolder folder;
  hdf5::write_dataset<Value>(hdf5::create_file(folder / "a.h5"), "values",
                             values_of<Value>(kind, count));
  const hdf5::Id file = hdf5::open_file(folder / "a.h5");
  const auto rows = hdf5::Rows<Value>::open(file, "values", 0, "a.h5");
  hdf5::StoredChunks chunks;
  REQUIRE(rows.read_chunks(0, count, chunks, [](std::size_t) {}));
  check_equal(chunks.size(), (count + 65'535) / 65'536);
  for (std::size_t i = 0; i < chunks.size(); ++i) {
    std::vector<std::byte> chunk(chunks[i].begin(), chunks[i].end());
    CHECK(hdf5::is_sealed(chunk));
    const std::vector<std::byte> whole = chunk;
    hdf5::seal_chunk(chunk);
    CHECK((chunk == whole));
    for (const std::size_t at : {chunk.size() / 3, chunk.size() - 1 - hdf5::kChecksumBytes}) {
      chunk[at] ^= std::byte{4};
      CHECK_FALSE(hdf5::is_sealed(chunk));
      chunk = whole;
    }
  }
}

}  // namespace

TEST_CASE("a chunk's checksum is that of HDF5, of an odd number of bytes too") {
  for (const char* kind : {"zero", "random", "all bits", "one bit", "sum of 65535"}) {
    for (const std::size_t count : {1, 2, 7, 15, 16, 17, 1000, 4096, 65'536, 70'000}) {
      check_checksums<std::uint32_t>(kind, count);
    }
  }
  for (const std::size_t count : {1, 2, 3, 15, 31, 33, 4095, 70'001}) {
    for (const char* kind : {"zero", "random"}) check_checksums<std::uint8_t>(kind, count);
  }
}

TEST_CASE("ranges of 2^16 rows end with a chunk, whatever a row takes") {
  for (const std::uint64_t row_bytes : {1, 2, 4, 8, 12, 24, 36}) {
    CAPTURE(row_bytes);
    const std::uint64_t rows = hdf5::rows_of_chunk(1'000'000, row_bytes);
    check_equal((1 << 16) % rows, 0);
    CHECK(rows * row_bytes <= 1 << 18);
    check_equal(hdf5::rows_of_chunk(5, row_bytes), 5);
  }
}

TEST_CASE("chunks that were written as they are stored are read by HDF5") {
  const ScratchFolder folder;
  const std::vector<std::uint32_t> values = values_of<std::uint32_t>("random", 70'000);
  {
    const hdf5::Id file = hdf5::create_file(folder / "a.h5");
    hdf5::Rows<std::uint32_t> rows(file, "values", values.size(), 0);
    rows.make_index();
    for (std::size_t first = 0; first < values.size(); first += rows.chunk_rows()) {
      const std::size_t count = std::min(values.size() - first, rows.chunk_rows());
      std::vector<std::byte> chunk(4 * rows.chunk_rows() + hdf5::kChecksumBytes);
      std::memcpy(chunk.data(), values.data() + first, 4 * count);
      hdf5::seal_chunk(chunk);
      rows.write_chunk(first, chunk);
    }
  }
  const hdf5::Id file = hdf5::open_file(folder / "a.h5");
  CHECK((hdf5::read_dataset<std::uint32_t>(file, "values", values.size(), 0, "a.h5") == values));
}
