#include "clearway/trajectory.hpp"

#include <cmath>

#include "clearway/error.hpp"
#include "support/catch.hpp"
#include "support/made_path.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

std::vector<Pose> poses_of(const std::string& text, const TrajectoryOptions& options = {},
                           const std::string& name = "path.txt") {
  return read_path(text, options, name).poses;
}

Vec3 place_of(const std::string& text, const TrajectoryOptions& options = {}) {
  return poses_of(text, options).at(0).position();
}

/// A quarter turn about z at (7, 8, 9), and its quaternion's last element.
const Pose kTurn{{0, -1, 0, 1, 0, 0, 0, 0, 1}, {7, 8, 9}};
const std::string kTurnRow = "0 -1 0 7 1 0 0 8 0 0 1 9", kHalf = "0.70710678118654752";
const std::string kIdentity = "1 0 0 0 0 1 0 0 0 0 1 0\n";

/// Rows of texts in which "@" stands for kHalf, each of one pose, which is kTurn.
void check_turns(std::string_view table, TrajectoryFormat format = TrajectoryFormat::kAuto) {
  for (const auto& row : text_rows(table)) {
    const RowName name(row[0]);
    std::string text = row[0];
    for (std::size_t at; (at = text.find('@')) != std::string::npos;) text.replace(at, 1, kHalf);
    const std::vector<Pose> poses = poses_of(text, {.format = format});
    REQUIRE(poses.size() == 1);
    check_near(poses[0].rotation, {0, -1, 0, 1, 0, 0, 0, 0, 1}, 1e-15);
    CHECK(poses[0].position() == kTurn.position());
  }
}

}  // namespace

TEST_CASE("matrices of 12 and 16 numbers stay as read") {
  CHECK(poses_of(kTurnRow + "\n") == std::vector<Pose>{kTurn});
  CHECK(poses_of("# any\n\n" + kTurnRow + " 0 0 0 1\r\n  // again\n" + kTurnRow +
                 " 0 0 -0.0 1.0") == std::vector<Pose>{kTurn, kTurn});
  CHECK(poses_of("0,-1,0,7,1,0,0,8,0,0,1,9\n") == std::vector<Pose>{kTurn});
  check_equal(poses_of("0.99999 0 0 0 0 1 0 0 0 0 1 0\n").at(0).rotation[0], 0.99999);
  CHECK(poses_of("").empty());
  CHECK(poses_of("# nothing\n").empty());
}

TEST_CASE("the formats of poses and the names of columns decide what a number is") {
  check_turns(R"rows(
    # time tx ty tz\n12.5 7 8 9 0 0 @ @\n
    # timestamp tx ty tz qx qy qz qw\n12.5 7 8 9 0 0 @ @\n
    12.5,7,8,9,0,0,@,@
    #timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z [], v_RS_R_x [m s^-1]\n1403715524907143168,7,8,9,@,0,0,@,0.1\n
    timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z [], v_RS_R_x [m s^-1]\n1403715524907143168,7,8,9,@,0,0,@,0.1\n
    qw,qx,qy,qz,t,x,y,z\n@,0,0,@,1,7,8,9\n
    name;q_x;q_y;q_z;q_w;p_x;p_y;p_z\na;0;0;@;@;7;8;9\n
    "Pos_X (m)", pos_y, pos_z, QW, QX, QY, QZ\n7, 8, 9, @, 0, 0, @
    r00,r01,r02,r10,r11,r12,r20,r21,r22,tx,ty,tz\n0,-1,0,1,0,0,0,0,1,7,8,9\n
    # t x y z qw qx qy qz\n1 7 8 9 @ 0 0 @\n
    sep=;\nqw;qx;qy;qz;t;x;y;z\n@;0;0;@;1;7;8;9\n
  )rows");
  check_turns("12.5 7 8 9 0 0 @ @", TrajectoryFormat::kTum);
  check_turns(R"(7 8 9 0 0 @ @\n)", TrajectoryFormat::kPoseXyzw);
  check_turns(R"(7 8 9 @ 0 0 @\n)", TrajectoryFormat::kPoseWxyz);
  check_turns(R"(
    1403715524907143168,7,8,9,@,0,0,@,0.1\n
    timestamp, p_RS_R_x [m], y, z, q_RS_w [], q_RS_x [], qy, qz\n1403715524907143168,7,8,9,@,0,0,@,0.1\n
    #timestamp, x, y, z, qw, qx, qy, qz\n1403715524907143168,7,8,9,@,0,0,@,0.1\n
  )",
              TrajectoryFormat::kEuroc);
  check_turns(R"(r11,r12,r13,r21,r22,r23,r31,r32,r33,tx,ty,tz\n0,-1,0,1,0,0,0,0,1,7,8,9\n)",
              TrajectoryFormat::kCsv);
}

