#include "clearway/alignment.hpp"

#include <cmath>
#include <map>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "clearway/error.hpp"
#include "clearway/file_unit.hpp"
#include "support/catch.hpp"
#include "support/land_xml.hpp"
#include "support/made_path.hpp"
#include "support/text_rows.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

MadePath made_of_land(const LandFile& file, const AlignmentOptions& options = {}) {
  const ScratchFolder scratch;
  MadePath made;
  made.poses =
      read_alignment(scratch.write("a.xml", file.text()), options, &made.remarks, &made.labels);
  return made;
}

/// The pose at one station.
Pose land_pose_at(const LandFile& file, double station, AlignmentOptions options = {}) {
  options.station_from = options.station_to = station;
  return made_of_land(file, options).poses.at(0);
}

template <typename Kind = InputError>
void check_land_refusal(const LandFile& file, const std::string& words,
                        const AlignmentOptions& options = {},
                        const Caller& caller = Caller::current()) {
  check_refused<Kind>([&] { made_of_land(file, options); }, words, caller);
}

const std::string kGauge = R"(gauge="1.435" rotationPoint="center")";
const std::string kLeft = "curvature=\"ccw\"", kRight = "curvature=\"cw\"";

/// Stations of a cant: "station cant more; ...".
std::string cants(const std::string& text) {
  std::istringstream all(text);
  std::string out;
  for (std::string one; std::getline(all, one, ';');) {
    std::istringstream words(one);
    double station = 0, cant = 0;
    std::string more;
    std::getline(words >> station >> cant, more);
    out += cant_station(station, cant, more);
  }
  return out;
}
LandFile with_cant(const std::string& stations, const std::string& attributes = kGauge) {
  return {.more = cant_of(attributes, cants(stations))};
}

/// The sound file with one part of another text. The last parts below are given in brief.
LandFile land_with(const std::string& part, const std::string& text) {
  const std::map<std::string, std::string LandFile::*> parts{
      {"units", &LandFile::units}, {"attributes", &LandFile::attributes},
      {"line", &LandFile::line},   {"curve", &LandFile::curve},
      {"more", &LandFile::more},   {"other", &LandFile::other}};
  LandFile file;
  if (const auto found = parts.find(part); found != parts.end()) {
    file.*found->second = text;
  } else if (part == "profile" || part == "rise" || part == "middle") {
    const std::string first = part == "profile" ? "" : "<PVI>1000 100</PVI>";
    const std::string last = part == "middle" ? "<PVI>1200 100</PVI>" : "";
    file.profile =
        "<Profile><ProfAlign name=\"p\">" + first + text + last + "</ProfAlign></Profile>";
  } else if (part == "spiral") {
    file.curve = "<Spiral length=\"20\" " + text + "><Start>0 100</Start><End>0 120</End></Spiral>";
  } else if (part == "gauge") {
    file = with_cant("1000 50 " + kLeft, text);
  } else if (part == "cant") {
    file = with_cant(text);
  } else {
    REQUIRE(part.empty());
  }
  return file;
}

/// Rows of part, text and words of the refusal.
void check_land_refusals(std::string_view table) {
  for (const auto& row : text_rows(table)) {
    const RowName name(row[2]);
    check_land_refusal(land_with(row[0], row[1]), row[2]);
  }
}

/// Rows of part, text, the codes of messages, and words of them.
void check_land_remarks(std::string_view table, AlignmentOptions options = {}) {
  options.step = 1;
  for (const auto& row : text_rows(table)) {
    const RowName name(row[1]);
    const MadePath made = made_of_land(land_with(row[0], row[1]), options);
    check_equal(made.codes(), row[2]);
    if (!row[3].empty()) check_says(made.text(), row[3]);
  }
}

const std::string kArc = R"(<Start>0 100</Start><Center>50 100</Center><End>50 150</End></Curve>)";
const AlignmentOptions kSwapped{.order = AxisOrder::kEastingNorthing};

}  // namespace

