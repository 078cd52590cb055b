// Origins of points on their way from scans and files of origins into a store.
#include <algorithm>
#include <cmath>
#include <set>

#include "io/store/convert/distribute.hpp"
#include "io/store/convert/origin_table.hpp"
#include "support/bytes/e57_bytes.hpp"
#include "support/bytes/pcd_bytes.hpp"
#include "support/catch.hpp"
#include "support/clouds.hpp"
#include "support/compare.hpp"
#include "support/store_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

constexpr Quantisation kSteps{{0.001, 0.001, 0.001}, {0, 0, 0}};
const std::string kOriginsHeader = "first,x,y,z\n";

/// A LAS scan of 300 points with steps of a millimetre, and a file of origins beside it.
struct ScanWithOrigins : Conversion {
  explicit ScanWithOrigins(const std::string& rows = "") {
    add_las("a.las", cube_cloud(300, -4000, 4000, 3), kSteps);
    if (!rows.empty()) give(kOriginsHeader + rows);
  }
  void give(const std::string& origins) { options.origins = folder.write("o.csv", origins); }
};

/// The place of the scanner that saw a point, in whole millimetres: "x y z", or "none".
std::string place_of(const StoreReader& store, std::size_t source) {
  const auto origin = origins_by_source(store)[source];
  if (!origin) return "none";
  std::string text;
  for (std::size_t k = 0; k < 3; ++k) {
    const double at = static_cast<double>((*origin)[k]) * 0.001 + store.quantisation().offset[k];
    text += (k == 0 ? "" : " ") + std::to_string(std::llround(at * 1000));
  }
  return text;
}

E57Bytes::Scan posed_scan(const std::string& xml, bool spherical = false) {
  E57Bytes::Scan scan{};
  const char* const names[2][3] = {{"cartesianX", "cartesianY", "cartesianZ"},
                                   {"sphericalRange", "sphericalAzimuth", "sphericalElevation"}};
  for (std::size_t k = 0; k < 3; ++k) {
    const std::vector<double> values{k == 0 ? 1 : 0.5, k == 0 ? 2 : 0.25};
    scan.fields.push_back(E57Bytes::float64(names[spherical ? 1 : 0][k], values));
  }
  scan.xml = xml;
  return scan;
}

}  // namespace

TEST_CASE("every point has the origin of its run in the file, whatever threads and layout") {
  ScanWithOrigins scan("0,1,2,3\n7,-4.0006,5,6\r\n 100 , 1, 2 ,3\n299,1e3,0,0\n");
  SECTION("adaptive") {}
  SECTION("regular") { scan.options.regular_size = 4; }
  const StoreReader store = scan.store();
  const StoreOrigins& origins = store.metadata().origins.value();
  CHECK(origins.quanta ==
        std::vector<OriginQuanta>{{-4001, 5000, 6000}, {1000, 2000, 3000}, {1000000, 0, 0}});
  check_equal(origins.points_without, 0);
  CHECK(origins.rest_on == std::vector<OriginBasis>{{"a file of origins", 300}});
  const auto by_source = origins_by_source(store);
  for (std::size_t i = 0; i < 300; ++i) {
    const std::size_t expected = i == 299 ? 2 : i >= 7 && i < 100 ? 0 : 1;
    REQUIRE(by_source[i] == origins.quanta[expected]);
  }
  const std::string bytes = bytes_of(scan.options.output);
  scan.options.threads = 4;
  const ConversionReport report = scan.convert();
  check_equal(report.origins, 3);
  check_equal(report.points_without_origin, 0);
  CHECK(bytes_of(scan.options.output) == bytes);
}

TEST_CASE("a store without origins says nothing of them, and origins change its fingerprint") {
  ScanWithOrigins scan;
  const StoreReader without = scan.store();
  CHECK_FALSE(without.has_origins());
  CHECK(bytes_of(scan.options.output).find("rest_on") == std::string::npos);
  std::set<std::uint64_t> prints{without.fingerprint()}, hashes;
  for (const char* rows : {"0,1,2,3\n", "0,1,2,4\n", "0,1,2,4\n9,1,2,3\n", "0,1,2,4\n8,1,2,3\n"}) {
    scan.give(kOriginsHeader + rows);
    const StoreReader store = scan.store();
    CHECK(store.metadata().points_hash == without.metadata().points_hash);
    prints.insert(store.fingerprint());
    hashes.insert(store.metadata().origins->hash);
  }
  check_equal(prints.size(), 5);
  check_equal(hashes.size(), 4);
}

