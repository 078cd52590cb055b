// Origins of points on their way from scans and files of origins into a store.
#include "support/origins.hpp"

#include <hdf5.h>

#include <algorithm>
#include <cmath>

#include "io/store/convert/origin_table.hpp"
#include "support/bytes/e57_bytes.hpp"
#include "support/bytes/pcd_bytes.hpp"
#include "support/catch.hpp"
#include "support/clouds.hpp"
#include "support/compare.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

constexpr Quantisation kSteps{{0.001, 0.001, 0.001}, {0, 0, 0}};

/// A LAS scan of 300 points with steps of a millimetre, and a file of origins beside it.
struct ScanWithOrigins {
  ScratchFolder folder;
  ConversionOptions options = conversion_of({folder / "a.las"}, folder / "a.h5");

  explicit ScanWithOrigins(const std::string& origins = "") {
    write_las(folder / "a.las", cube_cloud(300, -4000, 4000, 3), kSteps);
    if (!origins.empty()) give(origins);
  }
  void give(const std::string& origins) {
    put_bytes(folder / "o.csv", origins);
    options.origins = folder / "o.csv";
  }
};

std::vector<std::string> codes_of(const ConversionReport& report) {
  std::vector<std::string> codes;
  for (const Message& warning : report.warnings) codes.push_back(warning.code);
  return codes;
}

std::vector<OriginBasis> bases_of(const StoreReader& store) {
  return store.metadata().origins->rest_on;
}

E57Bytes::Scan posed_scan(const std::string& xml, bool spherical = false) {
  const std::vector<double> a{1, 2}, b{0.5, 0.25};
  E57Bytes::Scan scan{};
  const char* const names[2][3] = {{"cartesianX", "cartesianY", "cartesianZ"},
                                   {"sphericalRange", "sphericalAzimuth", "sphericalElevation"}};
  for (std::size_t k = 0; k < 3; ++k) {
    scan.fields.push_back(E57Bytes::float64(names[spherical ? 1 : 0][k], k == 0 ? a : b));
  }
  scan.xml = xml;
  return scan;
}

}  // namespace

TEST_CASE("every point has the origin of its run in the file, whatever threads and layout") {
  ScanWithOrigins scan("first,x,y,z\n0,1,2,3\n7,-4.0006,5,6\r\n 100 , 1, 2 ,3\n299,1e3,0,0\n");
  SECTION("adaptive") {}
  SECTION("regular") { scan.options.regular_size = 4; }
  const ConversionReport report = convert_quietly(scan.options);
  const StoreReader store(scan.options.output);
  REQUIRE(store.has_origins());
  const StoreOrigins& origins = *store.metadata().origins;
  CHECK(origins.quanta ==
        std::vector<OriginQuanta>{{-4001, 5000, 6000}, {1000, 2000, 3000}, {1000000, 0, 0}});
  check_equal(origins.points_without, 0);
  CHECK(origins.rest_on == std::vector<OriginBasis>{{"a file of origins", 300}});
  check_equal(report.origins, 3);
  check_equal(report.points_without_origin, 0);
  const auto by_source = origins_by_source(store);
  for (std::size_t i = 0; i < 300; ++i) {
    const std::size_t expected = i == 299 ? 2 : i >= 7 && i < 100 ? 0 : 1;
    REQUIRE(by_source[i] == origins.quanta[expected]);
  }
  CHECK(faults_of(store).empty());
  const std::string bytes = bytes_of(scan.options.output);
  scan.options.threads = 4;
  convert_quietly(scan.options);
  CHECK(bytes_of(scan.options.output) == bytes);
}

TEST_CASE("a store without origins says nothing of them, and origins change its fingerprint") {
  ScanWithOrigins scan;
  convert_quietly(scan.options);
  const StoreReader without(scan.options.output);
  CHECK_FALSE(without.has_origins());
  CHECK(bytes_of(scan.options.output).find("rest_on") == std::string::npos);
  std::vector<std::uint64_t> prints{without.fingerprint()}, hashes;
  for (const char* rows : {"0,1,2,3\n", "0,1,2,4\n", "0,1,2,4\n9,1,2,3\n", "0,1,2,4\n8,1,2,3\n"}) {
    scan.give(std::string("first,x,y,z\n") + rows);
    convert_quietly(scan.options);
    const StoreReader store(scan.options.output);
    CHECK(store.metadata().points_hash == without.metadata().points_hash);
    prints.push_back(store.fingerprint());
    hashes.push_back(store.metadata().origins->hash);
  }
  for (std::size_t i = 0; i < prints.size(); ++i) {
    check_equal(std::count(prints.begin(), prints.end(), prints[i]), 1);
  }
  for (const std::uint64_t hash : hashes) {
    check_equal(std::count(hashes.begin(), hashes.end(), hash), 1);
  }
}

