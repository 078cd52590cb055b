#include "clearway/alignment.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "clearway/error.hpp"
#include "clearway/file_unit.hpp"
#include "support/catch.hpp"
#include "support/land_xml.hpp"
#include "support/made_path.hpp"
#include "support/reader_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

MadePath made_of(const LandFile& file, const AlignmentOptions& options = {}) {
  const ScratchFolder scratch;
  MadePath made;
  made.poses =
      read_alignment(scratch.write("a.xml", file.text()), options, &made.remarks, &made.labels);
  return made;
}

/// The message with which the file is refused.
std::string refusal_of(const LandFile& file, const AlignmentOptions& options = {}) {
  try {
    made_of(file, options);
  } catch (const InputError& error) {
    return error.what();
  }
  return "read";
}

/// The message with which the options are refused.
std::string misuse_of(const LandFile& file, const AlignmentOptions& options) {
  try {
    made_of(file, options);
  } catch (const UsageError& error) {
    return error.what();
  }
  return "read";
}

LandFile with_line(const std::string& line) {
  LandFile file;
  file.line = line;
  return file;
}
LandFile with_curve(const std::string& curve) {
  LandFile file;
  file.curve = curve;
  return file;
}
LandFile with_profile(const std::string& elements) {
  LandFile file;
  file.profile = "<Profile><ProfAlign name=\"p\">" + elements + "</ProfAlign></Profile>";
  return file;
}
LandFile with_more(const std::string& more) {
  LandFile file;
  file.more = more;
  return file;
}

const std::string kArc = R"(<Start>0 100</Start><Center>50 100</Center><End>50 150</End></Curve>)";

}  // namespace

TEST_CASE("an alignment becomes poses at even stations and at its end") {
  const MadePath made = made_of({});
  check_equal(made.codes(), "");
  REQUIRE(made.poses.size() == 1787);
  check_equal(made.labels.station[0], 1000);
  check_equal(made.labels.station[1], 1000.1);
  CHECK(made.labels.station.back() == Approx(1178.539816339745).epsilon(1e-15));
  CHECK(made.labels.name.empty());
  // Easting is x, northing is y.
  const Pose& middle = made.poses[500];
  check_near(middle.translation[0], 50, 1e-12);
  check_near(middle.translation[1], 0, 1e-12);
  check_near(middle.translation[2], 10.5, 1e-12);
  const Pose& end = made.poses.back();
  check_near(end.translation[0], 150, 1e-11);
  check_near(end.translation[1], 50, 1e-11);
  check_near(end.rotation[3], 1 / std::hypot(1, 0.01), 1e-11);
}

TEST_CASE("a part of an alignment, and one station alone") {
  const MadePath part = made_of({}, {.station_from = 1020.05, .station_to = 1021, .step = 0.5});
  REQUIRE(part.labels.station == std::vector<double>{1020.05, 1020.55, 1021});
  const MadePath one = made_of({}, {.station_from = 1021, .station_to = 1021});
  REQUIRE(one.poses.size() == 1);
  for (int k = 0; k < 3; ++k) {
    CHECK(one.poses[0].translation[k] == part.poses[2].translation[k]);
  }
  // A station that the step reaches but for rounding does not stand twice.
  check_equal(made_of({}, {.station_from = 1000, .station_to = 1000.3}).poses.size(), 4);
  // A station just beyond the end counts as the end.
  check_equal(made_of({}, {.station_from = 1178.5398163, .station_to = 1178.53981733}).poses.size(),
              1);
  check_says(misuse_of({}, {.station_to = 1179}),
             "--to 1179 is off the alignment; expected a station from 1000 to 1178.5");
  check_says(misuse_of({}, {.station_from = 999}), "--from 999");
  check_says(misuse_of({}, {.station_from = 1100, .station_to = 1050}), "--reverse");
  check_says(misuse_of({}, {.station_from = NAN}), "finite station");
  check_says(misuse_of({}, {.step = 0}), "--step");
  check_says(misuse_of({}, {.step = 1e-6}), "at most 10,000,000 ... --step");
  check_says(misuse_of({}, {.max_gap = -1}), "--max-gap");
  check_says(misuse_of({}, {.rail_distance = 0}), "--rail-distance");
}

TEST_CASE("reverse turns x and y round, and the order") {
  const MadePath ahead = made_of({}, {.step = 1}), back = made_of({}, {.step = 1, .reverse = true});
  REQUIRE(ahead.poses.size() == back.poses.size());
  for (std::size_t i = 0; i < ahead.poses.size(); ++i) {
    const Pose &a = ahead.poses[i], &b = back.poses[back.poses.size() - 1 - i];
    CHECK(ahead.labels.station[i] == back.labels.station[back.poses.size() - 1 - i]);
    for (int k = 0; k < 3; ++k) CHECK(a.translation[k] == b.translation[k]);
    for (int k = 0; k < 9; ++k) CHECK(a.rotation[k] == (k % 3 == 2 ? 1 : -1) * b.rotation[k]);
  }
}

