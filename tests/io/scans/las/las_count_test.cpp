// Headers that declare fewer points than there are, as of a writer that crashed or wrote into a
// pipe.
#include <catch2/catch.hpp>

#include "support/bytes/las_bytes.hpp"
#include "support/reader_fixture.hpp"

using namespace clearway;
using namespace clearway::test;
using Catch::Matchers::Contains;

namespace {

/// The file's bytes with another count of points in the header.
std::string with_count(const LasBytes& las, std::uint32_t count) {
  std::string bytes = las.build();
  if (las.minor < 4 || las.format < 6) LasBytes::put(bytes, 107, count);
  if (las.minor == 4) LasBytes::put<std::uint64_t>(bytes, 247, count);
  return bytes;
}

/// A file for each way in which LAS ends its points.
std::vector<LasBytes> samples() {
  std::vector<LasBytes> all(5);
  all[0].format = 3;
  all[1].extra_bytes = 7;
  all[2].minor = 3;
  all[2].format = 4;
  all[2].global_encoding = 2;
  all[2].evlrs = {{"LASF_Spec", 65535, "waveforms"}};
  all[3].minor = 4;
  all[3].format = 6;
  all[4].minor = 4;
  all[4].format = 7;
  all[4].evlrs = {{"someone", 1, "payload"}, {"LASF_Projection", 2112, "LOCAL_CS[\"b\"]"}};
  return all;
}

ReadCloud read_stream(const std::filesystem::path& path) {
  return read_all(*open_las_stream(File::open_for_reading(path), path.parent_path()));
}

}  // namespace

TEST_CASE("a LAS file with more points than it declares is refused with both numbers") {
  const LasBytes las = samples()[GENERATE(0u, 1u, 2u, 3u, 4u)];
  const std::uint32_t count = GENERATE(0u, 2u);
  ReaderScratch scratch;
  const std::string message = refusal_of(scratch.write("a.las", with_count(las, count)));
  CHECK_THAT(message, Contains("a.las") &&
                          Contains("declares " + std::to_string(count) + " points") &&
                          Contains("holds 3 records of " + std::to_string(las.record_bytes())) &&
                          Contains("standard input"));
}

TEST_CASE("a stream with more points than it declares is read to its end, with a warning") {
  const LasBytes las = samples()[GENERATE(0u, 1u, 2u, 3u, 4u)];
  const std::uint32_t count = GENERATE(0u, 2u);
  ReaderScratch scratch;
  const ReadCloud cloud = read_stream(scratch.write("a.las", with_count(las, count)));
  CHECK(cloud.quanta == las.points);
  if (las.minor == 4 && !las.evlrs.empty()) CHECK(cloud.info.crs_wkt == "LOCAL_CS[\"b\"]");
  REQUIRE(cloud.info.remarks.size() == 1);
  const Message& remark = cloud.info.remarks[0];
  CHECK(remark.severity == Message::Severity::kWarning);
  CHECK(remark.code == "las-count");
  CHECK_THAT(remark.text, Contains("a.las") && Contains("declares " + std::to_string(count)) &&
                              Contains("3 came"));
  CHECK(remark.numbers == std::vector<std::pair<std::string, double>>{
                              {"declared", static_cast<double>(count)}, {"read", 3.0}});
}

TEST_CASE("a stream of many points beyond its count comes in whole batches") {
  LasBytes las;
  las.format = 1;
  las.points.assign(150000, {7, 8, 9});
  las.points.back() = {1, 2, 3};
  ReaderScratch scratch;
  const auto path = scratch.write("a.las", with_count(las, 70000));
  CHECK(read_stream(path).quanta == las.points);
  const auto reader = open_las_stream(File::open_for_reading(path), scratch.folder());
  PointBatch batch;
  std::vector<std::size_t> sizes;
  while (reader->read(batch)) sizes.push_back(batch.size());
  CHECK(sizes == std::vector<std::size_t>{65536, 65536, 18928});
}

TEST_CASE("less than a record behind the points is padding, in a file and in a stream") {
  LasBytes las;
  las.format = 2;
  ReaderScratch scratch;
  const auto path = scratch.write("a.las", las.build() + std::string(25, 'p'));
  for (const ReadCloud& cloud : {read_all(path), read_stream(path)}) {
    CHECK(cloud.quanta == las.points);
    CHECK(cloud.info.remarks.empty());
  }
  CHECK_THAT(refusal_of(scratch.write("b.las", las.build() + std::string(26, 'p'))),
             Contains("4 records"));
}

TEST_CASE("an empty LAS file that declares no points is no error") {
  LasBytes las;
  las.points.clear();
  ReaderScratch scratch;
  const auto path = scratch.write("a.las", las.build());
  CHECK(read_all(path).size() == 0);
  CHECK(read_stream(path).info.remarks.empty());
}
