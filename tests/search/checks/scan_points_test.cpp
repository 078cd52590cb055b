#include <cmath>
#include <vector>

#include "clearway/error.hpp"
#include "search/checks/facts/scan_facts.hpp"
#include "search/checks/single_floats.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/memory_cloud.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

constexpr Quantisation kMillimetres{{0.001, 0.001, 0.001}, {0, 0, 0}};

/// A cloud of a ground of 40 m by 40 m at height 0, with points 0.2 m apart, in cells of 1024.
MemoryCloud ground_cloud() {
  std::vector<Quantum> points;
  for (std::int32_t i = 0; i < 200; ++i) {
    for (std::int32_t j = 0; j < 200; ++j) points.push_back({200 * i + 100, 200 * j + 100, 0});
  }
  return {points, kMillimetres, {.cell_points = 1024, .bucket_points = 0}};
}

Pose turned(double angle, double scale, const Vec3& to) {
  const double c = scale * std::cos(angle), s = scale * std::sin(angle);
  return {{c, -s, 0, s, c, 0, 0, 0, scale}, {to.x, to.y, to.z}};
}

}  // namespace

TEST_CASE("the points in a turned box are all found, in its frame") {
  const MemoryCloud cloud = ground_cloud();
  const ScanPoints points(cloud);
  const Box box{{-4.03, -1.03, -3}, {4.03, 1.03, 0}};
  for (const double scale : {1.0, 0.5}) {
    for (const double angle : {0.0, 0.3, 0.8, 2.5}) {
      CAPTURE(scale, angle);
      const Pose pose = turned(angle, scale, {20, 20, scale * 1.5});
      std::uint64_t expected = 0, found = 0;
      for (int i = 0; i < 200; ++i) {
        for (int j = 0; j < 200; ++j) {
          const double x = 0.2 * i + 0.1 - 20, y = 0.2 * j + 0.1 - 20;
          const double along = (std::cos(angle) * x + std::sin(angle) * y) / scale;
          const double across = (-std::sin(angle) * x + std::cos(angle) * y) / scale;
          if (std::abs(along) <= 4.03 && std::abs(across) <= 1.03) ++expected;
        }
      }
      CHECK(points.visit(box, pose, [&](const Vec3& p, auto...) {
        CHECK(p.z == Approx(-1.5));
        ++found;
        return true;
      }));
      CHECK(found == expected);
      CHECK(points.has(box, pose, expected));
      CHECK_FALSE(points.has(box, pose, expected + 1));
    }
  }
}

TEST_CASE("a visit stops when it is told to, and passes over no damaged cell") {
  const MemoryCloud cloud = ground_cloud();
  const Box all{{0, 0, -1}, {40, 40, 1}};
  int seen = 0;
  CHECK(ScanPoints(cloud).visit(all, turned(0, 1, {0, 0, 0}), [&](auto...) { return ++seen < 7; }));
  check_equal(seen, 7);
  for (std::uint32_t cell = 0; cell < cloud.cells().size(); ++cell) {
    MemoryCloud damaged = ground_cloud();
    damaged.damage(cell);
    CHECK_THROWS_AS(
        ScanPoints(damaged).visit(all, turned(0, 1, {0, 0, 0}), [](auto...) { return true; }),
        InputError);
  }
}

TEST_CASE("ground is as far below a body as it is") {
  const MemoryCloud cloud = ground_cloud();
  const auto height_at = [&](const Vec3& at) {
    return height_above_ground(ScanPoints(cloud), {{-1, -1, 0.5}, {1, 1, 2}}, turned(0.4, 1, at));
  };
  CHECK(height_at({20, 20, 7}).value() == Approx(7.5));
  check_equal(height_at({20, 20, -1}).value(), 0);
  CHECK_FALSE(height_at({20, 20, -4}).has_value());
  CHECK_FALSE(height_at({50, 20, 7}).has_value());
}

// Which coordinates went through single precision.

TEST_CASE("numbers of single precision are told from others at coordinates of a map") {
  const auto single = [](double v) { return static_cast<double>(static_cast<float>(v)); };
  const auto rounded = [](double v, double step) { return std::round(v / step) * step; };
  // Eastings near 448 km, where steps are 1/32 m, and northings near 5,412 km, where they are 0.5
  // m.
  const auto step_of = [](const auto& change, double tolerance = 0.005) {
    std::vector<Vec3> places;
    for (int i = 0; i < 300; ++i) {
      const double x = 448'123.4567 + 0.3331 * i, y = 5'412'345.678 + 0.4117 * i;
      places.push_back({change(x), change(y), 512.3});
    }
    return single_precision_step(places, tolerance, 1).value_or(0);
  };
  const auto as_text = [&](double step) { return [=](double v) { return rounded(v, step); }; };
  check_equal(step_of(single), 0.5);
  check_equal(step_of([&](double v) { return rounded(single(v), 1e-3); }), 0.5);
  check_equal(step_of(single, 1), 0);
  check_equal(step_of([](double v) { return v; }), 0);
  check_equal(step_of(as_text(0.01)), 0);
  check_equal(step_of(as_text(0.001)), 0);
  check_equal(step_of(as_text(0.5)), 0);  // half metres are exact
  // Near the origin
  check_equal(step_of([&](double v) { return single(v - (v > 1e6 ? 5'412'000 : 448'000)); }), 0);
  // Text in feet with two decimals holds quarter feet, which single precision has, but no whole
  // centimetres.
  std::vector<Vec3> feet;
  for (int i = 0; i < 300; ++i) feet.push_back({1'471'500 + 0.25 * i, 17'756'000 + 2.0 * i, 1});
  CHECK(!single_precision_step(feet, 0.015, 1 / 0.3048));
  CHECK(!single_precision_step({}, 0.005, 1));
  // A single place may be such a number by chance.
  CHECK(!single_precision_step(std::vector<Vec3>{{448'123.03125, 5'412'345.5, 1}}, 0.005, 1));
}
