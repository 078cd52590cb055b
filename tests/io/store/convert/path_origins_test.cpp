// Origins by the GPS times of points and the path of a moving scanner.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>

#include "support/bytes/laz/laz_samples.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/store_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

constexpr double kWeek = 604800;

/// A scan of a moving scanner: points with times, and a path of which pose i is at (i, 0, 0), half
/// a second after the one before, with a turn of a tenth of a radian.
struct TimedScan : Conversion {
  LasBytes las;

  explicit TimedScan(std::vector<double> times = {100, 100.25, 101, 104.5}) {
    las.format = 1;
    las.scale = {0.001, 0.001, 0.001};
    las.offset = {0, 0, 0};
    options.path_options.format = TrajectoryFormat::kTum;
    give(std::move(times));
    path(100, 10);
  }
  void give(std::vector<double> times) {
    las.points.clear();
    for (std::size_t i = 0; i < times.size(); ++i) {
      las.points.push_back({static_cast<std::int32_t>(i * 100), 50, 3000});
    }
    las.times = std::move(times);
    add("a.las", las.build());
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
  void path_text(const std::string& text) { options.origins_path = folder.write("p.txt", text); }
  std::vector<std::optional<OriginQuanta>> origins() const { return origins_by_source(store()); }
};

OriginQuanta millimetres(double x, double y, double z) {
  return {std::llround(1000 * x), std::llround(1000 * y), std::llround(1000 * z)};
}

}  // namespace

TEST_CASE("a point of a moving scanner has the place on the path at its GPS time") {
  TimedScan scan;
  const Vec3 arm = GENERATE(Vec3{0, 0, 0}, Vec3{-1.5, 0.2, 2});  // turns with the poses
  scan.options.lever_arm = arm;
  const StoreReader store = scan.store();
  const auto origins = origins_by_source(store);
  for (std::size_t i = 0; i < 4; ++i) {
    const double at = 2 * (scan.las.times[i] - 100), c = std::cos(0.1 * at), s = std::sin(0.1 * at);
    CHECK(origins[i] == millimetres(at + arm.x * c - arm.y * s, arm.x * s + arm.y * c, arm.z));
  }
  check_equal(store.metadata().origins->quanta.size(), 4);
  check_equal(store.metadata().origins->points_without, 0);
  CHECK(store.metadata().origins->rest_on ==
        std::vector<OriginBasis>{{"a path and the GPS times of the points", 4}});
}

TEST_CASE("every point format with GPS times gives origins, compressed or not") {
  const unsigned format = GENERATE(1u, 3u, 4u, 5u, 6u, 7u, 8u, 9u, 10u);
  CAPTURE(format);
  TimedScan scan;
  scan.las.format = format;
  scan.las.minor = format < 4 ? 2 : format < 6 ? 3 : 4;
  scan.give({100, 100.25, 101, 104.5});
  const auto origins = scan.origins();
  CHECK(origins[1] == millimetres(0.5, 0, 0));
  CHECK(origins[3] == millimetres(9, 0, 0));
  if (std::ranges::find(kLazFormats, format) == std::end(kLazFormats)) return;
  LazBytes laz;
  laz.las = scan.las;
  laz.chunks = {3};
  for (std::size_t i = 0; i < 4; ++i) {
    LazPoint point;
    point.position = scan.las.points[i];
    point.gps_time = std::bit_cast<std::uint64_t>(scan.las.times[i]);
    laz.points.push_back(point);
  }
  scan.options.inputs.clear();
  scan.add("a.laz", laz.build());
  CHECK(scan.origins() == origins);
}

TEST_CASE("origins on a path are the same whatever threads") {
  std::vector<double> times;
  for (int i = 0; i < 200000; ++i) times.push_back(100 + 4.5 * ((i * 7919) % 200000) / 200000.0);
  TimedScan scan(times);
  scan.options.lever_arm = {0.3, 0, 1};
  scan.options.threads = 1;
  const std::string bytes = scan.converted_bytes();
  scan.options.threads = 3;
  CHECK(scan.converted_bytes() == bytes);
}

