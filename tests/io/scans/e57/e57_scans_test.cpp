// Scans, poses, spherical coordinates, records without a point, and the remarks about them.
#include <cmath>

#include "support/bytes/e57_bytes.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/reader_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

struct ReadScans {
  std::vector<Vec3> positions;
  std::vector<std::uint64_t> absent;  ///< places of the absent points, counted in the file
  CloudInfo info;
};

ReadScans collect(PointReader& reader) {
  ReadScans all;
  for (PointBatch batch; reader.read(batch);) {
    for (const std::uint32_t i : batch.absent) all.absent.push_back(all.positions.size() + i);
    all.positions.insert(all.positions.end(), batch.positions.begin(), batch.positions.end());
  }
  all.info = reader.info();
  return all;
}

ReadScans read_scans(const E57Bytes& file) {
  const ScratchFolder scratch;
  return collect(*open_point_file(scratch.write("a.e57", file.build())));
}

void check_near(const Vec3& found, const Vec3& expected) {
  for (int k = 0; k < 3; ++k) CHECK(found[k] == Approx(expected[k]).margin(1e-12));
}

std::string all_texts(const CloudInfo& info) {
  std::string all;
  for (const Message& message : info.remarks) all += message.text + "\n";
  return all;
}

const std::string kHalf = "7.0710678118654752e-1";

}  // namespace

TEST_CASE("each scan's pose turns and then shifts its points, in the order of the file") {
  E57Bytes file;
  file.scans = {e57_scan({1, 0}, {2, 0}, {3, 1}), e57_scan({1}, {2}, {3}), e57_scan({1}, {2}, {3})};
  // A quarter turn about z: x to y, y to -x.
  file.scans[0].xml = E57Bytes::pose({kHalf, "", "", kHalf}, {"400000", "5e6", "-1.5"});
  // A quarter turn about x: y to z, z to -y.
  file.scans[1].xml = E57Bytes::pose({kHalf, kHalf, "0", "0"}, {"0", "0", "0"});
  const ReadScans all = read_scans(file);
  REQUIRE(all.positions.size() == 4);
  check_near(all.positions[0], {399998, 5000001, 1.5});
  check_near(all.positions[1], {400000, 5000000, -0.5});
  check_near(all.positions[2], {1, -3, 2});
  CHECK(all.positions[3] == Vec3{1, 2, 3});
  check_equal(all.info.declared_points, 4);
  check_says(all_texts(all.info), "3 scans; 2 poses are applied");
}

TEST_CASE("half of a pose is a pose, a quaternion is normalised") {
  E57Bytes file;
  file.scans = {e57_scan({1}, {2}, {3}), e57_scan({1}, {2}, {3}), e57_scan({1}, {2}, {3})};
  const std::string shift = "<translation type=\"Structure\">" + E57Bytes::number("x", "4") +
                            E57Bytes::number("y", "5") + E57Bytes::number("z", "+6") +
                            "</translation>";
  file.scans[0].xml = "<pose type=\"Structure\">" + shift + "</pose>";
  file.scans[1].xml = "<pose type=\"Structure\"/>";
  file.scans[2].xml = E57Bytes::pose({"0.707", "0", "0", "0.707"}, {"0", "0", "0"});
  const ReadScans all = read_scans(file);
  CHECK(all.positions[0] == Vec3{5, 7, 9});
  CHECK(all.positions[1] == Vec3{1, 2, 3});
  check_near(all.positions[2], {-2, 1, 3});
}

TEST_CASE("spherical coordinates are range, azimuth from x to y, elevation from the plane to z") {
  const double quarter = std::acos(0.0);
  E57Bytes file;
  file.scans.emplace_back();
  file.scans[0].fields = {
      E57Bytes::float64("sphericalRange", {2, 2, 2, 2, 2}),
      E57Bytes::float64("sphericalAzimuth", {0, quarter, 0, -quarter, quarter / 2}),
      E57Bytes::float64("sphericalElevation", {0, 0, quarter, 0, -quarter / 2}),
      E57Bytes::integer("sphericalInvalidState", 0, 2, {0, 0, 0, 1, 0})};
  const ReadScans all = read_scans(file);
  REQUIRE(all.positions.size() == 5);
  check_near(all.positions[0], {2, 0, 0});
  check_near(all.positions[1], {0, 2, 0});
  check_near(all.positions[2], {0, 0, 2});
  CHECK(std::isnan(all.positions[3].x));
  check_near(all.positions[4], {1, 1, -std::sqrt(2.0)});
  check_equal(all.absent, {3});
}