TEST_CASE("a part of an alignment, and one station alone") {
  const MadePath part =
      made_of_land({}, {.station_from = 1020.05, .station_to = 1021, .step = 0.5});
  check_equal(part.labels.station, {1020.05, 1020.55, 1021});
  CHECK(land_pose_at({}, 1021).position() == part.poses.at(2).position());
  // A station that the step reaches but for rounding does not stand twice.
  check_equal(made_of_land({}, {.station_from = 1000, .station_to = 1000.3}).poses.size(), 4);
  // A station just beyond the end counts as the end.
  check_equal(
      made_of_land({}, {.station_from = 1178.5398163, .station_to = 1178.53981733}).poses.size(),
      1);
  const auto misused = [](const AlignmentOptions& options, const std::string& words) {
    check_land_refusal<UsageError>({}, words, options);
  };
  misused({.station_to = 1179},
          "--to 1179 is off the alignment; expected a station from 1000 to 1178.5");
  misused({.station_from = 999}, "--from 999");
  misused({.station_from = 1100, .station_to = 1050}, "--reverse");
  misused({.station_from = NAN}, "finite station");
  misused({.step = 0}, "--step");
  misused({.step = 1e-6}, "at most 10,000,000 ... --step");
  misused({.max_gap = -1}, "--max-gap");
  misused({.rail_distance = 0}, "--rail-distance");
  misused({.height = 0}, "has a profile");
}

TEST_CASE("lengths of every unit become metres") {
  const std::pair<std::string, double> rows[] = {
      {R"(<Imperial linearUnit="USSurveyFoot"/>)", kMetresPerUsSurveyFoot},
      {R"(<Imperial linearUnit="foot"/>)", 0.3048},
      {R"(<Metric linearUnit="millimeter"/>)", 0.001}};
  for (const auto& [unit, metres] : rows) {
    const RowName name(unit);
    const MadePath made = made_of_land({.units = unit}, {.step = 1, .max_gap = 1e-9});
    check_equal(made.codes(), "");
    check_near(made.poses.back().translation[0], 150 * metres, 1e-11);
    check_near(made.labels.station[0], 1000 * metres, 1e-12);
  }
}

TEST_CASE("lengths that the file leaves out follow from its places") {
  const MadePath given = made_of_land({});
  const MadePath found = made_of_land({.line = "<Line><Start>0 0</Start><End>0 100</End></Line>",
                                       .curve = "<Curve rot=\"ccw\">" + kArc});
  check_equal(found.codes(), "");
  REQUIRE(found.poses.size() == given.poses.size());
  check_near(found.poses[1500].position(), given.poses[1500].position(), 1e-9);
}

TEST_CASE("elements without a length are left out") {
  const MadePath without = made_of_land({});
  // The end is not quite the start, which must not become a full circle either.
  for (const auto& row : text_rows(R"(
    Line length="1e-7"                     | <Center>0 0</Center><End>0 100</End>               | Line
    Curve rot="cw" radius="5" length="0"   | <Center>0 0</Center><End>0 100</End>               | Curve
    Line                                   | <Center>50 100</Center><End>0 99.9999999999</End>  | Line
    Curve rot="cw"                         | <Center>50 100</Center><End>0 99.9999999999</End>  | Curve
    Curve rot="ccw" radius="50"            | <Center>50 100</Center><End>0 99.9999999999</End>  | Curve
    Spiral spiType="clothoid"              | <Center>50 100</Center><End>0 99.9999999999</End>  | Spiral
  )")) {
    const RowName name(row[0]);
    const MadePath made = made_of_land({.curve = "<" + row[0] + "><Start>0 100</Start>" + row[1] +
                                                 "</" + row[2] + ">" + LandFile().curve});
    check_equal(made.codes(), "");
    CHECK(made.poses == without.poses);
  }
  check_land_refusal(
      {.line = R"(<Line length="0"><Start>0 100</Start><End>0 100</End></Line>)", .curve = ""},
      "no element with a length");
}