TEST_CASE("columns of a table that make no pose are listed, and a cant is doubted") {
  for (const auto& row : text_rows(R"(
    station             |
    name                |
    speed               | note unread-columns
    roll                | note unread-columns
    height              | note unread-columns
    cant                | unread-columns
    Superelevation [mm] | unread-columns
  )")) {
    const RowName name(row[0]);
    check_equal(read_path("t,x,y,z,qx,qy,qz,qw," + row[0] + "\n1,7,8,9,0,0,0,1,5\n").codes(),
                row[1]);
  }
}

TEST_CASE("a quaternion is normalised, and refused far from norm 1") {
  check_equal(poses_of("0 0 0 0 0 0 0 0.995\n").at(0).rotation[0], 1);
  check_paths_refused(R"(
    0 0 0 0 0 0 0 1\n0 0 0 0 0 0 0 1.02\n | line 2 ... norm 1.02
    0 0 0 0 0 0 0 0\n                     | norm 0
    0 nan 0 0 0 0 0 1\n                   | finite
  )");
}

TEST_CASE("a matrix that is not rigid is refused with its line and singular values") {
  check_paths_refused(R"(
    1 0 0 0 0 1 0 0 0 0 1 0\n1.001 0 0 0 0 1 0 0 0 0 1 0\n | line 2 ... 1.001
    -1 0 0 0 0 1 0 0 0 0 1 0                               | determinant -1
    1 0 0 0 0 1 0 0 1 1 0 0                                | line 1 ... invertible
  )");
  const TrajectoryOptions any{.allow_non_rigid = true};
  check_equal(poses_of("1.001 0 0 0 0 1 0 0 0 0 1 0", any).size(), 1);
  check_equal(poses_of("-1 0 0 0 0 1 0 0 0 0 1 0", any).size(), 1);
  check_paths_refused(R"(
    1 0 0 0 0 1 0 0 1 1 0 0                  | invertible
    0 0 0 0 0 0 0 0 0 0 0 0                  | invertible
    1e308 1e308 0 0 1e308 1e308 0 0 0 0 1 0  | line 1
    1 0 0 nan 0 1 0 0 0 0 1 0                | finite
  )",
                      any);
  for (int i = 0; i < 100; ++i) {  // rotations printed with six digits are rigid
    char row[200];
    const double c = std::cos(0.0628 * i), s = std::sin(0.0628 * i);
    std::snprintf(row, sizeof row, "%.6f %.6f 0 0 %.6f %.6f 0 0 0 0 1 0", c, -s, s, c);
    check_equal(poses_of(row).size(), 1);
  }
}