TEST_CASE("feet of either kind become metres, and doubtful ones are warned of") {
  LandFile file;
  file.units = R"(<Imperial linearUnit="USSurveyFoot"/>)";
  const MadePath survey = made_of(file, {.step = 1});
  check_equal(survey.codes(), "");
  check_near(survey.poses.back().translation[0], 150 * kMetresPerUsSurveyFoot, 1e-11);
  check_near(survey.labels.station[0], 1000 * kMetresPerUsSurveyFoot, 1e-12);
  file.units = R"(<Imperial linearUnit="foot"/>)";
  check_near(made_of(file, {.step = 1}).poses.back().translation[0], 150 * 0.3048, 1e-11);
  file.line = R"(<Line length="100"><Start>0 2000000</Start><End>0 2000100</End></Line>)";
  file.curve = "";
  const MadePath far = made_of(file, {.step = 1});
  check_equal(far.codes(), "alignment-length, alignment-feet");
  check_says(far.remarks[1].text, "international feet ... 1.219 m elsewhere");
  file = {};
  file.units = R"(<Metric linearUnit="millimeter"/>)";
  check_near(made_of(file, {.max_gap = 1e-9}).poses.back().translation[0], 0.15, 1e-14);
}

TEST_CASE("lengths that the file leaves out follow from its places") {
  const LandFile file = [] {
    LandFile without;
    without.line = R"(<Line><Start>0 0</Start><End>0 100</End></Line>)";
    without.curve = "<Curve rot=\"ccw\">" + kArc;
    return without;
  }();
  const MadePath given = made_of({}), found = made_of(file);
  check_equal(found.codes(), "");
  REQUIRE(found.poses.size() == given.poses.size());
  for (int k = 0; k < 3; ++k) {
    check_near(found.poses[1500].translation[k], given.poses[1500].translation[k], 1e-9);
  }
  check_says(refusal_of(with_curve(
                 R"(<Curve rot="cw" radius="50"><Start>0 100</Start><End>50 150</End></Curve>)")),
             "neither length nor Center");
  check_says(refusal_of(with_curve(
                 R"(<Curve rot="cw" length="5"><Start>0 100</Start><End>50 150</End></Curve>)")),
             "neither radius nor Center");
}

TEST_CASE("elements without a length are left out") {
  LandFile file;
  file.line += R"(<Line length="1e-7"><Start>0 100</Start><End>0 100</End></Line>)"
               R"(<Curve rot="cw" radius="5" length="0"><Start>0 100</Start><Center>0 0</Center>)"
               R"(<End>0 100</End></Curve>)";
  check_equal(made_of(file).poses.size(), 1787);
  check_says(
      refusal_of(with_line(R"(<Line length="-5"><Start>0 0</Start><End>0 100</End></Line>)")),
      "line 7: XML element \"Line\": has the length -5 m");
  file.line = R"(<Line length="0"><Start>0 100</Start><End>0 100</End></Line>)";
  file.curve = "";
  check_says(refusal_of(file), "no element with a length");
}

TEST_CASE("gaps and elements that miss their ends are refused, unless they are allowed") {
  const LandFile gap =
      with_line(R"(<Line length="100"><Start>0 0</Start><End>0.0021 100</End></Line>)");
  check_says(refusal_of(gap), "line 7 ... ends 0.0021 m from where the next ... --max-gap 0.0021");
  check_equal(made_of(gap, {.max_gap = 0.0022}).codes(), "");
  const LandFile hole = with_line(R"(<Line length="95"><Start>0 0</Start><End>0 95</End></Line>)");
  check_says(refusal_of(hole), "ends 5 m from where");
  check_lacks(refusal_of(hole), "--max-gap");
  const LandFile misfit =
      with_line(R"(<Line length="100.003"><Start>0 0</Start><End>0 100</End></Line>)");
  check_says(refusal_of(misfit), "does not fit its ends ... 0.003 m ... --max-gap 0.003");
  check_equal(made_of(misfit, {.max_gap = 0.004}).codes(), "alignment-length");
  const LandFile bent =
      with_curve("<Curve rot=\"ccw\" radius=\"50.01\" length=\"78.539816339745\">" + kArc);
  check_says(refusal_of(bent), "XML element \"Curve\": does not fit its ends");
}

