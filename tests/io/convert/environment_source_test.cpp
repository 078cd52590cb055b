#include "io/convert/environment_source.hpp"

#include <sys/stat.h>

#include <catch2/catch.hpp>
#include <cmath>

#include "clearway/error.hpp"
#include "support/las_bytes.hpp"
#include "support/store_fixture.hpp"

using namespace clearway;
using namespace clearway::test;
using Catch::Contains;

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Environment {
  Quantisation quantisation;
  std::vector<StoredPoint> points;
  std::uint64_t input_points, non_finite_points;
  double largest_change;
  std::vector<Message> warnings;
  LengthUnit unit;
};

Environment read_environment(const std::vector<std::filesystem::path>& inputs,
                             const EnvironmentOptions& options = {}) {
  EnvironmentSource source(inputs, options);
  Environment out{};
  QuantaBatch batch;
  while (source.read(batch)) {
    for (std::size_t i = 0; i < batch.quanta.size(); ++i) {
      out.points.push_back({batch.source(i), batch.quanta[i]});
    }
  }
  out.quantisation = source.quantisation();
  out.input_points = source.input_points();
  out.non_finite_points = source.non_finite_points();
  out.largest_change = source.largest_change();
  out.warnings = source.warnings();
  out.unit = source.unit();
  return out;
}

std::optional<InputError> refused(const std::vector<std::filesystem::path>& inputs,
                                  const EnvironmentOptions& options = {}) {
  try {
    read_environment(inputs, options);
  } catch (const InputError& error) {
    return error;
  }
  return std::nullopt;
}

std::string refusal(const std::vector<std::filesystem::path>& inputs,
                    const EnvironmentOptions& options = {}) {
  const auto error = refused(inputs, options);
  return error ? error->what() : "";
}

/// The scale in metres that a refusal advises; 0: a coarser one, or one of the caller's choice;
/// negative: none.
double advised_scale(const std::vector<std::filesystem::path>& inputs,
                     const EnvironmentOptions& options = {}) {
  const auto error = refused(inputs, options);
  return error && (error->remedy() == Remedy::kScale || error->remedy() == Remedy::kOneScale)
             ? error->amount()
             : -1;
}

EnvironmentOptions with_scale(double scale) { return {.scale = scale}; }

std::vector<Vec3> positions(const Environment& environment) {
  std::vector<Vec3> out;
  for (const StoredPoint& p : environment.points) {
    out.push_back(position(environment.quantisation, p.q[0], p.q[1], p.q[2]));
  }
  return out;
}

Quantisation millimetres_from(double x, double y, double z) {
  return {{0.001, 0.001, 0.001}, {x, y, z}};
}

std::string las_with_wkt(const std::string& wkt) {
  LasBytes las;
  las.minor = 4;
  las.format = 6;
  las.global_encoding = 16;
  las.vlrs = {{"LASF_Projection", 2112, wkt}};
  return las.build();
}

const std::string kMetreWkt = R"(PROJCS["m",GEOGCS["g"],UNIT["metre",1]])";
const std::string kFootWkt = R"(PROJCS["f",GEOGCS["g"],UNIT["US survey foot",0.3048006096012192]])";
const std::string kDegreeWkt = R"(GEOGCS["WGS 84",UNIT["degree",0.0174532925199433]])";

}  // namespace

TEST_CASE("integers of a LAS file are kept") {
  const ScratchFolder folder;
  const std::vector<Quantum> points{
      {1, 2, 3}, {-2147483647 - 1, 2147483647, 0}, {2147483647, -1, -2147483647 - 1}};
  const Quantisation odd{{0.0007, 0.25, 1e-9}, {1e6 + 0.1, -0.3, 7}};
  write_las(folder / "a.las", points, odd);
  const Environment environment = read_environment({folder / "a.las"});
  CHECK(environment.quantisation == odd);
  CHECK(environment.largest_change == 0);
  REQUIRE(environment.points.size() == 3);
  for (std::size_t i = 0; i < 3; ++i) CHECK(environment.points[i] == StoredPoint{i, points[i]});
}

