// Classes and flags of points on their way from scans into a store.
#include <cmath>
#include <set>

#include "io/store/convert/distribute.hpp"
#include "io/store/convert/spooled_reader.hpp"
#include "io/store/convert/withheld_cubes.hpp"
#include "io/store/inspect_points.hpp"
#include "support/catch.hpp"
#include "support/classed_scans.hpp"
#include "support/clouds.hpp"
#include "support/compare.hpp"
#include "support/reader_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// The conversion of one LAS file whose points have these classes.
struct ClassedScan : Conversion {
  explicit ClassedScan(const std::vector<std::uint8_t>& classes, unsigned format = 6)
      : Conversion(200) {
    write_classed(folder / "a.las", cube_cloud(classes.size(), -4000, 4000, 3), classes, format);
    options.inputs = {folder / "a.las"};
  }
};

}  // namespace

TEST_CASE("a store has the class of every point, whatever layout, threads and width") {
  const auto classes = random_classes(5000, GENERATE(1U, 7U, 31U, 255U));
  ClassedScan scan(classes);
  SECTION("adaptive") {}
  SECTION("regular") { scan.options.regular_size = 4; }
  SECTION("another scale") { scan.options.scale = 0.01; }
  const StoreReader store = scan.store();
  REQUIRE(store.has_classes());
  CHECK(classes_by_source(store) == classes);
  std::array<std::uint64_t, 256> counts{};
  for (const std::uint8_t value : classes) ++counts[value];
  CHECK(store.metadata().classes->points == counts);
  const std::string bytes = bytes_of(scan.options.output);
  scan.options.threads = 4;
  CHECK(scan.converted_bytes() == bytes);
}

TEST_CASE("a store of points without classes, or all of class 0, says nothing of classes") {
  ClassedScan scan(random_classes(300, 0));
  SECTION("class 0") {}
  SECTION("class 0 with flags") {
    write_classed(scan.folder / "a.las", cube_cloud(300, -4000, 4000, 3),
                  std::vector<std::uint8_t>(300, 0x60), 3);
  }
  SECTION("another format") {
    scan.options.inputs.clear();
    scan.add("a.xyz", "1 2 3\n4 5 6\n");
  }
  CHECK_FALSE(scan.store().has_classes());
  CHECK(bytes_of(scan.options.output).find("classes") == std::string::npos);
}

TEST_CASE("classes change the fingerprint of a store, not the hash of its points") {
  std::set<std::uint64_t> prints, hashes, class_hashes;
  for (const unsigned most : {0U, 5U, 6U}) {
    const StoreReader store = ClassedScan(random_classes(300, most)).store();
    prints.insert(store.fingerprint());
    hashes.insert(store.metadata().points_hash);
    class_hashes.insert(store.has_classes() ? store.metadata().classes->hash : 0);
  }
  check_equal(prints.size(), 3);
  check_equal(hashes.size(), 1);
  check_equal(class_hashes.size(), 3);
}

TEST_CASE("a point on its way keeps class and source apart") {
  constexpr std::uint64_t kMost = (std::uint64_t{1} << 56) - 1;
  for (const std::uint64_t source : {std::uint64_t{0}, std::uint64_t{1} << 32, kMost}) {
    for (const std::uint8_t value : {std::uint8_t{0}, std::uint8_t{7}, std::uint8_t{255}}) {
      const auto point = DistributedPoint::of({1, 2, 3}, source, value);
      CHECK(point.source_index() == source);
      CHECK(point.point_class() == value);
    }
  }
}

// Points with the flag `withheld` on their way from scans into a store.
namespace {

/// A LAS file in which a third of the points is withheld, and some have other flags.
struct FlaggedScan {
  LasBytes las;
  std::vector<std::uint64_t> kept;  ///< numbers of the points that are not withheld
  FlagCounts flags;

  FlaggedScan(unsigned format, std::size_t count) {
    las.minor = format == 0 ? 1 : 4;
    las.format = format;
    las.scale = {0.001, 0.001, 0.001};
    las.points = cube_cloud(count, -4000, 4000, 3);
    for (std::size_t i = 0; i < count; ++i) {
      const unsigned bits =
          (i % 3 == 1 ? 4u : 0u) | (i % 5 == 0 ? 1u : 0u) | (i % 7 == 0 ? 2u : 0u);
      const unsigned overlap = i % 11 == 0 ? 1 : 0;
      const unsigned point_class = overlap && format < 6 ? 12 : static_cast<unsigned>(i % 9);
      if (format < 6) {
        las.bytes_of_class.push_back(static_cast<std::uint8_t>(bits << 5 | point_class));
      } else {
        las.bytes_of_class.push_back(static_cast<std::uint8_t>(point_class));
        las.bytes_of_flags.push_back(static_cast<std::uint8_t>(0xD0 | overlap << 3 | bits));
      }
      if (i % 3 != 1) kept.push_back(i);
      flags.withheld += i % 3 == 1;
      flags.synthetic += i % 5 == 0;
      flags.key_point += i % 7 == 0;
      flags.overlap += overlap;
    }
  }

