#include "clearway/line.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "clearway/error.hpp"
#include "support/catch.hpp"
#include "support/made_path.hpp"
#include "support/reader_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

constexpr double kPi = std::numbers::pi;

MadePath made_of(const std::string& text, const LineOptions& options = {}) {
  const ScratchFolder scratch;
  MadePath made;
  const auto path = scratch.write("a.csv", text);
  made.poses = read_line(path, options, &made.remarks, &made.labels);
  return made;
}

struct Refusal {
  std::string text = "read";
  Remedy remedy = Remedy::kNone;
};

template <typename Kind = InputError>
Refusal refused(const std::string& text, const LineOptions& options = {}) {
  try {
    made_of(text, options);
  } catch (const Kind& error) {
    return {error.what(), error.remedy()};
  }
  return {};
}

template <typename Kind = InputError>
std::string refusal_by(const std::string& text, const LineOptions& options = {}) {
  return refused<Kind>(text, options).text;
}

/// GeoJSON of one geometry.
std::string geometry(const std::string& type, const std::string& coordinates) {
  return R"({"type": ")" + type + R"(", "coordinates": )" + coordinates + "}";
}
std::string feature(const std::string& geometry) {
  return R"({"type": "Feature", "properties": {"name": "a"}, "geometry": )" + geometry + "}";
}
std::string collection(const std::string& features, const std::string& more = "") {
  return R"({"type": "FeatureCollection", )" + more + R"("features": [)" + features + "]}";
}

const std::string kStraight = "x,y,z\n0,0,1\n10,0,2\n20,0,3\n";

bool close(const Pose& pose, double x, double y, double z) {
  return std::hypot(pose.translation[0] - x, pose.translation[1] - y, pose.translation[2] - z) <
         1e-12;
}

}  // namespace

TEST_CASE("a straight line becomes poses at even places and at its end") {
  const MadePath made = made_of("x,y,z\n0,0,1\n10.05,0,2.005\n");
  check_equal(made.codes(), "");
  CHECK(made.labels.station.empty());
  REQUIRE(made.poses.size() == 102);
  CHECK(close(made.poses[0], 0, 0, 1));
  CHECK(close(made.poses[37], 3.7, 0, 1.37));
  CHECK(close(made.poses[101], 10.05, 0, 2.005));
  const double c = 1 / std::hypot(1, 0.1), s = 0.1 * c;
  const double expected[9] = {c, 0, -s, 0, 1, 0, s, 0, c};
  for (int k = 0; k < 9; ++k) check_near(made.poses[50].rotation[k], expected[k], 1e-14);
}

TEST_CASE("a line is driven in either direction, in any step") {
  const MadePath ahead = made_of(kStraight, {.step = 3});
  const MadePath back = made_of(kStraight, {.step = 3, .reverse = true});
  REQUIRE(ahead.poses.size() == 8);
  REQUIRE(back.poses.size() == 8);
  for (std::size_t i = 0; i < 8; ++i) {
    const Pose &a = ahead.poses[i], &b = back.poses[7 - i];
    for (int k = 0; k < 3; ++k) {
      CHECK(a.translation[k] == b.translation[k]);
      CHECK(a.rotation[3 * k] == -b.rotation[3 * k]);
      CHECK(a.rotation[3 * k + 1] == -b.rotation[3 * k + 1]);
      CHECK(a.rotation[3 * k + 2] == b.rotation[3 * k + 2]);
    }
  }
  check_says(refusal_by<UsageError>(kStraight, {.step = 0}), "step: 0");
  check_says(refusal_by<UsageError>(kStraight, {.step = 1e-9}), "at most 10,000,000");
}

