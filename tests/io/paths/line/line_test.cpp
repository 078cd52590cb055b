#include "clearway/line.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "clearway/error.hpp"
#include "support/catch.hpp"
#include "support/made_path.hpp"
#include "support/text_rows.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

MadePath made_of(const std::string& text, const LineOptions& options = {}) {
  const ScratchFolder scratch;
  MadePath made;
  made.poses = read_line(scratch.write("a.csv", text), options, &made.remarks, &made.labels);
  return made;
}

template <typename Kind = InputError>
void check_refusal(const std::string& text, std::string_view words, const LineOptions& options = {},
                   Remedy remedy = Remedy::kNone, const Caller& caller = Caller::current()) {
  const RowName name(text.substr(0, 200));
  try {
    made_of(text, options);
  } catch (const Kind& error) {
    check_says(error.what(), words, caller);
    if (remedy != Remedy::kNone) CHECK(error.remedy() == remedy);
    return;
  }
  fail_check("nothing was refused", caller);
}

/// Rows of a text and words of the refusal.
void check_refusals(std::string_view table, const LineOptions& options = {}) {
  for (const auto& row : text_rows(table)) check_refusal(row[0], row[1], options);
}

/// Rows of a text, codes of the messages, and words of them.
void check_remarks(std::string_view table, const LineOptions& options = {}) {
  for (const auto& row : text_rows(table)) {
    const RowName name(row[0]);
    const MadePath made = made_of(row[0], options);
    check_equal(made.codes(), row[1]);
    if (!row[2].empty()) check_says(made.text(), row[2]);
  }
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
const std::string kFlat = "x,y\n0,0\n10,0\n";

}  // namespace

TEST_CASE("a line is driven in either direction, in any step") {
  const MadePath ahead = made_of(kStraight, {.step = 3});
  const MadePath back = made_of(kStraight, {.step = 3, .reverse = true});
  REQUIRE(ahead.poses.size() == 8);
  REQUIRE(back.poses.size() == 8);
  for (std::size_t i = 0; i < 8; ++i) {
    const Pose &a = ahead.poses[i], &b = back.poses[7 - i];
    CHECK(a.position() == b.position());
    for (int k = 0; k < 9; ++k) CHECK(a.rotation[k] == (k % 3 == 2 ? 1 : -1) * b.rotation[k]);
  }
  check_refusal<UsageError>(kStraight, "step: 0", {.step = 0});
  check_refusal<UsageError>(kStraight, "at most 10,000,000", {.step = 1e-9});
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
    const RowName name(text);
    const MadePath made = made_of(text);
    CHECK((made.codes().empty() || made.codes() == "note unread-columns"));
    CHECK(made.poses == plain.poses);
  }
}

TEST_CASE("columns of a line that are not read are listed, and doubted by their names") {
  check_remarks(R"(
    x,y,z\n0,0,1\n50,0,1                                   |
    x,y,z,superelevation\n0,0,1,0\n50,0,1,0                | unread-columns
    x,y,z,Crossfall_left [mm]\n0,0,1,0\n50,0,1,0           | unread-columns
    x,y,z,roll\n0,0,1,0\n50,0,1,0                          | unread-columns
    x,y,z,track-cant\n0,0,1,0\n50,0,1,0                    | unread-columns
    x,y,z,"überhoehung"\n0,0,1,0\n50,0,1,0                 | unread-columns
    x,y,z,id,speed\n0,0,1,0,0\n50,0,1,0,0                  | note unread-columns
    x,y,z,significant,cantilever,embankment,controller\n0,0,1,0,0,0,0\n50,0,1,0,0,0,0 | note unread-columns
    x,y,z,height\n0,0,1,0\n50,0,1,0                        | note unread-columns
    x,y,z,a,b,roll\n0,0,1,1,1,1\n50,0,1,1,1,1 | unread-columns | 3 columns are not read: "a", "b", "roll" ... By its name, "roll"
  )");
  // Without heights of its own, a line may have meant another column.
  check_remarks("x,y,level\\n0,0,1\\n50,0,1 | unread-columns", {.height = 1});
}