TEST_CASE("inputs follow each other as given, a folder's in byte order of their names") {
  const ScratchFolder folder;
  std::filesystem::create_directory(folder / "scans");
  const auto add = [&](const std::string& name, std::int32_t x) {
    write_las(folder / name, std::vector<Quantum>{{x, 0, 0}});
  };
  add("scans/b.las", 3);
  add("scans/B.las", 1);
  add("scans/a10.las", 2);
  add("z.las", 0);
  add("a.las", 4);
  const Environment environment =
      read_environment({folder / "z.las", folder / "scans", folder / "a.las"});
  REQUIRE(environment.points.size() == 5);
  for (std::int32_t i = 0; i < 5; ++i) {
    CHECK(environment.points[static_cast<std::size_t>(i)] ==
          StoredPoint{static_cast<std::uint64_t>(i), {i, 0, 0}});
  }
}

TEST_CASE("files of one scale are rebased by whole quanta") {
  const ScratchFolder folder;
  const std::vector<Quantum> points{{10, -20, 30}};
  write_las(folder / "a.las", points, millimetres_from(1000, -5, 0));
  write_las(folder / "b.las", points, millimetres_from(1000.5, -6, 0.003));
  const Environment environment = read_environment({folder / "a.las", folder / "b.las"});
  CHECK(environment.quantisation == millimetres_from(1000, -5, 0));
  REQUIRE(environment.points.size() == 2);
  CHECK(environment.points[0].q == Quantum{10, -20, 30});
  CHECK(environment.points[1].q == Quantum{510, -1020, 33});
  CHECK(environment.largest_change < 1e-12);
}

TEST_CASE("the change by an offset that is a little off is reported") {
  const ScratchFolder folder;
  const std::vector<Quantum> points{{10, -20, 30}};
  write_las(folder / "a.las", points, millimetres_from(0, 0, 0));
  write_las(folder / "b.las", points, millimetres_from(0.9e-9, 0, 0));
  const Environment environment = read_environment({folder / "a.las", folder / "b.las"});
  CHECK(environment.points[1].q == points[0]);
  CHECK(environment.largest_change == Approx(0.9e-9).epsilon(1e-3));
}

TEST_CASE("files whose offsets or scales do not agree are refused with advice") {
  const ScratchFolder folder;
  const std::vector<Quantum> points{{10, -20, 30}};
  write_las(folder / "a.las", points, millimetres_from(0, 0, 0));
  write_las(folder / "half.las", points, millimetres_from(0, 0.0005, 0));
  write_las(folder / "coarse.las", points, {{0.01, 0.01, 0.01}, {0, 0, 0}});
  for (const char* other : {"half.las", "coarse.las"}) {
    CHECK_THAT(refusal({folder / "a.las", folder / other}), Contains(other));
    CHECK(advised_scale({folder / "a.las", folder / other}) == 0.001);
    const Environment environment =
        read_environment({folder / "a.las", folder / other}, with_scale(0.0005));
    REQUIRE(environment.points.size() == 2);
    CHECK(positions(environment)[0].x == Approx(0.01));
    CHECK(environment.largest_change < 0.00026);
  }
}

TEST_CASE("a file too far from the first is refused, and fits a coarser scale") {
  const ScratchFolder folder;
  write_las(folder / "a.las", std::vector<Quantum>{{0, 0, 0}}, millimetres_from(0, 0, 0));
  write_las(folder / "b.las", std::vector<Quantum>{{0, 0, 0}}, millimetres_from(3e6, 0, 0));
  CHECK_THAT(refusal({folder / "a.las", folder / "b.las"}), Contains("too far from"));
  CHECK(advised_scale({folder / "a.las", folder / "b.las"}) == 0);
  const Environment environment =
      read_environment({folder / "a.las", folder / "b.las"}, with_scale(0.01));
  CHECK(positions(environment)[1].x == 3e6);
}