TEST_CASE("what is no line, arc or clothoid is refused by name") {
  for (const char* name : {"IrregularLine", "Chain", "Parabola"}) {
    check_says(refusal_of(with_line("<" + std::string(name) + "/>")),
               std::string("XML element \"") + std::string(name) +
                   "\" ... expected Line, Curve or Spiral");
  }
  const auto spiral = [](const std::string& attributes) {
    return with_curve("<Spiral length=\"20\" " + attributes +
                      "><Start>0 100</Start><End>0 120</End></Spiral>");
  };
  check_says(refusal_of(spiral(R"(rot="cw" radiusStart="INF" radiusEnd="90" spiType="bloss")")),
             "type \"bloss\" ... expected clothoid");
  check_says(refusal_of(spiral(R"(rot="cw" radiusStart="INF" radiusEnd="90")")), "spiType");
  check_says(refusal_of(spiral(R"(rot="cw" radiusEnd="90" spiType="clothoid")")), "radiusStart");
  check_says(refusal_of(spiral(R"(rot="cw" radiusStart="-4" radiusEnd="90" spiType="clothoid")")),
             "radiusStart=\"-4\"");
  check_says(refusal_of(spiral(R"(radiusStart="0" radiusEnd="90" spiType="clothoid")")),
             "no attribute rot");
  check_says(refusal_of(spiral(R"(rot="left" radiusStart="0" radiusEnd="90" spiType="clothoid")")),
             "rot=\"left\"");
  check_says(
      refusal_of(with_line(R"(<Line length="100"><Start pntRef="P1"/><End>0 100</End></Line>)")),
      "pntRef");
  check_says(refusal_of(with_curve(
                 R"(<Curve rot="ccw" radius="50" length="314.159265">)"
                 R"(<Start>0 100</Start><Center>50 100</Center><End>0 100</End></Curve>)")),
             "closed curves");
  check_says(refusal_of(with_curve(
                 R"(<Curve rot="ccw" radius="50" length="315">)"
                 R"(<Start>0 100</Start><Center>50 100</Center><End>0 101</End></Curve>)")),
             "360. ... closed curves");
}

TEST_CASE("an element without a length that ends where it starts is left out") {
  const LandFile file;
  const MadePath without = made_of(file);
  for (const std::string kind : {"Line", "Curve rot=\"cw\"", "Curve rot=\"ccw\" radius=\"50\"",
                                 "Spiral spiType=\"clothoid\""}) {
    LandFile more;
    const std::string name = kind.substr(0, kind.find(' '));
    // The end is not quite the start, which must not become a full circle either.
    more.curve = "<" + kind + "><Start>0 100</Start><Center>50 100</Center><End>0 99.9999999999" +
                 "</End></" + name + ">" + file.curve;
    const MadePath made = made_of(more);
    check_equal(made.codes(), without.codes());
    CHECK(made.poses == without.poses);
  }
}

TEST_CASE("a clothoid between two radii meets its ends") {
  // A right curve of 200 m that becomes one of 60 m over 70 m; the end is known in 25 digits.
  LandFile file;
  file.attributes = R"(name="a" staStart="1000" length="170")";
  file.curve =
      R"(<Spiral length="70" radiusStart="200" radiusEnd="60" rot="cw" spiType="clothoid">)"
      R"(<Start>0 100</Start><PI>0 150</PI><End>-20.86563797700566 165.03843825359175</End></Spiral>)";
  const MadePath made = made_of(file, {.station_from = 1135, .station_to = 1135, .max_gap = 1e-9});
  check_equal(made.codes(), "");
  check_near(made.poses[0].translation[0], 134.62992084212285501, 1e-10);
  check_near(made.poses[0].translation[1], -4.228570671938813254, 1e-10);
}

TEST_CASE("swapped coordinates are noticed by the centre, and by the kinks that they make") {
  check_says(refusal_of({}, {.order = AxisOrder::kEastingNorthing}),
             "rot=ccw, but its Center lies on the other side ... --order ne");
  // An arc of more than a half circle has its centre on the other side of its chord.
  LandFile wide;
  wide.line = "";
  wide.attributes = R"(name="a" staStart="1000")";
  wide.curve = R"(<Curve rot="cw" radius="50" length="235.619449">)"
               R"(<Start>0 100</Start><Center>-50 100</Center><End>-50 50</End></Curve>)";
  check_equal(made_of(wide, {.station_to = 1200}).codes(), "");
  check_says(refusal_of(wide, {.order = AxisOrder::kEastingNorthing}), "other side");
  // An arc without a length would take the rest of its circle.
  LandFile bare;
  bare.curve = "<Curve rot=\"ccw\">" + kArc;
  check_says(refusal_of(bare, {.order = AxisOrder::kEastingNorthing}), "turned the other way");
  // Clothoids have no centre, but swapped they leave the line beside them at an angle.
  LandFile spiral;
  spiral.attributes = R"(name="a" staStart="1000" length="160")";
  spiral.curve =
      R"(<Spiral length="60" radiusStart="INF" radiusEnd="80" rot="ccw" spiType="clothoid">)"
      R"(<Start>0 100</Start><End>7.425001432715223 159.16172537187745</End></Spiral>)";
  check_equal(made_of(spiral).codes(), "");
  check_says(refusal_of(spiral, {.order = AxisOrder::kEastingNorthing}),
             "turned the other way ... --order ne");
  LandFile easting = spiral;
  easting.line = R"(<Line length="100"><Start>0 0</Start><End>100 0</End></Line>)";
  easting.curve =
      R"(<Spiral length="60" radiusStart="INF" radiusEnd="80" rot="ccw" spiType="clothoid">)"
      R"(<Start>100 0</Start><End>159.16172537187745 7.425001432715223</End></Spiral>)";
  const MadePath a = made_of(spiral), b = made_of(easting, {.order = AxisOrder::kEastingNorthing});
  check_near(a.poses.back().translation[0], b.poses.back().translation[0], 1e-12);
  check_says(refusal_of(easting), "--order en");
}