TEST_CASE("names of columns decide, not their order or form") {
  const MadePath plain = made_of(kStraight);
  for (const std::string& text :
       {std::string("z;y;x\n1;0;0\n2;0;10\n3;0;20\n"),
        std::string("\xEF\xBB\xBF# a survey\n\n  \"X [m]\" , \"Y [m]\" , Z_m, note\n0,0,1,a\n"
                    "// half\n10,0,2,\"b, c\"\n20,0,3,\r\n"),
        std::string("# x y z\n0 0 1\n10 0 2\n20 0 3"),
        std::string("\"x\",\"y\",\"z\"\r\"0\",\"0\",\"1\"\r\"10\",\" 0 \",\"2\"\r20,0,3\r"),
        std::string("id,Easting,Northing,Elevation\nA1,0,0,1\nA2,10,0,2\nA3,20,0,3\n")}) {
    CAPTURE(text);
    const MadePath made = made_of(text);
    CHECK((made.codes().empty() || made.codes() == "note unread-columns"));
    REQUIRE(made.poses.size() == plain.poses.size());
    bool same = true;
    for (std::size_t i = 0; i < made.poses.size(); ++i) same &= made.poses[i] == plain.poses[i];
    CHECK(same);
  }
  check_says(refusal_by("0,0,1\n1,0,1\n"), "line 1 ... header");
  check_says(refusal_by("a,b\n1,2\n"), "line 1 ... the columns x and y");
  check_says(refusal_by("x,y,x\n1,2,3\n"), "the columns x and y once");
  check_says(refusal_by("x,y,z,z\n1,2,3,4\n"), "the columns x and y once");
  check_says(refusal_by("x,y,station,chainage\n1,2,3,4\n"), "two columns of a station");
  check_says(refusal_by("lon,lat,z\n9,48,1\n"), "angles and no lengths ... transform");
  check_says(refusal_by("<kml>\n</kml>\n"), "is XML");
  check_says(refusal_by(std::string("\0\0\x27\x0A\0\0", 6)), "shapefile ... as CSV or GeoJSON");
  check_says(refusal_by(std::string("SQLite format 3\0", 16)), "GeoPackage ... as CSV or GeoJSON");
}

TEST_CASE("columns of a line that are not read are listed, and doubted by their names") {
  struct Row {
    std::string more;  ///< names of further columns
    std::string codes;
  };
  const Row rows[] = {{"", ""},
                      {",superelevation", "unread-columns"},
                      {",Crossfall_left [mm]", "unread-columns"},
                      {",roll", "unread-columns"},
                      {",track-cant", "unread-columns"},
                      {",\"\xC3\xBC"
                       "berhoehung\"",
                       "unread-columns"},
                      {",id,speed", "note unread-columns"},
                      {",significant,cantilever,embankment,controller", "note unread-columns"},
                      {",height", "note unread-columns"}};
  for (const Row& row : rows) {
    INFO(row.more);
    const auto columns = static_cast<std::size_t>(std::ranges::count(row.more, ','));
    std::string values;
    for (std::size_t i = 0; i < columns; ++i) values += ",0";
    const MadePath made =
        made_of("x,y,z" + row.more + "\n0,0,1" + values + "\n50,0,1" + values + "\n");
    check_equal(made.codes(), row.codes);
  }
  // Without heights of its own, a line may have meant another column.
  check_equal(made_of("x,y,level\n0,0,1\n50,0,1\n", {.height = 1}).codes(), "unread-columns");
  const MadePath many = made_of("x,y,z,a,b,roll\n0,0,1,1,1,1\n50,0,1,1,1,1\n");
  check_says(many.text(),
             "3 columns are not read: \"a\", \"b\", \"roll\" ... By its name, \"roll\"");
}

TEST_CASE("rows that are no vertex are refused with their line") {
  const std::string head = "x,y,z\n0,0,0\n";
  check_says(refusal_by(head + "5,nan,1\n"), "line 3 ... finite number");
  check_says(refusal_by(head + "5,inf,1\n"), "line 3 ... finite number");
  check_says(refusal_by(head + "\n5,,1\n"), "line 4 ... \"\" in column 2");
  check_says(refusal_by(head + "5,x,1\n"), "line 3 ... \"x\" in column 2");
  check_says(refusal_by(head + "5,1\n"), "line 3 ... 2 columns; expected 3");
  check_says(refusal_by(head + "5,1,2,3\n"), "4 columns; expected 3");
  check_says(refusal_by("x;y;z\n0,5;1,5;2,5\n"), "line 2 ... 0.25");
  check_says(refusal_by(head + "5,2e9,1\n"), "within 1e9 m");
  check_says(refusal_by(""), "no vertex");
  check_says(refusal_by("x,y,z\n"), "no vertex");
  check_says(refusal_by(head), "only one place");
  check_says(refusal_by(head + "0,0,0\n"), "only one place");
  check_equal(made_of(head + "9,0,1.").codes(), "cut-text");
}

