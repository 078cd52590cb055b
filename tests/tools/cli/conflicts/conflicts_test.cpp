// clearway conflicts and compare --conflicts, through the built program.
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <sstream>

#include "support/catch.hpp"
#include "tools/cli/support/hall.hpp"

using namespace clearway;
using namespace clearway::test;
using nlohmann::json;

namespace {

/// A result of the hall whose conflicts are many and have distances.
struct HallResult : Work {
  HallResult() {
    require_success(run_hall("hall/site.h5", "out.h5", "--force --first-pose --clearance 0.2"));
  }

  Outcome conflicts(const std::string& options, const std::string& result = "out.h5") const {
    return run("conflicts " + result + " --trajectory hall/trajectory.txt " + options);
  }
  json listed(const std::string& options) const {
    require_success(conflicts("--force -o listed.json " + options));
    return json::parse(bytes("listed.json"));
  }
};

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> out;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) out.push_back(line);
  return out;
}

bool is_installed(const char* program) {
  return std::system(("command -v " + std::string(program) + " >/dev/null 2>&1").c_str()) == 0;
}

/// The output of another project's program about a file; empty where the program is not installed.
std::string said_by(const std::string& program, const std::string& arguments, const Work& work) {
  if (!is_installed(program.c_str())) {
    WARN(program << " is not installed: not tested");
    return "";
  }
  const Outcome outcome = run_program_at(program, work.folder, arguments);
  check_outcome(outcome, 0);
  check_lacks(outcome.err, "ERROR");
  check_lacks(outcome.err, "Warning");
  return outcome.out;
}

}  // namespace

TEST_CASE("conflicts are listed in JSON and CSV, and no point is lost") {
  const HallResult work;
  const json all = work.listed("--min-points 3 -o listed.csv");
  REQUIRE(all["conflicts"].size() > 2);
  std::uint64_t points = all["small_points"];
  double chainage = 0;
  std::uint64_t id = 0;
  for (const json& c : all["conflicts"]) {
    CHECK(c["id"] == ++id);
    CHECK(c["chainage_from"] >= chainage);
    chainage = c["chainage_from"];
    points += c["points"].get<std::uint64_t>();
    CHECK(c["points"] >= 1);
    for (int k = 0; k < 3; ++k) {
      CHECK(c["lo"][k] <= c["centroid"][k]);
      CHECK(c["centroid"][k] <= c["hi"][k]);
    }
    CHECK(c["first_pose"] <= c["last_pose"]);
    CHECK(c["least_distance"].get<double>() < 0.1);
    CHECK(c["encroachment"] == 0.1 - c["least_distance"].get<double>());
    CHECK(c["encroachment_is"] == "at-least");
    CHECK(c["side"] != "unknown");
    CHECK(c["first_touch"] != "unknown");
  }
  CHECK(points == all["colliding_points"]);
  CHECK(all["conflict_count"] == all["conflicts"].size());
  check_json(all, R"({"radius": 0.1, "gap": 0.3, "split": 25, "poses": 150})");
  CHECK(all["warnings"].is_array());

  const auto rows = lines_of(work.bytes("listed.csv"));
  REQUIRE(rows.size() == 1 + all["conflicts"].size());
  CHECK(rows[0] ==
        "id,rank,points,source,lo_x,lo_y,lo_z,hi_x,hi_y,hi_z,centroid_x,centroid_y,centroid_z,"
        "first_pose,last_pose,chainage_from,chainage_to,least_distance,nearest_pose,nearest_source,"
        "encroachment,encroachment_is,side,first_touch,trim_left,trim_right,trim_above,trim_below,"
        "lateral,height,group,depth,points_inside,depth_source,obstacle_chainage,own_shift_left,"
        "own_shift_right,main_class,main_class_points,small_groups,small_points");
  CHECK_THAT(rows[1], StartsWith("1," + all["conflicts"][0]["rank"].dump() + "," +
                                 all["conflicts"][0]["points"].dump() + "," +
                                 all["conflicts"][0]["source"].dump() + ","));
}

TEST_CASE("a table and a summary are printed") {
  const HallResult work;
  check_outcome(
      work.conflicts("--show 2 --min-points 3"), 0, kAnything,
      "conflicts of ... along ... not listed:  ... the worst 2, lengths in m: ... missing ... The "
      "worst place is conflict");
  for (const std::string& line : lines_of(work.conflicts("--show 20 --min-points 3").out)) {
    CAPTURE(line);
    if (!line.empty() && (line.front() == ' ' || line.find(" - ") < 12)) CHECK(line.size() <= 100);
  }
  const json summary = json_of(work.conflicts("--json"));
  check_json(summary, R"({"kind": "conflicts"})");
  CHECK(!summary.contains("conflicts"));
  check_json(json_of(work.conflicts("--json --gap 10cm --split 2m")), R"({"gap": 0.1})");
}