TEST_CASE("kinks, other lengths and other stations are warned of with numbers") {
  LandFile kink;
  kink.line = R"(<Line length="100"><Start>-0.5 0.00125</Start><End>0 100</End></Line>)";
  const MadePath bent = made_of(kink, {.step = 1});
  check_equal(bent.codes(), "alignment-kink");
  check_says(bent.remarks[0].text, "1 place ... 0.2865 degrees at station 1100");
  CHECK(bent.remarks[0].numbers[2].second == Approx(1100));

  LandFile longer;
  longer.attributes = R"(name="a" staStart="1000" length="178.5415")";
  check_equal(made_of(longer, {.step = 1}).codes(), "alignment-length");
  longer.attributes = R"(name="a" staStart="1000" length="178.5405")";
  check_equal(made_of(longer, {.step = 1}).codes(), "");

  LandFile off;
  off.curve = R"(<Curve staStart="1100.25" rot="ccw" radius="50" length="78.539816339745">)" + kArc;
  const MadePath moved = made_of(off, {.step = 1});
  check_equal(moved.codes(), "alignment-stations");
  check_says(moved.remarks[0].text, "1 element ... by up to 0.25 m at station 1100");
}

TEST_CASE("several alignments and profiles are chosen by name") {
  LandFile file;
  const std::string second =
      R"(</Alignment><Alignment name="second &amp; last" staStart="0" length="10"><CoordGeom>)"
      R"(<Line length="10"><Start>7 0</Start><End>7 10</End></Line></CoordGeom>)"
      R"(<Profile><ProfAlign name="ground"><PVI>0 1</PVI><PVI>10 1</PVI></ProfAlign>)"
      R"(<ProfSurf name="terrain"/></Profile>)"
      R"(<Profile><ProfAlign name="track"><PVI>0 2</PVI><PVI>10 2</PVI></ProfAlign></Profile>)";
  file.more = second;
  check_says(refusal_of(file), "has 2 alignments: \"a\", \"second & last\" ... --alignment");
  check_says(refusal_of(file, {.alignment = "b"}),
             "no alignment of the name \"b\" ... \"a\", \"second & last\"");
  check_equal(made_of(file, {.alignment = "a"}).poses.size(), 1787);
  check_says(refusal_of(file, {.alignment = "second & last"}),
             "has 2 profiles: \"ground\", \"track\" ... --profile");
  const MadePath made = made_of(file, {.alignment = "second & last", .profile = "track"});
  check_equal(made.poses[0].translation[1], 7);
  check_equal(made.poses[0].translation[2], 2);
  check_says(refusal_of(file, {.alignment = "second & last", .profile = "terrain"}),
             "no profile of the name");
  file.attributes = R"(name="second &amp; last" staStart="1000")";
  check_says(refusal_of(file, {.alignment = "second & last"}), "2 alignments of the name");
}

TEST_CASE("a name in another encoding is found") {
  LandFile file;
  file.attributes =
      "name=\"S\xFC"
      "d\" staStart=\"1000\"";
  file.more = R"(</Alignment><Alignment name="N" staStart="0">)";
  check_equal(made_of(file, {.alignment = "S\xC3\xBC"
                                          "d"})
                  .poses.size(),
              1787);
  file.attributes =
      "name=\"S\xC3\xBC"
      "d\" staStart=\"1000\"";
  check_equal(made_of(file, {.alignment = "S\xC3\xBC"
                                          "d"})
                  .poses.size(),
              1787);
}

