#include "io/scans/las/las_reader.hpp"

#include <unistd.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "io/scans/scan_crs.hpp"
#include "io/store/convert/spooled_reader.hpp"
#include "support/bytes/las_bytes.hpp"
#include "support/reader_fixture.hpp"

using namespace clearway;
using namespace clearway::test;
using Catch::Matchers::Contains;

namespace {

const std::string kMetreWkt = R"(LOCAL_CS["any",UNIT["metre",1]])";

std::string geo_keys(const std::vector<std::array<std::uint16_t, 2>>& keys) {
  std::vector<std::uint16_t> words{1, 1, 0, static_cast<std::uint16_t>(keys.size())};
  for (const auto& [key, value] : keys) words.insert(words.end(), {key, 0, 1, value});
  return {reinterpret_cast<const char*>(words.data()), words.size() * 2};
}

std::string refusal_of_bytes(const std::string& bytes) {
  ReaderScratch scratch;
  const auto path = scratch.write("a.las", bytes);
  const std::string refusal = refusal_of(path);
  CHECK_THAT(refusal, Contains(path.string()));
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
  ReaderScratch scratch;
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
  CHECK(from_file->info().quantisation->scale[1] == 0.01);
  CHECK(from_file->info().quantisation->offset[0] == 100);
  CHECK(read_all(*from_file).quanta == las.points);
  from_file->rewind();
  CHECK(read_all(*from_file).quanta == las.points);
  const auto from_stream =
      open_las_stream(File::open_for_reading(path), std::filesystem::temp_directory_path());
  CHECK(read_all(*from_stream).quanta == las.points);
  CHECK_THROWS_AS(from_stream->rewind(), ResourceError);
}

TEST_CASE("classes of every point format are read, without the flags of formats 0 to 5") {
  ReaderScratch scratch;
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
  ReaderScratch scratch;
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
  ReaderScratch scratch;
  LasBytes las;
  las.minor = GENERATE(0u, 3u, 4u);
  las.points.clear();
  CHECK(read_all(scratch.write("a.las", las.build())).size() == 0);
}

TEST_CASE("bytes behind the points do no harm") {
  ReaderScratch scratch;
  LasBytes las;
  CHECK(read_all(scratch.write("a.las", las.build() + "surplus")).quanta == las.points);
}

TEST_CASE("a CRS in an extended record is known at once from a file, at the end from a stream") {
  ReaderScratch scratch;
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
  ReaderScratch scratch;
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
    ReaderScratch scratch;
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
  CHECK(by_keys.crs == "EPSG:26917");
  CHECK_THAT(by_keys.crs_doubt, Contains("PROJCS") && Contains("its GeoTIFF keys count"));
  CHECK_THAT(info("PROJCS[\"a\"]", {}).crs_unread, Contains("PROJCS"));
  const CloudInfo other = info(kMetreWkt, {{1024, 1}, {3076, 9002}});
  CHECK(other.unit == LengthUnit::kMetre);
  CHECK_THAT(other.unit_doubt, Contains("its GeoTIFF keys foot"));
}

TEST_CASE("a GeoTIFF directory that counts more keys than it holds is read as far as it goes") {
  ReaderScratch scratch;
  LasBytes las;
  std::string keys = geo_keys({{1024, 1}, {3076, 9002}});
  LasBytes::put<std::uint16_t>(keys, 6, 65535);
  las.vlrs = {{"LASF_Projection", 34735, keys + "odd"}};
  CHECK(open_point_file(scratch.write("a.las", las.build()))->info().unit == LengthUnit::kFoot);
}

TEST_CASE("a malformed LAS header is refused with its place") {
  LasBytes las;
  CHECK_THAT(refusal_with<char>(las, 0, 'X'), Contains("byte 0") && Contains("LASF"));
  CHECK_THAT(refusal_with<std::uint8_t>(las, 24, 2), Contains("byte 24") && Contains("2.2"));
  CHECK_THAT(refusal_with<std::uint8_t>(las, 25, 5), Contains("1.5"));
  CHECK_THAT(refusal_with<std::uint16_t>(las, 94, 226), Contains("byte 94") && Contains("227"));
  CHECK_THAT(refusal_with<std::uint32_t>(las, 96, 226), Contains("byte 96"));
  CHECK_THAT(refusal_with<std::uint8_t>(las, 104, 11), Contains("byte 104") && Contains("0 to 10"));
  CHECK_THAT(refusal_with<std::uint16_t>(las, 105, 19), Contains("byte 105") && Contains("20"));
  CHECK_THAT(refusal_with<std::uint16_t>(las, 105, 0), Contains("byte 105"));
  CHECK_THAT(refusal_with<std::uint32_t>(las, 107, 4), Contains("307") && Contains("4 points"));
  CHECK_THAT(refusal_with<std::uint32_t>(las, 107, 0xFFFFFFFF), Contains("4294967295 points"));
}

TEST_CASE("a scale that is not positive and a number that is not finite are refused") {
  LasBytes las;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  for (const double scale : {0.0, -0.001, nan, inf, -inf}) {
    CHECK_THAT(refusal_with(las, 139, scale), Contains("byte 139") && Contains("y scale"));
  }
  for (const double offset : {nan, inf, -inf}) {
    CHECK_THAT(refusal_with(las, 171, offset), Contains("byte 171") && Contains("z offset"));
  }
}

TEST_CASE("the 64-bit count of LAS 1.4 is the one that counts") {
  LasBytes las;
  las.minor = 4;
  CHECK_THAT(refusal_with<std::uint64_t>(las, 247, 4), Contains("byte 247"));
  CHECK_THAT(refusal_with<std::uint16_t>(las, 94, 374), Contains("375"));
  las.format = 6;
  CHECK_THAT(refusal_with<std::uint64_t>(las, 247, 4), Contains("4 points"));
  const std::uint64_t huge = std::numeric_limits<std::uint64_t>::max();
  CHECK_THAT(refusal_with(las, 247, huge), Contains("18446744073709551615 points"));
}

TEST_CASE("variable length records must end before the points, extended ones with the file") {
  LasBytes las;
  las.vlrs = {{"someone", 7, "payload"}};
  CHECK_THAT(refusal_with<std::uint16_t>(las, 227 + 20, 8),
             Contains("byte 227") && Contains("record 1 of 1"));
  CHECK_THAT(refusal_with<std::uint32_t>(las, 100, 2), Contains("record 2 of 2"));
  CHECK_THAT(refusal_with<std::uint32_t>(las, 100, 0xFFFFFFFF), Contains("of 4294967295"));

  LasBytes tail;
  tail.minor = 4;
  tail.evlrs = {{"someone", 7, "payload"}};
  const std::size_t start = tail.points_end();
  CHECK_THAT(refusal_with<std::uint64_t>(tail, start + 20, 8), Contains("extended"));
  CHECK_THAT(refusal_with<std::uint64_t>(tail, start + 20, ~std::uint64_t{0}),
             Contains("extended"));
  CHECK_THAT(refusal_with<std::uint64_t>(tail, 235, start - 1), Contains("behind the points"));
  CHECK_THAT(refusal_with<std::uint64_t>(tail, 235, ~std::uint64_t{0}), Contains("ends at byte"));
  CHECK_THAT(refusal_with<std::uint32_t>(tail, 243, 0xFFFFFFFF), Contains("record 2 of"));
  tail.evlrs = {{"LASF_Projection", 2112, "payload"}};
  CHECK_THAT(refusal_with<std::uint64_t>(tail, start + 20, ~std::uint64_t{0}),
             Contains("reference system"));
}
