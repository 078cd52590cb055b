#include "io/result/result.hpp"

#include <hdf5.h>

#include <catch2/catch.hpp>

#include "clearway/error.hpp"
#include "support/result_fixture.hpp"

using namespace clearway;
using namespace clearway::test;
using Catch::Contains;

TEST_CASE("a result is read as it was written") {
  const ScratchFolder folder;
  const bool first_pose = GENERATE(false, true);
  const std::size_t count = GENERATE(0u, 1u, 3u, 65'535u, 65'536u, 65'537u, 200'000u);
  ResultHeader header = sample_header(first_pose);
  header.between_poses = GENERATE(false, true);
  header.crs_wkt = GENERATE(std::string(), std::string("PROJCS[\"ETRS89 / UTM 32N — ä\"]"));
  const Collisions rows = sample_rows(header, count);
  write_result(folder / "out.h5", header, rows);

  const ResultReader reader(folder / "out.h5");
  CHECK(same_answer(reader.header(), header));
  CHECK(reader.collisions() == count);
  CHECK(reader.name() == (folder / "out.h5").string());
  CHECK(same_rows(read_rows(reader), rows));
}

TEST_CASE("a result is read by any range of rows") {
  const ScratchFolder folder;
  const ResultHeader header = sample_header(true);
  const Collisions rows = sample_rows(header, 70'000);
  write_result(folder / "out.h5", header, rows);
  const ResultReader reader(folder / "out.h5");
  for (const std::size_t first : {0u, 8'191u, 8'192u, 32'767u, 65'535u, 69'990u}) {
    Collisions read;
    reader.read(first, 10, read);
    CHECK(same_rows(read, part_of(rows, first, 10)));
  }
  Collisions read;
  CHECK_THROWS_AS(reader.read(69'991, 10, read), std::logic_error);
  CHECK(reader.column(&Collisions::source) == rows.source);
  CHECK(reader.column(&Collisions::xyz) == rows.xyz);
  CHECK(reader.column(&Collisions::first_pose) == rows.first_pose);
}

TEST_CASE("equal contents give equal bytes, however they were appended and named") {
  const ScratchFolder folder;
  const ResultHeader header = sample_header(GENERATE(false, true));
  const Collisions rows = sample_rows(header, 150'000);
  write_result(folder / "a.h5", header, rows, 150'000);
  const std::string bytes = bytes_of(folder / "a.h5");
  for (const std::size_t step : {7u, 8'192u, 65'537u, 149'999u}) {
    write_result(folder / "another name.h5", header, rows, step);
    CHECK(bytes_of(folder / "another name.h5") == bytes);
  }
}

TEST_CASE("results of different queries differ in their bytes") {
  const ScratchFolder folder;
  const ResultHeader header = sample_header(false);
  write_result(folder / "a.h5", header, {});
  ResultHeader other = header;
  SECTION("radius") { other.radius = std::nextafter(header.radius, 1.0); }
  SECTION("between poses") { other.between_poses = true; }
  write_result(folder / "b.h5", other, {});
  CHECK(bytes_of(folder / "a.h5") != bytes_of(folder / "b.h5"));
}

TEST_CASE("a writer refuses rows that do not belong to its result") {
  const ScratchFolder folder;
  const ResultHeader header = sample_header(true);
  const Collisions rows = sample_rows(header, 4);
  ResultWriter writer(folder / "out.h5", header, 3);
  CHECK_THROWS_AS(writer.append(rows), std::logic_error);
  Collisions two = part_of(rows, 0, 2);
  two.first_pose.clear();
  CHECK_THROWS_AS(writer.append(two), std::logic_error);
  writer.append(part_of(rows, 0, 2));
  CHECK_THROWS_AS(writer.append(part_of(rows, 0, 1)), std::logic_error);
  CHECK_THROWS_AS(writer.finish(), std::logic_error);
}

TEST_CASE("a result whose writer did not finish is refused") {
  const ScratchFolder folder;
  { ResultWriter writer(folder / "out.h5", sample_header(false), 0); }
  CHECK_THROWS_WITH(ResultReader(folder / "out.h5"), Contains("out.h5") && Contains("complete"));
  CHECK_THROWS_AS(ResultReader(folder / "out.h5"), InputError);
}

TEST_CASE("a folder that is not there is a resource error that names the file") {
  const ScratchFolder folder;
  CHECK_THROWS_AS(ResultWriter(folder / "no/out.h5", sample_header(false), 0), ResourceError);
  CHECK_THROWS_WITH(ResultWriter(folder / "no/out.h5", sample_header(false), 0),
                    Contains("no/out.h5"));
}