TEST_CASE("without a profile a height is needed, and with one it is refused") {
  LandFile file;
  file.profile = "";
  check_says(refusal_of(file), "no profile ... --height");
  check_equal(made_of(file, {.height = -3.5}).poses[77].translation[2], -3.5);
  check_says(misuse_of({}, {.height = 0}), "has a profile");
  check_says(refusal_of(file, {.profile = "p", .height = 0}), "no profile of the name \"p\"");
}

TEST_CASE("poses are made only where the profile reaches") {
  const MadePath late = made_of(with_profile("<PVI>1040.25 1</PVI><PVI>1100 2</PVI>"));
  check_equal(late.codes(), "profile-shorter");
  check_says(late.remarks[0].text, "begin 40.25 m later and end 78.54 m earlier");
  check_equal(late.labels.station.front(), 1040.25);
  check_equal(late.labels.station.back(), 1100);
  check_equal(late.poses.size(), 599);
  // What lies outside was not asked for.
  check_equal(made_of(with_profile("<PVI>1040.25 1</PVI><PVI>1100 2</PVI>"),
                      {.station_from = 1050, .station_to = 1100})
                  .codes(),
              "");
  check_says(refusal_of(with_profile("<PVI>1040.25 1</PVI><PVI>1100 2</PVI>"),
                        {.station_from = 1000, .station_to = 1000}),
             "from station 1040.25 to 1100 only, where no pose is wanted");
  check_says(refusal_of(with_profile("<PVI>0 1</PVI><PVI>900 2</PVI>")), "no pose is wanted");
}

TEST_CASE("curves of a profile are read") {
  const auto height = [](const std::string& curve, double station) {
    const MadePath made =
        made_of(with_profile("<PVI>1000 100</PVI>" + curve + "<PVI>1200 100</PVI>"),
                {.station_from = station, .station_to = station});
    return made.poses.at(0).translation[2];
  };
  // From +2 % to -2 %.
  check_near(height(R"(<ParaCurve length="40">1100 102</ParaCurve>)", 1100), 101.8, 1e-12);
  check_near(height(R"(<ParaCurve length="0">1100 102</ParaCurve>)", 1100), 102, 1e-12);
  check_near(
      height(R"(<UnsymParaCurve lengthIn="20" lengthOut="60">1100 102</UnsymParaCurve>)", 1100) -
          (102 - 20 * 60 * 0.04 / 160),
      0, 1e-12);
  const double radius = 2000, angle = std::atan(0.02);
  for (const char* sign : {"", "-"}) {
    const std::string curve =
        "<CircCurve length=\"7\" radius=\"" + std::string(sign) + "2000\">1100 102</CircCurve>";
    // The crown of the circle lies below the point by R / cos(angle) - R.
    check_near(height(curve, 1100), 102 - radius / std::cos(angle) + radius, 1e-11);
  }
}

TEST_CASE("profiles that make no sense are refused with their line") {
  const auto refused = [](const std::string& elements) {
    return refusal_of(with_profile(elements));
  };
  check_says(refused(""), "has 0 points; expected at least two");
  check_says(refused("<PVI>1000 1</PVI>"), "has 1 point");
  check_says(refused("<PVI>1000 1</PVI><PVI>1000 2</PVI>"), "ascending stations");
  check_says(refused("<PVI>1000 1</PVI><PVI>1200</PVI>"), "holds 1 number");
  check_says(refused("<PVI>1000 1</PVI><PVI>1200 1 2</PVI>"), "more than 2 numbers");
  check_says(refused("<PVI>1000 1</PVI><PVI>1200 1,5</PVI>"), "\"1,5\" ... decimal points");
  check_says(refused("<PVI>1000 1</PVI><PVI>1200 nan</PVI>"), "finite numbers");
  check_says(refused("<PVI>1000 1</PVI><PVI>1200 1e999</PVI>"), "\"1e999\"");
  check_says(refused("<PVI>1000 1</PVI><Bump>1100 2</Bump><PVI>1200 1</PVI>"), "\"Bump\"");
  check_says(refused("<ParaCurve length=\"9\">1000 1</ParaCurve><PVI>1200 1</PVI>"),
             "end of the profile");
  check_says(refused("<PVI>1000 1</PVI><CircCurve radius=\"9\">1200 1</CircCurve>"),
             "end of the profile");
  const auto middle = [&](const std::string& curve) {
    return refused("<PVI>1000 1</PVI>" + curve + "<PVI>1200 1</PVI>");
  };
  check_says(middle("<ParaCurve>1100 2</ParaCurve>"), "no attribute length");
  check_says(middle("<ParaCurve length=\"-1\">1100 2</ParaCurve>"), "length=\"-1\"");
  check_says(middle("<ParaCurve length=\"210\">1100 2</ParaCurve>"), "begins 5 m before");
  check_says(middle("<CircCurve length=\"9\">1100 2</CircCurve>"), "no attribute radius");
  check_says(middle("<CircCurve radius=\"0\">1100 2</CircCurve>"), "radius 0");
  check_says(middle("<UnsymParaCurve lengthIn=\"5\" lengthOut=\"0\">1100 2</UnsymParaCurve>"),
             "one side");
  check_says(middle("<UnsymParaCurve lengthIn=\"5\">1100 2</UnsymParaCurve>"), "lengthOut");
}

