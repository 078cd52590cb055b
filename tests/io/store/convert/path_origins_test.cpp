// Origins by the GPS times of points and the path of a moving scanner.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "io/store/convert/distribute.hpp"
#include "io/store/convert/origin_table.hpp"
#include "support/bytes/laz/laz_samples.hpp"
#include "support/catch.hpp"
#include "support/clouds.hpp"
#include "support/compare.hpp"
#include "support/origins.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

constexpr double kWeek = 604800;

/// A scan of a moving scanner: points with times, and a path of which pose i is at (i, 0, 0), half
/// a second after the one before, with a turn of a tenth of a radian.
struct TimedScan {
  ScratchFolder folder;
  LasBytes las;
  ConversionOptions options = conversion_of({folder / "a.las"}, folder / "a.h5");

  explicit TimedScan(std::vector<double> times = {100, 100.25, 101, 104.5}) {
    las.format = 1;
    las.scale = {0.001, 0.001, 0.001};
    las.offset = {0, 0, 0};
    give(std::move(times));
    path(100, 10);
  }
  void give(std::vector<double> times) {
    las.points.clear();
    for (std::size_t i = 0; i < times.size(); ++i) {
      las.points.push_back({static_cast<std::int32_t>(i * 100), 50, 3000});
    }
    las.times = std::move(times);
    put_bytes(folder / "a.las", las.build());
  }
  void path(double first, int poses, double step = 0.5) {
    std::string text;
    for (int i = 0; i < poses; ++i) {
      char line[200];
      std::snprintf(line, sizeof line, "%.4f %d 0 0 0 0 %.17g %.17g\n", first + step * i, i,
                    std::sin(0.05 * i), std::cos(0.05 * i));
      text += line;
    }
    path_text(text);
  }
  void path_text(const std::string& text) {
    put_bytes(folder / "p.txt", text);
    options.origins_path = folder / "p.txt";
    options.path_options.format = TrajectoryFormat::kTum;
  }
  std::vector<std::optional<OriginQuanta>> converted() {
    convert_quietly(options);
    const StoreReader store(options.output);
    CHECK(faults_of(store).empty());
    return origins_by_source(store);
  }
};

std::vector<std::string> codes_told(const ConversionReport& report) {
  std::vector<std::string> codes;
  for (const Message& warning : report.warnings) codes.push_back(warning.code);
  return codes;
}

OriginQuanta millimetres(double x, double y, double z) {
  return {std::llround(1000 * x), std::llround(1000 * y), std::llround(1000 * z)};
}

}  // namespace

TEST_CASE("a point of a moving scanner has the place on the path at its GPS time") {
  TimedScan scan;
  SECTION("at the poses and between them") {
    const auto origins = scan.converted();
    CHECK(origins[0] == millimetres(0, 0, 0));
    CHECK(origins[1] == millimetres(0.5, 0, 0));
    CHECK(origins[2] == millimetres(2, 0, 0));
    CHECK(origins[3] == millimetres(9, 0, 0));
  }
  SECTION("with a lever arm that turns with the poses") {
    scan.options.lever_arm = {-1.5, 0.2, 2};
    const auto origins = scan.converted();
    for (std::size_t i = 0; i < 4; ++i) {
      const double at = 2 * (scan.las.times[i] - 100), c = std::cos(0.1 * at),
                   s = std::sin(0.1 * at);
      CHECK(origins[i] == millimetres(at - 1.5 * c - 0.2 * s, -1.5 * s + 0.2 * c, 2));
    }
  }
  const StoreReader store(scan.options.output);
  const StoreOrigins& origins = *store.metadata().origins;
  check_equal(origins.quanta.size(), 4);
  check_equal(origins.points_without, 0);
  CHECK(origins.rest_on == std::vector<OriginBasis>{{"a path and the GPS times of the points", 4}});
}