TEST_CASE("heights come from the line or from an option, and from one of them") {
  const std::string flat = "x,y\n0,0\n10,0\n";
  const Refusal none = refused(flat);
  check_says(none.text, "no heights");
  CHECK(none.remedy == Remedy::kGiveHeight);
  CHECK(close(made_of(flat, {.height = 4.5}).poses[20], 2, 0, 4.5));
  check_says(refusal_by<UsageError>(kStraight, {.height = 4}), "have heights");
  check_says(refusal_by<UsageError>(flat, {.height = NAN}), "height");
}

TEST_CASE("vertices that stand twice in a row are left out, if they agree") {
  const MadePath made = made_of("x,y,z\n0,0,1\n0,0,1\n10,0,2\n20,0,3\n20,0,3\n20,0,3\n");
  check_equal(made.codes(), "");
  CHECK(made.poses == made_of(kStraight).poses);
  check_says(refusal_by("x,y,z\n0,0,1\n10,0,2\n10,0,2.5\n"), "line 4 ... height differs by 0.5 m");
  check_says(refusal_by("x,y,z,station\n0,0,1,0\n10,0,2,10\n10,0,2,90\n"),
             "station differs by 80 m");
}

TEST_CASE("vertices that turn by more than 15 degrees need arcs") {
  const auto bent = [](double degrees) {
    return "x,y\n0,0\n50,0\n" + std::to_string(50 + 50 * std::cos(degrees * kPi / 180)) + "," +
           std::to_string(50 * std::sin(degrees * kPi / 180)) + "\n";
  };
  CHECK(made_of(bent(14.99), {.height = 0}).poses.size() > 1000);
  CHECK(made_of(bent(-14.99), {.height = 0}).poses.size() > 1000);
  const Refusal sharp = refused(bent(15.01), {.height = 0});
  check_says(sharp.text, "line 3: the line turns by 15.01 degrees at vertex 2 at 50 0");
  CHECK(sharp.remedy == Remedy::kRoundCorners);
  check_says(refusal_by("x,y\n0,0\n9,0\n9,9\n0,9\n0,20\n", {.height = 0}),
             "line 3: the line turns by 90 degrees ... 2 other vertices too");
  const MadePath round = made_of(bent(15.01), {.height = 0, .corner_radius = 30});
  check_equal(round.codes(), "note line-rounded");
  check_says(round.text(),
             "1 vertex got an arc of radius 30 m ... vertex 2 at 50 0 0.25 ... to its inside");
}

TEST_CASE("corners become arcs with the exact places and headings") {
  const MadePath made =
      made_of("x,y\n0,0\n10,0\n10,10\n", {.step = 0.5, .height = 3, .corner_radius = 4});
  check_equal(made.codes(), "note line-rounded");
  const double length = 12 + 2 * kPi;
  check_equal(made.poses.size(), static_cast<std::size_t>(length / 0.5) + 2);
  for (std::size_t i = 0; i + 1 < made.poses.size(); ++i) {
    const double s = 0.5 * static_cast<double>(i);
    const double turn = std::clamp((s - 6) / 4, 0.0, kPi / 2);
    const double x = s < 6 ? s : 6 + 4 * std::sin(turn);
    const double y = std::max(s - 6 - 2 * kPi, 0.0) + 4 - 4 * std::cos(turn);
    CHECK(close(made.poses[i], x, y, 3));
    check_near(made.poses[i].rotation[0], std::cos(turn), 1e-14);
    check_near(made.poses[i].rotation[3], std::sin(turn), 1e-14);
  }
  CHECK(close(made.poses.back(), 10, 10, 3));
}

TEST_CASE("arcs that do not fit are refused by their vertex") {
  const std::string text = "x,y\n0,0\n30,0\n30,5\n60,5\n";
  check_says(refusal_by(text, {.height = 0, .corner_radius = 4}),
             "line 4: the leg from vertex 2 to vertex 3 is 5 m long ... vertex 3 at 30 5 ... need "
             "8 m ... A radius of 2.5 m fits everywhere");
  CHECK(made_of(text, {.height = 0, .corner_radius = 2.5}).poses.size() > 100);
  check_says(refusal_by("x,y\n0,0\n30,0\n10,0\n", {.height = 0, .corner_radius = 1}),
             "line 3 ... turns by 180 degrees ... turns back");
  check_says(refusal_by<UsageError>(text, {.height = 0, .corner_radius = 0.0}), "corner radius");
}