TEST_CASE("elements of a plan that make no sense are refused with their line") {
  check_land_refusals(R"(
    line   | <Line length="100"><Start>0 0</Start><End>0.0021 100</End></Line>     | line 7 ... ends 0.0021 m from where the next ... --max-gap 0.0021
    line   | <Line length="95"><Start>0 0</Start><End>0 95</End></Line>            | ends 5 m from where
    line   | <Line length="100.003"><Start>0 0</Start><End>0 100</End></Line>      | does not fit its ends ... 0.003 m ... --max-gap 0.003
    line   | <Line length="-5"><Start>0 0</Start><End>0 100</End></Line>           | line 7: XML element "Line": has length="-5"; expected 0 or more
    line   | <Line length="100"><Start pntRef="P1"/><End>0 100</End></Line>        | pntRef
    line   | <IrregularLine/> | XML element "IrregularLine" ... expected Line, Curve or Spiral
    line   | <Chain/>         | XML element "Chain" ... expected Line, Curve or Spiral
    line   | <Parabola/>      | XML element "Parabola" ... expected Line, Curve or Spiral
    curve  | <Curve rot="cw" radius="50"><Start>0 100</Start><End>50 150</End></Curve> | neither length nor Center
    curve  | <Curve rot="cw" length="5"><Start>0 100</Start><End>50 150</End></Curve>  | neither radius nor Center
    curve  | <Curve rot="ccw" radius="50.01" length="78.539816339745"><Start>0 100</Start><Center>50 100</Center><End>50 150</End></Curve> | XML element "Curve": does not fit its ends
    curve  | <Curve rot="ccw" radius="50" length="314.159265"><Start>0 100</Start><Center>50 100</Center><End>0 100</End></Curve> | closed curves
    curve  | <Curve rot="ccw" radius="50" length="315"><Start>0 100</Start><Center>50 100</Center><End>0 101</End></Curve>        | 360. ... closed curves
    spiral | rot="cw" radiusStart="INF" radiusEnd="90" spiType="bloss"    | spiType="bloss" ... expected clothoid
    spiral | rot="cw" radiusStart="INF" radiusEnd="90"                    | spiType
    spiral | rot="cw" radiusEnd="90" spiType="clothoid"                   | radiusStart
    spiral | rot="cw" radiusStart="-4" radiusEnd="90" spiType="clothoid"  | radiusStart="-4"
    spiral | radiusStart="0" radiusEnd="90" spiType="clothoid"            | no attribute rot
    spiral | rot="left" radiusStart="0" radiusEnd="90" spiType="clothoid" | rot="left"
  )");
  const auto line = [](const char* text) { return LandFile{.line = text}; };
  const auto gap = line("<Line length=\"100\"><Start>0 0</Start><End>0.0021 100</End></Line>");
  check_equal(made_of_land(gap, {.max_gap = 0.0022}).codes(), "");
  const auto misfit = line("<Line length=\"100.003\"><Start>0 0</Start><End>0 100</End></Line>");
  check_equal(made_of_land(misfit, {.max_gap = 0.004}).codes(), "alignment-length");
  try {  // Nobody can mean so long a hole.
    made_of_land(line(R"(<Line length="95"><Start>0 0</Start><End>0 95</End></Line>)"));
  } catch (const InputError& error) {
    check_lacks(error.what(), "--max-gap");
  }
}

TEST_CASE("swapped coordinates are noticed by the centre, and by the kinks that they make") {
  check_land_refusal({}, "rot=ccw, but its Center lies on the other side ... --order ne", kSwapped);
  // An arc of more than a half circle has its centre on the other side of its chord.
  LandFile wide{.attributes = R"(name="a" staStart="1000")", .line = ""};
  wide.curve =
      R"(<Curve rot="cw" radius="50" length="235.619449"><Start>0 100</Start><Center>-50 100</Center><End>-50 50</End></Curve>)";
  check_equal(made_of_land(wide, {.station_to = 1200}).codes(), "");
  check_land_refusal(wide, "other side", kSwapped);
  // An arc without a length would take the rest of its circle.
  check_land_refusal({.curve = "<Curve rot=\"ccw\">" + kArc}, "turned the other way", kSwapped);
  // Clothoids have no centre, but swapped they leave the line beside them at an angle.
  const std::string begin =
      R"(<Spiral length="60" radiusStart="INF" radiusEnd="80" rot="ccw" spiType="clothoid"><Start>)";
  LandFile northing{.attributes = R"(name="a" staStart="1000" length="160")"}, easting = northing;
  northing.curve = begin + "0 100</Start><End>7.425001432715223 159.16172537187745</End></Spiral>";
  easting.line = R"(<Line length="100"><Start>0 0</Start><End>100 0</End></Line>)";
  easting.curve = begin + "100 0</Start><End>159.16172537187745 7.425001432715223</End></Spiral>";
  check_equal(made_of_land(northing).codes(), "");
  check_land_refusal(northing, "turned the other way ... --order ne", kSwapped);
  check_land_refusal(easting, "--order en");
  check_near(made_of_land(northing).poses.back().position(),
             made_of_land(easting, kSwapped).poses.back().position(), 1e-12);
}