TEST_CASE("tables that are no line are refused with their line") {
  check_refusals(R"(
    0,0,1\n1,0,1\n                         | line 1 ... header
    a,b\n1,2\n                             | line 1 ... the columns x and y
    x,y,x\n1,2,3\n                         | the columns x and y once
    x,y,station,chainage\n1,2,3,4\n        | two columns for station
    lon,lat,z\n9,48,1\n                    | angles and no lengths ... transform
    <kml>\n</kml>\n                        | is XML
                                           | no vertex
    x,y,z\n                                | no vertex
    x,y,z\n0,0,0\n                         | only one place
    x,y,z\n0,0,0\n0,0,0\n                  | only one place
    x,y,z\n0,0,0\n5,nan,1\n                | line 3 ... finite number
    x,y,z\n0,0,0\n\n5,,1\n                 | line 4 ... "" in column 2
    x,y,z\n0,0,0\n5,x,1\n                  | line 3 ... "x" in column 2
    x,y,z\n0,0,0\n5,1\n                    | line 3 ... 2 columns; expected 3
    x,y,z\n0,0,0\n5,1,2,3\n                | 4 columns; expected 3
    x;y;z\n0,5;1,5;2,5\n                   | line 2 ... 0.25
    x,y,z\n0,0,0\n5,2e9,1\n                | within 1e9 m
    x,y,z\n0,0,1\n10,0,2\n10,0,2.5\n       | line 4 ... height differs by 0.5 m
    x,y,z,station\n0,0,1,0\n10,0,2,10\n10,0,2,90\n     | station differs by 80 m
    x,y,z,station [s]\n0,0,0,0\n100,0,0,328\n          | the station in
    x,y,z,cant\n0,0,5,0\n100,0,5,150\n                 | line 3 ... cant [mm]
    x,y,z,cant_m\n0,0,5,0\n100,0,5,1.5\n               | line 3 ... less than the distance
    x [deg],y [deg],z\n0,0,0\n1000,0,10\n              | positions in
  )");
  check_refusal(std::string("\0\0\x27\x0A\0\0", 6), "shapefile ... as CSV or GeoJSON");
  check_refusal(std::string("SQLite format 3\0", 16), "GeoPackage ... as CSV or GeoJSON");
  check_refusals("x [mm],y [mm],z [mm]\\n0,0,0\\n1000,0,10\\n | declared", {.unit = 1.0});
}

TEST_CASE("heights come from the line or from an option, and from one of them") {
  check_refusal(kFlat, "no heights", {}, Remedy::kGiveHeight);
  check_near(made_of(kFlat, {.height = 4.5}).poses[20].position(), {2, 0, 4.5}, 1e-12);
  check_refusal<UsageError>(kStraight, "have heights", {.height = 4});
  check_refusal<UsageError>(kFlat, "height", {.height = NAN});
}

TEST_CASE("vertices that stand twice in a row are left out") {
  const MadePath made = made_of("x,y,z\n0,0,1\n0,0,1\n10,0,2\n20,0,3\n20,0,3\n20,0,3\n");
  check_equal(made.codes(), "");
  CHECK(made.poses == made_of(kStraight).poses);
}

TEST_CASE("vertices that turn by more than 15 degrees need arcs") {
  const auto bent = [](double degrees) {
    return "x,y\n0,0\n50,0\n" +
           std::to_string(50 + 50 * std::cos(degrees * std::numbers::pi / 180)) + "," +
           std::to_string(50 * std::sin(degrees * std::numbers::pi / 180)) + "\n";
  };
  CHECK(made_of(bent(14.99), {.height = 0}).poses.size() > 1000);
  CHECK(made_of(bent(-14.99), {.height = 0}).poses.size() > 1000);
  check_refusal(bent(15.01), "line 3: the line turns by 15.01 degrees at vertex 2 at 50 0",
                {.height = 0}, Remedy::kRoundCorners);
  check_refusals(
      R"(x,y\n0,0\n9,0\n9,9\n0,9\n0,20\n | line 3: the line turns by 90 degrees ... 2 other vertices too)",
      {.height = 0});
  const MadePath round = made_of(bent(15.01), {.height = 0, .corner_radius = 30});
  check_equal(round.codes(), "note line-rounded");
  check_says(round.text(),
             "1 vertex got an arc of radius 30 m ... vertex 2 at 50 0 0.25 ... to its inside");
}

