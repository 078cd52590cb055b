// What `convert` makes and tells of LAS and LAZ, from files and from standard input.
#include "io/store/convert/convert.hpp"

#include <nlohmann/json.hpp>

#include "io/files/pending_file.hpp"
#include "support/bytes/laz/laz_samples.hpp"
#include "support/catch.hpp"
#include "support/clouds.hpp"
#include "support/store_fixture.hpp"
#include "tools/cli/support/program.hpp"

using namespace clearway;
using namespace clearway::test;
using nlohmann::json;
namespace fs = std::filesystem;

namespace {

/// Converts a file, and the same bytes from standard input, to file.h5 and pipe.h5.
void convert_both(const Workplace& work, const std::string& name, const std::string& options) {
  work.succeed("convert " + name + " --force -o file.h5" + options);
  require_success(work.run("convert - --force -o pipe.h5" + options, work.folder / name));
}

/// The JSON of a conversion of a LAS file.
json converted(const Workplace& work, const LasBytes& las) {
  work.put("a.las", las.build());
  return work.answer("convert --json --force a.las -o a.h5");
}

LasBytes::Record geo_keys(const std::vector<std::array<std::uint16_t, 2>>& keys) {
  std::vector<std::uint16_t> words{1, 1, 0, static_cast<std::uint16_t>(keys.size())};
  for (const auto& [key, value] : keys) words.insert(words.end(), {key, 0, 1, value});
  return {
      "LASF_Projection", 34735, {reinterpret_cast<const char*>(words.data()), words.size() * 2}};
}

LasBytes::Record wkt(const std::string& text) { return {"LASF_Projection", 2112, text}; }

}  // namespace

TEST_CASE("withheld points are told by convert and info, from files and from standard input") {
  const Workplace work;
  LasBytes las{.minor = 4, .format = 6};
  las.points = cube_cloud(200, -3000, 3000, 1);
  for (unsigned i = 0; i < 200; ++i) {
    las.bytes_of_flags.push_back(i % 4 == 3 ? 4 : i % 4 == 2 ? 9 : 0);
  }
  work.put("a.las", las.build());
  for (const bool pipe : {false, true}) {
    INFO((pipe ? "standard input" : "file"));
    const std::string input = pipe ? "-" : "a.las", end = " --json -o a.h5 --force";
    const fs::path from = pipe ? work.folder / "a.las" : fs::path();
    const Outcome left_out = require_success(work.run("convert " + input + end, from));
    check_says(left_out.err, "50 of 200 points (25 %) ... --keep-withheld");
    check_json(json_of(left_out), R"({
      "points": 150, "non_finite_points": 0, "withheld_points": 50, "kept_withheld_points": 0,
      "warnings": {"0": {"code": "withheld-points"}}})");
    const json store = work.answer("info --json a.h5");
    check_json(store, R"({"non_finite_points": 0, "withheld": {"points": 50, "kept": false}})");
    CHECK(store["withheld"]["cubes"] > 10);
    check_says(work.run("info a.h5").out, "50 points, left out, in ");
    const Outcome kept = work.run("convert --keep-withheld " + input + end, from);
    check_lacks(kept.err, "--keep-withheld");
    check_json(json_of(kept), R"({"kept_withheld_points": 50})");
    check_json(work.answer("info --json a.h5"), R"({"points": 200, "withheld": {"kept": true}})");
  }
  check_json(work.answer("info --json a.las"), R"({"points": 200, "flags":
             {"synthetic": 50, "key_point": 0, "withheld": 50, "overlap": 50}})");
}

TEST_CASE("convert --origins-path gives a moving scanner's points their origins, and says how") {
  const Workplace work;
  LasBytes las{.minor = 4, .format = 6, .global_encoding = 1};
  las.scale = {0.001, 0.001, 0.001};
  las.offset = {0, 0, 0};
  las.points = {{5000, 0, 0}, {6000, 0, 0}, {7000, 0, 0}, {8000, 0, 0}};
  // 2286 weeks after 1980-01-06, less 10^9.
  const double sunday = 2286 * 604800.0 - 1e9;
  las.times = {sunday + 1000.25, sunday + 1001, sunday + 1002, sunday + 1003.5};
  work.put("a.las", las.build());
  work.put("p.txt",
           "1000 0 0 0 0 0 0 1\n1001 2 0 0 0 0 0 1\n1002 4 0 0 0 0 1 0\n1003 6 0 0 0 0 1 0\n");
  const std::string path = " --trajectory-format tum --origins-path p.txt";
  const std::string convert = "convert a.las -o a.h5" + path;
  const Outcome outcome = work.succeed(convert + " --lever-arm 50cm,0,1 --json");
  const json report = json_of(outcome);
  check_json(report, R"({"origins": {"distinct": 3, "points_without": 1}, "origins_path": {
    "point_clock": "adjusted", "path_clock": "week-seconds", "first_pose": 1000.0,
    "last_pose": 1003.0, "before": 0, "after": 1, "in_gaps": 0, "without_time": 0}})");
  CHECK(report["origins_path"]["first_point"] == las.times[0]);
  CHECK(report["origins_path"]["last_point"] == las.times[3]);
  CHECK(report["origins_path"]["shifts"] == json{-sunday});
  check_says(outcome.err,
             "(adjusted standard GPS time, by the header) ... seconds of the GPS week ... exact");
  check_says(work.run("info a.h5").out, "a path and the GPS times of the points");
  work.check({{convert + " --lever-arm 50cm,0,1 --resume"},
              {convert + " --lever-arm 51cm,0,1 --resume", 2},
              {convert + " --origins x.csv --force", 2, "one of the two"},
              {"convert a.las -o b.h5 --lever-arm 1,0,0", 2, "lever arm"}});
  // Of standard input, whose CRS is known before its points, the times are kept too.
  const Outcome piped = require_success(
      work.run("convert - -o c.h5 --lever-arm 0.5,0,1 --json" + path, work.folder / "a.las"));
  CHECK(json_of(piped)["origins"]["hash"] == report["origins"]["hash"]);
}

