#include "core/trajectory/line/ground.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <random>
#include <vector>

#include "clearway/error.hpp"
#include "core/trajectory/line/line_path.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/memory_cloud.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// Steps that are no part of 0.1 m, so that no height is just on the border of a window.
constexpr Quantisation kSteps{{0.0007, 0.0007, 0.0007}, {0, 0, 0}};

using Height = std::function<double(double x, double y)>;

/// Points on a surface over 30 m by 6 m, with noise. There are none where the height is NaN.
std::vector<Vec3> surface(const Height& height, double noise = 0.004, std::size_t points = 60'000) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> x(-1, 29), y(-3, 3), error(-noise, noise);
  std::vector<Vec3> out;
  while (out.size() < points) {
    const double at = x(random), aside = y(random);
    out.push_back({at, aside, height(at, aside) + error(random)});
  }
  std::erase_if(out, [](const Vec3& p) { return std::isnan(p.z); });
  return out;
}

std::vector<GroundPlace> places_along_x(double to = 28) {
  std::vector<GroundPlace> places;
  for (int i = 0; 0.5 * i <= to; ++i) {
    places.push_back({0.5 * i, {{0.0123 + 0.5 * i, 0.00456}, 0}});
  }
  return places;
}

/// The rule, as its text says it, over all points. side: metres to the left.
struct Oracle {
  std::vector<Vec3> points;

  std::vector<double> strip(const GroundPlace& place, double side, double about,
                            double reach) const {
    const double c = std::cos(place.plan.heading), s = std::sin(place.plan.heading);
    std::vector<double> found;
    for (const Vec3& p : points) {
      const double dx = p.x - place.plan.at.real(), dy = p.y - place.plan.at.imag();
      const double along = c * dx + s * dy, left = c * dy - s * dx;
      if (std::abs(along) <= 0.25 && std::abs(left - side) <= 0.2 &&
          std::abs(p.z - about) <= reach) {
        found.push_back(p.z);
      }
    }
    return found;
  }

  static std::optional<double> ground(const std::vector<double>& heights) {
    const auto in_window = [&](double from) {
      std::vector<double> inside;
      for (const double h : heights) {
        if (h >= from && h <= from + 0.1) inside.push_back(h);
      }
      return inside;
    };
    std::size_t fullest = 0;
    for (const double from : heights) fullest = std::max(fullest, in_window(from).size());
    std::optional<double> lowest, best;
    for (const double from : heights) {
      const auto count = static_cast<double>(in_window(from).size());
      if (count < 12 || count < 0.2 * static_cast<double>(fullest)) continue;
      lowest = std::min(lowest.value_or(from), from);
    }
    if (!lowest) return std::nullopt;
    std::vector<double> starts = heights;
    std::sort(starts.begin(), starts.end());
    for (const double from : starts) {
      if (from < *lowest || from > *lowest + 0.1) continue;
      if (!best || in_window(from).size() > in_window(*best).size()) best = from;
    }
    std::vector<double> window = in_window(*best);
    std::sort(window.begin(), window.end());
    const std::size_t n = window.size();
    return n % 2 == 1 ? window[n / 2] : (window[n / 2 - 1] + window[n / 2]) / 2;
  }

  GroundSide side(const std::vector<GroundPlace>& places, double left,
                  std::optional<double> begin) const {
    GroundSide out;
    for (std::size_t i = 0; i < places.size(); ++i) {
      std::optional<double> about = places[i].height;
      if (!about && !out.heights.empty()) about = out.heights.back();
      if (!about) about = begin;
      const auto found = ground(strip(places[i], left, about.value_or(0), about ? 1 : 1e9));
      if (!found) continue;
      if (!out.heights.empty()) {
        const double way = places[i].station - places[out.places.back()].station;
        if (*found > out.heights.back() + 0.1 + 0.15 * way) {
          ++out.risen;
          continue;
        }
      }
      out.places.push_back(i);
      out.heights.push_back(*found);
    }
    return out;
  }
};

MemoryCloud cloud_of(const std::vector<Vec3>& points) {
  return {quantise(points, kSteps), kSteps, {.cell_points = 1024, .bucket_points = 0}};
}

/// What is found, after it was compared with the oracle.
GroundSide found_in(const std::vector<Vec3>& points, const std::vector<GroundPlace>& places,
                    double left, std::optional<double> begin = {}) {
  const GroundSide side =
      find_ground(cloud_of(points), places, {.left = left, .metre = 1, .begin = begin});
  const Oracle oracle{positions_of(quantise(points, kSteps), kSteps)};
  const GroundSide expected = oracle.side(places, left, begin);
  CHECK(side.places == expected.places);
  CHECK(side.risen == expected.risen);
  REQUIRE(side.heights.size() == expected.heights.size());
  for (std::size_t i = 0; i < side.heights.size(); ++i) {
    check_near(side.heights[i], expected.heights[i], 1e-12);
  }
  return side;
}