TEST_CASE("a file of origins that is not one is refused with its line") {
  struct Refused {
    std::string text, message;
  };
  const std::string header = "first,x,y,z\n";
  const Refused refused = GENERATE_COPY(values<Refused>({
      {header, "holds no origin"},
      {"x,y,z\n0,1,2\n", "line 1"},
      {"0,1,2,3\n", "expected the header first,x,y,z"},
      {std::string("\x7f"
                   "ELF\0\1\2\3\n",
                   9),
       "line 1"},
      {header + "0,nan,0,0\n", "line 2: \"nan\"; expected a finite coordinate"},
      {header + "0,0,0,inf\n", "line 2: \"inf\"; expected a finite coordinate"},
      {header + "0,0,0\n", "line 2"},
      {header + "0,0,0,0,0\n", "line 2"},
      {header + "-1,0,0,0\n", "line 2"},
      {header + "0.5,0,0,0\n", "line 2"},
      {header + "1,0,0,0\n", "line 2: starts at source index 1; expected 0"},
      {header + "0,1,1,1\n9,0,0,0\n9,0,0,0\n", "line 4: source index 9 after 9"},
      {header + "0,1,1,1\n9,0,0,0\n8,0,0,0\n", "line 4: source index 8 after 9"},
      {header + "0,1,1,1\n300,0,0,0\n", "line 3: starts at source index 300"},
      {header + "0,1,1,1.25", "line 2: ends without a line break"},
      {header + "0,1e30,1,1\n", "too far away"},
  }));
  ScanWithOrigins scan(refused.text);
  check_says(conversion_refusal<InputError>(scan.options), refused.message);
  CHECK_FALSE(std::filesystem::exists(scan.options.output));
}

TEST_CASE("an empty or missing file of origins is refused") {
  ScanWithOrigins scan;
  scan.give("");
  check_says(conversion_refusal<InputError>(scan.options), "is empty");
  scan.options.origins = scan.folder / "none.csv";
  check_says(conversion_refusal(scan.options), "none.csv");
  scan.options.origins = scan.folder / "o.csv";
  scan.options.output = scan.options.origins;
  scan.give("first,x,y,z\n0,1,2,3\n");
  CHECK_FALSE(conversion_refusal<UsageError>(scan.options).empty());
}