TEST_CASE("a PVI and the curve at it are one point, in either order") {
  struct Row {
    std::string curve;
    std::string height;  ///< of the PVI at station 1100
    std::string answer;  ///< "same" as without the PVI, or a part of the refusal
  };
  const std::string parabola = R"(<ParaCurve length="40">1100 102</ParaCurve>)";
  const Row rows[] = {
      {parabola, "102", "same"},
      {parabola, "102.0005", "same"},
      {R"(<UnsymParaCurve lengthIn="20" lengthOut="60">1100 102</UnsymParaCurve>)", "102", "same"},
      {R"(<CircCurve radius="2000">1100 102</CircCurve>)", "102", "same"},
      {parabola, "102.25", "102.25"},
      {parabola, "102.25", "one height"},
      {parabola + parabola, "102", "ascending stations"},
      {"<PVI>1100 102</PVI>", "102", "ascending stations"}};
  const auto file_of = [](const std::string& middle) {
    return with_profile("<PVI>1000 100</PVI>" + middle + "<PVI>1200 100</PVI>");
  };
  for (const Row& row : rows) {
    const std::string pvi = "<PVI>1100 " + row.height + "</PVI>";
    for (const std::string& both : {pvi + row.curve, row.curve + pvi}) {
      INFO(both);
      if (row.answer != "same") {
        check_says(refusal_of(file_of(both)), row.answer);
        continue;
      }
      CHECK(made_of(file_of(both)).poses == made_of(file_of(row.curve)).poses);
    }
  }
}

TEST_CASE("a ramp of cant has the form that the station before it names") {
  struct Row {
    std::string type;
    double share;  ///< of the change, after a fifth of the ramp
  };
  const Row rows[] = {{"", 0.2},
                      {"linear", 0.2},
                      {"clothoid", 0.2},
                      {"bloss", 0.104},
                      {"sinusoid", 0.2 - std::sin(0.4 * std::numbers::pi) / (2 * std::numbers::pi)},
                      {"cosine", (1 - std::cos(0.2 * std::numbers::pi)) / 2},
                      {" sineHalfWave ", (1 - std::cos(0.2 * std::numbers::pi)) / 2}};
  const auto file_of = [](const std::string& first, const std::string& second) {
    const auto station = [](double at, double cant, const std::string& type) {
      const std::string named = type.empty() ? "" : " transitionType=\"" + type + "\"";
      return cant_station(at, cant, "curvature=\"cw\"" + named);
    };
    return with_more(
        cant_of(R"(gauge="1.435" rotationPoint="center")",
                station(1000, 0, first) + station(1100, 150, second) + station(1178.6, 150, "")));
  };
  for (const Row& row : rows) {
    INFO(row.type);
    const MadePath made =
        made_of(file_of(row.type, row.type), {.station_from = 1020, .station_to = 1020});
    check_equal(made.codes(), "");
    const double cant = made.poses.at(0).rotation[7] * std::hypot(1, 0.01) * 1.5;
    check_near(cant, 0.15 * row.share, 1e-12);
  }
  for (const std::string type : {"biquadratic", "revBloss", "weinerBogen", "Bloss", ""}) {
    INFO(type);
    const std::string named = "transitionType=\"" + type + "\"";
    LandFile file = file_of("", "");
    file.more.insert(file.more.find("curvature"), named + " ");
    check_says(refusal_of(file), std::string(named) + " ... sinusoid ... --cant none");
    check_equal(refusal_of(file, {.cant = CantLine::kNone}), "read");
  }
  // The type at the end of the ramp may be meant for this ramp.
  const MadePath doubtful = made_of(file_of("", "bloss"));
  // Its curves turn the other way, too.
  REQUIRE(doubtful.codes() == "cant-transition, cant-side");
  CHECK(doubtful.remarks[0].numbers.at(1).second == Approx(0.01443).epsilon(1e-3));
}