TEST_CASE("what is odd about an alignment causes a warning with numbers") {
  check_land_remarks(R"(
    line       | <Line length="100"><Start>-0.5 0.00125</Start><End>0 100</End></Line> | alignment-kink | 1 place ... 0.2865 degrees at station 1100
    attributes | name="a" staStart="1000" length="178.5415" | alignment-length
    attributes | name="a" staStart="1000" length="178.5405" |
    curve      | <Curve staStart="1100.25" rot="ccw" radius="50" length="78.539816339745"><Start>0 100</Start><Center>50 100</Center><End>50 150</End></Curve> | alignment-stations | 1 element ... by up to 0.25 m at station 1100
    profile    | <PVI>1040.25 1</PVI><PVI>1100 2</PVI> | profile-shorter | begin 40.25 m later and end 78.54 m earlier
    more       | <StaEquation staAhead="5000" staInternal="1050" staBack="1050"/><StaEquation staAhead="9000" staInternal="1100"/> | station-equations | 2 equations ... the internal station 1050 5000
    more       | <Superelevation staStart="1000" staEnd="1100"/> | superelevation
  )");
  check_land_remarks(
      "profile | <PVI>1040.25 1</PVI><PVI>1100 2</PVI> |",
      {.station_from = 1050, .station_to = 1100});  // what lies outside was not asked for
  check_land_remarks("| | note no-cant", {.cant = CantLine::kCenter});
  check_land_remarks("| | note no-cant", {.cant = CantLine::kNone});
  check_land_remarks("| | note no-cant", {.rail_distance = 1.5});
  const std::string utm =
      R"(PROJCS["UTM",GEOGCS["ETRS89",DATUM["European_Terrestrial_Reference_System_1989",SPHEROID["GRS 1980",6378137,298.257222101]],PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433]],PROJECTION["Transverse_Mercator"],PARAMETER["central_meridian",9],UNIT["metre",1],AUTHORITY["EPSG","25832"]])";
  check_land_remarks(R"(
    other | <CoordinateSystem epsgCode="3878"/>                | alignment-crs | EPSG:3878 ... EPSG:25832
    other | <CoordinateSystem horizontalDatum="EPSG:25832"/>   |
    other |                                                    |
  )",
                     {.environment_crs = utm});
  LandFile feet{.units = R"(<Imperial linearUnit="foot"/>)", .curve = ""};
  feet.line = R"(<Line length="100"><Start>0 2000000</Start><End>0 2000100</End></Line>)";
  const MadePath far = made_of_land(feet, {.step = 1});
  check_equal(far.codes(), "alignment-length, alignment-feet");
  check_says(far.remarks[1].text, "international feet ... 1.219 m elsewhere");
}

TEST_CASE("several alignments and profiles are chosen by name") {
  const LandFile file{
      .more =
          R"(</Alignment><Alignment name="second &amp; last" staStart="0" length="10"><CoordGeom>)"
          R"(<Line length="10"><Start>7 0</Start><End>7 10</End></Line></CoordGeom>)"
          R"(<Profile><ProfAlign name="ground"><PVI>0 1</PVI><PVI>10 1</PVI></ProfAlign>)"
          R"(<ProfSurf name="terrain"/></Profile>)"
          R"(<Profile><ProfAlign name="track"><PVI>0 2</PVI><PVI>10 2</PVI></ProfAlign></Profile>)"};
  check_equal(made_of_land(file, {.alignment = "a"}).poses.size(), 1787);
  AlignmentOptions second{.alignment = "second & last", .profile = "track"};
  check_near(made_of_land(file, second).poses[0].position(), {0, 7, 2}, 0);
  second.profile = "terrain";
  check_land_refusal(file, "no profile of the name", second);
  second.profile = "";
  check_land_refusal(file, "has 2 profiles: \"ground\", \"track\" ... --profile", second);
  check_land_refusal(file, "has 2 alignments: \"a\", \"second & last\" ... --alignment");
  check_land_refusal(file, "no alignment of the name \"b\" ... \"a\", \"second & last\"",
                     {.alignment = "b"});
  LandFile same = file, bare{.profile = ""};
  same.attributes = R"(name="second &amp; last" staStart="1000")";
  check_land_refusal(same, "2 alignments of the name", second);
  check_land_refusal(bare, "no profile ... --height");
  check_land_refusal(bare, "no profile of the name \"p\"", {.profile = "p", .height = 0});
  check_equal(made_of_land(bare, {.height = -3.5}).poses[77].translation[2], -3.5);
  // A name is also found where the file is in Latin-1.
  for (const std::string letter : {"\xFC", "\xC3\xBC"}) {
    const LandFile latin{.attributes = "name=\"S" + letter + "d\" staStart=\"1000\"",
                         .more = R"(</Alignment><Alignment name="N" staStart="0">)"};
    check_equal(made_of_land(latin, {.alignment = "S\xC3\xBC"
                                                  "d"})
                    .poses.size(),
                1787);
  }
}