TEST_CASE("angles beyond their range are refused, unless their record is invalid") {
  const auto file_of = [](double azimuth, double elevation, int state) {
    E57Bytes file;
    file.scans.emplace_back();
    file.scans[0].fields = {E57Bytes::float64("sphericalRange", {2, 2}),
                            E57Bytes::float64("sphericalAzimuth", {0, azimuth}),
                            E57Bytes::float64("sphericalElevation", {0, elevation}),
                            E57Bytes::integer("sphericalInvalidState", 0, 2, {0, state})};
    return file;
  };
  const ScratchFolder scratch;
  const auto refusal = [&](double azimuth, double elevation) {
    return refusal_of(scratch.write("a.e57", file_of(azimuth, elevation, 0).build()));
  };
  check_says(refusal(7, 0),
             "scan 1, record 1 (counted from 0): azimuth 7; expected an angle up to "
             "6.28318531, as E57 has radians, not degrees");
  check_says(refusal(-90, 0), "azimuth -90");
  check_says(refusal(0, 3.2), "record 1 ... elevation 3.2");
  check_equal(read_scans(file_of(90, 90, 2)).positions.size(), 2);
  check_equal(read_scans(file_of(-6.2832, 1.6, 0)).positions.size(), 2);
}

TEST_CASE("the Cartesian coordinates count where they are valid, then the spherical ones") {
  E57Bytes file;
  file.scans = {e57_scan({1, 2, 3, 4}, {0, 0, 0, 0}, {0, 0, 0, 0})};
  auto& fields = file.scans[0].fields;
  for (const auto& [name, value] :
       {std::pair{"sphericalRange", 9.0}, {"sphericalAzimuth", 0.0}, {"sphericalElevation", 0.0}}) {
    fields.push_back(E57Bytes::float64(name, {value, value, value, value}));
  }
  SECTION("with states, whatever numbers they are") {
    fields.push_back(E57Bytes::float32("cartesianInvalidState", {0, 1, 2, 2}));
    fields.push_back(E57Bytes::integer("sphericalInvalidState", -1, 2, {2, 0, 0, 1}));
    const ReadScans all = read_scans(file);
    check_equal(all.positions[0].x, 1);
    check_equal(all.positions[1].x, 9);
    check_equal(all.positions[2].x, 9);
    CHECK(std::isnan(all.positions[3].x));
    check_equal(all.absent, {3});
    REQUIRE(all.info.remarks.size() == 1);
    check_says(all.info.remarks[0].text, "1 of 4 records have no valid point");
    CHECK(all.info.remarks[0].severity == Message::Severity::kNote);
  }
  SECTION("without states all are valid") {
    const ReadScans all = read_scans(file);
    check_equal(all.positions[3].x, 4);
    CHECK(all.absent.empty());
  }
}

TEST_CASE("absent records keep their numbers over batches and scans, reading again says the same") {
  E57Bytes file;
  constexpr std::size_t kCount = 70'000;
  std::vector<std::int64_t> x(kCount), state(kCount);
  for (std::size_t i = 0; i < kCount; ++i) {
    x[i] = static_cast<std::int64_t>(i);
    state[i] = i % 1000 == 7 ? 2 : 0;
  }
  for (int scan = 0; scan < 2; ++scan) {
    file.scans.emplace_back();
    file.scans.back().fields = {E57Bytes::integer("cartesianX", 0, 131071, x),
                                E57Bytes::integer("cartesianY", 3, 3, x),
                                E57Bytes::integer("cartesianZ", 0, 131071, x),
                                E57Bytes::integer("cartesianInvalidState", 0, 2, state)};
    file.scans.back().packets.assign(20, {8000, 0, 9000, 700});
  }
  const ScratchFolder scratch;
  const auto reader = open_point_file(scratch.write("a.e57", file.build()));
  for (int pass = 0; pass < 3; ++pass) {
    const ReadScans all = collect(*reader);
    REQUIRE(all.positions.size() == 2 * kCount);
    REQUIRE(all.absent.size() == 140);
    for (std::size_t i = 0; i < 140; ++i) REQUIRE(all.absent[i] == i * 1000 + 7);
    check_equal(all.positions[kCount + 5].x, 5);
    REQUIRE(all.info.remarks.size() == 2);
    check_says(all_texts(all.info), "2 scans; none has a pose ... 140 of 140,000 records");
    reader->rewind();
    PointBatch batch;
    if (pass == 1) REQUIRE(reader->read(batch));  // then it is rewound from the middle
    reader->rewind();
  }
}

TEST_CASE("scans without points or coordinates are stepped over, and said") {
  E57Bytes file;
  file.scans = {e57_scan({}, {}, {}), e57_scan({1}, {2}, {3})};
  file.scans.emplace_back();
  file.scans[2].fields = {E57Bytes::integer("colorRed", 0, 255, {1, 2, 3})};
  const ReadScans all = read_scans(file);
  check_equal(all.positions.size(), 1);
  check_equal(all.info.declared_points, 1);
  check_says(all_texts(all.info),
             "3 scans; none has a pose ... 1 scan without points, of 3 ... 1 scan without "
             "coordinates, of 3");
}

TEST_CASE("a file without scans, and a scan without a binary section, hold no points") {
  E57Bytes file;
  CHECK(read_scans(file).positions.empty());
  check_equal(read_scans(file).info.declared_points, 0);
  file.scans = {e57_scan({}, {}, {})};
  E57Bytes::Content content = file.content();
  const std::string offset = "fileOffset=\"48\"";
  content.bytes.replace(content.bytes.find(offset), offset.size(), "fileOffset=\"00\"");
  const ScratchFolder scratch;
  check_equal(read_all(scratch.write("a.e57", E57Bytes::paged(content.bytes))).size(), 0);
}