TEST_CASE("threads and the store's cells change no byte of any format") {
  const HallResult work;
  const auto write = [&](const std::string& name, const std::string& more,
                         const std::string& result = "out.h5") {
    std::string outputs;
    for (const std::string ending : {"csv", "json", "geojson", "gpkg", "bcf"}) {
      outputs += " -o " + name + "." + ending;
    }
    require_success(work.conflicts("--min-points 6 " + more + outputs, result));
    std::string all;
    for (const std::string ending : {"csv", "json", "geojson", "gpkg", "bcf"}) {
      all += work.bytes(name + "." + ending);
    }
    return all;
  };
  const std::string one = write("one", "--threads 1");
  CHECK(write("two", "--threads 2") == one);
  CHECK(write("seven", "--threads 7") == one);
  work.succeed("convert hall/environment.las -o other.h5 --cell-points 500");
  require_success(work.run_hall("other.h5", "other_out.h5", "--first-pose --clearance 0.2"));
  CHECK(write("other", "", "other_out.h5") == one);
  CHECK(write("dated", "--date 2025-03-31") != one);
}

TEST_CASE("GeoJSON and GeoPackage open in GDAL") {
  const HallResult work;
  const json all = work.listed("-o c.geojson -o c.gpkg");
  const std::string count = all["conflicts"].size() == 0 ? "" : all["conflict_count"].dump();
  REQUIRE(!count.empty());
  const json features = json::parse(work.bytes("c.geojson"));
  check_json(features, R"({
    "type": "FeatureCollection", "features": {"0": {"geometry": {"type": "Point"}},
    "1": {"geometry": {"type": "Polygon"}}},
    "crs": {"properties": {"name": "LOCAL_CS[\"unknown\",UNIT[\"metre\",1]]"}}})");
  CHECK(features["features"].size() == 2 * all["conflicts"].size());
  CHECK(features["features"][1]["geometry"]["coordinates"][0].size() == 5);

  const std::string package = said_by("ogrinfo", "-so -al c.gpkg", work);
  const std::string json_text = said_by("ogrinfo", "-so -al c.geojson", work);
  if (package.empty() || json_text.empty()) return;
  check_says(
      package,
      "Layer name: conflicts ... Geometry: 3D Point ... Layer name: footprints ... Geometry: 3D "
      "Polygon ... Layer name: stretches ... Geometry: 3D Line String ... Feature Count: " +
          count +
          " ... encroachment: Real ... encroachment_is: String ... side: String ... first_touch: "
          "String "
          "... trim_left: Real ... lateral: Real ... height: Real ... own_shift_left: Real");
  check_says(json_text, "Feature Count: " + std::to_string(features["features"].size()));
  check_lacks(json_text, "WGS 84");
  const std::string first = said_by("ogrinfo", "c.gpkg conflicts -fid 1", work);
  check_says(first,
             "points (Integer64) = " + all["conflicts"][0]["points"].dump() + " ... POINT Z (");
}

TEST_CASE("BCF follows its schemas") {
  const HallResult work;
  require_success(work.conflicts("-o c.bcf --min-points 3 --model hall/model.ply"));
  require_success(work.conflicts("-o none.bcfzip --min-points 1000000"));
  const Outcome checked = run_program_at(CHECK_BCF, work.folder, "c.bcf none.bcfzip");
  check_outcome(checked, 0);
  // Where no conflict is listed, the small groups become topics.
  check_lacks(checked.out, "none.bcfzip: 0 topics");
  check_lacks(checked.out, "c.bcf: 0 topics");
}

TEST_CASE("conflicts of no colliding point are an empty list in every format") {
  const HallResult work;
  work.succeed(
      "run --env hall/site.h5 --model hall/model.ply --trajectory hall/trajectory.txt --radius "
      "1e-9 --first-pose -o none.h5");
  check_outcome(work.conflicts("-o n.csv -o n.json -o n.geojson -o n.gpkg -o n.bcf", "none.h5"), 0,
                kAnything, "no conflicts");
  CHECK(lines_of(work.bytes("n.csv")).size() == 1);
  check_json(json::parse(work.bytes("n.json")), R"({"conflicts": []})");
  check_json(json::parse(work.bytes("n.geojson")), R"({"features": []})");
  said_by("ogrinfo", "-so -al n.gpkg", work);
}

