// Classes on their way from scans into a store.
#include <cmath>
#include <limits>
#include <set>

#include "io/store/convert/distribute.hpp"
#include "io/store/convert/spooled_reader.hpp"
#include "io/store/convert/withheld_cubes.hpp"
#include "io/store/inspect_points.hpp"
#include "support/catch.hpp"
#include "support/classed_scans.hpp"
#include "support/compare.hpp"
#include "support/leaks_of_hdf5.hpp"
#include "support/reader_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

void check_sound(const StoreReader& store, const std::vector<std::uint8_t>& classes) {
  REQUIRE(store.has_classes());
  CHECK(classes_by_source(store) == classes);
  std::array<std::uint64_t, 256> counts{};
  for (const std::uint8_t value : classes) ++counts[value];
  CHECK(store.metadata().classes->points == counts);
  CHECK(faults_of(store).empty());
}

}  // namespace

TEST_CASE("a store has the class of every point, whatever layout, threads and width") {
  const ScratchFolder folder;
  const auto points = cube_cloud(5000, -4000, 4000, 3);
  const unsigned most = GENERATE(1U, 7U, 31U, 255U);
  const auto classes = random_classes(points.size(), most);
  write_classed(folder / "a.las", points, classes);
  ConversionOptions options = conversion_of({folder / "a.las"}, folder / "a.h5", 200);
  SECTION("adaptive") {}
  SECTION("regular") { options.regular_size = 4; }
  SECTION("another scale") { options.scale = 0.01; }
  convert_quietly(options);
  check_sound(StoreReader(options.output), classes);
  const std::string bytes = bytes_of(options.output);
  options.threads = 4;
  convert_quietly(options);
  CHECK(bytes_of(options.output) == bytes);
}

TEST_CASE("a store of points without classes, or all of class 0, says nothing of classes") {
  const ScratchFolder folder;
  const auto points = cube_cloud(300, -4000, 4000, 3);
  SECTION("class 0") { write_classed(folder / "a.las", points, random_classes(300, 0)); }
  SECTION("class 0 with flags") {
    write_classed(folder / "a.las", points, std::vector<std::uint8_t>(300, 0x60), 3);
  }
  std::filesystem::path input = folder / "a.las";
  SECTION("another format") {
    input = folder / "a.xyz";
    put_bytes(input, "1 2 3\n4 5 6\n");
  }
  convert_quietly(conversion_of({input}, folder / "a.h5"));
  const StoreReader store(folder / "a.h5");
  CHECK_FALSE(store.has_classes());
  CHECK(faults_of(store).empty());
  CHECK(bytes_of(folder / "a.h5").find("classes") == std::string::npos);
}

TEST_CASE("of several scans those without classes have class 0, and dropped points none") {
  const ScratchFolder folder;
  const auto points = cube_cloud(300, -4000, 4000, 3);
  auto classes = random_classes(points.size(), 9);
  write_classed(folder / "a.las", points, classes);
  write_classed(folder / "c.las", points, classes);
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  write_ply(folder / "b.ply", std::vector<Vec3>{{1, 2, 3}, {kNone, 0, 0}, {4, 5, 6}});
  const auto once = classes;
  classes.insert(classes.end(), 3, 0);
  classes.insert(classes.end(), once.begin(), once.end());
  ConversionOptions options =
      conversion_of({folder / "a.las", folder / "b.ply", folder / "c.las"}, folder / "a.h5");
  convert_quietly(options);
  const StoreReader store(options.output);
  CHECK(store.point_count() + 1 == classes.size());
  CHECK(classes_by_source(store) == classes);
  CHECK(faults_of(store).empty());
}

TEST_CASE("classes change the fingerprint of a store, not the hash of its points") {
  const ScratchFolder folder;
  const auto points = cube_cloud(300, -4000, 4000, 3);
  std::vector<std::uint64_t> prints, hashes, class_hashes;
  for (const unsigned most : {0U, 5U, 6U}) {
    write_classed(folder / "a.las", points, random_classes(points.size(), most));
    convert_quietly(conversion_of({folder / "a.las"}, folder / "a.h5"));
    const StoreReader store(folder / "a.h5");
    prints.push_back(store.fingerprint());
    hashes.push_back(store.metadata().points_hash);
    if (store.has_classes()) class_hashes.push_back(store.metadata().classes->hash);
  }
  CHECK(prints[0] != prints[1]);
  CHECK(prints[1] != prints[2]);
  CHECK(hashes == std::vector<std::uint64_t>(3, hashes[0]));
  REQUIRE(class_hashes.size() == 2);
  CHECK(class_hashes[0] != class_hashes[1]);
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

/// The source indices of the store's points, ascending.
std::vector<std::uint64_t> sources_of(const StoreReader& store) {
  std::vector<std::uint64_t> sources;
  for (const StoredPoint& point : stored_points(store)) sources.push_back(point.source);
  std::ranges::sort(sources);
  return sources;
}

}  // namespace