TEST_CASE("poses are made only where the profile reaches") {
  const LandFile file = land_with("profile", "<PVI>1040.25 1</PVI><PVI>1100 2</PVI>");
  const MadePath late = made_of_land(file);
  check_equal(late.labels.station.front(), 1040.25);
  check_equal(late.labels.station.back(), 1100);
  check_equal(late.poses.size(), 599);
  check_land_refusal(file, "from station 1040.25 to 1100 only, where no pose is wanted",
                     {.station_from = 1000, .station_to = 1000});
  check_land_refusals("profile | <PVI>0 1</PVI><PVI>900 2</PVI> | no pose is wanted");
}

TEST_CASE("curves of a profile are read") {
  // From +2 % to -2 %. The crown of a circle lies below the point by R / cos(angle) - R.
  const double circle = 102 - 2000 / std::cos(std::atan(0.02)) + 2000;
  const std::pair<const char*, double> rows[] = {
      {R"(<ParaCurve length="40">1100 102</ParaCurve>)", 101.8},
      {R"(<ParaCurve length="0">1100 102</ParaCurve>)", 102},
      {R"(<UnsymParaCurve lengthIn="20" lengthOut="60">1100 102</UnsymParaCurve>)", 101.7},
      {R"(<CircCurve length="7" radius="2000">1100 102</CircCurve>)", circle},
      {R"(<CircCurve length="7" radius="-2000">1100 102</CircCurve>)", circle}};
  for (const auto& [curve, height] : rows) {
    const RowName name(curve);
    check_near(land_pose_at(land_with("middle", curve), 1100).translation[2], height, 1e-11);
  }
}

TEST_CASE("profiles that make no sense are refused with their line") {
  check_land_refusals(R"(
    profile |                                                         | has 0 points; expected at least two
    rise    |                                                         | has 1 point
    rise    | <PVI>1000 2</PVI>                                       | ascending stations
    rise    | <PVI>1200</PVI>                                         | holds 1 number
    rise    | <PVI>1200 1 2</PVI>                                     | more than 2 numbers
    rise    | <PVI>1200 1,5</PVI>                                     | "1,5" ... decimal points
    middle  | <Bump>1100 2</Bump>                                     | "Bump"
    profile | <ParaCurve length="9">1000 1</ParaCurve><PVI>1200 1</PVI> | end of the profile
    rise    | <CircCurve radius="9">1200 1</CircCurve>                | end of the profile
    middle  | <ParaCurve>1100 2</ParaCurve>                           | no attribute length
    middle  | <ParaCurve length="-1">1100 2</ParaCurve>               | length="-1"
    middle  | <ParaCurve length="210">1100 2</ParaCurve>              | begins 5 m before
    middle  | <CircCurve length="9">1100 2</CircCurve>                | no attribute radius
    middle  | <CircCurve radius="0">1100 2</CircCurve>                | radius 0
    middle  | <UnsymParaCurve lengthIn="5" lengthOut="0">1100 2</UnsymParaCurve> | one side
    middle  | <UnsymParaCurve lengthIn="5">1100 2</UnsymParaCurve>    | lengthOut
  )");
}

