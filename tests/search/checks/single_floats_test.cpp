// Which coordinates went through single precision.
#include "search/checks/single_floats.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <vector>

using namespace clearway;

TEST_CASE("numbers of single precision are told from others at coordinates of a map") {
  const auto single = [](double v) { return static_cast<double>(static_cast<float>(v)); };
  const auto rounded = [](double v, double step) { return std::round(v / step) * step; };
  struct Row {
    const char* what;
    std::function<double(double)> change;
    double expected;  ///< the largest step; 0: none is found
  };
  // Eastings near 448 km, where steps are 1/32 m, and northings near 5,412 km, where they are 0.5
  // m.
  for (const Row& row :
       {Row{"double", [](double v) { return v; }, 0}, Row{"single", single, 0.5},
        Row{"single, as text with millimetres", [&](double v) { return rounded(single(v), 1e-3); },
            0.5},
        Row{"centimetres", [&](double v) { return rounded(v, 0.01); }, 0},
        Row{"millimetres", [&](double v) { return rounded(v, 0.001); }, 0},
        Row{"half metres, which are exact", [&](double v) { return rounded(v, 0.5); }, 0},
        Row{"near the origin",
            [&](double v) { return single(v - (v > 1e6 ? 5'412'000 : 448'000)); }, 0}}) {
    CAPTURE(row.what);
    std::vector<Vec3> places;
    for (int i = 0; i < 300; ++i) {
      const double x = 448'123.4567 + 0.3331 * i, y = 5'412'345.678 + 0.4117 * i;
      places.push_back({row.change(x), row.change(y), 512.3});
    }
    CHECK(single_precision_step(places, 0.005, 1).value_or(0) == row.expected);
    CHECK(!single_precision_step(places, 1, 1));
  }
  // Text in feet with two decimals holds quarter feet, which single precision has, but no whole
  // centimetres.
  std::vector<Vec3> feet;
  for (int i = 0; i < 300; ++i) feet.push_back({1'471'500 + 0.25 * i, 17'756'000 + 2.0 * i, 1});
  CHECK(!single_precision_step(feet, 0.015, 1 / 0.3048));
  CHECK(!single_precision_step({}, 0.005, 1));
  // A single place may be such a number by chance.
  CHECK(!single_precision_step(std::vector<Vec3>{{448'123.03125, 5'412'345.5, 1}}, 0.005, 1));
}
