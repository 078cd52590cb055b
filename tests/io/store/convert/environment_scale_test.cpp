// Which integers the points of an environment become: the scale, the offset and the rounding.
#include "read_environment.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

Quantisation millimetres_from(double x, double y, double z) {
  return {{0.001, 0.001, 0.001}, {x, y, z}};
}

struct LasScan {
  std::vector<Quantum> points;
  Quantisation quantisation;
};

/// Files of LAS, named 0.las, 1.las and so on.
struct LasInputs : Inputs {
  explicit LasInputs(const std::vector<LasScan>& scans) {
    for (const auto& [points, quantisation] : scans) {
      add_las(std::to_string(options.inputs.size()) + ".las", points, quantisation);
    }
  }
};

}  // namespace

TEST_CASE("LAS files keep their integers, are rebased by whole quanta, or rounded to --scale") {
  const auto check = [](const std::vector<LasScan>& scans, std::optional<double> scale,
                        const Quantisation& quantisation, const std::vector<Quantum>& points,
                        double change, double tolerance) {
    const Environment environment = LasInputs(scans).read({.scale = scale});
    CHECK(environment.quantisation == quantisation);
    CHECK(environment.quanta() == points);
    check_near(environment.largest_change, change, tolerance);
  };
  constexpr std::int32_t kLeast = -2147483647 - 1, kMost = 2147483647;
  const Quantisation odd{{0.0007, 0.25, 1e-9}, {1e6 + 0.1, -0.3, 7}},
      mm = millimetres_from(0, 0, 0);
  const std::vector<Quantum> extremes{{1, 2, 3}, {kLeast, kMost, 0}, {kMost, -1, kLeast}};
  const std::vector<Quantum> one{{10, -20, 30}}, two{{15, 25, -35}, {0, 7, 4}};
  const LasScan shifted{two, millimetres_from(1.5, 0, 0)};
  check({{extremes, odd}}, {}, odd, extremes, 0, 0);
  check({{one, millimetres_from(1000, -5, 0)}, {one, millimetres_from(1000.5, -6, 0.003)}}, {},
        millimetres_from(1000, -5, 0), {one[0], {510, -1020, 33}}, 0, 1e-12);
  check({{one, mm}, {one, millimetres_from(0.9e-9, 0, 0)}}, {}, mm, {one[0], one[0]}, 0.9e-9,
        1e-12);
  check({shifted}, 0.001, shifted.quantisation, two, 0, 0);
  check({shifted}, 0.01, {{0.01, 0.01, 0.01}, {1, 0, -1}}, {{51, 2, 96}, {50, 1, 100}}, 0.005,
        1e-9);
  check({{{{0, 0, 0}}, mm}, {{{0, 0, 0}}, millimetres_from(3e6, 0, 0)}}, 0.01,
        {{0.01, 0.01, 0.01}, {0, 0, 0}}, {{0, 0, 0}, {300'000'000, 0, 0}}, 0, 0);
  check({{one, mm}, {one, millimetres_from(0, 0.0005, 0)}}, 0.0005,
        {{0.0005, 0.0005, 0.0005}, {0, -1, 0}}, {{20, 1960, 60}, {20, 1961, 60}}, 0, 1e-9);
}

TEST_CASE("positions take the finest power of ten that fits, the offset a whole number") {
  const auto check = [](double lo, double hi, double offset, double scale) {
    CAPTURE(lo, hi);
    Inputs inputs;
    inputs.add_ply("a.ply", std::vector<Vec3>{{lo, 0.5, 9}, {hi, 0.5, 9}});
    const Environment environment = inputs.read();
    const Quantisation& quantisation = environment.quantisation;
    check_equal(quantisation.offset[0], offset);
    check_equal(quantisation.scale[0], scale);
    check_equal(quantisation.offset[1], 0);
    check_equal(quantisation.scale[1], 1e-6);
    const std::int32_t last = environment.points[1].q[0];
    check_near(coordinate(quantisation, 0, last), hi, scale / 2 * (1 + 1e-6));
  };
  check(0.25, 1.75, 0, 1e-6);
  check(-0.25, 1.75, -1, 1e-6);
  check(-3, 2144.483647, -3, 1e-6);
  check(-3, 2144.483649, -3, 1e-5);
  check(5e6 + 0.5, 5e6 + 30000.5, 5e6, 1e-4);
  check(-1e6, 1e6, -1e6, 1e-3);
  check(7, 7, 7, 1e-6);
}

