#include "core/trajectory/alignment/alignment.hpp"

#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "core/trajectory/alignment/plan.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

using Curve = VerticalIntersection::Curve;

/// A track along x from station 0 to 1000.
Alignment straight_track() { return {.plan = AlignmentPlan({{1000, 0, 0, {0, 0}, {1000, 0}}}, 0)}; }

}  // namespace

TEST_CASE("curves of a profile join both slopes") {
  const auto around = [](const VerticalIntersection& middle, double first, double last,
                         double end) {
    return AlignmentProfile(
        {{.station = 0, .height = first}, middle, {.station = end, .height = last}});
  };
  // An unsymmetric parabola has its own length on either side; e = l1 l2 (g2 - g1) / 2 (l1 + l2).
  const AlignmentProfile skew =
      around({.station = 100, .height = -2, .curve = Curve::kParabola, .before = 40, .after = 25},
             0, 1, 200);
  const double e = 40.0 * 25 * 0.05 / (2 * 65);
  // Heights and slopes by the equation of the circle, in 25 digits (mpmath).
  const auto circle = [&](double sign) {
    return around({.station = 300, .height = 3 * sign, .curve = Curve::kCircle, .radius = 5000}, 0,
                  -5 * sign, 700);
  };
  struct Row {
    const AlignmentProfile& profile;
    double station, height, slope;
  };
  const AlignmentProfile crest = circle(1);
  for (const Row& row :
       {Row{skew, 0, 0, -0.02}, Row{skew, 60, -1.2, -0.02},
        Row{skew, 80, -1.6 + e / 4, -0.02 + e / 40}, Row{skew, 100, -2 + e, -0.02 + e / 20},
        Row{skew, 112.5, -2 + 0.03 * 12.5 + e / 4, 0.03 - e / 25}, Row{skew, 125, -1.25, 0.03},
        Row{skew, 200, 1, 0.03}, Row{crest, 225, 2.25, 0.01},
        Row{crest, 250, 2.4375214796057522295745, 0.005000687393391333639932113},
        Row{crest, 290, 2.4775468145992125740054, -0.002999388622873865395819985},
        Row{crest, 300, 2.4375527234354622381833, -0.004999437608958322470277381},
        Row{crest, 333.25, 2.1607561295727822694357, -0.01165016566803550217280979},
        Row{crest, 375, 1.5, -0.02}}) {
    CAPTURE(row.station, row.height);
    const auto found = row.profile.at(row.station);
    check_near(found.value, row.height, 1e-12);
    check_near(found.slope, row.slope, 1e-14);
    // A sag is the crest turned over.
    if (&row.profile != &crest) continue;
    check_near(circle(-1).at(row.station).value, -found.value, 1e-14);
    check_near(circle(-1).at(row.station).slope, -found.slope, 1e-15);
  }
  CHECK(skew.overlap_before(1) == Approx(-60));
  CHECK(skew.overlap_before(2) == Approx(-75));
  check_near(crest.overlap_before(1), -225.005624156431592650834, 1e-11);
  check_near(crest.overlap_before(2), 374.9831303419166687659908 - 700, 1e-11);
}

TEST_CASE("where curves overlap by rounding the later one counts") {
  const AlignmentProfile profile(
      {{.station = 0, .height = 0},
       {.station = 100, .height = 1, .curve = Curve::kParabola, .before = 50, .after = 50 + 1e-9},
       {.station = 200, .height = 0, .curve = Curve::kParabola, .before = 50, .after = 50},
       {.station = 300, .height = 0}});
  CHECK(profile.overlap_before(2) == Approx(1e-9).epsilon(1e-3));
  check_near(profile.at(150).value, 0.5, 1e-10);
  check_near(profile.at(150).slope, -0.01, 1e-10);
  // A station on a border, here between two slopes without a curve, belongs to the later one.
  const AlignmentProfile bare(
      {{.station = 0, .height = 0}, {.station = 10, .height = 1}, {.station = 20, .height = 1}});
  check_equal(bare.at(10).slope, 0);
  check_equal(bare.at(10).value, 1);
}

