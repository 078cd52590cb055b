#include "io/scans/las/las_reader.hpp"

#include <unistd.h>

#include <cmath>
#include <limits>

#include "io/scans/scan_crs.hpp"
#include "io/store/convert/spooled_reader.hpp"
#include "support/bytes/las_bytes.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/reader_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

const std::string kMetreWkt = R"(LOCAL_CS["any",UNIT["metre",1]])";

std::string geo_keys(const std::vector<std::array<std::uint16_t, 2>>& keys) {
  std::vector<std::uint16_t> words{1, 1, 0, static_cast<std::uint16_t>(keys.size())};
  for (const auto& [key, value] : keys) words.insert(words.end(), {key, 0, 1, value});
  return {reinterpret_cast<const char*>(words.data()), words.size() * 2};
}

std::string refusal_of_bytes(const std::string& bytes) {
  ScratchFolder scratch;
  const auto path = scratch.write("a.las", bytes);
  const std::string refusal = refusal_of(path);
  check_says(refusal, path.string());
  CHECK_FALSE(stream_refusal_of(path).empty());
  return refusal;
}

template <typename Number>
std::string refusal_with(LasBytes las, std::size_t at, Number value) {
  std::string bytes = las.build();
  LasBytes::put(bytes, at, value);
  return refusal_of_bytes(bytes);
}

}  // namespace

TEST_CASE("coordinates of every version and point format are read as stored") {
  ScratchFolder scratch;
  const unsigned minor = GENERATE(range(0u, 5u));
  const unsigned format = GENERATE(range(0u, 11u));
  const unsigned extra_bytes = GENERATE(0u, 7u);
  LasBytes las;
  las.minor = minor;
  las.format = format;
  las.extra_bytes = extra_bytes;
  las.padding = 2;
  las.vlrs = {{"someone", 7, "payload"}};
  const auto path = scratch.write("a.las", las.build());
  const auto from_file = open_point_file(path);
  REQUIRE(from_file->info().declared_points == 3u);
  REQUIRE(from_file->info().quantisation);
  check_equal(from_file->info().quantisation->scale[1], 0.01);
  check_equal(from_file->info().quantisation->offset[0], 100);
  CHECK(read_all(*from_file).quanta == las.points);
  from_file->rewind();
  CHECK(read_all(*from_file).quanta == las.points);
  const auto from_stream =
      open_las_stream(File::open_for_reading(path), std::filesystem::temp_directory_path());
  CHECK(read_all(*from_stream).quanta == las.points);
  CHECK_THROWS_AS(from_stream->rewind(), ResourceError);
}

TEST_CASE("classes of every point format are read, without the flags of formats 0 to 5") {
  ScratchFolder scratch;
  LasBytes las;
  las.minor = 4;
  las.format = GENERATE(range(0u, 11u));
  las.bytes_of_class = {2, 0xE0 | 7, 200};
  const bool flags = las.format < 6;
  const std::vector<std::uint8_t> expected{2, static_cast<std::uint8_t>(flags ? 7 : 0xE7),
                                           static_cast<std::uint8_t>(flags ? 200 & 31 : 200)};
  const auto path = scratch.write("a.las", las.build());
  CHECK(read_all(path).classes == expected);
  PointBatch piece;
  open_point_file(path)->read_piece(0, piece, nullptr);
  CHECK(piece.classes == expected);
  const auto spooled =
      spool(open_las_stream(File::open_for_reading(path), scratch.folder()), scratch.folder());
  CHECK(read_all(*spooled).classes == expected);
  spooled->rewind();
  CHECK(read_all(*spooled).classes == expected);
}