TEST_CASE("positions are rounded to nearest, ties to even, the largest change is known") {
  Inputs inputs;
  inputs.add_ply("a.ply", std::vector<Vec3>{{0.5, 1.5, 2.5}, {3.5, 0.25, 0.75}, {0, 0, 0}});
  const Environment environment = inputs.read({.scale = 1});
  CHECK(environment.quanta() == std::vector<Quantum>{{0, 2, 2}, {4, 0, 1}, {0, 0, 0}});
  check_equal(environment.largest_change, 0.5);
}

TEST_CASE("coordinates that do not fit the steps are refused with a scale that does") {
  // advised: scale in metres, or 0 for one of the caller's choice.
  const auto check = [](const Inputs& inputs, const std::string& words, double advised,
                        std::optional<double> scale = {}) {
    const InputError error = inputs.refused({.scale = scale});
    check_says(error.what(), words);
    CHECK((error.remedy() == Remedy::kScale || error.remedy() == Remedy::kOneScale));
    check_equal(error.amount(), advised);
  };
  const LasScan here{{{10, -20, 30}}, millimetres_from(0, 0, 0)};
  const auto beside = [&](const Quantisation& other) {
    return LasInputs({here, {here.points, other}});
  };
  check(beside(millimetres_from(0, 0.0005, 0)), "1.las", 0.001);
  check(beside({{0.01, 0.01, 0.01}, {0, 0, 0}}), "1.las", 0.001);
  check(beside(millimetres_from(3e6, 0, 0)), "too far from", 0);
  Inputs inputs;
  inputs.add_ply("a.ply", std::vector<Vec3>{{0, 0, 0}, {30000, 0, 0}});
  check(inputs, "a.ply", 0.0001, 1e-6);
  inputs.add_ply("a.ply", std::vector<Vec3>{{0, 0, 0}, {1e300, 0, 0}});
  check(inputs, "do not fit", 0);
  inputs.options.inputs.clear();
  inputs.add("b.xyz", "1e300 0 0\n0 0 0\n");
  check(inputs, "do not fit 32-bit integers", 0);
}

TEST_CASE("steps coarser than a millimetre are refused with the points that force them") {
  Inputs inputs;
  std::string rows = "# a scan\nx,y,z\n";
  for (int i = 0; i < 1000; ++i) rows += std::to_string(0.25 * i) + ",2,3\n";
  inputs.add("a.csv", rows + "1e9,7,8\n" + rows.substr(15) + "1,2,-4e8\n");
  const InputError error = inputs.refused();
  check_says(
      error.what(),
      "need steps of 1 m ... at most 0.001 m ... line 1003: 1000000000 7 8 ... line 2004: 1 2 "
      "-400000000 ... Without them steps of 0.000001 m do");
  CHECK(error.remedy() == Remedy::kAcceptScale);
  check_equal(error.amount(), 1);
  check_equal(inputs.read({.scale = 1}).points.size(), 2002);

  Inputs named;
  std::vector<Vec3> points(5000, {10, 20, 30});
  points[4321].y = -3e7;
  named.add_ply("a.ply", points);
  check_says(named.refusal(), "point 4,321 (counted from 0): 10 -30000000");
  named.add("b.ply",
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
            "property float z\nend_header\n1 2 3\n1 2 4\n1e8 2 3\n");
  check_says(named.refusal(), "a.ply point 4,321 ... b.ply line 10: 100000000 2 3");
  for (std::size_t i = 0; i < 40; ++i) points[i * 100].x = 1e9;
  named.add_ply("a.ply", points);
  CHECK_THAT(named.refusal(), Contains("and more") && !Contains("Without them"));

  Inputs frames;
  frames.add_ply("local.ply", std::vector<Vec3>(100, {1, 2, 3}));
  frames.add_ply("utm.ply", std::vector<Vec3>(100, {512345, 5412345, 3}));
  check_says(frames.refusal(), "local.ply and  ... utm.ply: coordinates y");
}
