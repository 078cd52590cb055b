// Files that are read in pieces, several at a time, and the memory or files in which points wait.
#include <catch2/catch.hpp>

#include "io/files/xxh64.hpp"
#include "io/scans/point_reader.hpp"
#include "io/store/convert/distribute.hpp"
#include "support/bytes/laz/laz_samples.hpp"
#include "support/clouds.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

std::uint64_t hash_of(const std::string& bytes) { return xxh64(std::as_bytes(std::span(bytes))); }

/// A folder with a LAS and a LAZ file of several pieces each, the LAS with bytes behind its points.
struct Files {
  Files() {
    write_las(las, cube_cloud(150'000, -5000, 5000, 1));
    put_bytes(las, bytes_of(las) + "behind");
    LazBytes compressed = laz_bytes(3, 150'000);
    compressed.chunks = {7001};
    put_bytes(laz, compressed.build());
  }

  ScratchFolder folder;
  std::filesystem::path las = folder / "a.las", laz = folder / "b.laz";
};

}  // namespace

TEST_CASE("pieces of a file hold its points and bytes in their order") {
  const Files files;
  // An index, because a generator outlives the test case's variables.
  const auto& path = GENERATE(0, 1) == 0 ? files.las : files.laz;
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
    CHECK(batch.quanta.size() == reader->points_of_piece(piece));
    CHECK(batch.positions.empty());
    parts.insert(parts.end(), batch.quanta.begin(), batch.quanta.end());
    CHECK((piece == 0 || from.first == end));
    end = from.first + from.count;
    CHECK(std::memcmp(from.bytes.get(), bytes.data() + from.first, from.count) == 0);
  }
  CHECK(parts == whole);
}

TEST_CASE("a store tells sizes and hashes of files read in pieces and of others") {
  const Files files;
  write_las(files.folder / "c.las", {});
  put_bytes(files.folder / "d.xyz", "1 2 3\n4 5 6\n");
  const std::vector<std::filesystem::path> inputs{files.las, files.folder / "c.las",
                                                  files.folder / "d.xyz", files.las};
  const auto options = conversion_of(inputs, files.folder / "s.h5");
  convert_quietly(options);
  const StoreReader store(options.output);
  const auto& sources = store.metadata().sources;
  REQUIRE(sources.size() == inputs.size());
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const std::string bytes = bytes_of(inputs[i]);
    CHECK(sources[i] == SourceFile{inputs[i].filename().string(), bytes.size(), hash_of(bytes)});
  }
}

TEST_CASE("points wait in memory where they fit and else in files and the store is the same") {
  constexpr std::size_t kPoints = 1'000'000;
  const ScratchFolder folder;
  write_las(folder / "a.las", cube_cloud(kPoints, -5000, 5000, 1));
  auto options = conversion_of({folder / "a.las"}, folder / "s.h5", 1000);
  options.memory_bytes = kLeastConversionMemory;
  CHECK(convert_quietly(options).temporary_bytes == kPoints * sizeof(DistributedPoint));
  const std::string bytes = bytes_of(options.output);
  options.memory_bytes = std::uint64_t{1} << 30;
  CHECK(convert_quietly(options).temporary_bytes == 0);
  CHECK(bytes_of(options.output) == bytes);
}