TEST_CASE("a --scale that the file has keeps its integers, another one rounds") {
  const ScratchFolder folder;
  const std::vector<Quantum> points{{15, 25, -35}, {0, 7, 4}};
  write_las(folder / "a.las", points, millimetres_from(1.5, 0, 0));
  const Environment kept = read_environment({folder / "a.las"}, with_scale(0.001));
  CHECK(kept.quantisation == millimetres_from(1.5, 0, 0));
  CHECK(kept.points[0].q == points[0]);
  const Environment rounded = read_environment({folder / "a.las"}, with_scale(0.01));
  CHECK(rounded.quantisation == Quantisation{{0.01, 0.01, 0.01}, {1, 0, -1}});
  CHECK(rounded.points[1].q == Quantum{50, 1, 100});
  CHECK(rounded.largest_change == Approx(0.005).epsilon(1e-9));
}

TEST_CASE("positions take the finest power of ten that fits, the offset a whole number") {
  const ScratchFolder folder;
  const struct {
    double lo, hi, offset, scale;
  } cases[] = {{0.25, 1.75, 0, 1e-6},
               {-0.25, 1.75, -1, 1e-6},
               {-3, 2144.483647, -3, 1e-6},
               {-3, 2144.483649, -3, 1e-5},
               {5e6 + 0.5, 5e6 + 30000.5, 5e6, 1e-4},
               {-1e9, 1e9, -1e9, 1},
               {7, 7, 7, 1e-6}};
  for (const auto& c : cases) {
    CAPTURE(c.lo, c.hi);
    write_ply(folder / "a.ply", std::vector<Vec3>{{c.lo, 0.5, 9}, {c.hi, 0.5, 9}});
    const Environment environment = read_environment({folder / "a.ply"});
    CHECK(environment.quantisation.offset[0] == c.offset);
    CHECK(environment.quantisation.scale[0] == c.scale);
    CHECK(environment.quantisation.offset[1] == 0);
    CHECK(environment.quantisation.scale[1] == 1e-6);
    CHECK(std::abs(positions(environment)[1].x - c.hi) <= c.scale / 2 * (1 + 1e-6));
  }
}

TEST_CASE("positions are rounded to nearest, ties to even, the largest change is known") {
  const ScratchFolder folder;
  write_ply(folder / "a.ply", std::vector<Vec3>{{0.5, 1.5, 2.5}, {3.5, 0.25, 0.75}, {0, 0, 0}});
  const Environment environment = read_environment({folder / "a.ply"}, with_scale(1));
  CHECK(environment.points[0].q == Quantum{0, 2, 2});
  CHECK(environment.points[1].q == Quantum{4, 0, 1});
  CHECK(environment.largest_change == 0.5);
}

TEST_CASE("a scale too fine for the extent is refused with one that fits") {
  const ScratchFolder folder;
  write_ply(folder / "a.ply", std::vector<Vec3>{{0, 0, 0}, {30000, 0, 0}});
  CHECK(advised_scale({folder / "a.ply"}, with_scale(1e-6)) == 0.0001);
  put_bytes(folder / "b.xyz", "1e300 0 0\n0 0 0\n");
  CHECK_THAT(refusal({folder / "b.xyz"}, {}), Contains("do not fit 32-bit integers"));
  CHECK(advised_scale({folder / "b.xyz"}) == 0);
  write_ply(folder / "a.ply", std::vector<Vec3>{{0, 0, 0}, {1e300, 0, 0}});
  CHECK_THAT(refusal({folder / "a.ply"}), Contains("do not fit"));
}

TEST_CASE("integers and positions go together only with --scale") {
  const ScratchFolder folder;
  write_las(folder / "a.las", std::vector<Quantum>{{1, 2, 3}}, millimetres_from(0, 0, 0));
  write_ply(folder / "a.ply", std::vector<Vec3>{{0.001, 0.002, 0.003}});
  CHECK_THAT(refusal({folder / "a.las", folder / "a.ply"}), Contains("one scale"));
  CHECK_THAT(refusal({folder / "a.ply", folder / "a.las"}), Contains("one scale"));
  const Environment environment =
      read_environment({folder / "a.ply", folder / "a.las"}, with_scale(0.001));
  REQUIRE(environment.points.size() == 2);
  CHECK(environment.points[0].q == environment.points[1].q);
  CHECK(environment.points[1].source == 1);
}