TEST_CASE("every point format with GPS times gives origins, compressed or not") {
  const unsigned format = GENERATE(1u, 3u, 4u, 5u, 6u, 7u, 8u, 9u, 10u);
  CAPTURE(format);
  TimedScan scan;
  scan.las.format = format;
  scan.las.minor = format < 4 ? 2 : format < 6 ? 3 : 4;
  scan.give({100, 100.25, 101, 104.5});
  const auto origins = scan.converted();
  CHECK(origins[1] == millimetres(0.5, 0, 0));
  CHECK(origins[3] == millimetres(9, 0, 0));
  if (std::find(std::begin(kLazFormats), std::end(kLazFormats), format) == std::end(kLazFormats)) {
    return;
  }
  LazBytes laz;
  laz.las = scan.las;
  laz.chunks = {3};
  for (std::size_t i = 0; i < 4; ++i) {
    LazPoint point;
    point.position = scan.las.points[i];
    point.gps_time = std::bit_cast<std::uint64_t>(scan.las.times[i]);
    laz.points.push_back(point);
  }
  put_bytes(scan.folder / "a.laz", laz.build());
  scan.options.inputs = {scan.folder / "a.laz"};
  CHECK(scan.converted() == origins);
}

TEST_CASE("origins on a path are the same whatever threads, and after resuming") {
  std::vector<double> times;
  for (int i = 0; i < 200000; ++i) times.push_back(100 + 4.5 * ((i * 7919) % 200000) / 200000.0);
  TimedScan scan(times);
  scan.options.lever_arm = {0.3, 0, 1};
  scan.options.threads = 1;
  convert_quietly(scan.options);
  const std::string bytes = bytes_of(scan.options.output);
  scan.options.threads = 3;
  convert_quietly(scan.options);
  CHECK(bytes_of(scan.options.output) == bytes);
  NoProgress progress;
  CHECK(is_converted(scan.options, progress));
  scan.options.lever_arm.z = 1.5;
  CHECK_FALSE(is_converted(scan.options, progress));
  scan.options.lever_arm.z = 1;
  scan.path(100, 11);
  CHECK_FALSE(is_converted(scan.options, progress));
  scan.options.origins_path.clear();
  scan.options.lever_arm = {};
  CHECK_FALSE(is_converted(scan.options, progress));
}

TEST_CASE("points that the path does not reach have no origin and are warned of") {
  TimedScan scan({99, 99.9, 100, 100.7, 101, 101.3, 102.5, 102.6, 103, 104,
                  std::numeric_limits<double>::quiet_NaN()});
  scan.path_text("100 0 0 0 0 0 0 1\n101 1 0 0 0 0 0 1\n102.5 2 0 0 0 0 0 1\n103 3 0 0 0 0 0 1\n");
  const ConversionReport report = convert_quietly(scan.options);
  check_equal(codes_told(report),
              {"gps-times-not-finite", "origins-path-gap", "points-without-origin"});
  check_equal(report.points_without_origin, 5);
  check_says(report.warnings[1].text,
             "4 of 10 points ... 2 are from before ... 1 from after ... 1 from between poses more "
             "than 1 s apart ... 1 such gap, the longest of 1.5 s");
  REQUIRE(report.origins_path);
  check_equal(report.origins_path->before, 2);
  check_equal(report.origins_path->after, 1);
  check_equal(report.origins_path->in_gaps, 1);
  check_equal(report.origins_path->without_time, 1);
  check_equal(report.origins_path->first_point, 99);
  check_equal(report.origins_path->last_point, 104);
  const auto origins = origins_by_source(StoreReader(scan.options.output));
  const std::vector<bool> expected{false, false, true, true,  true, false,
                                   true,  true,  true, false, false};
  for (std::size_t i = 0; i < expected.size(); ++i) CHECK(origins[i].has_value() == expected[i]);
}

