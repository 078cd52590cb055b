#include "io/scans/las/las_reader.hpp"

#include <unistd.h>

#include <bit>
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

using Keys = std::vector<std::array<std::uint16_t, 2>>;
using Counts = std::vector<std::pair<std::string, double>>;

constexpr const char* kMetreWkt = R"(LOCAL_CS["any",UNIT["metre",1]])";
constexpr const char* kFootWkt = R"(LOCAL_CS["feet",UNIT["foot",0.3048]])";

LasBytes::Record projection(const std::string& text) { return {"LASF_Projection", 2112, text}; }

LasBytes::Record projection(const Keys& keys) {
  std::vector<std::uint16_t> words{1, 1, 0, static_cast<std::uint16_t>(keys.size())};
  for (const auto& [key, value] : keys) words.insert(words.end(), {key, 0, 1, value});
  return {
      "LASF_Projection", 34735, {reinterpret_cast<const char*>(words.data()), words.size() * 2}};
}

CloudInfo info_of(const std::vector<LasBytes::Record>& vlrs) {
  const ScratchFolder scratch;
  LasBytes las;
  las.vlrs = vlrs;
  return open_point_file(scratch.write("a.las", las.build()))->info();
}

/// The file's bytes with another count of points in the header.
std::string with_count(const LasBytes& las, std::uint32_t count) {
  std::string bytes = las.build();
  if (las.minor < 4 || las.format < 6) LasBytes::put(bytes, 107, count);
  if (las.minor == 4) LasBytes::put<std::uint64_t>(bytes, 247, count);
  return bytes;
}

}  // namespace

TEST_CASE("coordinates of every version and point format are read as stored") {
  const ScratchFolder scratch;
  LasBytes las{.minor = GENERATE(range(0u, 5u)),
               .format = GENERATE(range(0u, 11u)),
               .extra_bytes = GENERATE(0u, 7u),
               .padding = 2};
  las.vlrs = {{"someone", 7, "payload"}};
  const auto path = scratch.write("a.las", las.build());
  const auto from_file = open_point_file(path);
  REQUIRE(from_file->info().declared_points == 3u);
  CHECK(*from_file->info().quantisation == Quantisation{{0.001, 0.01, 0.1}, {100, -200, 0}});
  for (int pass = 0; pass < 2; ++pass) {
    CHECK(read_all(*from_file).quanta == las.points);
    from_file->rewind();
  }
  const auto from_stream = open_las_stream(File::open_for_reading(path), scratch.folder());
  CHECK(read_all(*from_stream).quanta == las.points);
  CHECK_THROWS_AS(from_stream->rewind(), ResourceError);
}

TEST_CASE("classes of every point format are read, without the flags of formats 0 to 5") {
  const ScratchFolder scratch;
  LasBytes las{.minor = 4, .format = GENERATE(range(0u, 11u))};
  las.bytes_of_class = {2, 0xE0 | 7, 200};
  const std::vector<std::uint8_t> old{2, 7, 200 & 31};
  const std::vector<std::uint8_t>& expected = las.format < 6 ? old : las.bytes_of_class;
  const auto path = scratch.write("a.las", las.build());
  CHECK(read_all(path).classes == expected);
  PointBatch piece;
  open_point_file(path)->read_piece(0, piece, nullptr);
  CHECK(piece.classes == expected);
  const auto spooled =
      spool(open_las_stream(File::open_for_reading(path), scratch.folder()), scratch.folder());
  for (int pass = 0; pass < 2; ++pass) {
    CHECK(read_all(*spooled).classes == expected);
    spooled->rewind();
  }
}