TEST_CASE("what conflicts cannot do is refused, and no output is left") {
  const HallResult work;
  require_success(work.run_hall("hall/site.h5", "set.h5"));
  check_refused(work.conflicts("-o c.csv", "set.h5"), 2, "makes a result with first poses");
  check_cases([&](const std::string& more) { return work.conflicts(more); },
              {
                  {"-o c.xml", 2, "unknown output format"},
                  {"--gap 0", 2, "--gap"},
                  {"--split=-1", 2, "0 or more"},
                  {"--split 1e-308", 2, "or more, or 0 for none"},
                  {"--min-points 1.5", 2, "--min-points: 1.5: expected a whole number from 1"},
                  {"--min-points 0", 2, "expected a whole number from 1"},
                  {"--chainage-start far", 2, "--chainage-start"},
                  {"--forward +z", 2, "same axis"},
                  {"--date 2025-02-30 -o c.bcf", 2, "--date"},
                  {"--memory 1M", 4, "--memory"},
              });
  work.put("other.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n");
  check_refused(work.run("conflicts out.h5 --trajectory other.txt -o c.csv"), 3,
                "another trajectory");
  work.put("other.xyz", "1 2 3\n4 5 6\n");
  check_refused(work.conflicts("--model other.xyz"), 3, "is not the model of");
  for (const char* name : {"c.csv", "c.csv.partial", "c.xml", "c.bcf.partial"}) {
    CHECK_FALSE(work.has(name));
  }
  work.put("kept.csv", "mine");
  check_refused(work.conflicts("-o kept.csv"), 2, "--force");
  check_same(work.bytes("kept.csv"), "mine");
  check_refused(work.conflicts("--force -o out.h5"), 2, "out.h5");
}

TEST_CASE("compare --conflicts tells new, gone and the same, and exits with 1 on new ones") {
  const HallResult work;
  work.succeed(
      "run --env hall/site.h5 --model hall/model.ply --trajectory hall/trajectory.txt --radius "
      "0.02 --first-pose -o fewer.h5");
  const auto compare = [&](const std::string& a, const std::string& b, const std::string& more) {
    return work.run("compare " + a + " " + b +
                    " --conflicts --trajectory hall/trajectory.txt --min-points 1 " + more);
  };
  check_outcome(compare("out.h5", "out.h5", ""), 6, kAnything,
                "no new conflicts ... about the same scan");
  check_json(json_of(compare("out.h5", "out.h5", "--gap 1e-300 --json")), R"({"new": []})");
  const Outcome small = work.run(
      "compare fewer.h5 out.h5 --conflicts --trajectory hall/trajectory.txt --min-points 1000000");
  check_outcome(small, 1, kAnything, "too small to be listed");
  const json all = json_of(check_outcome(compare("fewer.h5", "out.h5", "--json"), 1));
  CHECK(all["new"].size() > 0);
  CHECK(all["new"].size() + all["same"].size() == all["b"]["conflicts"]);
  check_json(all, R"({"questions": {"0": {"what": "radius"}}})");
  CHECK(all["gone"].size() + all["same"].size() >= all["a"]["conflicts"]);
  check_says(compare("fewer.h5", "out.h5", "--show 1").out,
             "queries differ: radius: 0.02 m / 0.1 m ... new, only in b:  ... new conflicts");
  const json back = json_of(compare("out.h5", "fewer.h5", "--json"));
  check_json(back, R"({"gone": []})");  // a smaller radius does not find them
  CHECK(back["not_searched"].size() >= all["new"].size());
  check_refused(work.run("compare out.h5 out.h5 --conflicts"), 2, "--trajectory");
  check_outcome(work.run("compare out.h5 out.h5 --gap 1"), 2);
}

namespace {

/// A car of four points that drives 20 m along x at a height of 0.5 m, and scans of its
/// surroundings.
struct Street : Work {
  Street() {
    put("path.txt", path_along_x(81, 0.25));
    put("half.txt", path_along_x(41, 0.25));
    put("car.xyz", "1 0.5 0.5\n1 -0.5 0.5\n-1 0.5 0.5\n-1 -0.5 0.5\n");
    put("car.obj", "v 1 0.5 0.5\nv 1 -0.5 0.5\nv -1 0.5 0.5\nv -1 -0.5 0.5\nf 1 2 3\nf 2 4 3\n");
  }