TEST_CASE("malformed trajectories are refused with their line, and with what to write instead") {
  check_paths_refused(R"(
    1,5 0,0 0,0 2,5 0,0 1,0 0,0 3,5 0,0 0,0 1,0 4,5\n | line 1 ... decimal commas ... as in 0.25
    x;y;z;qx;qy;qz;qw\n1,5;2;3;0;0;0;1\n              | line 2 ... column 1 has a decimal comma
    1 0 0 0 0 1 0 0 0 0 1 0 5 6 7 1\n                 | stands column by column ... r31 r32 r33 z 0 0 0 1
    0 1 0 -1 0 0 0 0 1 5 6 7\n                        | first nine numbers are a rotation, and the last three a position
    1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1\n | line 2 ... 16 numbers; expected 12
    1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 1 0 0 0 0 1 0 x\n       | line 2
    1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 1 0 0 0 0 1\n  | 11 numbers
    1 0 0 0 0 1 0 0 0 0 1 0 0 0 1 0\n                 | last row
    1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n              | line 1 ... several lines
    0 0 0 0 0 0 0 1\n1 0 0 0 0 1 0 0 0 0 1 0\n        | line 2
    1 2 3 4 5 6 7\n                                   | 7 numbers
    7 8 9 0.8 0 0 0.6\n                               | pose-xyzw ... pose-wxyz
    1 2 3 0 0 0\n                                     | 6 numbers ... heading_deg
    1,0,0,0,0,1,0,0,0,0,1,\n                          | line 1
    1,,0,0,0,1,0,0,0,0,1,0\n                          | line 1
    hello\n                                           | line 1 ... hello
    1403715524907143168,0,0,0,1,0,0,0\n               | the format can be tum
    x,y,z,qx,qy,qz\n1,2,3,0,0,0\n                     | line 1 ... qw
    x,tx,y,z,qx,qy,qz,qw\n                            | line 1
    x,y,z,qx,qy,qz,qw\n1,2,3,0,0,0,1\n1,2,3,0,0,0,1,5\n | line 3 ... 8 columns; expected 7
    x,y,z,qx,qy,qz,qw\n1,2,,0,0,0,1\n                 | line 2 ... column 3
    x[mm],y[m],z[mm],qx,qy,qz,qw\n7,8,9,0,0,0,1\n     | positions in "mm" and in "m"
    x[px],y[px],z[px],qx,qy,qz,qw\n7,8,9,0,0,0,1\n    | px
    x_ft,y_ft,z,qx,qy,qz,qw\n10,20,30,0,0,0,1\n       | some of the positions
    PK)"
                      "\x03\x04"
                      R"(...                            | ZIP archive ... as CSV
    <?xml version="1.0"?>\n<LandXML/>\n               | is XML ... clearway trajectory alignment
    x,y,z\n1,2,3\n4,5,6\n                             | clearway trajectory line
    {"type": "LineString"}\n                          | clearway trajectory line
  )");
  check_paths_refused("1,2,3,0,0,0,1\\n | header", {.format = TrajectoryFormat::kCsv});
  check_paths_refused("hello\\n | line 1", {.format = TrajectoryFormat::kMatrix});
  check_paths_refused("0 0 0 0 0 0 0 1 | 8 numbers", {.format = TrajectoryFormat::kMatrix});
  check_paths_refused("1 0 0 0 0 1 0 0 0 0 1 0 | 12 numbers; expected 8",
                      {.format = TrajectoryFormat::kTum});
  check_paths_refused("1,2,3\\n | 3 columns", {.format = TrajectoryFormat::kEuroc});
  check_paths_refused("1 2 3\\n | 7: x y z qx qy qz qw", {.format = TrajectoryFormat::kPoseXyzw});
  check_paths_refused("x[mm],y[mm],z[mm],qx,qy,qz,qw\\n7,8,9,0,0,0,1 | was declared",
                      {.metres_per_unit = 1});
  check_path_refused(std::string(70'000, '1'), "65536");
  check_path_refused(std::string("\0\0\x27\x0A\0\0", 6), "is a shapefile");
  check_path_refused("\x89HDF\r\n", "as stores and results are");
  check_path_refused("\xFE\xFF" + std::string("\0001\0 ", 4), "UTF-16");
  check_path_refused("\xEF\xBB\xBF<LandXML>\n", "is XML");
}

TEST_CASE("a unit scales positions alone") {
  const Pose pose = poses_of("0 -1 0 7000 1 0 0 8000 0 0 1 9000", {.metres_per_unit = 0.001}).at(0);
  check_near(pose.position(), {7, 8, 9}, 0);
  check_equal(pose.rotation[1], -1);
  const std::string rest = ",qx,qy,qz,qw\n7000,8000,9000,0,0,0,1\n";
  check_equal(place_of("x[mm],y[mm],z[mm]" + rest).y, 8);
  check_equal(place_of("x_cm,y_cm,z_cm" + rest).y, 80);
  check_equal(place_of("x (ft),y (ft),z (ft)" + rest).x, 7000 * 0.3048);
  // 9 mm become the double nearest to 0.009, as for models.
  check_equal(place_of("1 0 0 9 0 1 0 3.048 0 0 1 0\n", {.metres_per_unit = 0.001}).x, 0.009);
}

TEST_CASE("a path in an environment in feet becomes feet, with its lever arm") {
  const std::string row = "1 0 0 9 0 1 0 3.048 0 0 1 0\n";
  // A path without a unit is in feet too, and 3.048 m are 10 feet.
  check_equal(place_of(row, {.environment_unit = 0.3048}).y, 3.048);
  CHECK(place_of(row, {.metres_per_unit = 1, .environment_unit = 0.3048}).y == Approx(10));
  const std::string named = "x_ft,y_ft,z_ft,qx,qy,qz,qw\n10,20,30,0,0,0,1\n";
  // A lever arm is in the unit of the environment.
  const TrajectoryOptions arm{.environment_unit = 0.3048, .lever_arm = {0, 4, 0}};
  check_near(place_of(named, arm), {10, 16, 30}, 1e-12);
}

TEST_CASE("a lever arm leads from the trajectory's point back to the model's origin") {
  // The antenna is 2 m ahead of the origin and 1 m above; the model looks along y.
  check_near(place_of(kTurnRow, {.lever_arm = {2, 0, 1}}), {7, 6, 8}, 0);
  const Vec3 arm{0.3, -1.2, 0.7};
  const Pose moved = poses_of(kTurnRow, {.lever_arm = arm}).at(0);
  check_near(moved.rotated(arm) + moved.position(), {7, 8, 9}, 1e-14);
}

TEST_CASE("3DTK: a .pose is one pose, in our frame") {
  // A pose of 3DTK: 100 to the right, 200 up, 300 ahead, and a quarter turn about its y axis.
  const Pose pose = poses_of("100 200 300\n0 90 0\n", {}, "scan000.pose").at(0);
  check_near(pose.position(), {3, -1, 2}, 1e-12);
  // The turn about up is left-handed, so the front turns to the right, which is -y.
  CHECK(pose.rotation[3] == Approx(-1));
  CHECK(pose.rotation[8] == Approx(1));
  check_path_refused("1 2 3\n", "expected six", {}, "scan000.pose");
  CHECK_THROWS_AS(poses_of("1 2 3 0 0 0\n", {.metres_per_unit = 0.01}, "a.pose"), UsageError);
}

TEST_CASE("3DTK: a folder is a trajectory in the order of its numbers") {
  const ScratchFolder scratch;
  scratch.write("scan002.pose", "0 0 200\n0 0 0\n");
  scratch.write("scan010.pose", "0 0 1000\n0 0 0\n");
  scratch.write("scan000.pose", "0 0 0\n0 0 0\n");
  scratch.write("scan000.3d", "1 2 3\n");
  scratch.write("readme.pose", "hello\n");
  std::vector<Message> remarks;
  PoseLabels labels;
  const auto poses = read_trajectory(scratch.folder(), {}, &remarks, &labels);
  REQUIRE(poses.size() == 3);
  check_equal(poses[1].translation[0], 2);
  check_equal(poses[2].translation[0], 10);
  check_equal(remarks.at(0).code, "model-frame");
  check_equal(labels.name, {"scan000.pose", "scan002.pose", "scan010.pose"});
  // The last line of a .frames counts.
  const std::string frames =
      "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 1\n1 0 0 0 0 1 0 0 0 0 1 0 100 200 500 1 2\n";
  scratch.write("scan000.frames", frames);
  check_refused([&] { read_trajectory(scratch.folder()); }, "scan002.pose has no .frames");
  check_equal(read_trajectory(scratch.folder(), {.format = TrajectoryFormat::kThreedtkPose}).size(),
              3);
  scratch.write("scan002.frames", frames);
  scratch.write("scan010.frames", frames);
  check_near(read_trajectory(scratch.folder()).at(0).position(), {5, -1, 2}, 1e-12);
  scratch.write("scan10.pose", "0 0 0\n0 0 0\n");
  check_refused([&] { read_trajectory(scratch.folder()); }, "the same number");
  const ScratchFolder empty;
  check_refused([&] { read_trajectory(empty.folder()); }, "scan000.pose");
}

namespace {

/// Names, times and stations in one text, "a, b; 1, 2; 5": empty lists are left out.
std::string labels_of(const std::string& text, const TrajectoryOptions& options = {}) {
  const ScratchFolder scratch;
  PoseLabels labels{{7}, {"stale"}};
  read_trajectory(scratch.write("path.csv", text), options, nullptr, &labels);
  std::string all;
  const auto add = [&](const std::string& name, const auto& list, const auto& text_of) {
    for (std::size_t i = 0; i < list.size(); ++i) {
      all += (i == 0 ? (all.empty() ? "" : "; ") + name + " " : ", ") + text_of(list[i]);
    }
  };
  const auto number = [](double value) {
    char digits[40];
    std::snprintf(digits, sizeof digits, "%.16g", value);
    return std::string(digits);
  };
  add("name", labels.name, [](const std::string& name) { return "'" + name + "'"; });
  add("time", labels.time, number);
  add("station", labels.station, number);
  return all;
}

}  // namespace

TEST_CASE("names, times in seconds and stations in metres are kept with the poses") {
  for (const auto& row : text_rows(R"(
    1.5 0 0 0 0 0 0 1\n2.25 1 0 0 0 0 0 1\n                                                     | time 1.5, 2.25
    name,time,x,y,z,qx,qy,qz,qw\n"P 1",3,0,0,0,0,0,0,1\n b ,4,1,0,0,0,0,0,1\n                   | name 'P 1', 'b'; time 3, 4
    name,time,x,y,z,qx,qy,qz,qw,"note, of it"\n"hall, north",3,0,0,0,0,0,0,1,"a,b"\n "say ""a, b""" ,4,1,0,0,0,0,0,1,none\n5" pipe,5,1,0,0,0,0,0,1,""\n | name 'hall, north', 'say "a, b"', '5" pipe'; time 3, 4, 5
    x,y,z,qx,qy,qz,qw,name,end\n0,0,0,0,0,0,1,"open,1\n                                         | name 'open'
    station,x,y,z,qx,qy,qz,qw\n1000,0,0,0,0,0,0,1\n1000.5,1,0,0,0,0,0,1\n                       | name '1000', '1000.5'; station 1000, 1000.5
    station [mm],x,y,z,qx,qy,qz,qw\n1000,0,0,0,0,0,0,1\n                                        | station 1
    station,x [ft],y [ft],z [ft],qx,qy,qz,qw\n10,0,0,0,0,0,0,1\n                                | name '10'; station 3.048
    station,x,y,z,qx,qy,qz,qw\nA 7,0,0,0,0,0,0,1\n                                              | name 'A 7'
    index,x,y,z,qx,qy,qz,qw\n007,0,0,0,0,0,0,1\n                                                | name '007'
    index,name,x,y,z,qx,qy,qz,qw\n7,a,0,0,0,0,0,0,1\n                                           | name 'a'
    index,id,x,y,z,qx,qy,qz,qw\n7,8,0,0,0,0,0,0,1\n                                             |
    id,x,y,z,roll_deg,pitch_deg,heading_deg\n9,0,0,0,1,2,3\n                                    | name '9'
    time,x,y,z,qx,qy,qz,qw\n1,0,0,0,0,0,0,1\n,1,0,0,0,0,0,1\n                                   |
    1 0 0 0 0 1 0 0 0 0 1 0\n                                                                   |
  )")) {
    const RowName name(row[0]);
    check_equal(labels_of(row[0]), row[1]);
  }
  check_equal(
      labels_of("1403636579763555584,0,0,0,1,0,0,0\n", {.format = TrajectoryFormat::kEuroc}),
      "time 1403636579.763556");
  // Without a unit of their own, stations have that of the positions, or of the environment.
  const TrajectoryOptions survey{.environment_unit = 1200.0 / 3937};
  const std::string rest = ",x,y,z,qx,qy,qz,qw\n1000,0,0,0,0,0,0,1\n";
  check_equal(labels_of("station" + rest, survey), "name '1000'; station 304.8006096012192");
  check_equal(labels_of("station [m]" + rest, survey), "station 1000");
}