TEST_CASE("stations of vertices become those of poses") {
  const MadePath made =
      made_of("x,y,z,station\n0,0,0,1000\n10,0,0,1010\n20,0,0,1020.5\n", {.step = 2.5});
  check_equal(made.codes(), "");
  CHECK(made.labels.station ==
        std::vector<double>{1000, 1002.5, 1005, 1007.5, 1010, 1012.625, 1015.25, 1017.875, 1020.5});
  const MadePath back =
      made_of("x,y,z,station\n0,0,0,20\n10,0,0,10\n20,0,0,0\n", {.step = 5, .reverse = true});
  check_equal(back.codes(), "");
  check_equal(back.labels.station, {0, 5, 10, 15, 20});
  // The station of a vertex that is rounded stands in the middle of its arc.
  const MadePath corner = made_of("x,y,chainage\n0,0,0\n10,0,10\n10,10,20\n",
                                  {.step = 6 + kPi, .height = 0, .corner_radius = 4});
  REQUIRE(corner.labels.station.size() == 3);
  CHECK(corner.labels.station[1] == Approx(10));
  const MadePath odd = made_of("x,y,z,station\n0,0,0,0\n10,0,0,10\n20,0,0,5\n");
  check_equal(odd.codes(), "station-order");
  check_says(odd.text(), "line 4 ... 5 m comes after 10 m");
  const MadePath feet = made_of("x,y,z,station\n0,0,0,0\n100,0,0,328\n");
  check_equal(feet.codes(), "line-stations");
  check_says(feet.text(), "span 328 m ... 100 m long");
  check_equal(made_of("x,y,z,station [ft]\n0,0,0,0\n100,0,0,328\n").codes(), "");
  check_says(refusal_by("x,y,z,station [s]\n0,0,0,0\n100,0,0,328\n"), "the station in");
}

TEST_CASE("cant of a line to the wrong side or in another unit is warned of") {
  struct Row {
    const char *unit, *cant;
    std::string codes;
  };
  for (const Row& row : {Row{" [mm]", "120", ""}, Row{" [m]", "0.12", ""},
                         Row{" [mm]", "-120", "cant-side"}, Row{" [mm]", "-45", ""},
                         Row{" [mm]", "0.12", "cant-unit"}, Row{" [mm]", "400", "cant-unit"}}) {
    CAPTURE(row.unit, row.cant);
    std::string text = "x,y,z,cant" + std::string(row.unit) + "\n";
    for (int i = 0; i <= 240; ++i) {  // an arc of 300 m to the right
      const double angle = i / 240.0;
      text += std::to_string(300 * std::sin(angle)) + "," + std::to_string(300 * std::cos(angle)) +
              ",5," + row.cant + "\n";
    }
    check_equal(made_of(text, {.rail_distance = 1.5}).codes(), row.codes);
  }
}

TEST_CASE("cant turns the path about the line that the option names") {
  const std::string text = "x,y,z,cant [mm]\n0,0,5,0\n100,0,5,150\n";
  const auto at_50 = [&](const LineOptions& options) {
    return made_of(text, options).poses.at(500);
  };
  const double half = 0.0375;  // of the cant of 75 mm
  check_equal(made_of(text).codes(), "note cant-rails");
  check_equal(made_of(text, {.rail_distance = 1.07}).codes(), "");
  CHECK(at_50({}).translation[2] == Approx(5));
  CHECK(at_50({.cant = CantLine::kFile}).translation[2] == Approx(5));
  CHECK(at_50({.cant = CantLine::kInsideRail}).translation[2] == Approx(5 + half));
  CHECK(at_50({.cant = CantLine::kOutsideRail}).translation[2] == Approx(5 - half));
  CHECK(at_50({.cant = CantLine::kLeftRail}).translation[2] == Approx(5 - half));
  CHECK(at_50({.cant = CantLine::kRightRail}).translation[2] == Approx(5 + half));
  // The left side is up.
  CHECK(at_50({}).rotation[7] == Approx(0.075 / 1.5));
  CHECK(at_50({.rail_distance = 1}).rotation[7] == Approx(0.075));
  check_equal(at_50({.cant = CantLine::kNone}).rotation[7], 0);
  check_equal(made_of(kStraight, {.cant = CantLine::kLeftRail}).codes(), "note no-cant");
  // Without a unit of its own it has that of the coordinates.
  CHECK(made_of("x [m],y [m],z [m],cant\n0,0,5,0\n100,0,5,0.15\n").poses[500] == at_50({}));
  check_says(refusal_by("x,y,z,cant\n0,0,5,0\n100,0,5,150\n"), "line 3 ... cant [mm]");
  check_says(refusal_by("x,y,z,cant_m\n0,0,5,0\n100,0,5,1.5\n"),
             "line 3 ... less than the distance");
}

