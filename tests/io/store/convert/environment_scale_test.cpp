// Which integers the points of an environment become: the scale, the offset and the rounding.
#include <cmath>

#include "read_environment.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// The scale in metres that a refusal advises; 0 where it advises a coarser one or one of the
/// caller's choice; negative where it advises none.
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

}  // namespace

TEST_CASE("integers of a LAS file are kept") {
  const ScratchFolder folder;
  const std::vector<Quantum> points{
      {1, 2, 3}, {-2147483647 - 1, 2147483647, 0}, {2147483647, -1, -2147483647 - 1}};
  const Quantisation odd{{0.0007, 0.25, 1e-9}, {1e6 + 0.1, -0.3, 7}};
  write_las(folder / "a.las", points, odd);
  const Environment environment = read_environment({folder / "a.las"});
  CHECK(environment.quantisation == odd);
  check_equal(environment.largest_change, 0);
  REQUIRE(environment.points.size() == 3);
  for (std::size_t i = 0; i < 3; ++i) CHECK(environment.points[i] == StoredPoint{i, points[i]});
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
    check_says(refusal({folder / "a.las", folder / other}), other);
    check_equal(advised_scale({folder / "a.las", folder / other}), 0.001);
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
  check_says(refusal({folder / "a.las", folder / "b.las"}), "too far from");
  check_equal(advised_scale({folder / "a.las", folder / "b.las"}), 0);
  const Environment environment =
      read_environment({folder / "a.las", folder / "b.las"}, with_scale(0.01));
  check_equal(positions(environment)[1].x, 3e6);
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
               {-1e6, 1e6, -1e6, 1e-3},
               {7, 7, 7, 1e-6}};
  for (const auto& c : cases) {
    CAPTURE(c.lo, c.hi);
    write_ply(folder / "a.ply", std::vector<Vec3>{{c.lo, 0.5, 9}, {c.hi, 0.5, 9}});
    const Environment environment = read_environment({folder / "a.ply"});
    CHECK(environment.quantisation.offset[0] == c.offset);
    CHECK(environment.quantisation.scale[0] == c.scale);
    check_equal(environment.quantisation.offset[1], 0);
    check_equal(environment.quantisation.scale[1], 1e-6);
    check_near(positions(environment)[1].x, c.hi, c.scale / 2 * (1 + 1e-6));
  }
}

TEST_CASE("positions are rounded to nearest, ties to even, the largest change is known") {
  const ScratchFolder folder;
  write_ply(folder / "a.ply", std::vector<Vec3>{{0.5, 1.5, 2.5}, {3.5, 0.25, 0.75}, {0, 0, 0}});
  const Environment environment = read_environment({folder / "a.ply"}, with_scale(1));
  CHECK(environment.points[0].q == Quantum{0, 2, 2});
  CHECK(environment.points[1].q == Quantum{4, 0, 1});
  check_equal(environment.largest_change, 0.5);
}

TEST_CASE("a scale too fine for the extent is refused with one that fits") {
  const ScratchFolder folder;
  write_ply(folder / "a.ply", std::vector<Vec3>{{0, 0, 0}, {30000, 0, 0}});
  check_equal(advised_scale({folder / "a.ply"}, with_scale(1e-6)), 0.0001);
  put_bytes(folder / "b.xyz", "1e300 0 0\n0 0 0\n");
  check_says(refusal({folder / "b.xyz"}, {}), "do not fit 32-bit integers");
  check_equal(advised_scale({folder / "b.xyz"}), 0);
  write_ply(folder / "a.ply", std::vector<Vec3>{{0, 0, 0}, {1e300, 0, 0}});
  check_says(refusal({folder / "a.ply"}), "do not fit");
}

TEST_CASE("steps coarser than a millimetre are taken only where they are asked for") {
  const ScratchFolder folder;
  std::string rows = "# a scan\nx,y,z\n";
  for (int i = 0; i < 1000; ++i) rows += std::to_string(0.25 * i) + ",2,3\n";
  put_bytes(folder / "a.csv", rows + "1e9,7,8\n" + rows.substr(15) + "1,2,-4e8\n");
  const auto error = refused({folder / "a.csv"});
  REQUIRE(error);
  check_says(
      error->what(),
      "need steps of 1 m ... at most 0.001 m ... line 1003: 1000000000 7 8 ... line 2004: 1 2 "
      "-400000000 ... Without them steps of 0.000001 m do");
  CHECK(error->remedy() == Remedy::kAcceptScale);
  check_equal(error->amount(), 1);
  check_equal(read_environment({folder / "a.csv"}, with_scale(1)).points.size(), 2002);
}

TEST_CASE("points that force a coarse step are named by line, or by number in binary files") {
  const ScratchFolder folder;
  std::vector<Vec3> points(5000, {10, 20, 30});
  points[4321].y = -3e7;
  write_ply(folder / "a.ply", points);
  check_says(refusal({folder / "a.ply"}), "point 4,321 (counted from 0): 10 -30000000");
  put_bytes(folder / "b.ply",
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
            "property float z\nend_header\n1 2 3\n1 2 4\n1e8 2 3\n");
  check_says(refusal({folder / "b.ply"}), "line 10: 100000000 2 3");
  check_says(refusal({folder / "a.ply", folder / "b.ply"}), "a.ply point 4,321 ... b.ply line 10");
  for (std::size_t i = 0; i < 40; ++i) points[i * 100].x = 1e9;
  write_ply(folder / "a.ply", points);
  CHECK_THAT(refusal({folder / "a.ply"}), Contains("and more") && !Contains("Without them"));
}

TEST_CASE("files in different frames are named where they force a coarse step") {
  const ScratchFolder folder;
  write_ply(folder / "local.ply", std::vector<Vec3>(100, {1, 2, 3}));
  write_ply(folder / "utm.ply", std::vector<Vec3>(100, {512345, 5412345, 3}));
  check_says(refusal({folder / "local.ply", folder / "utm.ply"}),
             "local.ply and  ... utm.ply: coordinates y");
}