  /// Writes a scan of a post of 200 points with its face at y, and `more` lines.
  void scan(const std::string& name, double y, const std::string& more = "", int seed = 0) const {
    std::string text;
    for (int i = 0; i < 200; ++i) {
      const double shift = 0.001 * ((i * 7 + seed * 13) % 5 - 2);
      text += std::to_string(10 + 0.005 * (i % 20) + shift) + " " + std::to_string(y + shift) +
              " " + std::to_string(0.42 + 0.016 * (i / 20) + shift) + "\n";
    }
    put_bytes(folder / (name + ".xyz"), text + more);
    require_success(run("convert " + name + ".xyz -o " + name + "_site.h5"));
  }
  void search(const std::string& site, const std::string& output, const std::string& more = "",
              const std::string& model = "car.xyz", const std::string& along = "path.txt") const {
    require_success(run("run --env " + site + "_site.h5 --model " + model + " --trajectory " +
                        along + " --radius 0.1 --first-pose -o " + output + ".h5 " + more));
  }
  Outcome compare(const std::string& a, const std::string& b, const std::string& more = "") const {
    return run("compare " + a + ".h5 " + b + ".h5 --conflicts --trajectory path.txt " + more);
  }
};

}  // namespace

TEST_CASE("compare --conflicts names every other question, and calls none of them the same") {
  const Street street;
  street.scan("site", 0.55);
  street.search("site", "a", "--clearance 0.2");
  street.search("site", "box", "--clearance 0.2 --ignore-box 0,0,0,20,1,2");
  street.search("site", "half", "--clearance 0.2", "car.xyz", "half.txt");
  street.search("site", "ways", "--between-poses");
  street.search("site", "surface", "--clearance 0.2 --model-as surface", "car.obj");
  const auto differs = [&](const std::string& b, const std::string& what,
                           const std::string& more = "") {
    const Outcome outcome = street.compare("a", b, more);
    INFO(outcome.out + outcome.err);
    check_outcome(outcome, 1, kAnything, "queries differ: " + what + " ... --allow-other-question");
    const json all = json_of(street.compare("a", b, more + " --json"));
    check_json(all, R"({"holds": false})");
    CHECK(all["questions"].size() > 0);
  };
  differs("box", "ignored points");
  differs("half", "trajectory", "--trajectory-b half.txt");
  differs("ways", "motion");
  differs("surface", "model");
  const Outcome allowed = street.compare("a", "box", "--allow-other-question");
  check_outcome(allowed, 6);  // the box holds all points
  check_says(allowed.out, "the question is in doubt (all-ignored) ... which was allowed");
  check_outcome(street.compare("a", "ways", "--allow-other-question"), 0);
  check_outcome(street.compare("a", "a"), 6);
}

TEST_CASE("compare --conflicts tells what became worse, and writes it") {
  const Street street;
  street.scan("before", 0.58);
  street.scan("after", 0.53);
  street.search("before", "a", "--clearance 0.2");
  street.search("after", "b", "--clearance 0.2");
  const Outcome worse = street.compare("a", "b", "-o c.csv");
  INFO(worse.out + worse.err);
  check_outcome(worse, 1, kAnything, "worse by more than 0.02 m: 1 ... 1 conflict is worse");
  check_says(street.bytes("c.csv"), "status,id_a,id_b ... \nworse,1,1,");
  check_outcome(street.compare("b", "a"), 0);
  check_outcome(street.compare("a", "b", "--worse-by 0.1"), 0);
  check_outcome(street.compare("a", "b", "--force -o c.json"), 1);
  CHECK(json::parse(street.bytes("c.json"))["worse"].size() == 1);
  check_outcome(street.compare("a", "b", "-o c.html"), 1);
  check_says(street.bytes("c.html"),
             "<strong>Worse</strong> ... Question ... Plan ... Obstacles ... worse</span>");
  check_refused(street.compare("a", "b", "-o c.xml"), 2, "unknown output format");
  check_refused(street.compare("a", "b", "-o c.csv"), 2, "--force");
}

