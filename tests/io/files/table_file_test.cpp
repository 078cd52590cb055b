#include "io/files/table_file.hpp"

#include <hdf5.h>

#include <array>
#include <cstring>
#include <random>
#include <stdexcept>
#include <vector>

#include "io/files/fletcher32.hpp"
#include "support/catch.hpp"
#include "support/change_header.hpp"
#include "support/compare.hpp"
#include "support/leaks_of_hdf5.hpp"
#include "support/result_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

constexpr TableFileKind kKind{"clearway test", 1, "a test", "clearway test", "test again"};

using Triple = std::array<std::int32_t, 3>;

/// A table with columns whose chunks have different lengths.
struct Sample {
  explicit Sample(std::size_t rows, const std::string& kind = "random") {
    std::mt19937_64 random(7);
    for (std::size_t i = 0; i < rows; ++i) {
      const std::uint64_t value = kind == "random"     ? random()
                                  : kind == "all bits" ? ~std::uint64_t{0}
                                  : kind == "one bit"  ? i == rows / 2
                                                       : 0;
      bytes.push_back(static_cast<std::uint8_t>(value));
      numbers.push_back(value);
      triples.push_back({static_cast<std::int32_t>(value), static_cast<std::int32_t>(i), -1});
    }
  }

  std::array<ColumnBytes, 3> part(std::size_t first, std::size_t count) const {
    return {std::as_bytes(std::span(bytes).subspan(first, count)),
            std::as_bytes(std::span(numbers).subspan(first, count)),
            std::as_bytes(std::span(triples).subspan(first, count))};
  }

  static TableWriter& table_in(TableFileWriter& file, std::size_t rows) {
    return file.add_table("t",
                          {table_column<std::uint8_t>("bytes"),
                           table_column<std::uint64_t>("numbers"), table_column<Triple>("triples")},
                          rows);
  }

  /// step: rows that are appended at a time; 0: as pieces.
  void write(const std::filesystem::path& path, std::size_t step) const {
    TableFileWriter file(path, kKind);
    TableWriter& table = table_in(file, bytes.size());
    for (std::size_t first = 0; first < bytes.size();) {
      const std::size_t count = std::min(step == 0 ? kPieceRows : step, bytes.size() - first);
      if (step == 0) {
        TablePiece piece = table.new_piece();
        piece.append(count / 2, part(first, count / 2));
        piece.append(count - count / 2, part(first + count / 2, count - count / 2));
        piece.seal();
        table.write(piece);
      } else {
        table.append(count, part(first, count));
      }
      first += count;
    }
    file.finish({{"name", "sample"}});
  }

  std::vector<std::uint8_t> bytes;
  std::vector<std::uint64_t> numbers;
  std::vector<Triple> triples;
};

}  // namespace

TEST_CASE(
    "a file of tables is read as it was written, by HDF5 too, and its bytes depend on its "
    "contents alone") {
  const ScratchFolder folder;
  const auto kind = GENERATE(as<std::string>(), "random", "zero", "all bits", "one bit");
  const auto rows = GENERATE(as<std::size_t>(), 0, 1, 2, 7, 15, 4095, 65'536, 65'537, 150'001);
  CAPTURE(kind, rows);
  const Sample sample(rows, kind);
  const auto path = folder / "a.h5";
  sample.write(path, 0);
  {
    const TableFile file(path, kKind);
    CHECK(file.header()["name"] == "sample");
    CHECK(file.all<std::uint8_t>("t/bytes") == sample.bytes);
    CHECK(file.all<std::uint64_t>("t/numbers") == sample.numbers);
    CHECK(file.all<Triple>("t/triples") == sample.triples);
  }
  // HDF5 checks the checksums of the chunks.
  CHECK(values_of_column<std::uint8_t>(path, "t/bytes") == sample.bytes);
  CHECK(values_of_column<std::uint64_t>(path, "t/numbers") == sample.numbers);
  for (const std::size_t step : {65'536u, 70'000u, 1'001u}) {
    sample.write(folder / "b.h5", step);
    check_same(bytes_of(folder / "b.h5"), bytes_of(path));
  }
}

TEST_CASE("any range of a column is read, and is checked") {
  const LeaksOfHdf5 ignored;
  const ScratchFolder folder;
  const auto path = folder / "a.h5";
  const Sample sample(150'001);
  sample.write(path, 0);
  const auto read = [&](std::uint64_t first, std::size_t count) {
    std::vector<std::uint64_t> out(count);
    TableFile(path, kKind).column<std::uint64_t>("t/numbers").read(first, out);
    return out;
  };
  for (const std::size_t first : {0u, 1u, 32'767u, 32'768u, 65'535u, 131'072u, 150'000u}) {
    for (const std::size_t count : {0u, 1u, 2u, 40'000u, 150'001u}) {
      if (count > sample.numbers.size() - first) continue;
      const auto from = sample.numbers.begin() + static_cast<std::ptrdiff_t>(first);
      CHECK(read(first, count) == std::vector(from, from + static_cast<std::ptrdiff_t>(count)));
    }
  }
  CHECK_THROWS_AS(read(150'000, 2), std::logic_error);
  CHECK_THROWS_AS(read(~std::uint64_t{0}, 2), std::logic_error);
  // A chunk with another value and a right checksum, which HDF5 takes for sound.
  const std::string bytes = bytes_of(path);
  std::string chunk(reinterpret_cast<const char*>(&sample.numbers[32'768]), 8 * 32'768);
  const std::size_t at = bytes.find(chunk);
  REQUIRE(at != std::string::npos);
  chunk[5] = static_cast<char>(chunk[5] ^ 1);
  const std::uint32_t checksum = fletcher32(std::as_bytes(std::span(chunk)));
  chunk.append(reinterpret_cast<const char*>(&checksum), sizeof checksum);
  put_bytes(path, std::string(bytes).replace(at, chunk.size(), chunk));
  CHECK(values_of_column<std::uint64_t>(path, "t/numbers").size() == 150'001);
  CHECK(read(0, 32'768).front() == sample.numbers.front());
  CHECK(read(65'536, 9).front() == sample.numbers[65'536]);
  for (const auto& [first, count] : {std::pair(32'767u, 2u), {65'535u, 1u}, {0u, 150'001u}}) {
    check_refused<InputError>([&, f = first, c = count] { return read(f, c); },
                              "/t/numbers: its rows from 32768 on are damaged");
  }
}

TEST_CASE("a writer of tables takes promised rows alone, in their order") {
  const ScratchFolder folder;
  const Sample sample(70'000);
  TableFileWriter file(folder / "a.h5", kKind);
  TableWriter& first = Sample::table_in(file, 70'000);
  TableWriter& last = file.add_table("u", {table_column<std::uint8_t>("v")}, 1);
  const std::uint8_t one = 1;
  const ColumnBytes value = std::as_bytes(std::span(&one, 1));
  CHECK_THROWS_AS(last.append(1, {&value, 1}), std::logic_error);  // before the first is complete
  CHECK_THROWS_AS(first.append(1, {&value, 1}), std::logic_error);
  CHECK_THROWS_AS(first.append(2, sample.part(0, 1)), std::logic_error);
  TablePiece piece = first.new_piece();
  piece.append(5, sample.part(0, 5));
  piece.seal();
  CHECK_THROWS_AS(first.write(piece), std::logic_error);  // too short a piece
  CHECK_THROWS_AS(file.finish(Json::object()), std::logic_error);
}