TEST_CASE("arcs that do not fit are refused by their vertex") {
  const std::string text = "x,y\n0,0\n30,0\n30,5\n60,5\n";
  check_refusal(text,
                "line 4: the leg from vertex 2 to vertex 3 is 5 m long ... vertex 3 at 30 5 ... "
                "need 8 m ... A radius of 2.5 m fits everywhere",
                {.height = 0, .corner_radius = 4});
  CHECK(made_of(text, {.height = 0, .corner_radius = 2.5}).poses.size() > 100);
  check_refusals(R"(x,y\n0,0\n30,0\n10,0\n | line 3 ... turns by 180 degrees ... turns back)",
                 {.height = 0, .corner_radius = 1});
  check_refusal<UsageError>(text, "corner radius", {.height = 0, .corner_radius = 0.0});
}

TEST_CASE("stations of vertices become those of poses") {
  const MadePath made =
      made_of("x,y,z,station\n0,0,0,1000\n10,0,0,1010\n20,0,0,1020.5\n", {.step = 2.5});
  check_equal(made.codes(), "");
  check_equal(made.labels.station,
              {1000, 1002.5, 1005, 1007.5, 1010, 1012.625, 1015.25, 1017.875, 1020.5});
  const MadePath back =
      made_of("x,y,z,station\n0,0,0,20\n10,0,0,10\n20,0,0,0\n", {.step = 5, .reverse = true});
  check_equal(back.codes(), "");
  check_equal(back.labels.station, {0, 5, 10, 15, 20});
  // The station of a vertex that is rounded stands in the middle of its arc.
  const MadePath corner = made_of("x,y,chainage\n0,0,0\n10,0,10\n10,10,20\n",
                                  {.step = 6 + std::numbers::pi, .height = 0, .corner_radius = 4});
  REQUIRE(corner.labels.station.size() == 3);
  CHECK(corner.labels.station[1] == Approx(10));
  check_remarks(R"(
    x,y,z,station\n0,0,0,0\n10,0,0,10\n20,0,0,5\n   | station-order | line 4 ... 5 m comes after 10 m
    x,y,z,station\n0,0,0,0\n100,0,0,328\n           | line-stations | span 328 m ... 100 m long
    x,y,z,station [ft]\n0,0,0,0\n100,0,0,328\n      |
  )");
}

TEST_CASE("cant of a line to the wrong side or in another unit is warned of") {
  const auto codes = [](const std::string& cant) {  // on a curve to the right
    const std::string end = "," + cant + "\n";
    return made_of("x,y,cant [mm]\n0,0" + end + "300,0" + end + "300,-300" + end,
                   {.height = 5, .corner_radius = 290, .rail_distance = 1.5})
        .codes();
  };
  check_equal(codes("120"), "note line-rounded");
  check_equal(codes("-120"), "note line-rounded, cant-side");
  check_equal(codes("0.12"), "note line-rounded, cant-unit");
}

TEST_CASE("cant turns the path about the line that the option names") {
  const std::string text = "x,y,z,cant [mm]\n0,0,5,0\n100,0,5,150\n";
  check_equal(made_of(text).codes(), "note cant-rails");
  check_equal(made_of(text, {.rail_distance = 1.07}).codes(), "");
  check_equal(made_of(kStraight, {.cant = CantLine::kLeftRail}).codes(), "note no-cant");
  struct Row {
    LineOptions options;
    double raise, roll = 0.075 / 1.5;
  };
  const double half = 0.0375;  // of the cant of 75 mm, by which the left side is up
  for (const Row& row :
       {Row{{}, 0}, Row{{.cant = CantLine::kFile}, 0}, Row{{.cant = CantLine::kInsideRail}, half},
        Row{{.cant = CantLine::kOutsideRail}, -half}, Row{{.cant = CantLine::kLeftRail}, -half},
        Row{{.cant = CantLine::kRightRail}, half}, Row{{.rail_distance = 1}, 0, 0.075},
        Row{{.cant = CantLine::kNone}, 0, 0}}) {
    CAPTURE(static_cast<int>(row.options.cant));
    const Pose pose = made_of(text, row.options).poses.at(500);
    CHECK(pose.translation[2] == Approx(5 + row.raise));
    CHECK(pose.rotation[7] == Approx(row.roll));
  }
  // Without a unit of its own it has that of the coordinates.
  CHECK(made_of("x [m],y [m],z [m],cant\n0,0,5,0\n100,0,5,0.15\n").poses == made_of(text).poses);
}