TEST_CASE("coordinates are in the unit that is declared, and poses in metres") {
  const MadePath feet = made_of("x [ft],y [ft],z [ft]\n0,0,0\n1000,0,10\n", {.step = 30.48});
  check_equal(feet.codes(), "note trajectory-unit");
  REQUIRE(feet.poses.size() == 11);
  CHECK(close(feet.poses[5], 152.4, 0, 1.524));
  CHECK(
      made_of("x,y,z\n0,0,0\n1000,0,10\n", {.step = 30.48, .unit = FileUnit::named("ift")}).poses ==
      feet.poses);
  // Without a unit they are in that of the environment, and a ft is its foot.
  const LineOptions in_feet{.step = 30.48, .environment_unit = kMetresPerUsSurveyFoot};
  const double mile = 1609.347218694438;
  CHECK(close(made_of("x,y,z\n0,0,0\n5280,0,0\n", in_feet).poses.back(), mile, 0, 0));
  CHECK(close(made_of("x_ft,y_ft,z_ft\n0,0,0\n5280,0,0\n", in_feet).poses.back(), mile, 0, 0));
  const MadePath other = made_of("x_ift,y_ift,z_ift\n0,0,0\n5280,0,0\n", in_feet);
  check_equal(other.codes(), "note trajectory-unit, two-feet");
  CHECK(close(other.poses.back(), 1609.344, 0, 0));
  const MadePath assumed =
      made_of("x_mm,y_mm,z_mm\n0,0,0\n5280,0,0\n", {.environment_unit_is_assumed = true});
  check_equal(assumed.codes(), "unit-assumed, note trajectory-unit");
  check_says(refusal_by("x [mm],y [mm],z [mm]\n0,0,0\n1000,0,10\n", {.unit = 1.0}), "declared");
  check_says(refusal_by("x [deg],y [deg],z\n0,0,0\n1000,0,10\n"), "positions in");
}

TEST_CASE("longitude and latitude are refused or doubted") {
  const Refusal degrees = refused("x,y\n9.181,48.782\n9.184,48.783\n", {.height = 0});
  check_says(degrees.text, "9.181 48.782 to 9.184 48.783 ... transform");
  CHECK(degrees.remedy == Remedy::kDeclareLength);
  CHECK(
      refused(geometry("LineString", "[[9.181, 48.782], [9.184, 48.783]]"), {.height = 0}).remedy ==
      Remedy::kDeclareLength);
  // Lengths, if they say so.
  check_equal(made_of("x [m],y [m]\n9.181,48.782\n9.184,48.783\n", {.height = 0}).codes(), "");
  check_equal(made_of("x,y\n9.181,48.782\n9.184,48.783\n", {.height = 0, .unit = 1.0}).codes(), "");
  check_equal(made_of("x,y\n9,48\n10,48.1\n", {.height = 0}).codes(), "line-degrees");
  check_equal(made_of("x,y\n0,0\n10,1\n", {.height = 0}).codes(), "");
  check_equal(made_of("x,y\n200,0\n201,0\n", {.height = 0}).codes(), "");
}