TEST_CASE("LAZ from a file and from standard input makes the store of its LAS twin") {
  const Workplace work;
  LazBytes laz = laz_bytes(7, 5000);
  laz.chunks = {300};
  laz.las.points = positions_of(laz.points);
  work.put("a.laz", laz.build());
  work.put("a.las", laz.las.build());
  work.succeed("convert a.las --cell-points 100 -o las.h5");
  convert_both(work, "a.laz", " --cell-points 100");
  const StoreReader las(work.folder / "las.h5");
  for (const char* name : {"file.h5", "pipe.h5"}) {
    const StoreReader store(work.folder / name);
    CHECK(stored_points(store) == stored_points(las));
    CHECK(store.quantisation() == las.quantisation());
  }
}

TEST_CASE("standard input makes the store of the file but for the description of its source") {
  const Workplace work;
  LasBytes las{.minor = 4, .format = 6, .global_encoding = 16};
  las.points = cube_cloud(5000, -3000, 3000, 1);
  las.evlrs = {wkt(R"(LOCAL_CS["m",UNIT["metre",1]])")};
  work.put("a.las", las.build());
  for (const std::string options : {"", " --scale 0.01", " --layout regular:5"}) {
    CAPTURE(options);
    convert_both(work, "a.las", " --cell-points 100" + options);
    const StoreReader file(work.folder / "file.h5"), pipe(work.folder / "pipe.h5");
    CHECK(pipe.fingerprint() == file.fingerprint());
    CHECK(std::ranges::equal(pipe.top_tree(), file.top_tree()));
    CHECK(pipe.metadata().unit == file.metadata().unit);
    CHECK(pipe.metadata().crs_wkt == file.metadata().crs_wkt);
    check_says(pipe.metadata().crs_wkt, "LOCAL_CS");
    CHECK(stored_points(pipe) == stored_points(file));
    CHECK(pipe.metadata().sources == std::vector<SourceFile>{{"-", 0, 0}});
  }
}

TEST_CASE("a store keeps few and short warnings") {
  std::vector<Message> many(99,
                            {Message::Severity::kWarning, "same-place", std::string(5000, 'x')});
  many.push_back({Message::Severity::kWarning, "cut-off", std::string(5000, 'x')});
  const std::vector<Message> kept = kept_warnings(many);
  REQUIRE(kept.size() == 64);
  CHECK(kept[0].code == "cut-off");  // which puts answers in doubt
  CHECK(kept[0].text.size() < 1010);
  CHECK(kept[63].code == "more-warnings");
  CHECK(kept[63].numbers[0].second == 37);
  CHECK(kept_warnings({}).empty());
}