  std::vector<std::uint8_t> kept_classes() const {
    std::vector<std::uint8_t> classes;
    for (const std::uint64_t i : kept) {
      classes.push_back(las.bytes_of_class[i] & (las.format < 6 ? 0x1F : 0xFF));
    }
    return classes;
  }

  /// The cubes of the withheld points, whose edge is in the unit of the file.
  std::vector<MetreCube> cubes(double edge = 1) const {
    std::set<MetreCube> cubes;
    for (std::size_t i = 1; i < las.points.size(); i += 3) {
      MetreCube cube;
      for (std::size_t k = 0; k < 3; ++k) {
        const double at = las.points[i][k] * las.scale[k] + las.offset[k];
        cube[k] = static_cast<std::int32_t>(std::floor(at / edge));
      }
      cubes.insert(cube);
    }
    return {cubes.begin(), cubes.end()};
  }
};

/// A conversion of one such file.
struct FlaggedConversion : Conversion {
  FlaggedConversion(unsigned format, std::size_t count) : scan(format, count) {
    add("a.las", scan.las.build());
  }
  FlaggedScan scan;
};

/// The source indices of the store's points, ascending.
std::vector<std::uint64_t> sources_of(const StoreReader& store) {
  std::vector<std::uint64_t> sources;
  for (const StoredPoint& point : stored_points(store)) sources.push_back(point.source);
  std::ranges::sort(sources);
  return sources;
}

}  // namespace

TEST_CASE("withheld points of all formats are left out and counted, or kept") {
  const unsigned format = GENERATE(range(0U, 11U));
  CAPTURE(format);
  FlaggedConversion conversion(format, 500);
  const FlaggedScan& scan = conversion.scan;
  conversion.options.cell_points = 100;
  if (format % 3 == 1) conversion.options.regular_size = 4;
  if (format % 3 == 2) conversion.options.scale = 0.01;  // the coordinates are rounded anew
  {
    const StoreReader store = conversion.store();
    CHECK(sources_of(store) == scan.kept);
    check_equal(store.metadata().input_points, 500);
    check_equal(store.metadata().points_without_place(), 0);
    CHECK(store.metadata().withheld == StoreWithheld{scan.flags.withheld, false, scan.cubes()});
    const std::vector<std::uint8_t> classes = classes_by_source(store);
    std::vector<std::uint8_t> kept;
    for (const std::uint64_t i : scan.kept) kept.push_back(classes[i]);
    CHECK(kept == scan.kept_classes());
  }
  const std::string bytes = bytes_of(conversion.options.output);
  conversion.options.threads = 4;
  const ConversionReport report = conversion.convert();
  CHECK(report.withheld_points == scan.flags.withheld);
  check_equal(report.kept_withheld_points, 0);
  CHECK(report.points == scan.kept.size());
  CHECK(bytes_of(conversion.options.output) == bytes);

  conversion.options.keep_withheld = true;
  const ConversionReport all = conversion.convert();
  check_equal(all.withheld_points, 0);
  CHECK(all.kept_withheld_points == scan.flags.withheld);
  check_equal(all.points, 500);
  CHECK(StoreReader(conversion.options.output).metadata().withheld ==
        StoreWithheld{scan.flags.withheld, true, {}});
  const FlagCounts flags = inspect_points(conversion.folder / "a.las").flags.value();
  CHECK(std::array{flags.synthetic, flags.key_point, flags.withheld, flags.overlap} ==
        std::array{scan.flags.synthetic, scan.flags.key_point, scan.flags.withheld,
                   scan.flags.overlap});
}