TEST_CASE("cant changes evenly between its stations and is kept beyond them") {
  const AlignmentCant cant({{100, 0}, {150, 0.1}, {250, 0.1}, {300, -0.05}});
  check_equal(cant.at(0).value, 0);
  CHECK(cant.at(125).value == Approx(0.05));
  CHECK(cant.at(125).slope == Approx(0.002));
  check_equal(cant.at(150).slope, 0);
  CHECK(cant.at(275).value == Approx(0.025));
  check_equal(cant.at(300).value, -0.05);
  check_equal(cant.at(400).value, -0.05);
  check_equal(cant.at(400).slope, 0);
}

TEST_CASE("ramps of cant join their ends, and their slopes are the derivatives of their heights") {
  for (const CantRamp ramp :
       {CantRamp::kLinear, CantRamp::kBloss, CantRamp::kSinusoid, CantRamp::kCosine}) {
    const AlignmentCant cant({{100, 0.05, ramp}, {150, -0.1}});
    INFO(static_cast<int>(ramp));
    check_equal(cant.at(100).value, 0.05);
    CHECK(cant.at(125).value == Approx(-0.025));
    CHECK(cant.at(std::nextafter(150.0, 0.0)).value == Approx(-0.1));
    for (double station = 100.5; station < 150; station += 0.5) {
      const double rise = cant.at(station + 1e-4).value - cant.at(station - 1e-4).value;
      check_near(rise / 2e-4, cant.at(station).slope, 1e-8);
    }
  }
}

TEST_CASE("a ramp of cant tilts the way by the raise of the middle") {
  Alignment track = straight_track();
  track.cant_line = CantLine::kInsideRail;
  track.cant.emplace(std::vector<CantPoint>{{0, 0.1}, {100, -0.1}, {200, -0.1}});
  const auto climb = [&](double s) {
    const Pose pose = track.pose_at(s);
    return pose.rotation[6] / std::hypot(pose.rotation[0], pose.rotation[3]);
  };
  check_near(climb(20), -0.001, 1e-15);
  check_near(climb(80), 0.001, 1e-15);
  check_near(climb(50), 0.001, 1e-15);  // on the border, the later side
  check_equal(climb(150), 0);
  for (const double s : {20.0, 80.0}) {
    const double rise =
        track.pose_at(s + 0.5).translation[2] - track.pose_at(s - 0.5).translation[2];
    CHECK(rise == Approx(climb(s)));
  }
}

// The plan of an alignment.
namespace {

using Place = std::complex<double>;

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
      CHECK(std::abs(std::remainder(found.heading - direction - place.angle,
                                    2 * std::numbers::pi)) < 1e-10);
    }
  }
}

}  // namespace

TEST_CASE("a clothoid has the places that Fresnel integrals give") {
  check_known(kEntering, 60, 0, 1.0 / 80);
  check_known(kBetween, 70, -1.0 / 200, -1.0 / 60);
}

TEST_CASE("an arc has the places of its circle, also beyond a half circle") {
  const double radius = 25, turn = 1.75 * std::numbers::pi;
  for (const double sense : {1.0, -1.0}) {
    const auto on_circle = [&](double angle) {
      return radius * Place(std::sin(angle), sense * (1 - std::cos(angle)));
    };
    const AlignmentPlan plan(
        {{radius * turn, sense / radius, sense / radius, 0.0, on_circle(turn)}}, 0);
    for (const double angle : {0.0, 0.1, 1.0, 3.0, 5.0, turn}) {
      const PlanPlace found = plan.at(radius * angle);
      CHECK(std::abs(found.at - on_circle(angle)) < 1e-12);
      CHECK(std::abs(std::remainder(found.heading - sense * angle, 2 * std::numbers::pi)) < 1e-13);
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
  CHECK(plan.at(10).heading == Approx(std::numbers::pi / 2));
  check_equal(plan.at(10 - 1e-9).heading, 0);
  CHECK(plan.kink_after(0) == Approx(std::numbers::pi / 2));
  check_equal(plan.station_of(1), 10);
}

TEST_CASE("a kink is counted across the half turn") {
  const auto ahead = [](double angle) { return std::polar(10.0, angle); };
  const Place middle = ahead(std::numbers::pi - 0.1);
  const AlignmentPlan plan(
      {{10, 0, 0, 0.0, middle}, {10, 0, 0, middle, middle + ahead(std::numbers::pi + 0.2)}}, 0);
  CHECK(plan.kink_after(0) == Approx(0.3));
}