TEST_CASE("keys and texts that name two units are warned of") {
  const Workplace work;
  const auto utm = geo_keys({{1024, 1}, {3072, 25832}, {3076, 9001}});
  const auto utm_in_feet = geo_keys({{1024, 1}, {3072, 25832}, {3076, 9003}});
  const auto plane = geo_keys({{1024, 1}, {3072, 2230}, {3076, 9003}, {4099, 9003}});
  const auto plane_in_metres = geo_keys({{1024, 1}, {3072, 2230}, {3076, 9001}});
  const auto heights_in_feet = geo_keys({{1024, 1}, {4099, 9003}});
  const auto feet = geo_keys({{1024, 1}, {3076, 9003}});
  const struct {
    std::vector<LasBytes::Record> records;
    double east, north;  ///< in the unit that the keys name, on the map that they name
    bool warned;
  } rows[] = {{{utm}, 500'000, 5'300'000, false},
              {{plane}, 6'500'000, 2'100'000, false},
              {{utm_in_feet}, 1'640'000, 17'390'000, true},
              {{plane_in_metres}, 1'980'000, 640'000, true},
              {{heights_in_feet}, 0, 0, true},
              {{feet, wkt(R"(LOCAL_CS["any",UNIT["metre",1]])")}, 0, 0, true}};
  for (const auto& [records, east, north, warned] : rows) {
    CAPTURE(east, north);
    LasBytes las;
    las.points = {{0, 0, 0}, {1000, 1000, 1000}};
    las.vlrs = records;
    las.offset = {east, north, 0};
    const auto codes = codes_in(converted(work, las)["warnings"]);
    CHECK((std::ranges::count(codes, "units-contradict") > 0) == warned);
  }
}

TEST_CASE("scans whose GeoTIFF keys or texts name different systems are warned of by both names") {
  const Workplace work;
  const auto keys = [](std::uint16_t code) { return geo_keys({{1024, 1}, {3072, code}}); };
  const auto text = [](const std::string& name, const std::string& code) {
    return wkt("PROJCS[\"" + name +
               R"(",GEOGCS["ETRS89",DATUM["European_Terrestrial_Reference_System_1989",)"
               R"(SPHEROID["GRS 1980",6378137,298.257222101]],PRIMEM["Greenwich",0],)"
               R"(UNIT["degree",0.0174532925199433]],PROJECTION["Transverse_Mercator"],)"
               R"(UNIT["metre",1])" +
               (code.empty() ? "" : ",AUTHORITY[\"EPSG\",\"" + code + "\"]") + "]");
  };
  const std::string zone = "ETRS89 / UTM zone 32N";
  const struct {
    LasBytes::Record a, b;
    std::string_view words;
  } rows[] = {
      {keys(25832), keys(25832), ""},
      {text(zone, "25832"), keys(25832), ""},
      {keys(25832), text(zone, "25832"), ""},
      {text("one", "25832"), text("the same", "25832"), ""},
      {keys(25832), keys(25833),
       "b.las: another coordinate reference system ( ... EPSG:25833 ... a.las ( ... "
       "EPSG:25832 ... may not fit together"},
      {text(zone, "25832"), keys(25833), "EPSG:25833 ... ETRS89 / UTM zone 32N, EPSG:25832"},
      {text("site grid", ""), keys(25833), "EPSG:25833 ... site grid, without an EPSG code"},
      {text("one", ""), text("two", ""), "(two, ... (one,"}};
  for (const auto& [a, b, words] : rows) {
    LasBytes las;
    las.vlrs = {a};
    work.put("a.las", las.build());
    las.vlrs = {b};
    work.put("b.las", las.build());
    std::string found;
    const json report = work.answer("convert --json --force a.las b.las -o ab.h5");
    for (const json& one : report["warnings"]) {
      if (one["code"] == "other-crs") found += one["message"].get<std::string>();
    }
    check_says(found, words);
  }
}

TEST_CASE("two writers of one output: the second is refused and leaves the first alone") {
  const Workplace work;
  work.put("scan.xyz", "1 2 3\n4 5 6\n");
  {
    const PendingFile first(work.folder / "two.h5", true);
    check_outcome(work.run("convert scan.xyz --force -o two.h5"), 4,
                  "another process is writing it");
    CHECK(fs::exists(first.partial()));
  }
  CHECK_FALSE(work.has("two.h5.partial"));
  work.put("two.h5.partial", "left by one that was killed");
  work.succeed("convert scan.xyz --force -o two.h5");
  work.succeed("convert scan.xyz -o one.h5");
  check_same(work.bytes("two.h5"), work.bytes("one.h5"));
}

TEST_CASE("a damaged store is named by verify, by a run and by a conversion that is resumed") {
  const Workplace work;
  work.put("scan.xyz", "1 2 3\n4 5 6\n2 3 4\n7 8 9\n");
  work.put("path.txt", pose_at(0));
  work.succeed("convert scan.xyz -o site.h5");
  const std::string sound = work.bytes("site.h5");
  const std::vector<std::uint64_t> chunks =
      StoreReader(work.folder / "site.h5").chunks()[0].address;
  REQUIRE(chunks.size() == 4);  // x, y, z and the source indices of one cell
  for (const std::uint64_t chunk : chunks) {
    std::string damaged = sound;
    damaged[chunk + 2] = static_cast<char>(damaged[chunk + 2] ^ 1);
    work.put("site.h5", damaged);
    check_outcome(work.run("convert scan.xyz -o site.h5 --resume"), 2,
                  "site.h5: cell 0:  ... is damaged ... --force instead of --resume overwrites it");
    check_same(work.bytes("site.h5"), damaged);
    check_outcome(work.run("verify site.h5"), 1, kAnything, "cell 0 ... damaged");
    check_refused(work.run("run --env site.h5 --model box:1,1,1 --trajectory path.txt "
                           "--radius 9 -o out.h5"),
                  3, "cell 0");
    CHECK_FALSE((work.has("out.h5") || work.has("out.h5.partial")));
  }
  work.succeed("convert scan.xyz -o site.h5 --force");
  check_same(work.bytes("site.h5"), sound);
}