TEST_CASE("LAS is read from a pipe") {
  LasBytes las{.minor = 4, .format = 6};
  las.vlrs = {projection(std::string(kMetreWkt) + '\0')};
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

TEST_CASE("a file without points is valid and empty, and so is a stream") {
  const ScratchFolder scratch;
  LasBytes las{.minor = GENERATE(0u, 3u, 4u)};
  las.points.clear();
  const auto path = scratch.write("a.las", las.build());
  check_equal(read_all(path).size(), 0);
  CHECK(read_stream(path).info.remarks.empty());
}

TEST_CASE("a CRS in an extended record is known at once from a file, at the end from a stream") {
  const ScratchFolder scratch;
  LasBytes las{.minor = 4, .format = 7};
  las.evlrs = {{"someone", 1, std::string(1000, 'x')}, projection(std::string(kMetreWkt) + '\0')};
  const auto path = scratch.write("a.las", las.build());
  CHECK(open_point_file(path)->info().unit == LengthUnit::kMetre);
  const auto stream = open_las_stream(File::open_for_reading(path), scratch.folder());
  CHECK(stream->info().unit == LengthUnit::kUnknown);
  CHECK(read_all(*stream).info.crs_wkt == kMetreWkt);
  CHECK(stream->info().unit == LengthUnit::kMetre);
}

TEST_CASE("well-known text counts more than what liblas repeats and than GeoTIFF keys") {
  std::vector<LasBytes::Record> vlrs{
      projection(Keys{{1024, 2}}), {"liblas", 2112, kFootWkt}, projection(kMetreWkt)};
  for (const LengthUnit unit : {LengthUnit::kMetre, LengthUnit::kFoot, LengthUnit::kDegrees}) {
    CHECK(info_of(vlrs).unit == unit);
    vlrs.pop_back();
  }
}

TEST_CASE("well-known text and GeoTIFF keys complete each other") {
  const auto info = [](const std::string& text, const Keys& keys) {
    return info_of({projection(keys), projection(text)});
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
  LasBytes::Record keys = projection(Keys{{1024, 1}, {3076, 9002}});
  keys.payload = edited(keys.payload, 6, 2, 65535) + "odd";
  CHECK(info_of({keys}).unit == LengthUnit::kFoot);
}

TEST_CASE("a LAS header or record that says what cannot be is refused with its place") {
  LasBytes las, records, tail, six;
  records.vlrs = {{"someone", 7, "payload"}};
  tail.minor = six.minor = 4;
  six.format = 6;
  tail.evlrs = {{"someone", 7, "payload"}};
  const std::size_t start = tail.points_end();
  const auto check = [](const LasBytes& file, std::size_t at, unsigned size, std::uint64_t value,
                        const std::string& words) {
    const RowName row(words);
    const std::string bytes = edited(file.build(), at, size, value);
    check_says(refusal_of_file("a.las", bytes), words);
    const ScratchFolder scratch;
    CHECK_FALSE(stream_refusal_of(scratch.write("a.las", bytes)).empty());
  };
  constexpr std::uint64_t kMost = ~std::uint64_t{0};
  check(las, 0, 1, 'X', "byte 0 ... LASF");
  check(las, 24, 1, 2, "byte 24 ... 2.2");
  check(las, 25, 1, 5, "1.5");
  check(las, 94, 2, 226, "byte 94 ... 227");
  check(las, 96, 4, 226, "byte 96");
  check(las, 104, 1, 11, "byte 104 ... 0 to 10");
  check(las, 105, 2, 19, "byte 105 ... 20");
  check(las, 105, 2, 0, "byte 105");
  check(las, 107, 4, 4, "307 ... 4 points");
  check(las, 107, 4, 0xFFFFFFFF, "4294967295 points");
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  for (const double scale : {0.0, -0.001, nan, inf, -inf}) {
    check(las, 139, 8, std::bit_cast<std::uint64_t>(scale), "byte 139 ... y scale");
  }
  for (const double offset : {nan, inf, -inf}) {
    check(las, 171, 8, std::bit_cast<std::uint64_t>(offset), "byte 171 ... z offset");
  }
  // In LAS 1.4 the count of 64 bits counts.
  check(tail, 247, 8, 4, "byte 247");
  check(six, 94, 2, 374, "375");
  check(six, 247, 8, 4, "4 points");
  check(six, 247, 8, kMost, "18446744073709551615 points");
  // Records end before the points, extended ones with the file.
  check(records, 227 + 20, 2, 8, "byte 227 ... record 1 of 1");
  check(records, 100, 4, 2, "record 2 of 2");
  check(records, 100, 4, 0xFFFFFFFF, "of 4294967295");
  check(tail, start + 20, 8, 8, "extended");
  check(tail, start + 20, 8, kMost, "extended");
  check(tail, 235, 8, start - 1, "behind the points");
  check(tail, 235, 8, kMost, "ends at byte");
  check(tail, 243, 4, 0xFFFFFFFF, "record 2 of");
  tail.evlrs = {projection("payload")};
  check(tail, start + 20, 8, kMost, "reference system");
}

// Headers of writers that crashed or wrote into a pipe declare fewer points than there are.
TEST_CASE("more points than declared are refused in a file, and a warning in a stream") {
  const ScratchFolder scratch;
  for (const LasBytes& las : las_samples()) {
    for (const std::uint32_t count : {0u, 2u}) {
      const auto path = scratch.write("a.las", with_count(las, count));
      const std::string declares = "a.las ... declares " + std::to_string(count);
      check_says(refusal_of(path), declares + " points ... holds 3 records of " +
                                       std::to_string(las.record_bytes()) + " ... standard input");
      const ReadCloud cloud = read_stream(path);
      CHECK(cloud.quanta == las.points);
      if (las.minor == 4 && !las.evlrs.empty()) check_equal(cloud.info.crs_wkt, "LOCAL_CS[\"b\"]");
      REQUIRE(codes_of(cloud.info.remarks) == "las-count");
      check_says(cloud.info.remarks[0].text, declares + " ... 3 came");
      CHECK(cloud.info.remarks[0].numbers ==
            Counts{{"declared", static_cast<double>(count)}, {"read", 3.0}});
    }
  }
}

TEST_CASE("a stream of many points beyond its count comes in whole batches") {
  LasBytes las{.format = 1};
  las.points.assign(150000, {7, 8, 9});
  las.points.back() = {1, 2, 3};
  const ScratchFolder scratch;
  const auto path = scratch.write("a.las", with_count(las, 70000));
  CHECK(read_stream(path).quanta == las.points);
  const auto reader = open_las_stream(File::open_for_reading(path), scratch.folder());
  std::vector<std::size_t> sizes;
  for (PointBatch batch; reader->read(batch);) sizes.push_back(batch.size());
  CHECK(sizes == std::vector<std::size_t>{65536, 65536, 18928});
}

TEST_CASE("bytes behind the points that are no whole record are refused as damage") {
  LasBytes las{.format = 2};
  const ScratchFolder scratch;
  for (const std::size_t more : {1u, 25u, 27u, 51u}) {
    const auto path = scratch.write("a.las", las.build() + std::string(more, 'p'));
    for (const std::string& refusal : {refusal_of(path), stream_refusal_of(path)}) {
      check_says(refusal, std::to_string(more) + " byte ... more behind its 3 points ... damaged");
      check_lacks(refusal, "standard input are");
    }
  }
  check_says(refusal_of_file("b.las", las.build() + std::string(26, 'p')), "4 records");
}

TEST_CASE("less than a record between the points and an extended record is a gap") {
  LasBytes las{.minor = 4};
  las.evlrs = {{"someone", 1, "payload"}};
  std::string bytes = edited(las.build(), 235, 8, las.points_end() + 3);
  bytes.insert(las.points_end(), "gap");
  const ScratchFolder scratch;
  const auto path = scratch.write("a.las", bytes);
  for (const ReadCloud& cloud : {read_all(path), read_stream(path)}) {
    CHECK(cloud.quanta == las.points);
    CHECK(cloud.info.remarks.empty());
  }
}
