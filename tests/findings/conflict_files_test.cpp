// Files of conflicts: coordinate reference systems, strings, and what cannot be written.
#include <sqlite3.h>

#include <cstring>
#include <nlohmann/json.hpp>

#include "clearway/error.hpp"
#include "findings/conflict_fixture.hpp"
#include "io/files/json.hpp"
#include "io/result/answer.hpp"
#include "io/result/conflicts/bcf/bcf_text.hpp"
#include "io/result/conflicts/conflict_fields.hpp"
#include "io/result/conflicts/markup_text.hpp"
#include "io/result/conflicts/write_conflicts.hpp"
#include "io/scans/scan_crs.hpp"
#include "support/compare.hpp"
#include "support/text_rows.hpp"

using namespace clearway;
using namespace clearway::test;
using nlohmann::json;

namespace {

constexpr const char* kUtm =
    R"(PROJCS["ETRS89 / UTM zone 32N",GEOGCS["ETRS89",DATUM["European_Terrestrial_Reference_System_1989",SPHEROID["GRS 1980",6378137,298.257222101]],PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433]],PROJECTION["Transverse_Mercator"],PARAMETER["latitude_of_origin",0],PARAMETER["central_meridian",9],PARAMETER["scale_factor",0.9996],PARAMETER["false_easting",500000],PARAMETER["false_northing",0],UNIT["metre",1],AUTHORITY["EPSG","25832"]])";
constexpr const char* kOwn =
    R"(PROJCS["Site \ grid ""A""",GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563]],PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433]],PROJECTION["Transverse_Mercator"],PARAMETER["latitude_of_origin",0],PARAMETER["central_meridian",9],PARAMETER["scale_factor",1],PARAMETER["false_easting",0],PARAMETER["false_northing",0],UNIT["metre",1]])";

/// Two conflicts of three points in a written file.
struct Written {
  explicit Written(const std::string& wkt, std::span<const double> station = {})
      : options{.min_points = 3, .station = station} {
    ResultHeader header = found.header();
    header.crs_wkt = wkt;
    write_result(folder / "out.h5", header, found.rows());
  }

  std::string write(ConflictFormat format) const {
    const Result result(folder / "out.h5");
    std::vector<std::uint32_t> conflict_of;
    const Conflicts conflicts = find_conflicts(result, found.poses, options, &conflict_of);
    REQUIRE(conflicts.listed.size() == 2);
    const Answer answer = counted_answer(result.reader());
    const ConflictFile file{conflicts, options, result.reader().header(), answer, found.poses, {}};
    const ConflictPictures pictures{conflict_points(result.reader(), conflicts, conflict_of), {}};
    write_conflicts(file, pictures, format, folder / "out");
    return bytes_of(folder / "out");
  }

  json parsed(ConflictFormat format) const { return json::parse(write(format)); }

  /// The first value of a query of the GeoPackage that was written, as text.
  std::string value(const std::string& sql) const {
    sqlite3* database = nullptr;
    sqlite3_stmt* statement = nullptr;
    REQUIRE(sqlite3_open_v2((folder / "out").c_str(), &database, SQLITE_OPEN_READONLY, nullptr) ==
            SQLITE_OK);
    REQUIRE(sqlite3_prepare_v2(database, sql.c_str(), -1, &statement, nullptr) == SQLITE_OK);
    REQUIRE(sqlite3_step(statement) == SQLITE_ROW);
    const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(statement, 0));
    const std::string out(text == nullptr ? "null" : text);
    sqlite3_finalize(statement);
    sqlite3_close(database);
    return out;
  }

  Found found{
      .quanta = {{0, 0, 0}, {100, 0, 0}, {200, 50, 0}, {9000, 0, 0}, {9100, 0, 0}, {9200, 0, 0}},
      .quantisation = {{0.001, 0.001, 0.001}, {500'000, 4'000'000, 100}},
      .poses = {translation({500'000, 4'000'000, 100})}};
  ConflictOptions options;
  ScratchFolder folder;
};

}  // namespace

TEST_CASE("text in pages and BCF is escaped for elements and attributes") {
  check_equal(markup_text("a < b & \"c\" > d\n"), "a &lt; b &amp; &quot;c&quot; &gt; d ");
  CHECK(markup_text("\xff") == "\xEF\xBF\xBD");
}

TEST_CASE("GeoJSON names the coordinate reference system of the scans") {
  const auto name = [](const std::string& wkt) {
    const json all = Written(wkt).parsed(ConflictFormat::kGeoJson);
    CHECK(all["features"][0]["geometry"]["coordinates"][1].get<double>() > 3'999'999);
    return all["crs"]["properties"]["name"].get<std::string>();
  };
  check_equal(name(kUtm), "urn:ogc:def:crs:EPSG::25832");
  check_says(name(kOwn), "PROJCS[\"Site");
  check_equal(name("no \"text\" \\ that\nPROJ knows"), "no \"text\" \\ that\nPROJ knows");
  CHECK_THAT(name(""), StartsWith("LOCAL_CS"));
}

TEST_CASE("a GeoPackage has the scans' system, its layers and its marks") {
  const Written written(kUtm);
  const std::string bytes = written.write(ConflictFormat::kGeoPackage);
  check_equal(bytes.compare(0, 15, "SQLite format 3"), 0);
  check_equal(bytes.compare(68, 4, "GPKG"), 0);
  for (const auto& row : text_rows(R"(
    PRAGMA integrity_check                                                     | ok
    SELECT count(*) FROM pragma_foreign_key_check                              | 0
    SELECT organization FROM gpkg_spatial_ref_sys WHERE srs_id = 25832         | EPSG
    SELECT organization_coordsys_id FROM gpkg_spatial_ref_sys WHERE srs_id = 25832 | 25832
    SELECT count(*) FROM gpkg_contents WHERE srs_id = 25832                    | 3
    SELECT last_change FROM gpkg_contents                                      | 2000-01-01T00:00:00.000Z
    SELECT min_x FROM gpkg_contents WHERE table_name = 'footprints'            | 500000.0
    SELECT points FROM conflicts WHERE id = 2                                  | 3
    SELECT least_distance FROM conflicts WHERE id = 2                          | null
    SELECT typeof(source) FROM stretches                                       | integer
    SELECT length(geom) - (8 + 5 + 24) FROM conflicts                          | 0
    SELECT length(geom) - (8 + 32 + 13 + 5 * 24) FROM footprints               | 0
    SELECT length(geom) - (8 + 32 + 9 + 2 * 24) FROM stretches                 | 0
  )")) {
    const RowName name(row[0]);
    check_equal(written.value(row[0]), row[1]);
  }
}

TEST_CASE("a GeoPackage keeps systems that have no number, and goes without any") {
  const std::pair<const char*, const char*> rows[] = {
      {kOwn, "PROJCS[\"Site"}, {"it's no WKT", "it's no WKT"}, {"", ""}};
  for (const auto& [wkt, definition] : rows) {
    const RowName name(wkt);
    const Written written(wkt);
    written.write(ConflictFormat::kGeoPackage);
    check_equal(written.value("SELECT srs_id FROM gpkg_contents"), *wkt == 0 ? "-1" : "100000");
    if (*wkt == 0) continue;
    CHECK_THAT(written.value("SELECT definition FROM gpkg_spatial_ref_sys WHERE srs_id = 100000"),
               StartsWith(definition));
  }
}

TEST_CASE("files of conflicts have stations where the trajectory has them, and only there") {
  const std::vector<double> station{1234.5}, two{1, 2};
  const Written with("", station), without("");
  const std::string csv = with.write(ConflictFormat::kCsv);
  check_says(csv, ",chainage_to,station_from,station_to,least_distance,");
  check_says(csv, ",0,0,0,0,1234.5,1234.5,,");
  for (const auto format : {ConflictFormat::kJson, ConflictFormat::kGeoJson}) {
    check_says(with.write(format), "\"station_to\": 1234.5");
  }
  for (const auto format : {ConflictFormat::kCsv, ConflictFormat::kJson, ConflictFormat::kGeoJson,
                            ConflictFormat::kBcf}) {
    check_lacks(without.write(format), "station");
  }
  with.write(ConflictFormat::kGeoPackage);
  check_equal(with.value("SELECT typeof(station_from) || station_to FROM stretches WHERE id = 2"),
              "real1234.5");
  // Small groups stand in for conflicts, and have stations too.
  ConflictOptions options{.min_points = 4, .station = station};
  const Result result(with.folder / "out.h5");
  const Conflicts found = find_conflicts(result, with.found.poses, options);
  REQUIRE(found.listed.empty());
  check_equal(found.small.at(1).station_to, 1234.5);
  const Answer answer = counted_answer(result.reader());
  const ConflictFile file{found, options, result.reader().header(), answer, with.found.poses, {}};
  check_says("{" + member_lines(summary_of(file)) + "}", "\"station_from\": 1234.5");
  options.station = two;
  check_refused([&] { return find_conflicts(result, with.found.poses, options); },
                "2 stations for 1 pose");
}

TEST_CASE("a topic of BCF names the stations of its conflict") {
  const Found found{.quanta = {{0, 0, 0}}};
  const ResultHeader header = found.header();
  Conflicts conflicts;
  conflicts.listed.push_back(
      {.id = 1, .chainage_to = 12.5, .station_from = 1250, .station_to = 1237.5});
  const ConflictOptions options;
  const Answer answer = answer_of(header);
  const ConflictFile file{conflicts, options, header, answer, found.poses, {}};
  check_says(bcf_markup(file, conflicts.listed[0]),
             "Conflict 1 at 0 m to 12.5 m, station 1250 to 1237.5 m");
}

TEST_CASE("a topic of BCF says how much is missing, or that the model is touched") {
  const Found found{.quanta = {{0, 0, 0}}};
  const ResultHeader header = found.header();
  const ConflictOptions options;
  const Answer answer = answer_of(header);
  struct Row {
    double least, missing;
    Bound is;
    const char* words;
  };
  for (const Row& row : {Row{0, 0.1, Bound::kExact, "; 0.100 m are missing."},
                         Row{0, 0.1, Bound::kAtLeast, "; it touches the model."},
                         Row{0.02, 0.08, Bound::kAtLeast, "; at least 0.080 m are missing."}}) {
    Conflicts conflicts;
    conflicts.listed.push_back({.id = 1,
                                .least_distance = row.least,
                                .nearest_pose = 0,
                                .encroachment = row.missing,
                                .encroachment_is = row.is});
    const ConflictFile file{conflicts, options, header, answer, found.poses, {}};
    check_says(bcf_markup(file, conflicts.listed[0]), row.words);
  }
}

TEST_CASE("strings of JSON are escaped, and bytes that are not UTF-8 replaced") {
  check_equal(json_string("a\"b\\c\n\x01"), "\"a\\\"b\\\\c\\u000a\\u0001\"");
  CHECK(json_string("\xc3\xa4 \xe2\x82\xac \xf0\x9f\x9a\x82") ==
        "\"\xc3\xa4 \xe2\x82\xac \xf0\x9f\x9a\x82\"");
  for (const char* bad : {"\xc3", "\x80", "\xc0\x80", "\xed\xa0\x80", "\xf5\x80\x80\x80",
                          "\xe2\x82", "\xf0\x80\x80\x80"}) {
    INFO(json_string(bad));
    check_equal(json::parse(json_string(bad)).get<std::string>().find("\xef\xbf\xbd"), 0);
  }
  check_equal(json_number(0.1), "0.1");
  check_equal(json_number(std::nan("")), "null");
}

TEST_CASE("every file of conflicts is JSON, CSV or binary as its name says") {
  CHECK(conflict_format_of("a.CSV") == ConflictFormat::kCsv);
  CHECK(conflict_format_of("a.bcfzip") == ConflictFormat::kBcf);
  for (const char* name : {"a", "a.xml", ".csv", "a.csv.gz", "gpkg"}) {
    CHECK_THROWS_AS(conflict_format_of(name), UsageError);
  }
}

TEST_CASE("a full disk is an error of the machine in every format") {
  if (!std::filesystem::exists("/dev/full")) return;
  const Written written("");
  std::filesystem::create_symlink("/dev/full", written.folder / "out");
  for (const auto format : {ConflictFormat::kCsv, ConflictFormat::kJson, ConflictFormat::kGeoJson,
                            ConflictFormat::kGeoPackage, ConflictFormat::kBcf}) {
    CHECK_THROWS_AS(written.write(format), ResourceError);
  }
}