/// The greatest difference between what was found and a height.
double worst_of(const GroundSide& side, const std::vector<GroundPlace>& places, double left,
                const Height& height) {
  double worst = 0;
  for (std::size_t i = 0; i < side.places.size(); ++i) {
    const double x = places[side.places[i]].plan.at.real();
    worst = std::max(worst, std::abs(side.heights[i] - height(x, left)));
  }
  return worst;
}

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

}  // namespace

TEST_CASE("the ground among heights is the median of the lowest full window") {
  const auto ground = [](std::vector<double> heights) { return ground_among(heights); };
  CHECK_FALSE(ground({}));
  CHECK_FALSE(ground(std::vector<double>(11, 3.0)));
  check_equal(ground(std::vector<double>(12, 3.0)), 3.0);
  // Twelve points below are ground, unless the fullest window has more than five times as many.
  std::vector<double> heights(12, 1.0);
  heights.insert(heights.end(), 60, 2.0);
  check_equal(ground(heights), 1.0);
  heights.push_back(2.0);
  check_equal(ground(heights), 2.0);
  // Stray points less than 0.1 m below the ground are in its window, and hardly pull its median
  // down.
  heights.assign(12, 4.95);
  for (int i = 0; i < 40; ++i) heights.push_back(5 + 0.001 * i);
  heights.push_back(5.04);
  CHECK(ground(heights) == Approx(5.014));
  heights.assign({1, 1.01, 1.02, 1.03, 1.04, 1.05, 1.06, 1.07, 1.08, 1.081, 1.082, 1.083});
  CHECK(ground(heights) == Approx(1.055));
}

TEST_CASE("flat and sloping ground is found at every place on both sides") {
  const std::vector<GroundPlace> places = places_along_x();
  const std::vector<Height> grounds{[](double, double) { return 5.0; },
                                    [](double x, double y) { return 5 + 0.1 * x - 0.03 * y; },
                                    [](double x, double y) { return 5 - 0.15 * x + 0.1 * y; }};
  for (const Height& ground : grounds) {
    for (const double left : {0.9, -0.9}) {
      const GroundSide side = found_in(surface(ground), places, left);
      check_equal(side.places.size(), places.size());
      CHECK(worst_of(side, places, left, ground) < 0.02);
    }
  }
}

TEST_CASE("a line that turns has its strips beside it") {
  const Height ground = [](double x, double y) { return 5 + 0.05 * x + 0.1 * y; };
  std::vector<GroundPlace> places;
  for (int i = 0; i < 9; ++i) {
    const double angle = 0.25 * i;
    places.push_back({0.5 * i, {std::polar(2.0, angle - 1.57) + PlanPoint(10.003, 0.5), angle}});
  }
  for (const double left : {0.6, -0.6}) {
    const GroundSide side = found_in(surface(ground), places, left);
    REQUIRE(side.places.size() == places.size());
    for (std::size_t i = 0; i < places.size(); ++i) {
      const PlanPoint at =
          places[i].plan.at + PlanPoint(0, left) * std::polar(1.0, places[i].plan.heading);
      check_near(side.heights[i], ground(at.real(), at.imag()), 0.02);
    }
  }
}

TEST_CASE("a kerb is climbed and left on the side that meets it") {
  const std::vector<GroundPlace> places = places_along_x();
  const Height kerb = [](double x, double y) { return y < 0 && x > 10 && x < 18 ? 5.12 : 5.0; };
  const GroundSide right = found_in(surface(kerb), places, -0.9);
  check_equal(right.places.size(), places.size());
  check_equal(right.risen, 0);
  CHECK(right.heights[28] == Approx(5.12).margin(0.01));
  CHECK(right.heights.back() == Approx(5).margin(0.01));
  CHECK(worst_of(found_in(surface(kerb), places, 0.9), places, 0.9, kerb) < 0.01);
  // One that is too high to be climbed is dropped, until it is as low as a slope would be.
  const Height wall = [](double x, double) { return x > 10 ? 5.5 : 5.0; };
  const GroundSide stopped = found_in(surface(wall), places, 0.9);
  check_equal(stopped.risen, 5);
}