TEST_CASE("cant turns the track about the line that the file or the caller names") {
  const std::string stations =
      cant_station(1000, 150, "curvature=\"ccw\"") + cant_station(1178.6, 150, "curvature=\"ccw\"");
  const auto made = [&](const std::string& attributes, const AlignmentOptions& options = {}) {
    AlignmentOptions at = options;
    at.station_from = at.station_to = 1050;
    return made_of(with_more(cant_of(attributes, stations)), at);
  };
  const double level = 10.5;
  // In a left curve the right rail is high, so the inner rail is the left one.
  const MadePath file = made(R"(gauge="1.435" rotationPoint="insideRail")");
  check_equal(file.codes(), "");
  check_near(file.poses[0].translation[2], level + 0.075, 1e-12);
  check_near(file.poses[0].rotation[7] * std::hypot(1, 0.01), -0.1, 1e-3);
  const auto raise = [&](CantLine line) {
    return made(R"(gauge="1.5")", {.cant = line}).poses[0].translation[2] - level;
  };
  check_near(raise(CantLine::kCenter), 0, 1e-12);
  check_near(raise(CantLine::kInsideRail), 0.075, 1e-12);
  check_near(raise(CantLine::kOutsideRail), -0.075, 1e-12);
  check_near(raise(CantLine::kLeftRail), 0.075, 1e-12);
  check_near(raise(CantLine::kRightRail), -0.075, 1e-12);
  const MadePath none = made(R"(gauge="bad")", {.cant = CantLine::kNone});
  check_equal(none.poses[0].rotation[7], 0);
  check_equal(none.codes(), "");
  const MadePath unsaid = made(R"(gauge="1.435")");
  check_equal(unsaid.codes(), "cant-rotation");
  CHECK(unsaid.poses[0].translation[2] == file.poses[0].translation[2]);
}

TEST_CASE("the side and the unit of cant follow the file") {
  const auto roll = [](const std::string& more,
                       const std::string& units = R"(<Metric linearUnit="meter"/>)") {
    LandFile file = with_more(cant_of(R"(gauge="1.5" rotationPoint="center")",
                                      cant_station(1000, 30, more) + cant_station(1180, 30, more)));
    file.units = units;
    return made_of(file, {.station_from = 1050, .station_to = 1050, .rail_distance = 1.5})
               .poses.at(0)
               .rotation[7] *
           1.5;
  };
  // The slope of 1 % takes part of the cant, of which 1 mm is left here.
  check_near(roll("curvature=\"cw\""), 0.03, 1e-5);
  check_near(roll("curvature=\"ccw\""), -0.03, 1e-5);
  check_near(roll("curvature=\"cw\" adverse=\"true\""), -0.03, 1e-5);
  check_near(roll("curvature=\"ccw\" adverse=\"1\""), 0.03, 1e-5);
  check_near(roll("curvature=\"cw\" adverse=\"false\""), 0.03, 1e-5);
  CHECK(std::abs(roll("curvature=\"cw\"", R"(<Imperial linearUnit="foot"/>)") - 30 * 0.0254) <
        1e-3);
}

TEST_CASE("cant to the wrong side or in another unit is warned of") {
  struct Row {
    double cant;
    const char* side;
    std::string codes;
  };
  // The curve of the file turns to the left, so its right rail is the outer one.
  for (const Row& row : {Row{100, "ccw", ""}, Row{40, "cw", ""}, Row{100, "cw", "cant-side"},
                         Row{0.1, "ccw", "cant-unit"}, Row{2, "ccw", ""},
                         Row{310, "ccw", "cant-unit"}, Row{180, "ccw", ""}}) {
    CAPTURE(row.cant, row.side);
    const std::string more = "curvature=\"" + std::string(row.side) + "\"";
    const LandFile file = with_more(
        cant_of(R"(gauge="1.435" rotationPoint="center")",
                cant_station(1000, row.cant, more) + cant_station(1178.6, row.cant, more)));
    const MadePath ahead = made_of(file, {.step = 1});
    check_equal(ahead.codes(), row.codes);
    check_equal(made_of(file, {.step = 1, .reverse = true}).codes(), row.codes);
    if (row.codes == "cant-side") {
      check_says(ahead.remarks[0].text, "on 100 % of the length ... 100 mm");
    }
  }
}

TEST_CASE("cant beyond its stations causes a warning where it is kept") {
  const auto codes = [](const std::string& stations) {
    return made_of(with_more(cant_of(R"(gauge="1.435" rotationPoint="center")", stations)),
                   {.step = 1})
        .codes();
  };
  const std::string left = "curvature=\"ccw\"";
  check_equal(codes(cant_station(1000, 0, "") + cant_station(1150, 50, left)), "cant-ends");
  check_equal(codes(cant_station(1020, 50, left) + cant_station(1190, 0, "")), "cant-ends");
  check_equal(
      codes(cant_station(1020, 0, "") + cant_station(1050, 50, left) + cant_station(1150, 0, "")),
      "");
  check_equal(codes(cant_station(1000, 50, left) + cant_station(1190, 50, left)), "");
  check_equal(codes(cant_station(1050, 0, "")), "");  // no cant at all
}