TEST_CASE("withheld points of all formats are left out and counted, or kept") {
  const ScratchFolder folder;
  const unsigned format = GENERATE(range(0U, 11U));
  CAPTURE(format);
  const FlaggedScan scan(format, 500);
  put_bytes(folder / "a.las", scan.las.build());
  ConversionOptions options = conversion_of({folder / "a.las"}, folder / "a.h5", 100);
  if (format % 3 == 1) options.regular_size = 4;
  if (format % 3 == 2) options.scale = 0.01;  // the coordinates are rounded anew
  const ConversionReport report = convert_quietly(options);
  CHECK(report.withheld_points == scan.flags.withheld);
  check_equal(report.kept_withheld_points, 0);
  CHECK(report.points == scan.kept.size());
  {
    const StoreReader store(options.output);
    CHECK(sources_of(store) == scan.kept);
    check_equal(store.metadata().input_points, 500);
    check_equal(store.metadata().points_without_place(), 0);
    REQUIRE(store.metadata().withheld);
    CHECK(*store.metadata().withheld == StoreWithheld{scan.flags.withheld, false, scan.cubes()});
    const std::vector<std::uint8_t> classes = classes_by_source(store);
    std::vector<std::uint8_t> kept;
    for (const std::uint64_t i : scan.kept) kept.push_back(classes[i]);
    CHECK(kept == scan.kept_classes());
    CHECK(faults_of(store).empty());
  }
  const std::string bytes = bytes_of(options.output);
  options.threads = 4;
  convert_quietly(options);
  CHECK(bytes_of(options.output) == bytes);

  options.keep_withheld = true;
  const ConversionReport all = convert_quietly(options);
  check_equal(all.withheld_points, 0);
  CHECK(all.kept_withheld_points == scan.flags.withheld);
  const StoreReader store(options.output);
  check_equal(store.point_count(), 500);
  CHECK(*store.metadata().withheld == StoreWithheld{scan.flags.withheld, true, {}});

  const auto flags = inspect_points(folder / "a.las").flags;
  REQUIRE(flags);
  CHECK(flags->synthetic == scan.flags.synthetic);
  CHECK(flags->key_point == scan.flags.key_point);
  CHECK(flags->withheld == scan.flags.withheld);
  CHECK(flags->overlap == scan.flags.overlap);
}

TEST_CASE("a store has no classes where all points with a class are left out") {
  const ScratchFolder folder;
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
  put_bytes(folder / "a.las", las.build());
  ConversionOptions options = conversion_of({folder / "a.las"}, folder / "a.h5");
  options.near = folder.write("path.txt", "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1\n");
  options.within = 10;
  check_equal(convert_quietly(options).points, std::uint64_t{200});
  CHECK_FALSE(StoreReader(options.output).has_classes());
}

TEST_CASE("the message on withheld points is a note up to one of a hundred, else a warning") {
  const ScratchFolder folder;
  FlaggedScan scan(6, 300);
  const auto severity = [&](std::size_t withheld, bool keep) {
    std::fill(scan.las.bytes_of_flags.begin(), scan.las.bytes_of_flags.end(), 0);
    std::fill_n(scan.las.bytes_of_flags.begin(), withheld, 4);
    put_bytes(folder / "a.las", scan.las.build());
    ConversionOptions options = conversion_of({folder / "a.las"}, folder / "a.h5");
    options.keep_withheld = keep;
    std::string found = "none";
    options.message = [&](const Message& message) {
      if (message.code != "withheld-points") return;
      found = message.severity == Message::Severity::kNote ? "note" : "warning";
      CHECK(message.numbers[0].second == static_cast<double>(withheld));
    };
    convert_quietly(options);
    return found;
  };
  check_equal(severity(0, false), "none");
  check_equal(severity(3, false), "note");
  check_equal(severity(4, false), "warning");
  check_equal(severity(300, false), "warning");
  check_equal(severity(4, true), "note");
}

TEST_CASE("LAS 1.0 has no flags, and other formats have none") {
  const ScratchFolder folder;
  FlaggedScan scan(0, 100);
  scan.las.minor = 0;
  put_bytes(folder / "a.las", scan.las.build());
  put_bytes(folder / "b.xyz", "1 2 3\n");
  check_equal(convert_quietly(conversion_of({folder / "a.las"}, folder / "a.h5")).points, 100);
  CHECK_FALSE(StoreReader(folder / "a.h5").metadata().withheld);
  CHECK_FALSE(inspect_points(folder / "a.las").flags);
  CHECK_FALSE(inspect_points(folder / "b.xyz").flags);
}