TEST_CASE("points of many batches arrive in order") {
  ScratchFolder scratch;
  LasBytes las;
  las.extra_bytes = GENERATE(0u, 3u);
  las.points.clear();
  for (std::int32_t i = 0; i < 150'001; ++i) las.points.push_back({i, -i, 2 * i});
  CHECK(read_all(scratch.write("a.las", las.build())).quanta == las.points);
}

TEST_CASE("LAS is read from a pipe") {
  LasBytes las;
  las.minor = 4;
  las.format = 6;
  las.vlrs = {{"LASF_Projection", 2112, kMetreWkt + '\0'}};
  const std::string bytes = las.build();
  int ends[2];
  REQUIRE(::pipe(ends) == 0);
  REQUIRE(::write(ends[1], bytes.data(), bytes.size()) == static_cast<ssize_t>(bytes.size()));
  ::close(ends[1]);
  const auto reader = open_las_stream(File::adopt(ends[0], "standard input"),
                                      std::filesystem::temp_directory_path());
  CHECK(reader->info().crs_wkt == kMetreWkt);
  CHECK(reader->info().unit == LengthUnit::kMetre);
  CHECK(read_all(*reader).quanta == las.points);
}

TEST_CASE("a file without points is valid and empty") {
  ScratchFolder scratch;
  LasBytes las;
  las.minor = GENERATE(0u, 3u, 4u);
  las.points.clear();
  check_equal(read_all(scratch.write("a.las", las.build())).size(), 0);
}

TEST_CASE("a CRS in an extended record is known at once from a file, at the end from a stream") {
  ScratchFolder scratch;
  LasBytes las;
  las.minor = 4;
  las.format = 7;
  las.evlrs = {{"someone", 1, std::string(1000, 'x')}, {"LASF_Projection", 2112, kMetreWkt + '\0'}};
  const auto path = scratch.write("a.las", las.build());
  CHECK(open_point_file(path)->info().unit == LengthUnit::kMetre);
  const auto stream =
      open_las_stream(File::open_for_reading(path), std::filesystem::temp_directory_path());
  CHECK(stream->info().unit == LengthUnit::kUnknown);
  CHECK(read_all(*stream).info.crs_wkt == kMetreWkt);
  CHECK(stream->info().unit == LengthUnit::kMetre);
}

TEST_CASE("well-known text counts more than what liblas repeats and than GeoTIFF keys") {
  ScratchFolder scratch;
  LasBytes las;
  las.vlrs = {{"LASF_Projection", 34735, geo_keys({{1024, 2}})},
              {"liblas", 2112, "LOCAL_CS[\"feet\",UNIT[\"foot\",0.3048]]"},
              {"LASF_Projection", 2112, kMetreWkt}};
  CHECK(open_point_file(scratch.write("a.las", las.build()))->info().unit == LengthUnit::kMetre);
  las.vlrs.pop_back();
  CHECK(open_point_file(scratch.write("a.las", las.build()))->info().unit == LengthUnit::kFoot);
  las.vlrs.pop_back();
  CHECK(open_point_file(scratch.write("a.las", las.build()))->info().unit == LengthUnit::kDegrees);
}

TEST_CASE("well-known text and GeoTIFF keys complete each other") {
  using Keys = std::vector<std::array<std::uint16_t, 2>>;
  const auto info = [](const std::string& text, const Keys& keys) {
    ScratchFolder scratch;
    LasBytes las;
    las.vlrs = {{"LASF_Projection", 34735, geo_keys(keys)}, {"LASF_Projection", 2112, text}};
    return open_point_file(scratch.write("a.las", las.build()))->info();
  };
  const CloudInfo heights = info(kMetreWkt, {{1024, 1}, {3072, 26917}, {4099, 9003}});
  CHECK(heights.unit == LengthUnit::kMetre);
  CHECK(unit_of_length(heights.height_unit) == LengthUnit::kUsSurveyFoot);
  CHECK(info("LOCAL_CS[\"a\"]", {{1024, 1}, {3076, 9002}}).unit == LengthUnit::kFoot);
  const CloudInfo by_keys = info("PROJCS[\"a\"]", {{1024, 1}, {3072, 26917}});
  CHECK(by_keys.unit == LengthUnit::kMetre);
  check_equal(by_keys.crs, "EPSG:26917");
  check_says(by_keys.crs_doubt, "PROJCS ... its GeoTIFF keys count");
  check_says(info("PROJCS[\"a\"]", {}).crs_unread, "PROJCS");
  const CloudInfo other = info(kMetreWkt, {{1024, 1}, {3076, 9002}});
  CHECK(other.unit == LengthUnit::kMetre);
  check_says(other.unit_doubt, "its GeoTIFF keys foot");
}

TEST_CASE("a GeoTIFF directory that counts more keys than it holds is read as far as it goes") {
  ScratchFolder scratch;
  LasBytes las;
  std::string keys = geo_keys({{1024, 1}, {3076, 9002}});
  LasBytes::put<std::uint16_t>(keys, 6, 65535);
  las.vlrs = {{"LASF_Projection", 34735, keys + "odd"}};
  CHECK(open_point_file(scratch.write("a.las", las.build()))->info().unit == LengthUnit::kFoot);
}

TEST_CASE("a malformed LAS header is refused with its place") {
  LasBytes las;
  check_says(refusal_with<char>(las, 0, 'X'), "byte 0 ... LASF");
  check_says(refusal_with<std::uint8_t>(las, 24, 2), "byte 24 ... 2.2");
  check_says(refusal_with<std::uint8_t>(las, 25, 5), "1.5");
  check_says(refusal_with<std::uint16_t>(las, 94, 226), "byte 94 ... 227");
  check_says(refusal_with<std::uint32_t>(las, 96, 226), "byte 96");
  check_says(refusal_with<std::uint8_t>(las, 104, 11), "byte 104 ... 0 to 10");
  check_says(refusal_with<std::uint16_t>(las, 105, 19), "byte 105 ... 20");
  check_says(refusal_with<std::uint16_t>(las, 105, 0), "byte 105");
  check_says(refusal_with<std::uint32_t>(las, 107, 4), "307 ... 4 points");
  check_says(refusal_with<std::uint32_t>(las, 107, 0xFFFFFFFF), "4294967295 points");
}

TEST_CASE("a scale that is not positive and a number that is not finite are refused") {
  LasBytes las;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  for (const double scale : {0.0, -0.001, nan, inf, -inf}) {
    check_says(refusal_with(las, 139, scale), "byte 139 ... y scale");
  }
  for (const double offset : {nan, inf, -inf}) {
    check_says(refusal_with(las, 171, offset), "byte 171 ... z offset");
  }
}

TEST_CASE("the 64-bit count of LAS 1.4 is the one that counts") {
  LasBytes las;
  las.minor = 4;
  check_says(refusal_with<std::uint64_t>(las, 247, 4), "byte 247");
  check_says(refusal_with<std::uint16_t>(las, 94, 374), "375");
  las.format = 6;
  check_says(refusal_with<std::uint64_t>(las, 247, 4), "4 points");
  const std::uint64_t huge = std::numeric_limits<std::uint64_t>::max();
  check_says(refusal_with(las, 247, huge), "18446744073709551615 points");
}

TEST_CASE("variable length records must end before the points, extended ones with the file") {
  LasBytes las;
  las.vlrs = {{"someone", 7, "payload"}};
  check_says(refusal_with<std::uint16_t>(las, 227 + 20, 8), "byte 227 ... record 1 of 1");
  check_says(refusal_with<std::uint32_t>(las, 100, 2), "record 2 of 2");
  check_says(refusal_with<std::uint32_t>(las, 100, 0xFFFFFFFF), "of 4294967295");

  LasBytes tail;
  tail.minor = 4;
  tail.evlrs = {{"someone", 7, "payload"}};
  const std::size_t start = tail.points_end();
  check_says(refusal_with<std::uint64_t>(tail, start + 20, 8), "extended");
  check_says(refusal_with<std::uint64_t>(tail, start + 20, ~std::uint64_t{0}), "extended");
  check_says(refusal_with<std::uint64_t>(tail, 235, start - 1), "behind the points");
  check_says(refusal_with<std::uint64_t>(tail, 235, ~std::uint64_t{0}), "ends at byte");
  check_says(refusal_with<std::uint32_t>(tail, 243, 0xFFFFFFFF), "record 2 of");
  tail.evlrs = {{"LASF_Projection", 2112, "payload"}};
  check_says(refusal_with<std::uint64_t>(tail, start + 20, ~std::uint64_t{0}), "reference system");
}

// Headers that declare fewer points than there are, as of a writer that crashed or wrote into a
// pipe.
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
  ScratchFolder scratch;
  const std::string message = refusal_of(scratch.write("a.las", with_count(las, count)));
  check_says(message, std::string("a.las ... declares ") + std::to_string(count) +
                          " points ... holds 3 records of " + std::to_string(las.record_bytes()) +
                          " ... standard input");
}