TEST_CASE("points that the path does not reach have no origin and are warned of") {
  TimedScan scan({99, 99.9, 100, 100.7, 101, 101.3, 102.5, 102.6, 103, 104,
                  std::numeric_limits<double>::quiet_NaN()});
  scan.path_text("100 0 0 0 0 0 0 1\n101 1 0 0 0 0 0 1\n102.5 2 0 0 0 0 0 1\n103 3 0 0 0 0 0 1\n");
  const ConversionReport report = scan.convert();
  check_equal(codes_of(report.warnings),
              "gps-times-not-finite, origins-path-gap, points-without-origin");
  check_equal(report.points_without_origin, 5);
  check_says(report.warnings[1].text,
             "4 of 10 points ... 2 are from before ... 1 from after ... 1 from between poses more "
             "than 1 s apart ... 1 such gap, the longest of 1.5 s");
  check_says(report.warnings[2].text, "5 of 11 points (45. ... %) have no origin");
  REQUIRE(report.origins_path);
  check_equal(report.origins_path->before, 2);
  check_equal(report.origins_path->after, 1);
  check_equal(report.origins_path->in_gaps, 1);
  check_equal(report.origins_path->without_time, 1);
  check_equal(report.origins_path->first_point, 99);
  check_equal(report.origins_path->last_point, 104);
  std::vector<bool> found;
  for (const auto& origin : scan.origins()) found.push_back(origin.has_value());
  check_equal(found, {false, false, true, true, true, false, true, true, true, false, false});
}

TEST_CASE("seconds of the week and adjusted standard GPS time are told apart and matched") {
  // 2286 weeks and 1000 s after 1980-01-06, and what adjusted time makes of it.
  const double week = 2286 * kWeek, adjusted = week + 1000 - 1e9;
  const auto check = [](unsigned encoding, double points, double path, double shift,
                        const char* point_clock, const char* path_clock, const char* codes = "") {
    CAPTURE(point_clock, path_clock, shift);
    TimedScan scan;
    scan.las.global_encoding = static_cast<std::uint16_t>(encoding);
    scan.give({points, points + 0.25, points + 4.5});
    scan.path(path, 10);
    std::string told;
    scan.options.message = [&](const Message& message) { told += message.text; };
    const ConversionReport report = scan.convert();
    check_equal(codes_of(report.warnings), codes);
    if (!report.warnings.empty()) check_says(report.warnings[0].text, "3 points ... bit 0");
    REQUIRE(report.origins_path);
    check_equal(report.origins_path->point_clock, point_clock);
    check_equal(report.origins_path->path_clock, path_clock);
    check_equal(report.origins_path->shifts, {shift});
    check_says(told, std::string("the GPS times of the points go from ... ") +
                         (shift == 0 ? "compared as they are" : " s are added"));
    CHECK(origins_by_source(StoreReader(scan.options.output)) ==
          std::vector<std::optional<OriginQuanta>>{millimetres(0, 0, 0), millimetres(0.5, 0, 0),
                                                   millimetres(9, 0, 0)});
  };
  check(0, 1000, 1000, 0, "week-seconds", "week-seconds");
  check(0, 1000, adjusted, adjusted - 1000, "week-seconds", "adjusted");
  check(0, 1000, week + 1000, week, "week-seconds", "standard");
  check(1, adjusted, adjusted, 0, "adjusted", "adjusted");
  check(1, adjusted, 1000, 1000 - adjusted, "adjusted", "week-seconds");
  check(1, adjusted, week + 1000, 1e9, "adjusted", "standard");
  check(0, 2, kWeek + 2, kWeek, "week-seconds", "week-seconds");
  // Times that contradict the header are compared as they are.
  check(0, 3.8e8, 3.8e8, 0, "week-seconds", "adjusted", "gps-times-contradict");
  check(1, 1000, 1000, 0, "adjusted", "week-seconds", "gps-times-contradict");
}

TEST_CASE("a path that gives no point an origin is refused with both ranges and what would help") {
  const double adjusted = 3.8e8, standard = adjusted + 1e9;
  const auto check = [&](unsigned encoding, double path, const std::string& words) {
    TimedScan scan;
    scan.las.global_encoding = static_cast<std::uint16_t>(encoding);
    scan.give({adjusted, adjusted + 4});
    scan.path(path, 10);
    char first_pose[40];
    std::snprintf(first_pose, sizeof first_pose, "from %.3f to", path);
    check_says(scan.refusal(), "gives no point an origin ... from 380000000.000 to ... " +
                                   std::string(first_pose) + " ... " + words);
    CHECK_FALSE(std::filesystem::exists(scan.options.output));
  };
  check(1, standard + 315964800 - 18, "-1315964782 s were added");
  check(0, standard, "-1000000000 s were added");
  check(1, adjusted - 18, "+18 s were added");
  check(1, adjusted + 3 * kWeek, "by whole weeks");
  check(1, adjusted + 5000, "the path of another recording?");
}

TEST_CASE("GPS times that cannot be those of a recording are refused with the file") {
  TimedScan scan;
  scan.path(0, 10);
  for (const auto& [times, words] : std::vector<std::pair<std::vector<double>, std::string>>{
           {std::vector<double>(300, 0.0), "a.las: all 300 points have the GPS time 0.000 s"},
           {std::vector<double>(16, 1.5), "16 points have the GPS time"},
           {std::vector<double>(15, 1.5), ""},  // returns of one pulse
           {std::vector<double>(3, INFINITY), "finite GPS time"}}) {
    scan.give(times);
    check_says(scan.refusal(), words);
  }
  scan.las.global_encoding = 1;
  const double adjusted = 2286 * kWeek + 1000 - 1e9;
  scan.give({adjusted, adjusted + kWeek});
  scan.path(1000, 10);
  check_says(scan.refusal(), "of 2 weeks");
}