TEST_CASE("coordinates are in the unit that is declared, and poses in metres") {
  const MadePath feet = made_of("x [ft],y [ft],z [ft]\n0,0,0\n1000,0,10\n", {.step = 30.48});
  check_equal(feet.codes(), "note trajectory-unit");
  REQUIRE(feet.poses.size() == 11);
  check_near(feet.poses[5].position(), {152.4, 0, 1.524}, 1e-12);
  CHECK(
      made_of("x,y,z\n0,0,0\n1000,0,10\n", {.step = 30.48, .unit = FileUnit::named("ift")}).poses ==
      feet.poses);
  // Without a unit they are in that of the environment, and a ft is its foot.
  LineOptions in_feet{.step = 30.48, .environment_unit = kMetresPerUsSurveyFoot};
  struct Row {
    const char *header, *codes;
    double mile;
  };
  for (const Row& row : {Row{"x,y,z", "note trajectory-unit", 1609.347218694438},
                         Row{"x_ft,y_ft,z_ft", "note trajectory-unit", 1609.347218694438},
                         Row{"x_ift,y_ift,z_ift", "note trajectory-unit, two-feet", 1609.344}}) {
    const RowName name(row.header);
    const MadePath made = made_of(row.header + std::string("\n0,0,0\n5280,0,0\n"), in_feet);
    check_equal(made.codes(), row.codes);
    check_near(made.poses.back().position(), {row.mile, 0, 0}, 1e-12);
  }
  check_remarks(R"(x_mm,y_mm,z_mm\n0,0,0\n5280,0,0\n | unit-assumed, note trajectory-unit)",
                {.environment_unit_is_assumed = true});
}

TEST_CASE("longitude and latitude are refused or doubted") {
  check_refusal("x,y\n9.181,48.782\n9.184,48.783\n", "9.181 48.782 to 9.184 48.783 ... transform",
                {.height = 0}, Remedy::kDeclareLength);
  check_refusal(geometry("LineString", "[[9.181, 48.782], [9.184, 48.783]]"), "transform",
                {.height = 0}, Remedy::kDeclareLength);
  check_remarks(R"(
    x [m],y [m]\n9.181,48.782\n9.184,48.783\n    |
    x,y\n9,48\n10,48.1\n                         | line-degrees
    x,y\n0,0\n10,1\n                             |
    x,y\n200,0\n201,0\n                          |
  )",
                {.height = 0});
  check_remarks(R"(x,y\n9.181,48.782\n9.184,48.783\n |)", {.height = 0, .unit = 1.0});
}