TEST_CASE("a parked car is passed over where its roof and bonnet are seen, not where its sill is") {
  const std::vector<GroundPlace> places = places_along_x();
  const auto car = [](double height) {
    return [height](double x, double y) { return y > 0 && x > 10 && x < 14 ? height : 5.0; };
  };
  // A bonnet of 0.9 m is in reach, and rises too steeply; a roof of 1.4 m is out of reach.
  for (const double height : {5.9, 6.4}) {
    const GroundSide side = found_in(surface(car(height)), places, 0.9);
    CHECK(worst_of(side, places, 0.9, [](double, double) { return 5.0; }) < 0.01);
    CHECK(side.risen == (height < 6 ? 7 : 0));
    const std::vector<double> all = side.bridged(places, 0, places.size() - 1);
    REQUIRE(all.size() == places.size());
    for (const double ground : all) check_near(ground, 5, 0.01);
  }
  // Below a car that stands 0.3 m above the ground the path fails by that much.
  const GroundSide low = found_in(surface(car(5.3)), places, 0.9);
  const double worst = worst_of(low, places, 0.9, [](double, double) { return 5.0; });
  CHECK(worst > 0.28);
  CHECK(worst < 0.31);
}

TEST_CASE("places without points are left out and bridged evenly") {
  const std::vector<GroundPlace> places = places_along_x();
  for (const double hole : {4.0, 6.0}) {
    const Height ground = [hole](double x, double) {
      return x > 10 && x < 10 + hole ? kNone : 5 + 0.1 * x;
    };
    const GroundSide side = found_in(surface(ground), places, 0.9);
    double longest = 0;
    for (std::size_t i = 0; i + 1 < side.places.size(); ++i) {
      longest =
          std::max(longest, places[side.places[i + 1]].station - places[side.places[i]].station);
    }
    CHECK(longest == hole);
    const std::vector<double> all = side.bridged(places, 2, places.size() - 1);
    REQUIRE(all.size() == places.size() - 2);
    for (std::size_t i = 0; i < all.size(); ++i) {
      check_near(all[i], 5 + 0.1 * places[i + 2].plan.at.real(), 0.02);
    }
  }
}

TEST_CASE("the height of the line or the last ground says on which floor it runs") {
  const std::vector<GroundPlace> places = places_along_x();
  std::vector<Vec3> floors = surface([](double, double) { return 2.0; });
  const std::vector<Vec3> upper = surface([](double x, double) { return 5 + 0.05 * x; });
  floors.insert(floors.end(), upper.begin(), upper.end());
  const GroundSide lowest = found_in(floors, places, 0.9);
  CHECK(worst_of(lowest, places, 0.9, [](double, double) { return 2.0; }) < 0.01);
  const GroundSide begun = found_in(floors, places, 0.9, 5.5);
  CHECK(worst_of(begun, places, 0.9, [](double x, double) { return 5 + 0.05 * x; }) < 0.01);
  std::vector<GroundPlace> high = places;
  for (GroundPlace& place : high) place.height = 5.5 + 0.05 * place.station;
  CHECK(found_in(floors, high, -0.9).heights == found_in(floors, places, -0.9, 5.5).heights);
  for (GroundPlace& place : high) place.height = 3.5;
  CHECK(found_in(floors, high, 0.9).places.empty());
}

TEST_CASE("a cloud in feet has the same ground in metres") {
  const std::vector<GroundPlace> places = places_along_x();
  const auto points = surface([](double x, double) { return 5 + 0.1 * x; });
  std::vector<Vec3> feet;
  for (const Vec3& p : points) feet.push_back((1 / 0.3048) * p);
  const Quantisation fine{{1e-6, 1e-6, 1e-6}, {0, 0, 0}};
  const MemoryCloud in_metres(quantise(points, fine), fine, {.cell_points = 1024});
  const MemoryCloud in_feet(quantise(feet, fine), fine, {.cell_points = 1024});
  const GroundSide a = find_ground(in_metres, places, {.left = 0.9});
  const GroundSide b = find_ground(in_feet, places, {.left = 0.9, .metre = 1 / 0.3048});
  CHECK(a.places == b.places);
  REQUIRE(a.heights.size() == b.heights.size());
  for (std::size_t i = 0; i < a.heights.size(); ++i) {
    check_near(a.heights[i], b.heights[i], 1e-4);
  }
}

TEST_CASE(
    "there is no ground without points, and damaged cells are refused only where they are read") {
  const std::vector<GroundPlace> places = places_along_x();
  CHECK(find_ground(MemoryCloud({}, kSteps), places, {.left = 0.9}).places.empty());
  const auto points = surface([](double, double) { return 5.0; });
  std::size_t read = 0;
  const MemoryCloud whole = cloud_of(points);
  const std::size_t cells = whole.cells().size();
  for (std::uint32_t cell = 0; cell < cells; ++cell) {
    MemoryCloud damaged = cloud_of(points);
    damaged.damage(cell);
    try {
      find_ground(damaged, places, {.left = 0.9});
    } catch (const InputError&) {
      ++read;
    }
  }
  CHECK(read > 0);
  CHECK(read < cells);
}
