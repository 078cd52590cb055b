#include "core/trajectory/alignment/plan.hpp"

#include <cmath>
#include <complex>
#include <numbers>

#include "support/catch.hpp"
#include "support/compare.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

using Place = std::complex<double>;
constexpr double kPi = std::numbers::pi;

/// A place along an element that begins at 0 along x, and the angle there, in 25 digits by Fresnel
/// integrals and by quadrature (mpmath).
struct Known {
  double u;
  Place at;
  double angle;
};

/// From a straight line to a left curve of 80 m over 60 m.
constexpr Known kEntering[] = {
    {0.25, {0.2499999999989403618706618, 0.0000005425347222205796779989167}, 0.25 * 0.25 / 9600},
    {15, {14.99917604634511729717191, 0.1171829020077685295894169}, 0.0234375},
    {37.5, {37.41961362604009048433415, 1.828250162069182377266995}, 0.146484375},
    {60, {59.16172537187745313035447, 7.425001432715223465747093}, 0.375}};

/// From a right curve of 200 m to one of 60 m over 70 m.
constexpr Known kBetween[] = {
    {10.5, {10.49382292837686256881844, -0.3076872934510022524083268}, -0.0616875},
    {35, {34.62992084212285501341708, -4.228570671938813254491547}, -0.2770833333333333333333333},
    {70, {65.03843825359174596986232, -20.86563797700566065306139}, -0.7583333333333333333333333}};

/// Checks the places of an element that begins somewhere in some direction.
template <std::size_t count>
void check_known(const Known (&known)[count], double length, double first, double last) {
  const Place start(385012.5, -5812034.25);
  for (const double direction : {0.0, 2.5, -1.0}) {
    const Place end = start + std::polar(1.0, direction) * known[count - 1].at;
    const AlignmentPlan plan({{length, first, last, start, end}}, 1000);
    CHECK(plan.last_station() == 1000 + length);
    CHECK(std::abs(plan.misfit_of(0)) < 2e-9);
    for (const Known& place : known) {
      const PlanPlace found = plan.at(1000 + place.u);
      CHECK(std::abs(found.at - (start + std::polar(1.0, direction) * place.at)) < 2e-9);
      CHECK(std::abs(std::remainder(found.heading - direction - place.angle, 2 * kPi)) < 1e-10);
    }
  }
}

}  // namespace

TEST_CASE("a clothoid has the places that Fresnel integrals give") {
  check_known(kEntering, 60, 0, 1.0 / 80);
  check_known(kBetween, 70, -1.0 / 200, -1.0 / 60);
}

TEST_CASE("an arc has the places of its circle, also beyond a half circle") {
  const double radius = 25, turn = 1.75 * kPi;
  for (const double sense : {1.0, -1.0}) {
    const auto on_circle = [&](double angle) {
      return radius * Place(std::sin(angle), sense * (1 - std::cos(angle)));
    };
    const AlignmentPlan plan(
        {{radius * turn, sense / radius, sense / radius, 0.0, on_circle(turn)}}, 0);
    for (const double angle : {0.0, 0.1, 1.0, 3.0, 5.0, turn}) {
      const PlanPlace found = plan.at(radius * angle);
      CHECK(std::abs(found.at - on_circle(angle)) < 1e-12);
      CHECK(std::abs(std::remainder(found.heading - sense * angle, 2 * kPi)) < 1e-13);
    }
  }
}

TEST_CASE("elements meet the places of the file though lengths and gaps do not quite fit") {
  // The first line is 0.9 mm too short for its nodes, the second starts 0.5 mm aside.
  const AlignmentPlan plan(
      {{100, 0, 0, {0, 0}, {100.0009, 0}}, {50, 0, 0, {100.0009, 0.0005}, {150, 0}}}, 10);
  CHECK(std::abs(plan.at(10).at - Place(0, 0)) < 1e-15);
  CHECK(std::abs(plan.at(110).at - Place(100.0009, 0.0005)) < 1e-12);
  CHECK(std::abs(plan.at(109.9999999999).at - Place(100.0009, 0.0005)) < 1e-9);
  CHECK(std::abs(plan.at(160).at - Place(150, 0)) < 1e-12);
  CHECK(plan.misfit_of(0) == Approx(0.0009).epsilon(1e-3));
  CHECK(plan.gap_after(0) == Approx(0.0005));
  check_equal(plan.gap_after(1), 0);
  // Stations beyond the ends are those of the ends.
  CHECK(plan.at(9).at == plan.at(10).at);
  CHECK(std::abs(plan.at(161).at - Place(150, 0)) < 1e-12);
}

TEST_CASE("a station on a border belongs to the later element") {
  const AlignmentPlan plan({{10, 0, 0, {0, 0}, {10, 0}}, {10, 0, 0, {10, 0}, {10, 10}}}, 0);
  CHECK(plan.at(10).heading == Approx(kPi / 2));
  check_equal(plan.at(10 - 1e-9).heading, 0);
  CHECK(plan.kink_after(0) == Approx(kPi / 2));
  check_equal(plan.station_of(1), 10);
}

TEST_CASE("a kink is counted across the half turn") {
  const auto ahead = [](double angle) { return std::polar(10.0, angle); };
  const Place middle = ahead(kPi - 0.1);
  const AlignmentPlan plan({{10, 0, 0, 0.0, middle}, {10, 0, 0, middle, middle + ahead(kPi + 0.2)}},
                           0);
  CHECK(plan.kink_after(0) == Approx(0.3));
}
