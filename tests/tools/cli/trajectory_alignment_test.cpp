#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "clearway/alignment.hpp"
#include "clearway/trajectory.hpp"
#include "support/catch.hpp"
#include "support/land_xml.hpp"
#include "tools/cli/support/program.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// A folder with track.xml, which has cant.
struct Track : Workplace {
  explicit Track(const std::string& name = "track.xml") : input(folder / name) {
    LandFile file;
    file.more = cant_of("gauge=\"1.435\" rotationPoint=\"insideRail\"",
                        cant_station(1000, 0, "") + cant_station(1200, 80, "curvature=\"ccw\""));
    put_bytes(input, file.text());
  }

  Outcome make(const std::string& more) const {
    return run("trajectory alignment " + quoted(input) + " -o out.csv " + more);
  }
  std::string out() const { return bytes("out.csv"); }

  std::filesystem::path input;
};

}  // namespace

TEST_CASE("trajectory alignment writes poses and stations that read back unchanged") {
  const Track track;
  const Outcome outcome = require_success(track.make("--json"));
  CHECK(track.out().starts_with(
      "station [m],x [m],y [m],z [m],r00,r01,r02,r10,r11,r12,r20,r21,r22\n1000,0,0,10,"));
  CHECK_FALSE(track.out().find("-0,") != std::string::npos);
  PoseLabels made_labels, labels;
  std::vector<Message> remarks;
  const auto made = read_alignment(track.input, {}, nullptr, &made_labels);
  const auto read = read_trajectory(track.folder / "out.csv", {}, &remarks, &labels);
  CHECK(remarks.empty());
  CHECK(labels.station == made_labels.station);
  REQUIRE(read.size() == made.size());
  bool same = true;
  for (std::size_t i = 0; i < read.size(); ++i) {
    for (int k = 0; k < 3; ++k) same = same && read[i].translation[k] == made[i].translation[k];
    for (int k = 0; k < 9; ++k) same = same && read[i].rotation[k] == made[i].rotation[k];
  }
  CHECK(same);
  const auto json = json_of(outcome);
  check_json(json, R"({
    "alignment": "a", "profile": "p", "unit": "meter", "poses": 1787, "first_station": 1000,
    "warnings": []})");
  check_near(json, "/alignment_to", 1178.539816339745);
  const Outcome info = track.run("trajectory info out.csv");
  check_outcome(info, 0);
  check_lacks(info.err, "warning");
}

TEST_CASE("trajectory alignment takes all of its options") {
  const Track track;
  require_success(track.make("--step 50cm --from 1010 --to 1011 --alignment a --profile p"));
  const auto ahead = read_trajectory(track.folder / "out.csv");
  REQUIRE(ahead.size() == 3);
  require_success(track.make("--step 0.5 --from 1010 --to 1011 --reverse --force"));
  const auto back = read_trajectory(track.folder / "out.csv");
  CHECK(back[0].translation[0] == ahead[2].translation[0]);
  CHECK(back[0].rotation[0] == -ahead[2].rotation[0]);
  const auto height = [&](const std::string& more) {
    require_success(track.make("--from 1100 --to 1100 --force " + more));
    return read_trajectory(track.folder / "out.csv").at(0).translation[2];
  };
  // The cant of 80 mm at station 1200 has grown to 40 mm at station 1100.
  const double cases[] = {height("--cant file"),
                          height("--cant none"),
                          height("--cant center"),
                          height("--cant inside-rail"),
                          height("--cant outside-rail"),
                          height("--cant left-rail"),
                          height("--cant right-rail --rail-distance 1.5")};
  const double raises[] = {0.02, 0, 0, 0.02, -0.02, 0.02, -0.02};
  for (std::size_t i = 0; i < std::size(cases); ++i)
    CHECK(std::abs(cases[i] - 11 - raises[i]) < 1e-12);
  check_outcome(track.make("--max-gap 1mm --order ne --force"), 0);
  check_outcome(track.make("--order en --force"), 3, "--order ne");
}

TEST_CASE("trajectory alignment refuses what it cannot use and leaves no output") {
  const Track track;
  const auto refused = [&](const std::string& more, int code, const std::string& words) {
    const Outcome outcome = track.make(more);
    CHECK(outcome.exit_code == code);
    check_says(outcome.err, words);
    CHECK_FALSE(track.has("out.csv"));
    CHECK_FALSE(track.has("out.csv.partial"));
  };
  refused("--step 0", 2, "--step");
  refused("--step nan", 2, "--step");
  refused("--from nan", 2, "--from");
  refused("--from x", 2, "--from");
  refused("--from 1+010", 2, "--from: 1+010: expected a number with a decimal point");
  refused("--to 1010,5", 2, "--to: 1010,5: expected a number with a decimal point");
  refused("--from -5", 2, "--from -5 is off the alignment");
  refused("--from 1100 --to 1000", 2, "--from 1100 is after --to 1000");
  refused("--cant middle", 2, "--cant");
  refused("--order xy", 2, "--order");
  refused("--height 3", 2, "--height");
  refused("--rail-distance 0", 2, "--rail-distance");
  refused("--max-gap -1", 2, "--max-gap");
  refused("--alignment b", 3, "expected one of \"a\"");
  refused("--profile b", 3, "expected one of \"p\"");
  check_outcome(track.run("trajectory alignment " + quoted(track.input) + " -o " +
                          quoted(track.input) + " --force"),
                2);
  CHECK(bytes_of(track.input).starts_with("<?xml"));
  track.put("out.csv", "mine");
  check_outcome(track.make(""), 2);
  CHECK(track.out() == "mine");
  check_outcome(track.make("--force"), 0);
}

TEST_CASE("trajectory alignment warns of a store in another coordinate system") {
  const Track track;
  LandFile file;
  file.other = "<CoordinateSystem epsgCode=\"3878\"/>";
  put_bytes(track.input, file.text());
  track.put("points.xyz", "0 0 0\n1 1 1\n2 1 0\n");
  require_success(track.run("convert points.xyz -o site.h5"));
  // A store without a system contradicts nothing.
  const Outcome none = track.make("--env site.h5");
  check_outcome(none, 0);
  check_lacks(none.err, "warning");
  check_outcome(track.make("--force --env missing.h5"), 4);
}

TEST_CASE("poses are made along 14 km") {
  const Track track;
  LandFile file;
  file.attributes = "name=\"a\" staStart=\"0\"";
  file.line = file.curve = file.profile = "";
  for (int i = 0; i < 140; ++i) {
    const std::string from = std::to_string(100 * i), to = std::to_string(100 * (i + 1));
    file.line +=
        "<Spiral length=\"100\" radiusStart=\"INF\" radiusEnd=\"INF\" rot=\"cw\" "
        "spiType=\"clothoid\"><Start>0 " +
        from + "</Start><End>0 " + to + "</End></Spiral>";
  }
  file.profile =
      "<Profile><ProfAlign name=\"p\"><PVI>0 10</PVI><ParaCurve length=\"900\">7000 "
      "12</ParaCurve><PVI>14000 10</PVI></ProfAlign></Profile>";
  put_bytes(track.input, file.text());
  require_success(track.make(""));
  CHECK(read_trajectory(track.folder / "out.csv").size() == 140'001);
}