TEST_CASE("a file of origins that is not one is refused with its line") {
  ScanWithOrigins scan;
  const auto check = [&](const std::string& text, const char* words) {
    CAPTURE(text);
    scan.give(text);
    check_says(scan.refusal(), words);
    CHECK_FALSE(std::filesystem::exists(scan.options.output));
  };
  const std::string& header = kOriginsHeader;
  check("", "is empty");
  check(header, "holds no origin");
  check("x,y,z\n0,1,2\n", "line 1");
  check("0,1,2,3\n", "expected the header first,x,y,z");
  check({"\x7f\x45LF\0\1\2\3\n", 9}, "line 1");
  for (const char* row : {"0,0,0", "0,0,0,0,0", "-1,0,0,0", "0.5,0,0,0"}) {
    check(header + row + "\n", "line 2");
  }
  check(header + "0,nan,0,0\n", "line 2: \"nan\" in column 2; expected a finite number as x");
  check(header + "0,0,0,inf\n", "line 2: \"inf\" in column 4; expected a finite number as z");
  check(header + "1,0,0,0\n", "line 2: starts at source index 1; expected 0");
  check(header + "0,1,1,1\n9,0,0,0\n9,0,0,0\n", "line 4: source index 9 after 9");
  check(header + "0,1,1,1\n9,0,0,0\n8,0,0,0\n", "line 4: source index 8 after 9");
  check(header + "0,1,1,1\n300,0,0,0\n", "line 3: starts at source index 300");
  check(header + "0,1,1,1.25", "line 2: ends without a line break");
  check(header + "0,1e30,1,1\n", "too far away");
  scan.options.origins = scan.folder / "none.csv";
  check_says(scan.refusal<Error>(), "none.csv");
  scan.give(header + "0,1,2,3\n");
  scan.options.output = scan.options.origins;
  check_says(scan.refusal<UsageError>(), "o.csv");
}

TEST_CASE("origins at zero and far away are warned of") {
  ScanWithOrigins scan("0,0,0,0\n50,0,0,0\n");
  check_equal(codes_of(scan.convert().warnings), "origins-at-zero");
  scan.give(kOriginsHeader + "0,0,0,0\n50,0,0,0.5\n");
  check_equal(codes_of(scan.convert().warnings), "");
  scan.give(kOriginsHeader + "0,0,0,0\n");  // a single scan in its scanner's own coordinates
  check_equal(codes_of(scan.convert().warnings), "");
  // All points are 99 m or more, and then 101 m or more away from the scanner.
  for (const double away : {103.0, 105.0}) {
    scan.add_las("a.las", cube_cloud(300, -4000, 4000, 3), {{0.001, 0.001, 0.001}, {away, 0, 0}});
    const ConversionReport report = scan.convert();
    check_equal(report.warnings.size(), (away > 104 ? 1 : 0));
    if (away > 104) check_says(report.warnings[0].text, "more than 101");
  }
  scan.add_las("a.las", cube_cloud(300, -4000, 4000, 3), kSteps);
  scan.give(kOriginsHeader + "0,1,0,0\n50,0,1e6,0\n");
  const ConversionReport far = scan.convert();
  REQUIRE(codes_of(far.warnings) == "origins-far");
  check_says(far.warnings[0].text, "1 of 2 origins ... 0 1000000 0");
  check_equal(StoreReader(scan.options.output).metadata().origins->quanta[0][1], 1000000000);
  scan.options.strict = true;
  check_says(scan.refusal(), "origins-far");
  // Far means a kilometre, which 3,200 feet are not.
  scan.options.strict = false;
  scan.options.unit = kMetresPerFoot;
  scan.give(kOriginsHeader + "0,1,0,0\n50,0,3200,0\n");
  check_equal(codes_of(scan.convert().warnings), "feet");
}

TEST_CASE("more origins than the memory may hold are refused with a number") {
  OriginTable table(kSteps, 1000);
  CHECK_THROWS_WITH(
      [&] {
        for (std::uint64_t i = 0; i < 100; ++i) {
          table.add(i, Vec3{static_cast<double>(i), 0, 0}, "o.csv");
        }
      }(),
      Contains("o.csv: 10 changes of the origin"));
}