TEST_CASE("the coordinate reference system is kept, and its unit, E57's own is the metre") {
  E57Bytes file;
  file.scans = {e57_scan({1}, {2}, {3})};
  CHECK(read_scans(file).info.unit == LengthUnit::kMetre);
  CHECK(read_scans(file).info.crs_wkt.empty());
  const std::string wkt = R"(LOCAL_CS["p",UNIT["US survey foot",0.3048006096012192]])";
  file.root_xml =
      "<coordinateMetadata type=\"String\"><![CDATA[" + wkt + "]]></coordinateMetadata>";
  CHECK(read_scans(file).info.unit == LengthUnit::kUsSurveyFoot);
  CHECK(read_scans(file).info.crs_wkt == wkt);
  REQUIRE(read_scans(file).info.remarks.size() == 1);
  check_equal(read_scans(file).info.remarks[0].code, "e57-unit");
  file.root_xml =
      "<coordinateMetadata type=\"String\"><![CDATA[LOCAL_CS[\"l\",UNIT[\"metre\",1]],"
      "VERT_CS[\"v\",VERT_DATUM[\"d\",2005],UNIT[\"foot\",0.3048]] ]]></coordinateMetadata>";
  CHECK(read_scans(file).info.unit == LengthUnit::kMetre);
  check_equal(read_scans(file).info.height_unit, 0.3048);
  file.root_xml = "<coordinateMetadata type=\"String\">EPSG:25832</coordinateMetadata>";
  check_equal(read_scans(file).info.crs, "EPSG:25832");
  file.root_xml = "<coordinateMetadata type=\"String\">a &lt; b</coordinateMetadata>";
  CHECK_FALSE(read_scans(file).info.crs_unread.empty());
  CHECK(read_scans(file).info.unit == LengthUnit::kMetre);
  check_equal(read_scans(file).info.crs_wkt, "a < b");
}

TEST_CASE("points far beyond the declared bounds are warned of, in either frame") {
  E57Bytes file;
  file.scans = {e57_scan({1000, 5000}, {0, 0}, {0, 2000})};
  const auto bounds = [](const std::string& least, const std::string& greatest) {
    std::string xml = "<cartesianBounds type=\"Structure\">";
    for (const std::string axis : {"x", "y", "z"}) {
      xml +=
          E57Bytes::number(axis + "Minimum", least) + E57Bytes::number(axis + "Maximum", greatest);
    }
    return xml + "</cartesianBounds>";
  };
  const auto remarks = [&] { return read_scans(file).info.remarks; };
  file.scans[0].xml = bounds("0", "5");  // the points are in millimetres
  REQUIRE(remarks().size() == 1);
  CHECK(remarks()[0].severity == Message::Severity::kWarning);
  check_equal(remarks()[0].code, "outside-bounds");
  check_says(remarks()[0].text, "scan 1: all 2 points ... (5000, 0, 2000)");
  file.scans[0].xml = bounds("0", "1500");
  check_equal(remarks()[0].code, "declared-bounds");
  check_says(remarks()[0].text, "scan 1: 1 of 2 points");
  for (const auto& [least, greatest] : {std::pair{"0", "5000"},
                                        {"0", "4999.9"},
                                        {"0", "0"},
                                        {"-1.79e308", "1.79e308"},
                                        {"3", "1"},
                                        {"nan", "inf"}}) {
    file.scans[0].xml = bounds(least, greatest);
    CHECK(remarks().empty());
  }
  // Some writers declare the bounds behind the pose.
  file.scans[0].xml =
      bounds("-6000", "-2000") + E57Bytes::pose({"1", "0", "0", "0"}, {"-7000", "-4000", "-4000"});
  check_equal(remarks().size(), 1);
  CHECK(remarks()[0].severity == Message::Severity::kNote);
  file.scans[0].xml =
      bounds("0", "5000") + E57Bytes::pose({"1", "0", "0", "0"}, {"-1e6", "-4000", "-4000"});
  check_equal(remarks().size(), 1);
}

TEST_CASE("coordinates at an end of 32-bit integers are cut off, and a single one is not") {
  const auto remarks = [](const std::vector<std::int64_t>& y, std::int64_t greatest) {
    E57Bytes file;
    const std::vector<double> others(y.size());
    file.scans = {e57_scan(others, others, others)};
    file.scans[0].fields[1] =
        E57Bytes::integer("cartesianY", -2147483648, greatest, y, "scale=\"0.001\" offset=\"5\"");
    return read_scans(file).info.remarks;
  };
  constexpr std::int64_t kEnd = 2147483647;
  const std::vector<Message> cut = remarks({1, kEnd, -2147483648, kEnd, kEnd, 7}, kEnd);
  REQUIRE(cut.size() == 1);
  check_equal(cut[0].code, "cut-off");
  check_says(cut[0].text, "scan 1 ... 3 points at the greatest y");
  CHECK(remarks({1, kEnd, -2147483648, 7}, kEnd).empty());
  CHECK(remarks({1, kEnd, kEnd, 7}, 2 * kEnd).empty());
}