TEST_CASE("compare --conflicts finds a rescan the same, and a new cable") {
  const Street street;
  street.scan("before", 0.55);
  street.scan("again", 0.55, "", 3);
  street.scan("cable", 0.55, "5 0.55 0.5\n5 0.56 0.5\n5 0.57 0.5\n", 3);
  for (const char* name : {"before", "again", "cable"})
    street.search(name, name, "--clearance 0.2");
  const Outcome same = street.compare("before", "again");
  INFO(same.out + same.err);
  check_outcome(same, 0, kAnything, "the same in both: 1\n");
  const Outcome cable = street.compare("before", "cable");
  check_outcome(cable, 1, kAnything, "new groups that are too small to be listed: 1");
  check_json(json_of(street.compare("before", "cable", "--json")), R"({
    "new_small": {"0": {"points": 3}}})");
  // A cable that both scans have is not new, but one at another place is.
  street.scan("later", 0.55, "5 0.55 0.5\n5 0.56 0.5\n5 0.57 0.5\n", 5);
  street.search("later", "later", "--clearance 0.2");
  check_outcome(street.compare("cable", "later"), 0);
  street.scan("moved", 0.55, "7 0.55 0.5\n7 0.56 0.5\n7 0.57 0.5\n");
  street.search("moved", "moved", "--clearance 0.2");
  check_outcome(street.compare("cable", "moved"), 1);
}

TEST_CASE("conflicts of a few points are told by the headline and by every output") {
  const Street street;
  street.put("cable.xyz", "5 0.55 0.5\n5 0.56 0.5\n5 0.57 0.5\n");
  street.succeed("convert cable.xyz -o cable_site.h5");
  street.search("cable", "cable");
  std::string outputs;
  for (const char* ending : {"csv", "json", "geojson", "gpkg", "bcf"}) {
    outputs += " -o " + std::string("c.") + ending;
  }
  const Outcome outcome =
      street.run("conflicts cable.h5 --trajectory path.txt --min-points 10" + outputs);
  INFO(outcome.out + outcome.err);
  check_outcome(outcome, 0, kAnything,
                "3 points collide ... 1 group of fewer than 10 ... 5.000 0.560 0.500 ... "
                "--min-points 1 lists it");
  const auto rows = lines_of(street.bytes("c.csv"));
  REQUIRE(rows.size() == 2);
  CHECK_THAT(rows[1], StartsWith("0,0,3,0,5,") && EndsWith(",1,3"));
  check_json(json::parse(street.bytes("c.json")), R"({"small": {"0": {"points": 3}}})");
  const json features = json::parse(street.bytes("c.geojson"));
  REQUIRE(features["features"].size() == 1);
  check_json(features, R"({"features": {"0": {"properties": {"shape": "small group"}}}})");
  const std::string package = said_by("ogrinfo", "-so -al c.gpkg", street);
  if (!package.empty()) CHECK_THAT(package, Contains("Layer name: small_groups"));
  const Outcome checked = run_program_at(CHECK_BCF, street.folder, "c.bcf");
  CHECK_THAT(checked.out, Contains("c.bcf: 1 topics") || Contains("c.bcf: 1 topic"));
}

TEST_CASE("compare --conflicts calls nothing good where b could not find anything") {
  const Street street;
  street.scan("site", 0.55);
  street.scan("away", 500);
  street.search("site", "a", "--clearance 0.2");
  street.search("away", "off", "--clearance 0.2");
  const Outcome undecided = street.compare("a", "off");
  check_outcome(undecided, 6, kAnything,
                "no new conflicts; b has not searched 1 place where a has a conflict; b is "
                "undecided, because the question is in doubt (out-of-reach)");
  check_json(json_of(street.compare("a", "off", "--json")),
             R"({"holds": false, "b": {"verdict": "undecided", "doubts": ["out-of-reach"]}})");
  check_outcome(street.compare("off", "a"), 1, kAnything,
                "; a is undecided, because the question is in doubt (out-of-reach)");
  check_says(street.compare("a", "off", "-o u.html").out, "undecided");
  check_says(street.bytes("u.html"), "b is undecided");
}

TEST_CASE("compare --conflicts does not call a deeper touch of a surface the same") {
  const Street street;
  street.scan("touch", 0.51);
  street.scan("deep", 0.36);
  street.search("touch", "a", "--clearance 0.2", "car.obj");
  street.search("deep", "b", "--clearance 0.2", "car.obj");
  check_outcome(street.compare("a", "b"), 0, kAnything,
                "1 conflict of which it is not known whether it is worse");
  CHECK(json_of(street.compare("a", "b", "--json"))["unknown_worse"].size() == 1);
  check_lacks(street.compare("a", "a").out, "not known");
  const std::string model = "--model car.obj";
  check_outcome(street.compare("a", "b", model), 1, kAnything,
                "its own points need a shift of 0.0 ... 1 conflict is worse");
  check_outcome(street.compare("b", "a", model), 0);
  check_outcome(street.compare("a", "b", model + " -o c.csv -o c.html"), 1);
  check_says(street.bytes("c.csv"), "\nworse,1,1, ... its own points need a shift");
  check_says(street.bytes("c.html"), "its own points need a shift");
}