TEST_CASE("a store has no classes where all points with a class are left out") {
  LasBytes las;
  las.minor = 4;
  las.format = 6;
  las.scale = {0.001, 0.001, 0.001};
  las.offset = {0, 0, 0};
  las.points.clear();
  const bool far = GENERATE(false, true);
  for (std::int32_t i = 0; i < 300; ++i) {
    const bool classed = i % 3 == 1;
    las.points.push_back({i, classed && far ? 50'000 : 0, 0});
    las.bytes_of_class.push_back(classed ? 7 : 0);
    las.bytes_of_flags.push_back(classed && !far ? 4 : 0);
  }
  Conversion conversion;
  conversion.add("a.las", las.build());
  conversion.options.near =
      conversion.folder.write("path.txt", "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1\n");
  conversion.options.within = 10;
  const StoreReader store = conversion.store();
  check_equal(store.point_count(), std::uint64_t{200});
  CHECK_FALSE(store.has_classes());
}

TEST_CASE("the message on withheld points is a note up to one of a hundred, else a warning") {
  const auto [withheld, keep, codes] =
      GENERATE(table<std::size_t, bool, std::string>({{0, false, ""},
                                                      {3, false, "note withheld-points"},
                                                      {4, false, "withheld-points"},
                                                      {300, false, "withheld-points"},
                                                      {4, true, "note withheld-points"}}));
  FlaggedConversion conversion(6, 300);
  LasBytes& las = conversion.scan.las;
  las.bytes_of_flags.assign(300, 0);
  std::fill_n(las.bytes_of_flags.begin(), withheld, 4);
  conversion.add("a.las", las.build());
  conversion.options.keep_withheld = keep;
  std::vector<Message> found;
  conversion.options.message = [&](const Message& message) {
    if (message.code != "withheld-points") return;
    found.push_back(message);
    check_equal(number_of(message, "points"), static_cast<double>(withheld));
  };
  conversion.convert();
  check_equal(codes_of(found), codes);
}

TEST_CASE("LAS 1.0 has no flags, and other formats have none") {
  FlaggedConversion conversion(0, 100);
  conversion.scan.las.minor = 0;
  conversion.add("a.las", conversion.scan.las.build());
  const StoreReader store = conversion.store();
  check_equal(store.point_count(), 100);
  CHECK_FALSE(store.metadata().withheld);
  CHECK_FALSE(inspect_points(conversion.folder / "a.las").flags);
  CHECK_FALSE(inspect_points(conversion.folder.write("b.xyz", "1 2 3\n")).flags);
}

TEST_CASE("cubes of withheld points have edges of a metre in feet too") {
  FlaggedConversion conversion(6, 200);
  LasBytes& las = conversion.scan.las;
  las.global_encoding = 16;
  las.vlrs = {
      {"LASF_Projection", 2112, "LOCAL_CS[\"a\",LOCAL_DATUM[\"b\",0],UNIT[\"foot\",0.3048]]"}};
  conversion.add("a.las", las.build());
  const StoreReader store = conversion.store();
  REQUIRE(store.metadata().unit == LengthUnit::kFoot);
  CHECK(store.metadata().withheld->cubes == conversion.scan.cubes(1 / 0.3048));
}

TEST_CASE("of several scans each point has its class, and its number counts dropped points") {
  FlaggedConversion conversion(7, 300);
  const FlaggedScan& scan = conversion.scan;
  conversion.add_ply("b.ply", std::vector<Vec3>{{101, -202, 3}, {NAN, 0, 0}, {104, -205, 2}});
  conversion.add("c.las", scan.las.build());
  conversion.options.origins =
      conversion.folder.write("origins.csv", "first,x,y,z\n0,1,2,3\n301,4,5,6\n");
  std::vector<std::uint64_t> sources = scan.kept;
  sources.insert(sources.end(), {300, 302});
  for (const std::uint64_t i : scan.kept) sources.push_back(303 + i);
  const StoreReader store = conversion.store();
  CHECK(sources_of(store) == sources);
  check_equal(store.metadata().points_without_place(), 1);
  check_equal(store.metadata().source_points, {300, 3, 300});
  CHECK(store.metadata().withheld->cubes == scan.cubes());
  const auto classes = classes_by_source(store);
  for (const std::uint64_t i : scan.kept) REQUIRE(classes[i] == scan.las.bytes_of_class[i]);
  for (const std::uint64_t i : scan.kept) REQUIRE(classes[303 + i] == classes[i]);
  check_equal(classes[300] + classes[302], 0);
  const auto origins = origins_by_source(store);
  for (const std::uint64_t source : sources)
    REQUIRE(origins[source] == origins[source < 301 ? 0 : 302]);
  CHECK(origins[0] != origins[302]);
}

TEST_CASE("a stream that is read twice has its flags both times") {
  const ScratchFolder scratch;
  const auto path = scratch.write("a.las", FlaggedScan(6, 300).las.build());
  const auto stream =
      spool(open_las_stream(File::open_for_reading(path), scratch.folder()), scratch.folder());
  const ReadCloud first = read_all(*stream);
  stream->rewind();
  check_equal(first.flags.size(), 300);
  CHECK(read_all(*stream).flags == first.flags);
}

TEST_CASE("cubes are collected in bounded memory") {
  WithheldCubes cubes(std::uint64_t{1} << 20);
  std::vector<MetreCube> some;
  const auto fill = [&](std::int32_t from) {
    some.clear();
    for (std::int32_t i = 0; i < 10'000; ++i) some.push_back({from + i, 0, -i});
  };
  for (int round = 0; round < 1000; ++round) {
    fill(10'000 * (round % 3));
    cubes.add(some);
  }
  const std::vector<MetreCube> found = cubes.take();
  check_equal(found.size(), 30'000);
  CHECK(std::ranges::is_sorted(found));
  WithheldCubes more(std::uint64_t{1} << 20);
  CHECK_THROWS_AS(
      [&] {
        for (int round = 0; round < 100; ++round) {
          fill(10'000 * round);
          more.add(some);
        }
      }(),
      ResourceError);
}