TEST_CASE("a PVI and the curve at it are one point, in either order") {
  for (const auto& row : text_rows(R"(
    102      | <ParaCurve length="40">1100 102</ParaCurve>                               |
    102.0005 | <ParaCurve length="40">1100 102</ParaCurve>                               |
    102      | <UnsymParaCurve lengthIn="20" lengthOut="60">1100 102</UnsymParaCurve>    |
    102      | <CircCurve radius="2000">1100 102</CircCurve>                             |
    102.25   | <ParaCurve length="40">1100 102</ParaCurve>                               | 102.25
    102.25   | <ParaCurve length="40">1100 102</ParaCurve>                               | one height
    102      | <ParaCurve length="40">1100 102</ParaCurve><ParaCurve length="40">1100 102</ParaCurve> | ascending stations
    102      | <PVI>1100 102</PVI>                                                       | ascending stations
  )")) {
    const std::string pvi = "<PVI>1100 " + row[0] + "</PVI>";
    for (const std::string& both : {pvi + row[1], row[1] + pvi}) {
      const RowName name(both);
      const LandFile file = land_with("middle", both);
      if (!row[2].empty()) {
        check_land_refusal(file, row[2]);
      } else {
        CHECK(made_of_land(file).poses == made_of_land(land_with("middle", row[1])).poses);
      }
    }
  }
}

namespace {

/// The same cant in millimetres at both ends.
LandFile with_even_cant(const std::string& cant, const std::string& more,
                        const std::string& attributes = kGauge) {
  return with_cant("1000 " + cant + " " + more + "; 1178.6 " + cant + " " + more, attributes);
}

/// How much higher the left rail is, by a pose that climbs by 1 %.
double cant_at(const Pose& pose) { return 1.5 * pose.rotation[7] * std::hypot(1, 0.01); }

}  // namespace

TEST_CASE("a ramp of cant has the form that the station before it names") {
  const auto file_of = [](const std::string& first, const std::string& second) {
    return with_cant("1000 0 " + kRight + first + "; 1100 150 " + kRight + second +
                     "; 1178.6 150 " + kRight);
  };
  const auto type = [](const std::string& name) { return " transitionType=\"" + name + "\""; };
  constexpr double kPi = std::numbers::pi;
  // The share of the change after a fifth of the ramp.
  const std::pair<std::string, double> rows[] = {
      {"", 0.2},
      {type("linear"), 0.2},
      {type("clothoid"), 0.2},
      {type("bloss"), 0.104},
      {type("sinusoid"), 0.2 - std::sin(0.4 * kPi) / (2 * kPi)},
      {type("cosine"), (1 - std::cos(0.2 * kPi)) / 2},
      {type(" sineHalfWave "), (1 - std::cos(0.2 * kPi)) / 2}};
  for (const auto& [name, share] : rows) {
    const RowName row(name);
    const MadePath made =
        made_of_land(file_of(name, name), {.station_from = 1020, .station_to = 1020});
    check_equal(made.codes(), "");
    check_near(cant_at(made.poses.at(0)), 0.15 * share, 1e-12);
  }
  for (const char* name : {"biquadratic", "revBloss", "weinerBogen", "Bloss", ""}) {
    const LandFile file = file_of(type(name), "");
    check_land_refusal(file, type(name).substr(1) + " ... sinusoid ... --cant none");
    made_of_land(file, {.cant = CantLine::kNone});
  }
  // The type at the end of the ramp may be meant for this ramp. Its curves turn the other way, too.
  const MadePath doubtful = made_of_land(file_of("", type("bloss")));
  REQUIRE(doubtful.codes() == "cant-transition, cant-side");
  CHECK(doubtful.remarks[0].numbers.at(1).second == Approx(0.01443).epsilon(1e-3));
}

TEST_CASE(
    "cant without a point of rotation turns about the inner rail, or not at all if not asked") {
  const AlignmentOptions at_1050{.station_from = 1050, .station_to = 1050};
  const MadePath inner = made_of_land(with_even_cant("150", kLeft, R"(gauge="1.435")"), at_1050);
  check_equal(inner.codes(), "cant-rotation");
  check_near(inner.poses.at(0).translation[2], 10.575, 1e-12);
  // In a left curve the right rail is high.
  check_near(cant_at(inner.poses[0]), -0.15, 1.5e-3);
  const Pose level =
      land_pose_at(with_even_cant("150", kLeft, R"(gauge="bad")"), 1050, {.cant = CantLine::kNone});
  check_near(level.translation[2], 10.5, 1e-12);
  check_equal(level.rotation[7], 0);
}

