#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "clearway/alignment.hpp"
#include "clearway/trajectory.hpp"
#include "support/land_xml.hpp"
#include "tools/cli/support/program.hpp"

using namespace clearway;
using namespace clearway::test;
using Catch::Contains;

namespace {

/// A folder with track.xml, which has cant.
struct Track {
  explicit Track(const std::string& name = "track.xml") : input(folder / name) {
    LandFile file;
    file.more = cant_of("gauge=\"1.435\" rotationPoint=\"insideRail\"",
                        cant_station(1000, 0, "") + cant_station(1200, 80, "curvature=\"ccw\""));
    put_bytes(input, file.text());
  }

  Outcome make(const std::string& more) const {
    return run_program(folder, "trajectory alignment " + quoted(input) + " -o " +
                                   quoted(folder / "out.csv") + " " + more);
  }
  std::string out() const { return bytes_of(folder / "out.csv"); }

  ScratchFolder folder;
  std::filesystem::path input;
};

}  // namespace

TEST_CASE("trajectory alignment writes poses and stations that read back unchanged") {
  const Track track;
  const Outcome outcome = track.make("--json");
  REQUIRE(outcome.exit_code == 0);
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
  const auto json = nlohmann::json::parse(outcome.out);
  CHECK(json["alignment"] == "a");
  CHECK(json["profile"] == "p");
  CHECK(json["unit"] == "meter");
  CHECK(json["poses"] == 1787);
  CHECK(json["first_station"] == 1000);
  CHECK(json["alignment_to"] == Approx(1178.539816339745));
  CHECK(json["warnings"].empty());
  const Outcome info =
      run_program(track.folder, "trajectory info " + quoted(track.folder / "out.csv"));
  CHECK(info.exit_code == 0);
  CHECK_THAT(info.err, !Contains("warning"));
}

TEST_CASE("trajectory alignment takes all of its options") {
  const Track track;
  REQUIRE(track.make("--step 50cm --from 1010 --to 1011 --alignment a --profile p").exit_code == 0);
  const auto ahead = read_trajectory(track.folder / "out.csv");
  REQUIRE(ahead.size() == 3);
  REQUIRE(track.make("--step 0.5 --from 1010 --to 1011 --reverse --force").exit_code == 0);
  const auto back = read_trajectory(track.folder / "out.csv");
  CHECK(back[0].translation[0] == ahead[2].translation[0]);
  CHECK(back[0].rotation[0] == -ahead[2].rotation[0]);
  const auto height = [&](const std::string& more) {
    REQUIRE(track.make("--from 1100 --to 1100 --force " + more).exit_code == 0);
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
  CHECK(track.make("--max-gap 1mm --order ne --force").exit_code == 0);
  const Outcome swapped = track.make("--order en --force");
  CHECK(swapped.exit_code == 3);
  CHECK_THAT(swapped.err, Contains("--order ne"));
}

TEST_CASE("trajectory alignment refuses what it cannot use and leaves no output") {
  const Track track;
  const auto refused = [&](const std::string& more, int code, const std::string& words) {
    const Outcome outcome = track.make(more);
    CHECK(outcome.exit_code == code);
    CHECK_THAT(outcome.err, Contains(words));
    CHECK_FALSE(std::filesystem::exists(track.folder / "out.csv"));
    CHECK_FALSE(std::filesystem::exists(track.folder / "out.csv.partial"));
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
  const Outcome same = run_program(track.folder, "trajectory alignment " + quoted(track.input) +
                                                     " -o " + quoted(track.input) + " --force");
  CHECK(same.exit_code == 2);
  CHECK(bytes_of(track.input).starts_with("<?xml"));
  put_bytes(track.folder / "out.csv", "mine");
  CHECK(track.make("").exit_code == 2);
  CHECK(track.out() == "mine");
  CHECK(track.make("--force").exit_code == 0);
}

TEST_CASE("trajectory alignment warns of a store in another coordinate system") {
  const Track track;
  LandFile file;
  file.other = "<CoordinateSystem epsgCode=\"3878\"/>";
  put_bytes(track.input, file.text());
  put_bytes(track.folder / "points.xyz", "0 0 0\n1 1 1\n2 1 0\n");
  REQUIRE(run_program(track.folder, "convert " + quoted(track.folder / "points.xyz") + " -o " +
                                        quoted(track.folder / "site.h5"))
              .exit_code == 0);
  // A store without a system contradicts nothing.
  const Outcome none = track.make("--env " + quoted(track.folder / "site.h5"));
  CHECK(none.exit_code == 0);
  CHECK_THAT(none.err, !Contains("warning"));
  const Outcome missing = track.make("--force --env " + quoted(track.folder / "missing.h5"));
  CHECK(missing.exit_code == 4);
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
  REQUIRE(track.make("").exit_code == 0);
  CHECK(read_trajectory(track.folder / "out.csv").size() == 140'001);
}