TEST_CASE("a table of origins that are seen again and again takes memory for each only once") {
  OriginTable table(kSteps, std::uint64_t{1} << 20);
  for (std::uint64_t i = 0; i < 50000; ++i) {
    table.add_quanta(i, OriginQuanta{static_cast<std::int64_t>(i * 7919 % 100), 0, 0}, "a.las");
  }
  table.finish();
  CHECK(table.allocated_bytes() < 2 << 20);
  std::vector<DistributedPoint> points{DistributedPoint::of({}, 0, 0),
                                       DistributedPoint::of({}, 1, 0),
                                       DistributedPoint::of({}, 49999, 0)};
  check_equal(table.numbers_of(points), {1, 20, 1 + 49999 * 7919 % 100});
  OriginTable small(kSteps, std::uint64_t{1} << 20);
  check_refused(
      [&] {
        for (std::uint64_t i = 0; i < 80000; ++i) {
          small.add_quanta(i, OriginQuanta{static_cast<std::int64_t>(i % 2), 0, 0}, "a.las");
        }
      },
      "a quarter of the memory");
  OriginTable least(kSteps, 1000);
  check_refused(
      [&] {
        for (int i = 0; i < 100; ++i) {
          least.add(static_cast<std::uint64_t>(i), Vec3{1.0 * i, 0, 0}, "o.csv");
        }
      },
      "o.csv: 10 changes of the origin");
}

TEST_CASE("a scan of E57 has its pose's place as origin, or that of its spherical coordinates") {
  E57Bytes e57;
  e57.scans = {
      posed_scan(""), posed_scan(E57Bytes::pose({"1", "0", "0", "0"}, {"10", "-20", "0.5"})),
      posed_scan("", true), posed_scan(E57Bytes::pose({"0", "1", "0", "0"}, {"0", "0", "0"}))};
  Conversion conversion;
  conversion.add("a.e57", e57.build());
  conversion.options.scale = 0.001;
  check_equal(codes_of(conversion.convert().warnings), "points-without-origin");
  const StoreReader store = conversion.store();
  CHECK(store.metadata().origins.value().rest_on == std::vector<OriginBasis>{{"poses of E57", 6}});
  check_equal(store.metadata().origins->points_without, 2);
  for (const auto& [source, place] :
       {std::pair(1, "none"), {2, "10000 -20000 500"}, {4, "0 0 0"}, {7, "0 0 0"}}) {
    check_equal(place_of(store, static_cast<std::size_t>(source)), place);
  }
}

TEST_CASE("of merged inputs each point has the origin that its own format tells") {
  Conversion conversion;
  conversion.add(
      "a.ptx",
      "1\n2\n5 6 7\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n5 6 7 1\n"
      "1 1 1 0.5\n0 0 0 0.5\n"
      "1\n1\n8 6 7\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n8 6 7 1\n2 2 2 0.5\n");
  conversion.add("b.xyz", "1 2 3\n4 5 6\n");
  PcdHeaderText pcd;
  pcd.viewpoint = "10 20 -3 1 0 0 0";
  conversion.add("c.pcd", pcd.build("ascii") + "1.5 -2 0.1\n4 5 6\n");
  conversion.add("d.3d", "100 200 300\n");
  put_bytes(conversion.folder / "d.pose", "100 200 300\n0 0 0\n");
  conversion.options.scale = 0.001;
  check_equal(conversion.convert().points_without_origin, 2);
  {
    const StoreReader store = conversion.store();
    CHECK(store.metadata().origins.value().rest_on ==
          std::vector<OriginBasis>{
              {"scanner positions of PTX", 2}, {"viewpoints of PCD", 2}, {"poses of 3DTK", 1}});
    // The second record has no point, and is not stored.
    for (const auto& [source, place] : {std::pair(0, "5000 6000 7000"),
                                        {1, "none"},
                                        {2, "8000 6000 7000"},
                                        {3, "none"},
                                        {5, "10000 20000 -3000"},
                                        {7, "3000 -1000 2000"}}) {
      check_equal(place_of(store, static_cast<std::size_t>(source)), place);
    }
  }
  conversion.options.origins = conversion.folder.write("o.csv", "first,x,y,z\n0,1,2,3\n");
  CHECK(conversion.store().metadata().origins.value().rest_on ==
        std::vector<OriginBasis>{{"a file of origins", 7}});
}