TEST_CASE("a stream with more points than it declares is read to its end, with a warning") {
  const LasBytes las = samples()[GENERATE(0u, 1u, 2u, 3u, 4u)];
  const std::uint32_t count = GENERATE(0u, 2u);
  ScratchFolder scratch;
  const ReadCloud cloud = read_stream(scratch.write("a.las", with_count(las, count)));
  CHECK(cloud.quanta == las.points);
  if (las.minor == 4 && !las.evlrs.empty()) check_equal(cloud.info.crs_wkt, "LOCAL_CS[\"b\"]");
  REQUIRE(cloud.info.remarks.size() == 1);
  const Message& remark = cloud.info.remarks[0];
  CHECK(remark.severity == Message::Severity::kWarning);
  check_equal(remark.code, "las-count");
  check_says(remark.text,
             std::string("a.las ... declares ") + std::to_string(count) + " ... 3 came");
  CHECK(remark.numbers == std::vector<std::pair<std::string, double>>{
                              {"declared", static_cast<double>(count)}, {"read", 3.0}});
}

TEST_CASE("a stream of many points beyond its count comes in whole batches") {
  LasBytes las;
  las.format = 1;
  las.points.assign(150000, {7, 8, 9});
  las.points.back() = {1, 2, 3};
  ScratchFolder scratch;
  const auto path = scratch.write("a.las", with_count(las, 70000));
  CHECK(read_stream(path).quanta == las.points);
  const auto reader = open_las_stream(File::open_for_reading(path), scratch.folder());
  PointBatch batch;
  std::vector<std::size_t> sizes;
  while (reader->read(batch)) sizes.push_back(batch.size());
  CHECK(sizes == std::vector<std::size_t>{65536, 65536, 18928});
}