TEST_CASE("points that are not finite are counted and keep their index") {
  const ScratchFolder folder;
  const std::vector<Vec3> points{{kNaN, 0, 0},       {1, 1, 1}, {0, kInfinity, 0}, {2, 2, 2},
                                 {0, 0, -kInfinity}, {3, 3, 3}, {kNaN, kNaN, kNaN}};
  write_ply(folder / "a.ply", points);
  write_ply(folder / "none.ply", std::vector<Vec3>(3, {kNaN, 0, 0}));
  const Environment environment =
      read_environment({folder / "a.ply", folder / "none.ply", folder / "a.ply"});
  CHECK(environment.non_finite_points == 11);
  CHECK(environment.input_points == 17);
  std::vector<std::uint64_t> sources;
  for (const StoredPoint& p : environment.points) sources.push_back(p.source);
  CHECK(sources == std::vector<std::uint64_t>{1, 3, 5, 11, 13, 15});
  CHECK_THAT(refusal({folder / "a.ply"}, {.strict = true}), Contains("point 0 is not finite"));
}

TEST_CASE("points of batches that start, end and consist of non-finite ones keep their index") {
  const ScratchFolder folder;
  std::vector<Vec3> points(3 * PointReader::kBatchPoints + 5, {1, 2, 3});
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::size_t batch = i / PointReader::kBatchPoints;
    points[i].x = static_cast<double>(i % 1000);
    if (batch == 1 || i % PointReader::kBatchPoints < 3 || i % 7 == 0) points[i].z = kNaN;
  }
  write_ply(folder / "a.ply", points);
  const Environment environment = read_environment({folder / "a.ply"});
  std::size_t next = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (std::isnan(points[i].z)) continue;
    REQUIRE(next < environment.points.size());
    REQUIRE(environment.points[next].source == i);
    REQUIRE(environment.points[next].q[0] == 1'000'000 * static_cast<std::int32_t>(points[i].x));
    ++next;
  }
  CHECK(next == environment.points.size());
}

TEST_CASE("no point, and none that is finite, make an empty environment") {
  const ScratchFolder folder;
  write_ply(folder / "a.ply", std::vector<Vec3>(2, {kNaN, 0, 0}));
  CHECK(read_environment({folder / "a.ply"}).points.empty());
  write_ply(folder / "b.ply", std::vector<Vec3>{});
  CHECK(read_environment({folder / "b.ply"}).points.empty());
}

TEST_CASE("degrees are refused, unless they are to be taken as they are") {
  const ScratchFolder folder;
  put_bytes(folder / "a.las", las_with_wkt(kDegreeWkt));
  CHECK_THAT(refusal({folder / "a.las"}), Contains("degrees"));
  CHECK(refused({folder / "a.las"})->remedy() == Remedy::kIgnoreCrs);
  CHECK(read_environment({folder / "a.las"}, {.ignore_crs = true}).points.size() == 3);
}

TEST_CASE("feet are reported, other units than the first file's refused") {
  const ScratchFolder folder;
  put_bytes(folder / "feet.las", las_with_wkt(kFootWkt));
  put_bytes(folder / "metres.las", las_with_wkt(kMetreWkt));
  const Environment feet = read_environment({folder / "feet.las"});
  CHECK(feet.unit == LengthUnit::kUsSurveyFoot);
  REQUIRE(feet.warnings.size() == 1);
  CHECK_THAT(feet.warnings[0].text, Contains("feet"));
  CHECK(read_environment({folder / "metres.las"}).warnings.empty());
  CHECK_THAT(refusal({folder / "metres.las", folder / "feet.las"}), Contains("unit of length"));
  CHECK(read_environment({folder / "metres.las", folder / "feet.las"}, {.ignore_crs = true})
            .points.size() == 6);
}

TEST_CASE("a pipe given as a file is refused with advice") {
  const ScratchFolder folder;
  const auto pipe = folder / "pipe.las";
  REQUIRE(::mkfifo(pipe.c_str(), 0600) == 0);
  CHECK_THAT(refusal({pipe}), Contains("standard input"));
}

TEST_CASE("standard input goes with nothing else") {
  CHECK_THROWS_AS(EnvironmentSource({"-", "a.las"}, {}), UsageError);
}