TEST_CASE("an input of which all points are left out does not lack GPS times") {
  TimedScan scan;
  scan.las.points = {{0, 90'000, 0}, {0, 90'000, 0}, {0, 90'000, 0}, {0, 90'000, 0}};
  scan.add("far.las", scan.las.build());
  scan.options.near = scan.folder.write("near.txt", "0 0 0 0 0 0 0 1\n");
  scan.options.within = 10;
  const ConversionReport report = scan.convert();
  check_equal(codes_of(report.warnings), "");
  check_equal(report.origins_path->without_time, 0);
  scan.options.inputs = {scan.folder / "far.las"};
  check_says(scan.refusal(), "none of the 4 points ... within 10");
}

TEST_CASE("inputs without GPS times have no origins by a path") {
  TimedScan scan;
  scan.add_ply("b.ply", std::vector<Vec3>{{1, 2, 3}, {4, 5, 6}});
  const ConversionReport report = scan.convert();
  check_says(codes_of(report.warnings), "no-gps-times ... points-without-origin");
  check_equal(report.points_without_origin, 2);
  const auto origins = scan.origins();
  CHECK(origins[3].has_value());
  CHECK_FALSE(origins[4].has_value());
  scan.options.inputs = {scan.folder / "b.ply"};
  check_says(scan.refusal(), "none of the inputs has GPS times");
  scan.las.format = 2;
  scan.las.times.clear();
  scan.add("a.las", scan.las.build());
  scan.options.inputs = {scan.folder / "a.las"};
  check_says(scan.refusal(), "none of the inputs has GPS times");
}

TEST_CASE("a path that is none, and options that contradict each other, are refused") {
  const auto check = [](const char* words, const std::function<void(TimedScan&)>& change) {
    TimedScan scan;
    change(scan);
    check_says(scan.refusal<Error>(), words);
    CHECK_FALSE(std::filesystem::exists(scan.folder / "a.h5"));
  };
  check("have no times", [](TimedScan& scan) {
    scan.path_text("0 0 0 0 0 0 1\n1 0 0 0 0 0 1\n");
    scan.options.path_options.format = TrajectoryFormat::kPoseXyzw;
  });
  check("expected times that ascend", [](TimedScan& scan) {
    scan.path_text("100 0 0 0 0 0 0 1\n102 1 0 0 0 0 0 1\n101 2 0 0 0 0 0 1\n");
  });
  check("p.txt",
        [](TimedScan& scan) { scan.path_text("100 0 nan 0 0 0 0 1\n101 1 0 0 0 0 0 1\n"); });
  check("more than a week", [](TimedScan& scan) { scan.path(100, 3, kWeek); });
  check("none.txt", [](TimedScan& scan) { scan.options.origins_path = scan.folder / "none.txt"; });
  check("one of the two", [](TimedScan& scan) { scan.options.origins = scan.folder / "o.csv"; });
  check("lever arm", [](TimedScan& scan) {
    scan.options.origins_path.clear();
    scan.options.lever_arm = {1, 0, 0};
  });
  check("lever arm", [](TimedScan& scan) { scan.options.lever_arm = {NAN, 0, 0}; });
  check("p.txt", [](TimedScan& scan) { scan.options.output = scan.options.origins_path; });
}

TEST_CASE("a path that takes more than an eighth of the memory is refused with a number") {
  TimedScan scan({100.25});
  std::string text;
  for (int i = 0; i < 480000; ++i) text += std::to_string(100 + 0.001 * i) + " 1 2 3 0 0 0 1\n";
  scan.path_text(text);
  scan.options.lever_arm = {1, 0, 0};
  scan.options.memory_bytes = kLeastConversionMemory;
  check_says(scan.refusal<ResourceError>(), "480,000 poses take 29.3 MiB ... 28.0 MiB, an eighth");
  scan.options.memory_bytes = 8 * 64 * 480000;
  check_equal(scan.refusal<Error>(), "");
}

TEST_CASE("a lever arm is in metres and a path in metres becomes the feet of the environment") {
  TimedScan scan({100.25});
  scan.options.unit = FileUnit::named("ift");
  scan.options.path_options.metres_per_unit = 1.0;
  scan.options.lever_arm = {0, 0, 3.048};
  CHECK(scan.origins()[0] == millimetres(0.5 / 0.3048, 0, 10));
}