TEST_CASE("bytes behind the points that are no whole record are refused as damage") {
  LasBytes las;
  las.format = 2;
  ScratchFolder scratch;
  const std::size_t more = GENERATE(1u, 25u, 27u, 51u);
  const auto path = scratch.write("a.las", las.build() + std::string(more, 'p'));
  for (const std::string& refusal : {refusal_of(path), stream_refusal_of(path)}) {
    check_says(refusal, std::to_string(more) + " byte ... more behind its 3 points ... damaged");
    CHECK(refusal.find("standard input are") == refusal.npos);
  }
  check_says(refusal_of(scratch.write("b.las", las.build() + std::string(26, 'p'))), "4 records");
}

TEST_CASE("less than a record between the points and an extended record is a gap") {
  LasBytes las;
  las.minor = 4;
  las.evlrs = {{"someone", 1, "payload"}};
  std::string bytes = las.build();
  bytes.insert(las.points_end(), "gap");
  LasBytes::put<std::uint64_t>(bytes, 235, las.points_end() + 3);
  ScratchFolder scratch;
  const auto path = scratch.write("a.las", bytes);
  for (const ReadCloud& cloud : {read_all(path), read_stream(path)}) {
    CHECK(cloud.quanta == las.points);
    CHECK(cloud.info.remarks.empty());
  }
}

TEST_CASE("an empty LAS file that declares no points is no error") {
  LasBytes las;
  las.points.clear();
  ScratchFolder scratch;
  const auto path = scratch.write("a.las", las.build());
  check_equal(read_all(path).size(), 0);
  CHECK(read_stream(path).info.remarks.empty());
}