TEST_CASE("seconds of the week and adjusted standard GPS time are told apart and matched") {
  // 2286 weeks and 1000 s after 1980-01-06, and what adjusted time makes of it.
  const double week = 2286 * kWeek, adjusted = week + 1000 - 1e9;
  struct Clocks {
    std::uint16_t encoding;
    double points, path;
    double shift;
    std::string point_clock, path_clock;
  };
  const Clocks clocks = GENERATE_COPY(values<Clocks>({
      {0, 1000, 1000, 0, "week-seconds", "week-seconds"},
      {0, 1000, adjusted, adjusted - 1000, "week-seconds", "adjusted"},
      {0, 1000, week + 1000, week, "week-seconds", "standard"},
      {1, adjusted, adjusted, 0, "adjusted", "adjusted"},
      {1, adjusted, 1000, 1000 - adjusted, "adjusted", "week-seconds"},
      {1, adjusted, week + 1000, 1e9, "adjusted", "standard"},
      {0, 2, kWeek + 2, kWeek, "week-seconds", "week-seconds"},
  }));
  CAPTURE(clocks.point_clock, clocks.path_clock, clocks.shift);
  TimedScan scan;
  scan.las.global_encoding = clocks.encoding;
  scan.give({clocks.points, clocks.points + 0.25, clocks.points + 4.5});
  scan.path(clocks.path, 10);
  std::string told;
  scan.options.message = [&](const Message& message) { told += message.text; };
  const ConversionReport report = convert_quietly(scan.options);
  CHECK(codes_told(report).empty());
  REQUIRE(report.origins_path);
  CHECK(report.origins_path->point_clock == clocks.point_clock);
  CHECK(report.origins_path->path_clock == clocks.path_clock);
  check_equal(report.origins_path->shifts, {clocks.shift});
  check_says(told, "the GPS times of the points go from");
  check_says(told, clocks.shift == 0 ? "compared as they are" : " s are added");
  const auto origins = origins_by_source(StoreReader(scan.options.output));
  CHECK(origins[0] == millimetres(0, 0, 0));
  CHECK(origins[1] == millimetres(0.5, 0, 0));
  CHECK(origins[2] == millimetres(9, 0, 0));
}

TEST_CASE("times that contradict the header are compared as they are, with a warning") {
  TimedScan scan;
  SECTION("adjusted times without the bit") {
    scan.give({3.8e8, 3.8e8 + 1});
    scan.path(3.8e8, 10);
  }
  SECTION("seconds of the week with the bit") {
    scan.las.global_encoding = 1;
    scan.give({1000, 1001});
    scan.path(1000, 10);
  }
  const ConversionReport report = convert_quietly(scan.options);
  REQUIRE(codes_told(report) == std::vector<std::string>{"gps-times-contradict"});
  check_says(report.warnings[0].text, "2 points ... bit 0");
  check_equal(report.points_without_origin, 0);
}

TEST_CASE("a path that gives no point an origin is refused with both ranges and what would help") {
  const double adjusted = 3.8e8, standard = adjusted + 1e9;
  struct Refused {
    std::uint16_t encoding;
    double points, path;
    std::string message;
  };
  const Refused refused = GENERATE_COPY(values<Refused>({
      {1, adjusted, standard + 315964800 - 18, "-1315964782 s were added"},
      {0, adjusted, standard, "-1000000000 s were added"},
      {1, adjusted, adjusted - 18, "+18 s were added"},
      {1, adjusted, adjusted + 3 * kWeek, "by whole weeks"},
      {1, adjusted, adjusted + 5000, "the path of another recording?"},
  }));
  TimedScan scan;
  scan.las.global_encoding = refused.encoding;
  scan.give({refused.points, refused.points + 4});
  scan.path(refused.path, 10);
  char first_point[40], first_pose[40];
  std::snprintf(first_point, sizeof first_point, "from %.3f to", refused.points);
  std::snprintf(first_pose, sizeof first_pose, "from %.3f to", refused.path);
  check_says(conversion_refusal<InputError>(scan.options),
             std::string("gives no point an origin ... ") + first_point + " ... " + first_pose +
                 " ... " + refused.message);
  CHECK_FALSE(std::filesystem::exists(scan.options.output));
}

