#include <filesystem>

#include "clearway/trajectory.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/reader_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

using Names = std::vector<std::string>;
using Times = std::vector<double>;

PoseLabels labels_of(const std::string& text, const std::string& name,
                     const TrajectoryOptions& options = {}) {
  const ScratchFolder scratch;
  PoseLabels labels{{7}, {"stale"}};
  read_trajectory(scratch.write(name, text), options, nullptr, &labels);
  return labels;
}

}  // namespace

TEST_CASE("times of TUM and EuRoC are kept, in seconds") {
  const PoseLabels tum = labels_of("1.5 0 0 0 0 0 0 1\n2.25 1 0 0 0 0 0 1\n", "path.txt");
  CHECK(tum.time == Times{1.5, 2.25});
  CHECK(tum.name.empty());
  const PoseLabels euroc = labels_of("1403636579763555584,0,0,0,1,0,0,0\n", "path.csv",
                                     {.format = TrajectoryFormat::kEuroc});
  REQUIRE(euroc.time.size() == 1);
  CHECK(euroc.time[0] == Approx(1403636579.763555584).epsilon(1e-15));
}

TEST_CASE("a column of names is kept, quotes and blanks around them are not") {
  const PoseLabels labels = labels_of(
      "name,time,x,y,z,qx,qy,qz,qw\n\"P 1\",3,0,0,0,0,0,0,1\n b ,4,1,0,0,0,0,0,1\n", "path.csv");
  check_equal(labels.name, {"P 1", "b"});
  CHECK(labels.time == Times{3, 4});
}

TEST_CASE("a separator within quotes is part of the name") {
  const PoseLabels labels = labels_of(
      "name,time,x,y,z,qx,qy,qz,qw,\"note, of it\"\n"
      "\"hall, north\",3,0,0,0,0,0,0,1,\"a,b\"\n"
      " \"say \"\"a, b\"\"\" ,4,1,0,0,0,0,0,1,none\n"
      "5\" pipe,5,1,0,0,0,0,0,1,\"\"\n",
      "path.csv");
  check_equal(labels.name, {"hall, north", "say \"a, b\"", "5\" pipe"});
  CHECK(labels.time == Times{3, 4, 5});
  // Quotes that are not closed, or closed before more text, are text.
  CHECK(labels_of("x,y,z,qx,qy,qz,qw,name,end\n0,0,0,0,0,0,1,\"open,1\n", "path.csv").name.size() ==
        1);
}

TEST_CASE("a column of stations is kept, in metres") {
  const std::string rest = "x,y,z,qx,qy,qz,qw\n1000,0,0,0,0,0,0,1\n1000.5,1,0,0,0,0,0,1\n";
  CHECK(labels_of("station," + rest, "path.csv").station == Times{1000, 1000.5});
  CHECK(labels_of("station [mm]," + rest, "path.csv").station == Times{1, 1.0005});
  // It is a name too, as before.
  check_equal(labels_of("station," + rest, "path.csv").name, {"1000", "1000.5"});
  // Without a unit of their own, stations have that of the positions, or of the environment.
  const std::string in_feet = "station,x [ft],y [ft],z [ft],qx,qy,qz,qw\n10,0,0,0,0,0,0,1\n";
  CHECK(labels_of(in_feet, "path.csv").station.at(0) == Approx(3.048));
  const double survey = 1200.0 / 3937;
  CHECK(labels_of("station," + rest, "path.csv", {.environment_unit = survey}).station.at(0) ==
        Approx(1000 * survey));
  CHECK(labels_of("station [m]," + rest, "path.csv", {.environment_unit = survey}).station.at(0) ==
        1000);
  // Texts are names alone.
  const PoseLabels texts = labels_of("station,x,y,z,qx,qy,qz,qw\nA 7,0,0,0,0,0,0,1\n", "path.csv");
  CHECK(texts.station.empty());
  check_equal(texts.name, {"A 7"});
}

TEST_CASE("an index counts where there is no name") {
  const std::string pose = ",0,0,0,0,0,0,1\n";
  check_equal(labels_of("index,x,y,z,qx,qy,qz,qw\n007" + pose, "path.csv").name, {"007"});
  check_equal(labels_of("index,name,x,y,z,qx,qy,qz,qw\n7,a" + pose, "path.csv").name, {"a"});
  CHECK(labels_of("index,id,x,y,z,qx,qy,qz,qw\n7,8" + pose, "path.csv").name.empty());
  CHECK(labels_of("id,x,y,z,roll_deg,pitch_deg,heading_deg\n9,0,0,0,1,2,3\n", "path.csv").name ==
        Names{"9"});
}

TEST_CASE("a time that is missing in one line is kept in none") {
  const PoseLabels labels =
      labels_of("time,x,y,z,qx,qy,qz,qw\n1,0,0,0,0,0,0,1\n,1,0,0,0,0,0,1\n", "path.csv");
  CHECK(labels.time.empty());
}

TEST_CASE("matrices have no labels") {
  const PoseLabels labels = labels_of("1 0 0 0 0 1 0 0 0 0 1 0\n", "path.txt");
  CHECK((labels.time.empty() && labels.name.empty()));
}

TEST_CASE("poses of a folder of 3DTK are called as their files") {
  const ScratchFolder scratch;
  scratch.write("scan001.pose", "0 0 0\n0 0 0\n");
  const auto folder = scratch.write("scan000.pose", "0 0 0\n0 0 0\n").parent_path();
  PoseLabels labels;
  read_trajectory(folder, {}, nullptr, &labels);
  check_equal(labels.name, {"scan000.pose", "scan001.pose"});
}