TEST_CASE("cants that make no sense are refused with their line") {
  const std::string left = "curvature=\"ccw\"", good = cant_station(1000, 50, left);
  const auto refused = [&](const std::string& attributes, const std::string& stations,
                           const AlignmentOptions& options = {}) {
    return refusal_of(with_more("\n" + cant_of(attributes, stations)), options);
  };
  const std::string gauge = R"(gauge="1.435" rotationPoint="center")";
  check_says(refused(R"(gauge="1435" rotationPoint="center")", good),
             "gauge=\"1435\" ... up to 10");
  check_says(refused(R"(gauge="1435")", cant_station(1000, 0, "")), "up to 10");
  check_says(refused(R"(gauge="0" rotationPoint="center")", good), "gauge=\"0\"");
  check_says(refused(R"(gauge="1.0" rotationPoint="center")", good),
             "a gauge of 1 m ... --rail-distance");
  check_equal(refused(R"(gauge="1.0" rotationPoint="center")", good, {.rail_distance = 1.07}),
              "read");
  check_says(refused(R"(rotationPoint="center")", good), "no attribute gauge ... --rail-distance");
  check_says(refused(R"(gauge="1.435" rotationPoint="axle")", good), "\"axle\" ... insideRail");
  check_says(refused(gauge, ""), "no CantStation ... --cant none");
  check_says(refused(gauge, cant_station(1000, 1600, left)),
             "raises a rail by up to 1.6 m ... millimetres");
  check_says(refused(gauge, cant_station(1000, 50, "")), "no attribute curvature");
  check_says(refused(gauge, cant_station(1000, 50, "curvature=\"up\"")), "curvature=\"up\"");
  check_says(refused(gauge, cant_station(1000, 50, left + " adverse=\"yes\"")), "adverse=\"yes\"");
  check_says(refused(gauge, good + good), "ascending stations");
  check_says(refused(gauge, "<CantStation station=\"1\"/>"), "no attribute appliedCant");
  check_says(refused(gauge, "<CantStation appliedCant=\"1\"/>"), "no attribute station");
  check_says(refusal_of(with_more(cant_of(gauge, good) + cant_of(gauge, good))), "stands twice");
}

TEST_CASE("options of cant change nothing without cant, which a note says") {
  check_equal(made_of({}, {.step = 1, .cant = CantLine::kCenter}).codes(), "note no-cant");
  check_equal(made_of({}, {.step = 1, .cant = CantLine::kNone}).codes(), "note no-cant");
  check_equal(made_of({}, {.step = 1, .rail_distance = 1.5}).codes(), "note no-cant");
}

TEST_CASE("station equations are warned of") {
  const MadePath made =
      made_of(with_more(R"(<StaEquation staAhead="5000" staInternal="1050" staBack="1050"/>)"
                        R"(<StaEquation staAhead="9000" staInternal="1100"/>)"),
              {.step = 1});
  check_equal(made.codes(), "station-equations");
  check_says(made.remarks[0].text, "2 equations ... the internal station 1050 5000");
  check_equal(made.labels.station[60], 1060);
}

TEST_CASE("the superelevation of a road is warned of, as it is left out") {
  check_equal(made_of(with_more("<Superelevation staStart=\"1000\" staEnd=\"1100\"/>"), {.step = 1})
                  .codes(),
              "superelevation");
}

TEST_CASE("another coordinate system than the environment's is warned of") {
  const std::string utm =
      R"(PROJCS["ETRS89 / UTM zone 32N",GEOGCS["ETRS89",DATUM["European_Terrestrial_Reference_System_1989",)"
      R"(SPHEROID["GRS 1980",6378137,298.257222101]],PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433]],)"
      R"(PROJECTION["Transverse_Mercator"],PARAMETER["latitude_of_origin",0],)"
      R"(PARAMETER["central_meridian",9],PARAMETER["scale_factor",0.9996],)"
      R"(PARAMETER["false_easting",500000],PARAMETER["false_northing",0],UNIT["metre",1],)"
      R"(AUTHORITY["EPSG","25832"]])";
  LandFile file;
  file.other = R"(<CoordinateSystem epsgCode="3878"/>)";
  const MadePath other = made_of(file, {.step = 1, .environment_crs = utm});
  check_equal(other.codes(), "alignment-crs");
  check_says(other.remarks[0].text, "EPSG:3878 ... EPSG:25832");
  file.other = R"(<CoordinateSystem horizontalDatum="EPSG:25832"/>)";
  check_equal(made_of(file, {.step = 1, .environment_crs = utm}).codes(), "");
  check_equal(made_of({}, {.step = 1, .environment_crs = utm}).codes(), "");
}