TEST_CASE("GeoJSON holds one line, in whatever it is wrapped") {
  const MadePath plain = made_of(kStraight);
  const std::string line = geometry("LineString", "[[0, 0, 1], [10, 0, 2], [20, 0, 3]]");
  const std::string parts = geometry("MultiLineString", "[[[0, 0, 1], [10, 0, 2], [20, 0, 3]]]");
  const std::string both = R"({"type": "GeometryCollection", "geometries": [)" + line + "]}";
  for (const std::string& text : {line, feature(line), collection(feature(line)), parts,
                                  collection(feature(both)), "\xEF\xBB\xBF \n " + line}) {
    CAPTURE(text);
    const MadePath made = made_of(text);
    check_equal(made.codes(), "");
    CHECK(made.poses == plain.poses);
  }
  const std::string point = feature(geometry("Point", "[1, 2]"));
  const MadePath beside = made_of(collection(point + "," + feature(line) + "," + feature("null")));
  check_equal(beside.codes(), "note line-others");
  check_says(beside.text(), "1 Point, which were left out");
  check_equal(made_of(geometry("LineString", "[[0, 0], [10, 0]]"), {.height = 2}).poses.size(),
              101);
}

TEST_CASE("other GeoJSON is refused with the key") {
  const std::string line = geometry("LineString", "[[0, 0], [10, 0]]");
  const auto refusal = [](const std::string& text) { return refusal_by(text, {.height = 0}); };
  check_says(refusal(collection(feature(line) + "," + feature(line))),
             "2 LineStrings ... exactly one");
  check_says(refusal(feature(geometry("Polygon", "[[[0, 0], [1, 0], [1, 1], [0, 0]]]"))),
             "holds no LineStrings but 1 Polygon");
  check_says(refusal(R"({"type": "FeatureCollection", "features": []})"), "is empty");
  check_says(refusal(R"({"features": []})"), "type: is missing");
  check_says(refusal(R"({"type": "Topology"})"), "no type of GeoJSON");
  check_says(refusal(geometry("LineString", "[[0, 0], [10, 0, 5]]")),
             "coordinates[1] ... expected 2");
  check_says(refusal(geometry("LineString", "[[0, 0], [10]]")),
             "coordinates[1] ... two or three numbers");
  check_says(refusal(geometry("LineString", "[[0, 0], [10, \"a\"]]")), "coordinates[1]");
  check_says(refusal(geometry("LineString", "[[0, 0], [10, null]]")), "coordinates[1]");
  check_says(refusal(geometry("LineString", "[[0, 0], [10, 0, 1, 2]]")), "coordinates[1]");
  check_says(refusal(geometry("LineString", "[[0, 0], [10, NaN]]")), "is no JSON");
  check_says(refusal(geometry("LineString", "[[0, 0], [10, 1e999]]")), "no JSON");
  check_says(refusal(geometry("LineString", "[[0, 0], [1e10, 0]]")), "within 1e9 m");
  check_says(refusal(geometry("LineString", "[]")), "one place");
  check_says(refusal(geometry("LineString", "{}")), "expected a list");
  check_says(refusal(geometry("LineString", "[[0, 0], [50, 0], [50, 50]]")),
             "coordinates[1]: the line turns by 90 degrees");
  CHECK_THAT(refusal(std::string(1000, '{')), Contains("nested too deep") || Contains("no JSON"));
  std::string deep;
  for (int i = 0; i < 100'000; ++i) deep += R"({"type":"GeometryCollection","geometries":[)";
  check_says(refusal(deep), "nested too deep");
}

TEST_CASE("the reference system of GeoJSON is compared, and degrees are refused by it") {
  const auto with = [](const std::string& name) {
    return collection(feature(geometry("LineString", "[[400000, 5000000], [400010, 5000000]]")),
                      R"("crs": {"type": "name", "properties": {"name": ")" + name + R"("}}, )");
  };
  const std::string utm32 = "urn:ogc:def:crs:EPSG::25832";
  const std::string wkt =
      R"(PROJCS["ETRS89 / UTM zone 33N",GEOGCS["ETRS89",DATUM["European_Terrestrial_Reference_System_1989",)"
      R"(SPHEROID["GRS 1980",6378137,298.257222101]],PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433]],)"
      R"(PROJECTION["Transverse_Mercator"],PARAMETER["latitude_of_origin",0],)"
      R"(PARAMETER["central_meridian",15],PARAMETER["scale_factor",0.9996],)"
      R"(PARAMETER["false_easting",500000],PARAMETER["false_northing",0],UNIT["metre",1],)"
      R"(AUTHORITY["EPSG","25833"]])";
  check_equal(made_of(with(utm32), {.height = 0}).codes(), "");
  const MadePath other = made_of(with(utm32), {.height = 0, .environment_crs = wkt});
  check_equal(other.codes(), "line-crs");
  check_says(other.text(), "EPSG:25832 ... EPSG:25833");
  check_equal(made_of(with("EPSG:25833"), {.height = 0, .environment_crs = wkt}).codes(), "");
  check_equal(made_of(with("mine"), {.height = 0, .environment_crs = wkt}).codes(), "");
  for (const char* globe : {"urn:ogc:def:crs:OGC:1.3:CRS84", "EPSG:4326"}) {
    check_says(refusal_by(with(globe), {.height = 0}), "longitude and latitude");
  }
  check_equal(made_of(collection(feature(geometry("LineString", "[[0, 0], [10, 0]]")),
                                 R"("crs": {"properties": [1]}, )"),
                      {.height = 0})
                  .poses.size(),
              101);
}

TEST_CASE("what is odd about a line is said with numbers") {
  // A circle of 20 m, closed, in legs of 3.5 m, that leave it by 76 mm.
  std::string circle = "x,y\n";
  for (int i = 0; i < 36; ++i) {
    circle += std::to_string(20 * std::cos(i * kPi / 18)) + "," +
              std::to_string(20 * std::sin(i * kPi / 18)) + "\n";
  }
  circle += "20.000000,0.000000\n";
  const MadePath closed = made_of(circle, {.height = 0});
  check_equal(closed.codes(), "note line-curved");
  check_says(closed.text(), "0.07 ... beside the straight legs");
  CHECK(close(closed.poses.front(), 20, 0, 0));
  CHECK(close(closed.poses.back(), 20, 0, 0));
  const MadePath coarse = made_of("x,y\n0,0\n100,0\n200,20\n300,60\n", {.height = 0});
  check_equal(coarse.codes(), "line-curved");
  const MadePath hill = made_of("x,y,z\n0,0,0\n100,0,0\n200,0,10\n300,0,10\n");
  check_equal(hill.codes(), "line-curved");
  check_says(hill.text(), "0 m beside");
  const MadePath steep = made_of("x,y,z\n0,0,0\n10,0,4\n");
  check_equal(steep.codes(), "line-steep");
  check_says(steep.text(), "40 % ... vertex 1 at 0 0");
}

TEST_CASE("a line of many vertices is read, and one of too many refused") {
  std::string text = "x,y,z\n";
  for (int i = 0; i < 100'000; ++i) text += std::to_string(i) + ",0,0\n";
  check_equal(made_of(text, {.step = 10}).poses.size(), 10'001);
  for (int i = 100'000; i < 1'000'001; ++i) text += std::to_string(i) + ",0,0\n";
  check_says(refusal_by(text), "line 1000002 ... 1,000,000");
}

TEST_CASE("a line that is cut or changed anywhere is read or refused") {
  const std::string table =
      "x [m],y [m],z [m],station,cant [mm]\n0,0,1,5,0\n10,0,2,15,10\n20,1,3,25,20\n";
  const std::string json =
      collection(feature(geometry("LineString", "[[0, 0, 1], [10, 0, 2], [20, 1, 3]]")),
                 R"("crs": {"properties": {"name": "EPSG:25832"}}, )");
  const ScratchFolder scratch;
  std::size_t read = 0, refusals = 0;
  const auto look_at = [&](const std::string& text) {
    try {
      const auto poses = read_line(scratch.write("a", text), {.step = 1, .corner_radius = 3});
      for (const Pose& pose : poses) {
        for (const double number : pose.translation) REQUIRE(std::isfinite(number));
        for (const double number : pose.rotation) REQUIRE(std::isfinite(number));
      }
      ++read;
    } catch (const Error&) {
      ++refusals;
    }
  };
  for (const std::string& good : {table, json}) {
    for (std::size_t i = 0; i < good.size(); ++i) {
      look_at(good.substr(0, i));
      for (const char c : {'9', '-', ',', '\0', '"', '{', '\n', 'e'}) {
        std::string text = good;
        text[i] = c;
        look_at(text);
      }
    }
  }
  CHECK(read > 300);
  CHECK(refusals > 500);
}
