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

std::vector<std::uint32_t> values_of(const std::string& kind, std::size_t count) {
  std::vector<std::uint32_t> values(count);
  std::mt19937 random(7);
  for (std::size_t i = 0; i < count; ++i) {
    if (kind == "random") values[i] = static_cast<std::uint32_t>(random());
    if (kind == "all bits") values[i] = 0xffffffff;
    if (kind == "one bit") values[i] = i == count / 2 ? 1 : 0;
    if (kind == "sum of 65535") values[i] = i == 0 ? 0xfffe0001 : 0;
  }
  return values;
}

}  // namespace

TEST_CASE("a chunk's checksum is that of HDF5") {
  const std::string kind = GENERATE("zero", "random", "all bits", "one bit", "sum of 65535");
  const std::size_t count = GENERATE(1, 2, 7, 15, 16, 17, 1000, 4096, 65'536, 70'000);
  CAPTURE(kind, count);
  const ScratchFolder folder;
  const std::vector<std::uint32_t> values = values_of(kind, count);
  {
    const hdf5::Id file = hdf5::create_file(folder / "a.h5");
    hdf5::write_dataset<std::uint32_t>(file, "values", values);
  }
  const hdf5::Id file = hdf5::open_file(folder / "a.h5");
  const auto rows = hdf5::Rows<std::uint32_t>::open(file, "values", 0, "a.h5");
  hdf5::StoredChunks chunks;
  REQUIRE(rows.read_chunks(0, count, chunks, [](std::size_t) {}));
  check_equal(chunks.size(), (count + 65'535) / 65'536);
  for (std::size_t i = 0; i < chunks.size(); ++i) {
    std::vector<std::byte> chunk(chunks[i].begin(), chunks[i].end());
    CHECK(hdf5::is_sealed(chunk));
    const std::vector<std::byte> whole = chunk;
    hdf5::seal_chunk(chunk);
    CHECK((chunk == whole));
    chunk[chunk.size() / 3] ^= std::byte{4};
    CHECK_FALSE(hdf5::is_sealed(chunk));
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

TEST_CASE("the checksum of an odd number of bytes is that of HDF5") {
  for (const std::size_t count : {1, 2, 3, 15, 31, 33, 4095, 70'001}) {
    for (const bool zero : {false, true}) {
      CAPTURE(count, zero);
      std::vector<std::uint8_t> values(count);
      std::mt19937 random(3);
      for (std::uint8_t& value : values) value = static_cast<std::uint8_t>(zero ? 0 : random());
      const ScratchFolder folder;
      {
        const hdf5::Id file = hdf5::create_file(folder / "a.h5");
        hdf5::write_dataset<std::uint8_t>(file, "values", values);
      }
      const hdf5::Id file = hdf5::open_file(folder / "a.h5");
      const auto rows = hdf5::Rows<std::uint8_t>::open(file, "values", 0, "a.h5");
      hdf5::StoredChunks chunks;
      REQUIRE(rows.read_chunks(0, count, chunks, [](std::size_t) {}));
      REQUIRE(chunks.size() == count / 65'536 + 1);
      std::vector<std::byte> chunk(chunks[0].begin(), chunks[0].end());
      CHECK(hdf5::is_sealed(chunk));
      const std::vector<std::byte> whole = chunk;
      hdf5::seal_chunk(chunk);
      CHECK((chunk == whole));
      chunk[chunk.size() - 1 - hdf5::kChecksumBytes] ^= std::byte{4};
      CHECK_FALSE(hdf5::is_sealed(chunk));
    }
  }
}

TEST_CASE("chunks that were written as they are stored are read by HDF5") {
  const ScratchFolder folder;
  const std::vector<std::uint32_t> values = values_of("random", 70'000);
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