TEST_CASE("points of several weeks do not match a path in seconds of the week") {
  TimedScan scan;
  scan.las.global_encoding = 1;
  const double adjusted = 2286 * kWeek + 1000 - 1e9;
  scan.give({adjusted, adjusted + kWeek});
  scan.path(1000, 10);
  check_says(conversion_refusal<InputError>(scan.options), "of 2 weeks");
}

TEST_CASE("GPS times that cannot be those of a recording are refused with the file") {
  TimedScan scan;
  scan.path(0, 10);
  scan.give(std::vector<double>(300, 0.0));
  check_says(conversion_refusal<InputError>(scan.options),
             "a.las: all 300 points have the GPS time 0.000 s");
  scan.give(std::vector<double>(16, 1.5));
  check_says(conversion_refusal<InputError>(scan.options), "16 points have the GPS time");
  scan.give(std::vector<double>(15, 1.5));  // returns of one pulse
  CHECK(conversion_refusal(scan.options).empty());
  scan.give(std::vector<double>(3, std::numeric_limits<double>::infinity()));
  check_says(conversion_refusal<InputError>(scan.options), "finite GPS time");
}

TEST_CASE("an input of which all points are left out does not lack GPS times") {
  TimedScan scan;
  scan.las.points = {{0, 90'000, 0}, {0, 90'000, 0}, {0, 90'000, 0}, {0, 90'000, 0}};
  put_bytes(scan.folder / "far.las", scan.las.build());
  scan.options.inputs = {scan.folder / "far.las", scan.folder / "a.las"};
  scan.options.near = scan.folder.write("near.txt", "0 0 0 0 0 0 0 1\n");
  scan.options.within = 10;
  const ConversionReport report = convert_quietly(scan.options);
  CHECK(codes_told(report).empty());
  check_equal(report.origins_path->without_time, 0);
  scan.options.inputs = {scan.folder / "far.las"};
  check_says(conversion_refusal<InputError>(scan.options), "none of the 4 points ... within 10");
}

TEST_CASE("inputs without GPS times have no origins by a path") {
  TimedScan scan;
  write_ply(scan.folder / "b.ply", std::vector<Vec3>{{1, 2, 3}, {4, 5, 6}});
  scan.options.inputs = {scan.folder / "b.ply", scan.folder / "a.las"};
  const ConversionReport report = convert_quietly(scan.options);
  const auto codes = codes_told(report);
  check_equal(std::count(codes.begin(), codes.end(), "no-gps-times"), 1);
  check_equal(std::count(codes.begin(), codes.end(), "points-without-origin"), 1);
  check_equal(report.points_without_origin, 2);
  const auto origins = origins_by_source(StoreReader(scan.options.output));
  CHECK_FALSE(origins[0].has_value());
  CHECK(origins[3].has_value());
  scan.options.inputs = {scan.folder / "b.ply"};
  check_says(conversion_refusal<InputError>(scan.options), "none of the inputs has GPS times");
  scan.las.format = 2;
  scan.las.times.clear();
  put_bytes(scan.folder / "a.las", scan.las.build());
  scan.options.inputs = {scan.folder / "a.las"};
  check_says(conversion_refusal<InputError>(scan.options), "none of the inputs has GPS times");
}