TEST_CASE("cubes of withheld points have edges of a metre in feet too") {
  const ScratchFolder folder;
  FlaggedScan scan(6, 200);
  scan.las.global_encoding = 16;
  scan.las.vlrs = {
      {"LASF_Projection", 2112, "LOCAL_CS[\"a\",LOCAL_DATUM[\"b\",0],UNIT[\"foot\",0.3048]]"}};
  put_bytes(folder / "a.las", scan.las.build());
  convert_quietly(conversion_of({folder / "a.las"}, folder / "a.h5"));
  const StoreReader store(folder / "a.h5");
  REQUIRE(store.metadata().unit == LengthUnit::kFoot);
  CHECK(store.metadata().withheld->cubes == scan.cubes(1 / 0.3048));
}

TEST_CASE("source numbers count withheld points: of several scans, and in a file of origins") {
  const ScratchFolder folder;
  const FlaggedScan scan(7, 300);
  put_bytes(folder / "a.las", scan.las.build());
  put_bytes(folder / "c.las", scan.las.build());
  write_ply(folder / "b.ply", std::vector<Vec3>{{101, -202, 3}, {NAN, 0, 0}, {104, -205, 2}});
  put_bytes(folder / "origins.csv", "first,x,y,z\n0,1,2,3\n301,4,5,6\n");
  ConversionOptions options =
      conversion_of({folder / "a.las", folder / "b.ply", folder / "c.las"}, folder / "a.h5");
  options.origins = folder / "origins.csv";
  const ConversionReport report = convert_quietly(options);
  std::vector<std::uint64_t> sources = scan.kept;
  sources.insert(sources.end(), {300, 302});
  for (const std::uint64_t i : scan.kept) sources.push_back(303 + i);
  const StoreReader store(options.output);
  CHECK(sources_of(store) == sources);
  check_equal(report.non_finite_points, 1);
  check_equal(store.metadata().points_without_place(), 1);
  check_equal(store.metadata().source_points, {300, 3, 300});
  CHECK(store.metadata().withheld->cubes == scan.cubes());
  for (std::uint32_t cell = 0; cell < store.cells().size(); ++cell) {
    const auto origins = store.origins(cell);
    const auto from = store.sources(cell);
    for (std::uint32_t i = 0; i < store.cells()[cell].count; ++i) {
      REQUIRE(origins[i] == (from[i] < 301 ? 1 : 2));
    }
  }
  CHECK(faults_of(store).empty());
}

TEST_CASE("a stream that is read twice has its flags both times") {
  const ScratchFolder scratch;
  const FlaggedScan scan(6, 300);
  const auto path = scratch.write("a.las", scan.las.build());
  const auto stream =
      spool(open_las_stream(File::open_for_reading(path), scratch.folder()), scratch.folder());
  const ReadCloud first = read_all(*stream);
  stream->rewind();
  check_equal(first.flags.size(), 300);
  CHECK(read_all(*stream).flags == first.flags);
}

TEST_CASE("a store with withheld points left out is not that with them kept") {
  const ScratchFolder folder;
  put_bytes(folder / "a.las", FlaggedScan(6, 100).las.build());
  ConversionOptions options = conversion_of({folder / "a.las"}, folder / "a.h5");
  NoProgress progress;
  for (const bool kept : {false, true}) {
    options.keep_withheld = kept;
    convert_quietly(options);
    CHECK(is_converted(options, progress));
    options.strict = true;
    CHECK(is_converted(options, progress));
    options.strict = false;
    options.keep_withheld = !kept;
    CHECK_FALSE(is_converted(options, progress));
  }
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

TEST_CASE("damaged cubes of withheld points are refused") {
  const ScratchFolder folder;
  put_bytes(folder / "a.las", FlaggedScan(6, 60).las.build());
  convert_quietly(conversion_of({folder / "a.las"}, folder / "a.h5"));
  const std::string bytes = bytes_of(folder / "a.h5");
  const StoreWithheld sound = *StoreReader(folder / "a.h5").metadata().withheld;
  const std::string_view cubes(reinterpret_cast<const char*>(sound.cubes.data()),
                               sound.cubes.size() * sizeof(MetreCube));
  const std::size_t begin = bytes.find(cubes);
  REQUIRE(begin != std::string::npos);
  const LeaksOfHdf5 of_damaged_files;
  std::uint64_t refused = 0;
  for (std::size_t at = begin; at < begin + cubes.size(); ++at) {
    std::string changed = bytes;
    changed[at] = static_cast<char>(changed[at] ^ 0x10);
    put_bytes(folder / "b.h5", changed);
    try {
      const StoreReader store(folder / "b.h5");
    } catch (const InputError&) {
      ++refused;
    }
  }
  CHECK(refused == cubes.size());
}
