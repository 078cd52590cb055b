#include "clearway/line.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "clearway/error.hpp"
#include "support/reader_fixture.hpp"

using namespace clearway;
using namespace clearway::test;
using Catch::Contains;

namespace {

constexpr double kPi = std::numbers::pi;

using Codes = std::vector<std::string>;

struct Made {
  std::vector<Pose> poses;
  std::vector<Message> remarks;
  PoseLabels labels;

  Codes codes() const {
    Codes codes;
    for (const Message& remark : remarks) {
      const bool warns = remark.severity == Message::Severity::kWarning;
      codes.push_back((warns ? "" : "note ") + remark.code);
    }
    return codes;
  }
  std::string text() const {
    std::string all;
    for (const Message& remark : remarks) all += remark.text + "\n";
    return all;
  }
};

Made made_of(const std::string& text, const LineOptions& options = {}) {
  const ReaderScratch scratch;
  Made made;
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
  const Made made = made_of("x,y,z\n0,0,1\n10.05,0,2.005\n");
  CHECK(made.codes().empty());
  CHECK(made.labels.station.empty());
  REQUIRE(made.poses.size() == 102);
  CHECK(close(made.poses[0], 0, 0, 1));
  CHECK(close(made.poses[37], 3.7, 0, 1.37));
  CHECK(close(made.poses[101], 10.05, 0, 2.005));
  const double c = 1 / std::hypot(1, 0.1), s = 0.1 * c;
  const double expected[9] = {c, 0, -s, 0, 1, 0, s, 0, c};
  for (int k = 0; k < 9; ++k) CHECK(std::abs(made.poses[50].rotation[k] - expected[k]) < 1e-14);
}

TEST_CASE("a line is driven in either direction, in any step") {
  const Made ahead = made_of(kStraight, {.step = 3});
  const Made back = made_of(kStraight, {.step = 3, .reverse = true});
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
  CHECK_THAT(refusal_by<UsageError>(kStraight, {.step = 0}), Contains("step: 0"));
  CHECK_THAT(refusal_by<UsageError>(kStraight, {.step = 1e-9}), Contains("at most 10,000,000"));
}

TEST_CASE("names of columns decide, not their order or form") {
  const Made plain = made_of(kStraight);
  for (const std::string& text :
       {std::string("z;y;x\n1;0;0\n2;0;10\n3;0;20\n"),
        std::string("\xEF\xBB\xBF# a survey\n\n  \"X [m]\" , \"Y [m]\" , Z_m, note\n0,0,1,a\n"
                    "// half\n10,0,2,\"b, c\"\n20,0,3,\r\n"),
        std::string("# x y z\n0 0 1\n10 0 2\n20 0 3"),
        std::string("id,Easting,Northing,Elevation\nA1,0,0,1\nA2,10,0,2\nA3,20,0,3\n")}) {
    CAPTURE(text);
    const Made made = made_of(text);
    CHECK((made.codes().empty() || made.codes() == Codes{"note unread-columns"}));
    REQUIRE(made.poses.size() == plain.poses.size());
    bool same = true;
    for (std::size_t i = 0; i < made.poses.size(); ++i) same &= made.poses[i] == plain.poses[i];
    CHECK(same);
  }
  CHECK_THAT(refusal_by("0,0,1\n1,0,1\n"), Contains("line 1") && Contains("header"));
  CHECK_THAT(refusal_by("a,b\n1,2\n"), Contains("line 1") && Contains("the columns x and y"));
  CHECK_THAT(refusal_by("x,y,x\n1,2,3\n"), Contains("the columns x and y once"));
  CHECK_THAT(refusal_by("x,y,z,z\n1,2,3,4\n"), Contains("the columns x and y once"));
  CHECK_THAT(refusal_by("x,y,station,chainage\n1,2,3,4\n"), Contains("two columns of a station"));
  CHECK_THAT(refusal_by("lon,lat,z\n9,48,1\n"),
             Contains("angles and no lengths") && Contains("transform"));
  CHECK_THAT(refusal_by("<kml>\n</kml>\n"), Contains("is XML"));
}

TEST_CASE("columns of a line that are not read are listed, and doubted by their names") {
  struct Row {
    std::string more;  ///< names of further columns
    Codes codes;
  };
  const Row rows[] = {{"", {}},
                      {",superelevation", {"unread-columns"}},
                      {",Crossfall_left [mm]", {"unread-columns"}},
                      {",roll", {"unread-columns"}},
                      {",track-cant", {"unread-columns"}},
                      {",\"\xC3\xBC"
                       "berhoehung\"",
                       {"unread-columns"}},
                      {",id,speed", {"note unread-columns"}},
                      {",significant,cantilever,embankment,controller", {"note unread-columns"}},
                      {",height", {"note unread-columns"}}};
  for (const Row& row : rows) {
    INFO(row.more);
    const auto columns = static_cast<std::size_t>(std::ranges::count(row.more, ','));
    std::string values;
    for (std::size_t i = 0; i < columns; ++i) values += ",0";
    const Made made = made_of("x,y,z" + row.more + "\n0,0,1" + values + "\n50,0,1" + values + "\n");
    CHECK(made.codes() == row.codes);
  }
  // Without heights of its own, a line may have meant another column.
  CHECK(made_of("x,y,level\n0,0,1\n50,0,1\n", {.height = 1}).codes() == Codes{"unread-columns"});
  const Made many = made_of("x,y,z,a,b,roll\n0,0,1,1,1,1\n50,0,1,1,1,1\n");
  CHECK_THAT(many.text(), Contains("3 columns are not read: \"a\", \"b\", \"roll\"") &&
                              Contains("By its name, \"roll\""));
}

TEST_CASE("rows that are no vertex are refused with their line") {
  const std::string head = "x,y,z\n0,0,0\n";
  CHECK_THAT(refusal_by(head + "5,nan,1\n"), Contains("line 3") && Contains("finite number"));
  CHECK_THAT(refusal_by(head + "5,inf,1\n"), Contains("line 3") && Contains("finite number"));
  CHECK_THAT(refusal_by(head + "\n5,,1\n"), Contains("line 4") && Contains("\"\" in column 2"));
  CHECK_THAT(refusal_by(head + "5,x,1\n"), Contains("line 3") && Contains("\"x\" in column 2"));
  CHECK_THAT(refusal_by(head + "5,1\n"), Contains("line 3") && Contains("2 columns; expected 3"));
  CHECK_THAT(refusal_by(head + "5,1,2,3\n"), Contains("4 columns; expected 3"));
  CHECK_THAT(refusal_by("x;y;z\n0,5;1,5;2,5\n"), Contains("line 2") && Contains("0.25"));
  CHECK_THAT(refusal_by(head + "5,2e9,1\n"), Contains("within 1e9 m"));
  CHECK_THAT(refusal_by(""), Contains("no vertex"));
  CHECK_THAT(refusal_by("x,y,z\n"), Contains("no vertex"));
  CHECK_THAT(refusal_by(head), Contains("only one place"));
  CHECK_THAT(refusal_by(head + "0,0,0\n"), Contains("only one place"));
  CHECK(made_of(head + "9,0,1.").codes() == Codes{"cut-text"});
}

TEST_CASE("heights come from the line or from an option, and from one of them") {
  const std::string flat = "x,y\n0,0\n10,0\n";
  const Refusal none = refused(flat);
  CHECK_THAT(none.text, Contains("no heights"));
  CHECK(none.remedy == Remedy::kGiveHeight);
  CHECK(close(made_of(flat, {.height = 4.5}).poses[20], 2, 0, 4.5));
  CHECK_THAT(refusal_by<UsageError>(kStraight, {.height = 4}), Contains("have heights"));
  CHECK_THAT(refusal_by<UsageError>(flat, {.height = NAN}), Contains("height"));
}

TEST_CASE("vertices that stand twice in a row are left out, if they agree") {
  const Made made = made_of("x,y,z\n0,0,1\n0,0,1\n10,0,2\n20,0,3\n20,0,3\n20,0,3\n");
  CHECK(made.codes().empty());
  CHECK(made.poses == made_of(kStraight).poses);
  CHECK_THAT(refusal_by("x,y,z\n0,0,1\n10,0,2\n10,0,2.5\n"),
             Contains("line 4") && Contains("height differs by 0.5 m"));
  CHECK_THAT(refusal_by("x,y,z,station\n0,0,1,0\n10,0,2,10\n10,0,2,90\n"),
             Contains("station differs by 80 m"));
}

TEST_CASE("vertices that turn by more than 15 degrees need arcs") {
  const auto bent = [](double degrees) {
    return "x,y\n0,0\n50,0\n" + std::to_string(50 + 50 * std::cos(degrees * kPi / 180)) + "," +
           std::to_string(50 * std::sin(degrees * kPi / 180)) + "\n";
  };
  CHECK(made_of(bent(14.99), {.height = 0}).poses.size() > 1000);
  CHECK(made_of(bent(-14.99), {.height = 0}).poses.size() > 1000);
  const Refusal sharp = refused(bent(15.01), {.height = 0});
  CHECK_THAT(sharp.text, Contains("line 3: the line turns by 15.01 degrees at vertex 2 at 50 0"));
  CHECK(sharp.remedy == Remedy::kRoundCorners);
  CHECK_THAT(refusal_by("x,y\n0,0\n9,0\n9,9\n0,9\n0,20\n", {.height = 0}),
             Contains("line 3: the line turns by 90 degrees") && Contains("2 other vertices too"));
  const Made round = made_of(bent(15.01), {.height = 0, .corner_radius = 30});
  CHECK(round.codes() == Codes{"note line-rounded"});
  CHECK_THAT(round.text(), Contains("1 vertex got an arc of radius 30 m") &&
                               Contains("vertex 2 at 50 0 0.25") && Contains("to its inside"));
}

TEST_CASE("corners become arcs with the exact places and headings") {
  const Made made =
      made_of("x,y\n0,0\n10,0\n10,10\n", {.step = 0.5, .height = 3, .corner_radius = 4});
  CHECK(made.codes() == Codes{"note line-rounded"});
  const double length = 12 + 2 * kPi;
  CHECK(made.poses.size() == static_cast<std::size_t>(length / 0.5) + 2);
  for (std::size_t i = 0; i + 1 < made.poses.size(); ++i) {
    const double s = 0.5 * static_cast<double>(i);
    const double turn = std::clamp((s - 6) / 4, 0.0, kPi / 2);
    const double x = s < 6 ? s : 6 + 4 * std::sin(turn);
    const double y = std::max(s - 6 - 2 * kPi, 0.0) + 4 - 4 * std::cos(turn);
    CHECK(close(made.poses[i], x, y, 3));
    CHECK(std::abs(made.poses[i].rotation[0] - std::cos(turn)) < 1e-14);
    CHECK(std::abs(made.poses[i].rotation[3] - std::sin(turn)) < 1e-14);
  }
  CHECK(close(made.poses.back(), 10, 10, 3));
}

TEST_CASE("arcs that do not fit are refused by their vertex") {
  const std::string text = "x,y\n0,0\n30,0\n30,5\n60,5\n";
  CHECK_THAT(refusal_by(text, {.height = 0, .corner_radius = 4}),
             Contains("line 4: the leg from vertex 2 to vertex 3 is 5 m long") &&
                 Contains("vertex 3 at 30 5") && Contains("need 8 m") &&
                 Contains("A radius of 2.5 m fits everywhere"));
  CHECK(made_of(text, {.height = 0, .corner_radius = 2.5}).poses.size() > 100);
  CHECK_THAT(refusal_by("x,y\n0,0\n30,0\n10,0\n", {.height = 0, .corner_radius = 1}),
             Contains("line 3") && Contains("turns by 180 degrees") && Contains("turns back"));
  CHECK_THAT(refusal_by<UsageError>(text, {.height = 0, .corner_radius = 0.0}),
             Contains("corner radius"));
}

TEST_CASE("stations of vertices become those of poses") {
  const Made made =
      made_of("x,y,z,station\n0,0,0,1000\n10,0,0,1010\n20,0,0,1020.5\n", {.step = 2.5});
  CHECK(made.codes().empty());
  CHECK(made.labels.station ==
        std::vector<double>{1000, 1002.5, 1005, 1007.5, 1010, 1012.625, 1015.25, 1017.875, 1020.5});
  const Made back =
      made_of("x,y,z,station\n0,0,0,20\n10,0,0,10\n20,0,0,0\n", {.step = 5, .reverse = true});
  CHECK(back.codes().empty());
  CHECK(back.labels.station == std::vector<double>{0, 5, 10, 15, 20});
  // The station of a vertex that is rounded stands in the middle of its arc.
  const Made corner = made_of("x,y,chainage\n0,0,0\n10,0,10\n10,10,20\n",
                              {.step = 6 + kPi, .height = 0, .corner_radius = 4});
  REQUIRE(corner.labels.station.size() == 3);
  CHECK(corner.labels.station[1] == Approx(10));
  const Made odd = made_of("x,y,z,station\n0,0,0,0\n10,0,0,10\n20,0,0,5\n");
  CHECK(odd.codes() == Codes{"station-order"});
  CHECK_THAT(odd.text(), Contains("line 4") && Contains("5 m comes after 10 m"));
  const Made feet = made_of("x,y,z,station\n0,0,0,0\n100,0,0,328\n");
  CHECK(feet.codes() == Codes{"line-stations"});
  CHECK_THAT(feet.text(), Contains("span 328 m") && Contains("100 m long"));
  CHECK(made_of("x,y,z,station [ft]\n0,0,0,0\n100,0,0,328\n").codes().empty());
  CHECK_THAT(refusal_by("x,y,z,station [s]\n0,0,0,0\n100,0,0,328\n"), Contains("the station in"));
}

TEST_CASE("cant of a line to the wrong side or in another unit is warned of") {
  struct Row {
    const char *unit, *cant;
    Codes codes;
  };
  for (const Row& row : {Row{" [mm]", "120", {}}, Row{" [m]", "0.12", {}},
                         Row{" [mm]", "-120", {"cant-side"}}, Row{" [mm]", "-45", {}},
                         Row{" [mm]", "0.12", {"cant-unit"}}, Row{" [mm]", "400", {"cant-unit"}}}) {
    CAPTURE(row.unit, row.cant);
    std::string text = "x,y,z,cant" + std::string(row.unit) + "\n";
    for (int i = 0; i <= 240; ++i) {  // an arc of 300 m to the right
      const double angle = i / 240.0;
      text += std::to_string(300 * std::sin(angle)) + "," + std::to_string(300 * std::cos(angle)) +
              ",5," + row.cant + "\n";
    }
    CHECK(made_of(text, {.rail_distance = 1.5}).codes() == row.codes);
  }
}

TEST_CASE("cant turns the path about the line that the option names") {
  const std::string text = "x,y,z,cant [mm]\n0,0,5,0\n100,0,5,150\n";
  const auto at_50 = [&](const LineOptions& options) {
    return made_of(text, options).poses.at(500);
  };
  const double half = 0.0375;  // of the cant of 75 mm
  CHECK(made_of(text).codes() == Codes{"note cant-rails"});
  CHECK(made_of(text, {.rail_distance = 1.07}).codes().empty());
  CHECK(at_50({}).translation[2] == Approx(5));
  CHECK(at_50({.cant = CantLine::kFile}).translation[2] == Approx(5));
  CHECK(at_50({.cant = CantLine::kInsideRail}).translation[2] == Approx(5 + half));
  CHECK(at_50({.cant = CantLine::kOutsideRail}).translation[2] == Approx(5 - half));
  CHECK(at_50({.cant = CantLine::kLeftRail}).translation[2] == Approx(5 - half));
  CHECK(at_50({.cant = CantLine::kRightRail}).translation[2] == Approx(5 + half));
  // The left side is up.
  CHECK(at_50({}).rotation[7] == Approx(0.075 / 1.5));
  CHECK(at_50({.rail_distance = 1}).rotation[7] == Approx(0.075));
  CHECK(at_50({.cant = CantLine::kNone}).rotation[7] == 0);
  CHECK(made_of(kStraight, {.cant = CantLine::kLeftRail}).codes() == Codes{"note no-cant"});
  // Without a unit of its own it has that of the coordinates.
  CHECK(made_of("x [m],y [m],z [m],cant\n0,0,5,0\n100,0,5,0.15\n").poses[500] == at_50({}));
  CHECK_THAT(refusal_by("x,y,z,cant\n0,0,5,0\n100,0,5,150\n"),
             Contains("line 3") && Contains("cant [mm]"));
  CHECK_THAT(refusal_by("x,y,z,cant_m\n0,0,5,0\n100,0,5,1.5\n"),
             Contains("line 3") && Contains("less than the distance"));
}

TEST_CASE("coordinates are in the unit that is declared, and poses in metres") {
  const Made feet = made_of("x [ft],y [ft],z [ft]\n0,0,0\n1000,0,10\n", {.step = 30.48});
  CHECK(feet.codes() == Codes{"note trajectory-unit"});
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
  const Made other = made_of("x_ift,y_ift,z_ift\n0,0,0\n5280,0,0\n", in_feet);
  CHECK(other.codes() == Codes{"note trajectory-unit", "two-feet"});
  CHECK(close(other.poses.back(), 1609.344, 0, 0));
  const Made assumed =
      made_of("x_mm,y_mm,z_mm\n0,0,0\n5280,0,0\n", {.environment_unit_is_assumed = true});
  CHECK(assumed.codes() == Codes{"unit-assumed", "note trajectory-unit"});
  CHECK_THAT(refusal_by("x [mm],y [mm],z [mm]\n0,0,0\n1000,0,10\n", {.unit = 1.0}),
             Contains("declared"));
  CHECK_THAT(refusal_by("x [deg],y [deg],z\n0,0,0\n1000,0,10\n"), Contains("positions in"));
}

TEST_CASE("longitude and latitude are refused or doubted") {
  const Refusal degrees = refused("x,y\n9.181,48.782\n9.184,48.783\n", {.height = 0});
  CHECK_THAT(degrees.text, Contains("9.181 48.782 to 9.184 48.783") && Contains("transform"));
  CHECK(degrees.remedy == Remedy::kDeclareLength);
  CHECK(
      refused(geometry("LineString", "[[9.181, 48.782], [9.184, 48.783]]"), {.height = 0}).remedy ==
      Remedy::kDeclareLength);
  // Lengths, if they say so.
  CHECK(made_of("x [m],y [m]\n9.181,48.782\n9.184,48.783\n", {.height = 0}).codes().empty());
  CHECK(made_of("x,y\n9.181,48.782\n9.184,48.783\n", {.height = 0, .unit = 1.0}).codes().empty());
  CHECK(made_of("x,y\n9,48\n10,48.1\n", {.height = 0}).codes() == Codes{"line-degrees"});
  CHECK(made_of("x,y\n0,0\n10,1\n", {.height = 0}).codes().empty());
  CHECK(made_of("x,y\n200,0\n201,0\n", {.height = 0}).codes().empty());
}

TEST_CASE("GeoJSON holds one line, in whatever it is wrapped") {
  const Made plain = made_of(kStraight);
  const std::string line = geometry("LineString", "[[0, 0, 1], [10, 0, 2], [20, 0, 3]]");
  const std::string parts = geometry("MultiLineString", "[[[0, 0, 1], [10, 0, 2], [20, 0, 3]]]");
  const std::string both = R"({"type": "GeometryCollection", "geometries": [)" + line + "]}";
  for (const std::string& text : {line, feature(line), collection(feature(line)), parts,
                                  collection(feature(both)), "\xEF\xBB\xBF \n " + line}) {
    CAPTURE(text);
    const Made made = made_of(text);
    CHECK(made.codes().empty());
    CHECK(made.poses == plain.poses);
  }
  const std::string point = feature(geometry("Point", "[1, 2]"));
  const Made beside = made_of(collection(point + "," + feature(line) + "," + feature("null")));
  CHECK(beside.codes() == Codes{"note line-others"});
  CHECK_THAT(beside.text(), Contains("1 Point, which were left out"));
  CHECK(made_of(geometry("LineString", "[[0, 0], [10, 0]]"), {.height = 2}).poses.size() == 101);
}

TEST_CASE("other GeoJSON is refused with the key") {
  const std::string line = geometry("LineString", "[[0, 0], [10, 0]]");
  const auto refusal = [](const std::string& text) { return refusal_by(text, {.height = 0}); };
  CHECK_THAT(refusal(collection(feature(line) + "," + feature(line))),
             Contains("2 LineStrings") && Contains("exactly one"));
  CHECK_THAT(refusal(feature(geometry("Polygon", "[[[0, 0], [1, 0], [1, 1], [0, 0]]]"))),
             Contains("holds no LineStrings but 1 Polygon"));
  CHECK_THAT(refusal(R"({"type": "FeatureCollection", "features": []})"), Contains("is empty"));
  CHECK_THAT(refusal(R"({"features": []})"), Contains("type: is missing"));
  CHECK_THAT(refusal(R"({"type": "Topology"})"), Contains("no type of GeoJSON"));
  CHECK_THAT(refusal(geometry("LineString", "[[0, 0], [10, 0, 5]]")),
             Contains("coordinates[1]") && Contains("expected 2"));
  CHECK_THAT(refusal(geometry("LineString", "[[0, 0], [10]]")),
             Contains("coordinates[1]") && Contains("two or three numbers"));
  CHECK_THAT(refusal(geometry("LineString", "[[0, 0], [10, \"a\"]]")), Contains("coordinates[1]"));
  CHECK_THAT(refusal(geometry("LineString", "[[0, 0], [10, null]]")), Contains("coordinates[1]"));
  CHECK_THAT(refusal(geometry("LineString", "[[0, 0], [10, 0, 1, 2]]")),
             Contains("coordinates[1]"));
  CHECK_THAT(refusal(geometry("LineString", "[[0, 0], [10, NaN]]")), Contains("is no JSON"));
  CHECK_THAT(refusal(geometry("LineString", "[[0, 0], [10, 1e999]]")), Contains("no JSON"));
  CHECK_THAT(refusal(geometry("LineString", "[[0, 0], [1e10, 0]]")), Contains("within 1e9 m"));
  CHECK_THAT(refusal(geometry("LineString", "[]")), Contains("one place"));
  CHECK_THAT(refusal(geometry("LineString", "{}")), Contains("expected a list"));
  CHECK_THAT(refusal(geometry("LineString", "[[0, 0], [50, 0], [50, 50]]")),
             Contains("coordinates[1]: the line turns by 90 degrees"));
  CHECK_THAT(refusal(std::string(1000, '{')), Contains("nested too deep") || Contains("no JSON"));
  std::string deep;
  for (int i = 0; i < 100'000; ++i) deep += R"({"type":"GeometryCollection","geometries":[)";
  CHECK_THAT(refusal(deep), Contains("nested too deep"));
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
  CHECK(made_of(with(utm32), {.height = 0}).codes().empty());
  const Made other = made_of(with(utm32), {.height = 0, .environment_crs = wkt});
  CHECK(other.codes() == Codes{"line-crs"});
  CHECK_THAT(other.text(), Contains("EPSG:25832") && Contains("EPSG:25833"));
  CHECK(made_of(with("EPSG:25833"), {.height = 0, .environment_crs = wkt}).codes().empty());
  CHECK(made_of(with("mine"), {.height = 0, .environment_crs = wkt}).codes().empty());
  for (const char* globe : {"urn:ogc:def:crs:OGC:1.3:CRS84", "EPSG:4326"}) {
    CHECK_THAT(refusal_by(with(globe), {.height = 0}), Contains("longitude and latitude"));
  }
  CHECK(made_of(collection(feature(geometry("LineString", "[[0, 0], [10, 0]]")),
                           R"("crs": {"properties": [1]}, )"),
                {.height = 0})
            .poses.size() == 101);
}

TEST_CASE("what is odd about a line is said with numbers") {
  // A circle of 20 m, closed, in legs of 3.5 m, that leave it by 76 mm.
  std::string circle = "x,y\n";
  for (int i = 0; i < 36; ++i) {
    circle += std::to_string(20 * std::cos(i * kPi / 18)) + "," +
              std::to_string(20 * std::sin(i * kPi / 18)) + "\n";
  }
  circle += "20.000000,0.000000\n";
  const Made closed = made_of(circle, {.height = 0});
  CHECK(closed.codes() == Codes{"note line-closed", "note line-curved"});
  CHECK_THAT(closed.text(), Contains("0.07") && Contains("beside the straight legs"));
  CHECK(close(closed.poses.front(), 20, 0, 0));
  CHECK(close(closed.poses.back(), 20, 0, 0));
  const Made coarse = made_of("x,y\n0,0\n100,0\n200,20\n300,60\n", {.height = 0});
  CHECK(coarse.codes() == Codes{"line-curved"});
  const Made hill = made_of("x,y,z\n0,0,0\n100,0,0\n200,0,10\n300,0,10\n");
  CHECK(hill.codes() == Codes{"line-curved"});
  CHECK_THAT(hill.text(), Contains("0 m beside"));
  const Made steep = made_of("x,y,z\n0,0,0\n10,0,4\n");
  CHECK(steep.codes() == Codes{"line-steep"});
  CHECK_THAT(steep.text(), Contains("40 %") && Contains("vertex 1 at 0 0"));
}

TEST_CASE("a line of many vertices is read, and one of too many refused") {
  std::string text = "x,y,z\n";
  for (int i = 0; i < 100'000; ++i) text += std::to_string(i) + ",0,0\n";
  CHECK(made_of(text, {.step = 10}).poses.size() == 10'001);
  for (int i = 100'000; i < 1'000'001; ++i) text += std::to_string(i) + ",0,0\n";
  CHECK_THAT(refusal_by(text), Contains("line 1000002") && Contains("1,000,000"));
}

TEST_CASE("a line that is cut or changed anywhere is read or refused") {
  const std::string table =
      "x [m],y [m],z [m],station,cant [mm]\n0,0,1,5,0\n10,0,2,15,10\n20,1,3,25,20\n";
  const std::string json =
      collection(feature(geometry("LineString", "[[0, 0, 1], [10, 0, 2], [20, 1, 3]]")),
                 R"("crs": {"properties": {"name": "EPSG:25832"}}, )");
  const ReaderScratch scratch;
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
