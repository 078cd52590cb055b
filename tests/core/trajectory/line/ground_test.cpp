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
constexpr Quantisation kGroundSteps{{0.0007, 0.0007, 0.0007}, {0, 0, 0}};

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

  GroundSide side(const std::vector<GroundPlace>& places, double left) const {
    GroundSide out;
    for (std::size_t i = 0; i < places.size(); ++i) {
      std::optional<double> about = places[i].height;
      if (!about && !out.heights.empty()) about = out.heights.back();
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
  return {quantise(points, kGroundSteps), kGroundSteps, {.cell_points = 1024, .bucket_points = 0}};
}

/// What is found, after it was compared with the oracle.
GroundSide found_in(const std::vector<Vec3>& points, const std::vector<GroundPlace>& places,
                    double left) {
  const GroundSide side = find_ground(cloud_of(points), places, {.left = left, .metre = 1});
  const Oracle oracle{positions_of(quantise(points, kGroundSteps), kGroundSteps)};
  const GroundSide expected = oracle.side(places, left);
  CHECK(side.places == expected.places);
  CHECK(side.risen == expected.risen);
  REQUIRE(side.heights.size() == expected.heights.size());
  for (std::size_t i = 0; i < side.heights.size(); ++i) {
    check_near(side.heights[i], expected.heights[i], 1e-12);
  }
  // Between the first and the last found place, heights change evenly from one to the next.
  for (std::size_t k = 0; k + 1 < side.places.size(); ++k) {
    const std::size_t from = side.places[k], to = side.places[k + 1];
    const std::vector<double> all = side.bridged(places, from, to);
    REQUIRE(all.size() == to + 1 - from);
    for (std::size_t i = from; i <= to; ++i) {
      const double share = static_cast<double>(i - from) / static_cast<double>(to - from);
      check_near(all[i - from], side.heights[k] + share * (side.heights[k + 1] - side.heights[k]),
                 1e-12);
    }
  }
  return side;
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

TEST_CASE("the ground of even and uneven surfaces is that of the rule") {
  struct Row {
    const char* what;
    Height surface;
    double left, last;        ///< the side, and the height at the last place
    std::size_t places = 57;  ///< at which ground is found
    std::size_t risen = 0;    ///< places that rise too steeply
  };
  const auto part = [](double from, double to, double height) {
    return [=](double x, double y) { return y > 0 && x > from && x < to ? height : 5.0; };
  };
  const Height up = [](double x, double y) { return 5 + 0.1 * x - 0.03 * y; };
  const Height down = [](double x, double y) { return 5 - 0.15 * x + 0.1 * y; };
  for (const Row& row :
       {Row{"level", part(0, 0, 0), 0.9, 5}, Row{"rising", up, 0.9, 7.77},
        Row{"falling", down, 0.9, 0.89}, Row{"falling, on the right", down, -0.9, 0.71},
        Row{"a kerb", part(10, 18, 5.12), 0.9, 5},
        Row{"a kerb on the other side", part(10, 18, 5.12), -0.9, 5},
        Row{"a kerb that goes on", part(10, 99, 5.12), 0.9, 5.12},
        // One that is too high is dropped, until it is as low as a slope would be.
        Row{"a wall", part(10, 99, 5.5), 0.9, 5.5, 52, 5},
        // A bonnet is in reach, and rises too steeply; a roof is out of reach.
        Row{"a bonnet", part(10, 14, 5.9), 0.9, 5, 50, 7},
        Row{"a roof", part(10, 14, 6.4), 0.9, 5, 50},
        // Below a car that stands 0.3 m above the ground the path fails by that much.
        Row{"a sill", part(10, 99, 5.3), 0.9, 5.3, 55, 2},
        Row{"a hole", part(10, 14, kNone), 0.9, 5, 50},
        Row{"a longer hole", part(10, 16, kNone), 0.9, 5, 46}}) {
    const RowName name(row.what);
    const GroundSide side = found_in(surface(row.surface), places_along_x(), row.left);
    check_near(side.heights.back(), row.last, 0.02);
    check_equal(side.places.size(), row.places);
    check_equal(side.risen, row.risen);
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
    check_equal(found_in(surface(ground), places, left).places.size(), places.size());
  }
}

TEST_CASE(
    "there is no ground without points, and damaged cells are refused only where they are read") {
  const std::vector<GroundPlace> places = places_along_x();
  CHECK(find_ground(MemoryCloud({}, kGroundSteps), places, {.left = 0.9}).places.empty());
  const auto points = surface([](double, double) { return 5.0; });
  std::size_t read = 0;
  const std::size_t cells = cloud_of(points).cells().size();
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