TEST_CASE("a path that is none, and options that contradict each other, are refused") {
  TimedScan scan;
  SECTION("no times") {
    scan.path_text("0 0 0 0 0 0 1\n1 0 0 0 0 0 1\n");
    scan.options.path_options.format = TrajectoryFormat::kPoseXyzw;
    check_says(conversion_refusal<InputError>(scan.options), "have no times");
  }
  SECTION("times that go back") {
    scan.path_text("100 0 0 0 0 0 0 1\n102 1 0 0 0 0 0 1\n101 2 0 0 0 0 0 1\n");
    check_says(conversion_refusal<InputError>(scan.options), "expected times that ascend");
  }
  SECTION("a pose that is not a number") {
    scan.path_text("100 0 nan 0 0 0 0 1\n101 1 0 0 0 0 0 1\n");
    check_says(conversion_refusal<InputError>(scan.options), "p.txt");
  }
  SECTION("too long for seconds of the week") {
    scan.path(100, 3, kWeek);
    check_says(conversion_refusal<InputError>(scan.options), "more than a week");
  }
  SECTION("a missing file") {
    scan.options.origins_path = scan.folder / "none.txt";
    check_says(conversion_refusal(scan.options), "none.txt");
  }
  SECTION("a file of origins too") {
    scan.options.origins = scan.folder / "o.csv";
    check_says(conversion_refusal<UsageError>(scan.options), "expected one of the two");
  }
  SECTION("a lever arm alone") {
    scan.options.origins_path.clear();
    scan.options.lever_arm = {1, 0, 0};
    check_says(conversion_refusal<UsageError>(scan.options), "lever arm");
  }
  SECTION("a lever arm that is no length") {
    scan.options.lever_arm = {std::nan(""), 0, 0};
    check_says(conversion_refusal<UsageError>(scan.options), "lever arm");
  }
  SECTION("the path as output") {
    scan.options.output = scan.options.origins_path;
    CHECK_FALSE(conversion_refusal<UsageError>(scan.options).empty());
    return;
  }
  CHECK_FALSE(std::filesystem::exists(scan.options.output));
}

TEST_CASE("a path that takes more than an eighth of the memory is refused with a number") {
  TimedScan scan({100.25});
  std::string text;
  for (int i = 0; i < 480000; ++i) text += std::to_string(100 + 0.001 * i) + " 1 2 3 0 0 0 1\n";
  scan.path_text(text);
  scan.options.lever_arm = {1, 0, 0};
  scan.options.memory_bytes = kLeastConversionMemory;
  check_says(conversion_refusal<ResourceError>(scan.options),
             "480,000 poses take 29.3 MiB ... 28.0 MiB, an eighth");
  scan.options.memory_bytes = 8 * 64 * 480000;
  CHECK(conversion_refusal(scan.options).empty());
}

TEST_CASE("a lever arm is in metres and a path in metres becomes the feet of the environment") {
  TimedScan scan({100.25});
  scan.options.unit = FileUnit::named("ift");
  scan.options.path_options.metres_per_unit = 1.0;
  scan.options.lever_arm = {0, 0, 3.048};
  CHECK(scan.converted()[0] == millimetres(0.5 / 0.3048, 0, 10));
}

TEST_CASE("a table of origins that are seen again and again takes memory for each only once") {
  const Quantisation steps{{0.001, 0.001, 0.001}, {0, 0, 0}};
  OriginTable table(steps, std::uint64_t{1} << 20);
  for (std::uint64_t i = 0; i < 50000; ++i) {
    table.add_quanta(i, OriginQuanta{static_cast<std::int64_t>(i * 7919 % 100), 0, 0}, "a.las");
  }
  table.finish();
  CHECK(table.allocated_bytes() < 2 << 20);
  std::vector<DistributedPoint> points{DistributedPoint::of({}, 0, 0),
                                       DistributedPoint::of({}, 1, 0),
                                       DistributedPoint::of({}, 49999, 0)};
  check_equal(table.numbers_of(points), {1, 20, 1 + 49999 * 7919 % 100});
  CHECK_THROWS_WITH(
      [&] {
        OriginTable small(steps, std::uint64_t{1} << 20);
        for (std::uint64_t i = 0; i < 80000; ++i) {
          small.add_quanta(i, OriginQuanta{static_cast<std::int64_t>(i % 2), 0, 0}, "a.las");
        }
      }(),
      Contains("a quarter of the memory"));
}