TEST_CASE("GeoJSON holds one line, in whatever it is wrapped") {
  const MadePath plain = made_of(kStraight);
  const std::string line = geometry("LineString", "[[0, 0, 1], [10, 0, 2], [20, 0, 3]]");
  const std::string parts = geometry("MultiLineString", "[[[0, 0, 1], [10, 0, 2], [20, 0, 3]]]");
  const std::string both = R"({"type": "GeometryCollection", "geometries": [)" + line + "]}";
  for (const std::string& text : {line, feature(line), collection(feature(line)), parts,
                                  collection(feature(both)), "\xEF\xBB\xBF \n " + line}) {
    const RowName name(text);
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
  check_refusals(R"(
    {"type": "FeatureCollection", "features": []}            | is empty
    {"features": []}                                         | type: is missing
    {"type": "Topology"}                                     | no type of GeoJSON
    {"type": "Polygon", "coordinates": [[[0, 0], [1, 0], [1, 1], [0, 0]]]} | holds no LineStrings but 1 Polygon
    {"type": "MultiLineString", "coordinates": [[[0, 0], [10, 0]], [[0, 0], [10, 0]]]} | 2 LineStrings ... exactly one
  )",
                 {.height = 0});
  for (const auto& row : text_rows(R"(
    [[0, 0], [10, 0, 5]]         | coordinates[1] ... expected 2
    [[0, 0], [10]]               | coordinates[1] ... two or three numbers
    [[0, 0], [10, "a"]]          | coordinates[1]
    [[0, 0], [10, null]]         | coordinates[1]
    [[0, 0], [10, 0, 1, 2]]      | coordinates[1]
    [[0, 0], [10, NaN]]          | is no JSON
    [[0, 0], [10, 1e999]]        | no JSON
    [[0, 0], [1e10, 0]]          | within 1e9 m
    []                           | one place
    {}                           | expected a list
    [[0, 0], [50, 0], [50, 50]]  | coordinates[1]: the line turns by 90 degrees
  )")) {
    check_refusal(geometry("LineString", row[0]), row[1], {.height = 0});
  }
  check_refusal(std::string(1000, '{'), "nested too deep", {.height = 0});
  std::string deep;
  for (int i = 0; i < 100'000; ++i) deep += R"({"type":"GeometryCollection","geometries":[)";
  check_refusal(deep, "nested too deep", {.height = 0});
}

TEST_CASE("the reference system of GeoJSON is compared, and degrees are refused by it") {
  const auto with = [](const std::string& name) {
    return collection(feature(geometry("LineString", "[[400000, 5000000], [400010, 5000000]]")),
                      R"("crs": {"type": "name", "properties": {"name": ")" + name + R"("}}, )");
  };
  const std::string utm32 = "urn:ogc:def:crs:EPSG::25832";
  const LineOptions in_utm33{
      .height = 0,
      .environment_crs =
          R"(PROJCS["ETRS89 / UTM zone 33N",GEOGCS["ETRS89",DATUM["European_Terrestrial_Reference_System_1989",SPHEROID["GRS 1980",6378137,298.257222101]],PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433]],PROJECTION["Transverse_Mercator"],PARAMETER["central_meridian",15],UNIT["metre",1],AUTHORITY["EPSG","25833"]])"};
  check_equal(made_of(with(utm32), {.height = 0}).codes(), "");
  const MadePath other = made_of(with(utm32), in_utm33);
  check_equal(other.codes(), "line-crs");
  check_says(other.text(), "EPSG:25832 ... EPSG:25833");
  for (const char* same : {"EPSG:25833", "mine"}) {
    check_equal(made_of(with(same), in_utm33).codes(), "");
  }
  for (const char* globe : {"urn:ogc:def:crs:OGC:1.3:CRS84", "EPSG:4326"}) {
    check_refusal(with(globe), "longitude and latitude", {.height = 0});
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
    circle += std::to_string(20 * std::cos(i * std::numbers::pi / 18)) + "," +
              std::to_string(20 * std::sin(i * std::numbers::pi / 18)) + "\n";
  }
  circle += "20.000000,0.000000\n";
  const MadePath closed = made_of(circle, {.height = 0});
  check_equal(closed.codes(), "note line-curved");
  check_says(closed.text(), "0.07 ... beside the straight legs");
  check_near(closed.poses.front().position(), {20, 0, 0}, 1e-12);
  check_near(closed.poses.back().position(), {20, 0, 0}, 1e-12);
  check_remarks(R"(x,y\n0,0\n100,0\n200,20\n300,60\n | line-curved)", {.height = 0});
  check_remarks(R"(
    x,y,z\n0,0,0\n100,0,0\n200,0,10\n300,0,10\n | line-curved | 0 m beside
    x,y,z\n0,0,0\n10,0,4\n                      | line-steep  | 40 % ... vertex 1 at 0 0
    x,y,z\n0,0,0\n9,0,1.                        | cut-text
  )");
}

TEST_CASE("a line of many vertices is read, and one of too many refused") {
  std::string text = "x,y,z\n";
  for (int i = 0; i < 100'000; ++i) text += std::to_string(i) + ",0,0\n";
  check_equal(made_of(text, {.step = 10}).poses.size(), 10'001);
  for (int i = 100'000; i < 1'000'001; ++i) text += std::to_string(i) + ",0,0\n";
  check_refusal(text, "line 1000002 ... 1,000,000");
}

TEST_CASE("a line that is cut or changed anywhere is read or refused") {
  const std::string table =
      "x [m],y [m],z [m],station,cant [mm]\n0,0,1,5,0\n10,0,2,15,10\n20,1,3,25,20\n";
  const std::string json =
      collection(feature(geometry("LineString", "[[0, 0, 1], [10, 0, 2], [20, 1, 3]]")),
                 R"("crs": {"properties": {"name": "EPSG:25832"}}, )");
  std::size_t read = 0, refusals = 0;
  const auto look_at = [&](const std::string& text) {
    try {
      for (const Pose& pose : made_of(text, {.step = 1, .corner_radius = 3}).poses) {
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