TEST_CASE("origins at zero and far away are warned of") {
  ScanWithOrigins scan("first,x,y,z\n0,0,0,0\n50,0,0,0\n");
  check_equal(codes_of(convert_quietly(scan.options)), {"origins-at-zero"});
  scan.give("first,x,y,z\n0,0,0,0\n50,0,0,0.5\n");
  CHECK(codes_of(convert_quietly(scan.options)).empty());
  scan.give("first,x,y,z\n0,0,0,0\n");  // a single scan in its scanner's own coordinates
  CHECK(codes_of(convert_quietly(scan.options)).empty());
  // All points are 99 m or more, and then 101 m or more away from the scanner.
  for (const double away : {103.0, 105.0}) {
    write_las(scan.folder / "a.las", cube_cloud(300, -4000, 4000, 3),
              {{0.001, 0.001, 0.001}, {away, 0, 0}});
    const ConversionReport report = convert_quietly(scan.options);
    check_equal(codes_of(report).size(), (away > 104 ? 1 : 0));
    if (away > 104) check_says(report.warnings[0].text, "more than 101");
  }
  write_las(scan.folder / "a.las", cube_cloud(300, -4000, 4000, 3), kSteps);
  scan.give("first,x,y,z\n0,1,0,0\n50,0,1e6,0\n");
  const ConversionReport far = convert_quietly(scan.options);
  REQUIRE(codes_of(far) == std::vector<std::string>{"origins-far"});
  check_says(far.warnings[0].text, "1 of 2 origins ... 0 1000000 0");
  check_equal(StoreReader(scan.options.output).metadata().origins->quanta[0][1], 1000000000);
  scan.options.strict = true;
  check_says(conversion_refusal<InputError>(scan.options), "origins-far");
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

TEST_CASE("resuming knows the origins that a store was given") {
  ScanWithOrigins scan("first,x,y,z\n0,1,2,3\n");
  convert_quietly(scan.options);
  NoProgress progress;
  CHECK(is_converted(scan.options, progress));
  scan.give("first,x,y,z\n0,1,2,4\n");
  CHECK_FALSE(is_converted(scan.options, progress));
  scan.options.origins.clear();
  CHECK_FALSE(is_converted(scan.options, progress));
  convert_quietly(scan.options);
  CHECK(is_converted(scan.options, progress));
}

TEST_CASE("a scan of E57 has its pose's place as origin, or that of its spherical coordinates") {
  const ScratchFolder folder;
  E57Bytes e57;
  e57.scans = {
      posed_scan(""), posed_scan(E57Bytes::pose({"1", "0", "0", "0"}, {"10", "-20", "0.5"})),
      posed_scan("", true), posed_scan(E57Bytes::pose({"0", "1", "0", "0"}, {"0", "0", "0"}))};
  put_bytes(folder / "a.e57", e57.build());
  ConversionOptions options = conversion_of({folder / "a.e57"}, folder / "a.h5");
  options.scale = 0.001;
  const ConversionReport report = convert_quietly(options);
  const StoreReader store(options.output);
  REQUIRE(store.has_origins());
  CHECK(bases_of(store) == std::vector<OriginBasis>{{"poses of E57", 6}});
  check_equal(store.metadata().origins->points_without, 2);
  check_equal(codes_of(report), {"points-without-origin"});
  const auto by_source = origins_by_source(store);
  const auto& offset = store.quantisation().offset;
  const auto quanta = [&](double x, double y, double z) {
    return OriginQuanta{std::llround((x - offset[0]) / 0.001),
                        std::llround((y - offset[1]) / 0.001),
                        std::llround((z - offset[2]) / 0.001)};
  };
  CHECK_FALSE(by_source[1].has_value());
  CHECK(by_source[2] == quanta(10, -20, 0.5));
  CHECK(by_source[4] == quanta(0, 0, 0));
  CHECK(by_source[7] == quanta(0, 0, 0));
  CHECK(faults_of(store).empty());
}

TEST_CASE("of merged inputs each point has the origin that its own format tells") {
  const ScratchFolder folder;
  put_bytes(folder / "a.ptx",
            "1\n2\n5 6 7\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n5 6 7 1\n"
            "1 1 1 0.5\n0 0 0 0.5\n"
            "1\n1\n8 6 7\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n8 6 7 1\n2 2 2 0.5\n");
  put_bytes(folder / "b.xyz", "1 2 3\n4 5 6\n");
  PcdHeaderText pcd;
  pcd.viewpoint = "10 20 -3 1 0 0 0";
  put_bytes(folder / "c.pcd", pcd.build("ascii") + "1.5 -2 0.1\n4 5 6\n");
  put_bytes(folder / "d.3d", "100 200 300\n");
  put_bytes(folder / "d.pose", "100 200 300\n0 0 0\n");
  ConversionOptions options = conversion_of(
      {folder / "a.ptx", folder / "b.xyz", folder / "c.pcd", folder / "d.3d"}, folder / "a.h5");
  options.scale = 0.001;
  const ConversionReport report = convert_quietly(options);
  const StoreReader store(options.output);
  REQUIRE(store.has_origins());
  CHECK(bases_of(store) == std::vector<OriginBasis>{{"scanner positions of PTX", 2},
                                                    {"viewpoints of PCD", 2},
                                                    {"poses of 3DTK", 1}});
  check_equal(report.points_without_origin, 2);
  const auto& offset = store.quantisation().offset;
  const auto place = [&](std::size_t source) {
    const auto q = origins_by_source(store)[source];
    if (!q) return std::string("none");
    std::string text;
    for (std::size_t k = 0; k < 3; ++k) {
      const double at = static_cast<double>((*q)[k]) * 0.001 + offset[k];
      text += std::to_string(std::llround(at * 1000)) + " ";
    }
    return text;
  };
  check_equal(place(0), "5000 6000 7000 ");
  check_equal(place(1), "none");  // a record without a point is not stored
  check_equal(place(2), "8000 6000 7000 ");
  check_equal(place(3), "none");
  check_equal(place(5), "10000 20000 -3000 ");
  check_equal(place(7), "3000 -1000 2000 ");
  CHECK(faults_of(store).empty());
  put_bytes(folder / "o.csv", "first,x,y,z\n0,1,2,3\n");
  options.origins = folder / "o.csv";
  convert_quietly(options);
  const StoreReader given(options.output);
  CHECK(bases_of(given) == std::vector<OriginBasis>{{"a file of origins", 7}});
}