TEST_CASE("the side and the unit of cant follow the file") {
  const std::string gauge = R"(gauge="1.5" rotationPoint="center")";
  // The slope of 1 % takes part of the cant.
  const auto check = [](const LandFile& file, double cant, double within) {
    check_near(1.5 * land_pose_at(file, 1050, {.rail_distance = 1.5}).rotation[7], cant, within);
  };
  for (const std::string& side :
       {kRight, kLeft + " adverse=\"1\"", kRight + " adverse=\"false\""}) {
    check(with_even_cant("30", side, gauge), 0.03, 1e-5);
  }
  for (const std::string& side : {kLeft, kRight + " adverse=\"true\""}) {
    check(with_even_cant("30", side, gauge), -0.03, 1e-5);
  }
  LandFile feet = with_even_cant("30", kRight, gauge);
  feet.units = R"(<Imperial linearUnit="foot"/>)";
  check(feet, 0.762, 1e-3);
}

TEST_CASE("cant to the wrong side, in another unit or kept beyond its stations is warned of") {
  // The curve of the file turns to the left, so its right rail is the outer one.
  const std::string_view table = R"(
    cant | 1000 100 curvature="ccw"; 1178.6 100 curvature="ccw" |
    cant | 1000 40  curvature="cw";  1178.6 40  curvature="cw"  |
    cant | 1000 100 curvature="cw";  1178.6 100 curvature="cw"  | cant-side | on 100 % of the length ... 100 mm
    cant | 1000 0.1 curvature="ccw"; 1178.6 0.1 curvature="ccw" | cant-unit
    cant | 1000 2   curvature="ccw"; 1178.6 2   curvature="ccw" |
    cant | 1000 310 curvature="ccw"; 1178.6 310 curvature="ccw" | cant-unit
    cant | 1000 180 curvature="ccw"; 1178.6 180 curvature="ccw" |
    cant | 1000 0; 1150 50 curvature="ccw"                      | cant-ends
    cant | 1020 50 curvature="ccw"; 1190 0                      | cant-ends
    cant | 1020 0; 1050 50 curvature="ccw"; 1150 0              |
    cant | 1000 50 curvature="ccw"; 1190 50 curvature="ccw"     |
    cant | 1050 0                                               |
  )";
  check_land_remarks(table);
  check_land_remarks(table, {.reverse = true});
}

TEST_CASE("cants that make no sense are refused with their line") {
  check_land_refusals(R"(
    gauge | gauge="1435" rotationPoint="center"   | gauge="1435" ... up to 10
    gauge | gauge="0" rotationPoint="center"      | gauge="0"
    gauge | gauge="1.0" rotationPoint="center"    | a gauge of 1 m ... --rail-distance
    gauge | rotationPoint="center"                | no attribute gauge ... --rail-distance
    gauge | gauge="1.435" rotationPoint="axle"    | "axle" ... insideRail
    cant  |                                       | no CantStation ... --cant none
    cant  | 1000 1600 curvature="ccw"             | raises a rail by up to 1.6 m ... millimetres
    cant  | 1000 50                               | no attribute curvature
    cant  | 1000 50 curvature="up"                | curvature="up"
    cant  | 1000 50 curvature="ccw" adverse="yes" | adverse="yes"
    cant  | 1000 50 curvature="ccw"; 1000 50 curvature="ccw" | ascending stations
    more  | <Cant name="c" gauge="1.435"><CantStation station="1"/></Cant>     | no attribute appliedCant
    more  | <Cant name="c" gauge="1.435"><CantStation appliedCant="1"/></Cant> | no attribute station
  )");
  check_land_refusal(with_cant("1000 0", R"(gauge="1435")"), "up to 10");
  const std::string cant = with_cant("1000 50 " + kLeft).more;
  check_land_refusal({.more = cant + cant}, "stands twice");
  made_of_land(land_with("gauge", R"(gauge="1.0" rotationPoint="center")"),
               {.rail_distance = 1.07});
}
