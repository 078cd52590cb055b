#include "clearway/trajectory.hpp"

#include <cmath>

#include "clearway/error.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/reader_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

std::vector<Pose> poses_of(const std::string& text,
                           TrajectoryFormat format = TrajectoryFormat::kAuto, bool any = false) {
  ScratchFolder scratch;
  return read_trajectory(scratch.write("path.txt", text), {format, any});
}

std::string refusal_of_text(const std::string& text,
                            TrajectoryFormat format = TrajectoryFormat::kAuto, bool any = false) {
  ScratchFolder scratch;
  const auto path = scratch.write("path.txt", text);
  try {
    read_trajectory(path, {format, any});
  } catch (const InputError& error) {
    check_says(error.what(), path.string());
    return error.what();
  }
  return {};
}

/// The pose of a quarter turn about z at (7, 8, 9).
const Pose kTurn{{0, -1, 0, 1, 0, 0, 0, 0, 1}, {7, 8, 9}};
const std::string kIdentity = "1 0 0 0 0 1 0 0 0 0 1 0";
const std::string kTurnRow = "0 -1 0 7 1 0 0 8 0 0 1 9";
const std::string kHalf = "0.70710678118654752";  // element of the quaternion (0, 0, kHalf, kHalf)

void check_turn(const std::vector<Pose>& poses) {
  REQUIRE(poses.size() == 1);
  for (int k = 0; k < 9; ++k) check_near(poses[0].rotation[k], kTurn.rotation[k], 1e-15);
  for (int k = 0; k < 3; ++k) CHECK(poses[0].translation[k] == kTurn.translation[k]);
}

}  // namespace

TEST_CASE("matrices of 12 and 16 numbers stay as read") {
  CHECK(poses_of(kTurnRow + "\n") == std::vector<Pose>{kTurn});
  CHECK(poses_of("# any\n\n" + kTurnRow + " 0 0 0 1\r\n" + kTurnRow + " 0 0 -0.0 1.0") ==
        std::vector<Pose>{kTurn, kTurn});
  CHECK(poses_of("0,-1,0,7,1,0,0,8,0,0,1,9\n") == std::vector<Pose>{kTurn});
  check_equal(poses_of("0.99999 0 0 0 0 1 0 0 0 0 1 0\n").at(0).rotation[0], 0.99999);
  CHECK(poses_of("").empty());
  CHECK(poses_of("# nothing\n").empty());
}

TEST_CASE("TUM: time, position, quaternion x y z w") {
  const std::string row = "12.5 7 8 9 0 0 " + kHalf + " " + kHalf + "\n";
  check_turn(poses_of("# time tx ty tz\n" + row));
  check_turn(poses_of("# timestamp tx ty tz qx qy qz qw\n" + row));
  check_turn(poses_of(row, TrajectoryFormat::kTum));
  check_turn(poses_of("12.5,7,8,9,0,0," + kHalf + "," + kHalf));
}

TEST_CASE("EuRoC: nanoseconds, position, quaternion w x y z, and more") {
  const std::string header =
      "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], "
      "q_RS_z [], v_RS_R_x [m s^-1]\n";
  const std::string row = "1403715524907143168,7,8,9," + kHalf + ",0,0," + kHalf + ",0.1\n";
  check_turn(poses_of(header + row));
  check_turn(poses_of(header + row, TrajectoryFormat::kEuroc));
  check_turn(poses_of(row, TrajectoryFormat::kEuroc));
  check_turn(poses_of(header.substr(1) + row, TrajectoryFormat::kEuroc));
  check_turn(poses_of(header.substr(1) + row));
}

TEST_CASE("a CSV header names the columns, in any order") {
  check_turn(poses_of("qw,qx,qy,qz,t,x,y,z\n" + kHalf + ",0,0," + kHalf + ",1,7,8,9\n"));
  check_turn(
      poses_of("name;q_x;q_y;q_z;q_w;p_x;p_y;p_z\na;0;0;" + kHalf + ";" + kHalf + ";7;8;9\n"));
  check_turn(poses_of("\"Pos_X (m)\", pos_y, pos_z, QW, QX, QY, QZ\n7, 8, 9, " + kHalf +
                      ", 0, 0, " + kHalf));
  check_turn(poses_of("r00,r01,r02,r10,r11,r12,r20,r21,r22,tx,ty,tz\n0,-1,0,1,0,0,0,0,1,7,8,9\n"));
  check_turn(poses_of("r11,r12,r13,r21,r22,r23,r31,r32,r33,tx,ty,tz\n0,-1,0,1,0,0,0,0,1,7,8,9\n",
                      TrajectoryFormat::kCsv));
  check_turn(poses_of("# t x y z qw qx qy qz\n1 7 8 9 " + kHalf + " 0 0 " + kHalf + "\n"));
  check_turn(poses_of("sep=;\nqw;qx;qy;qz;t;x;y;z\n" + kHalf + ";0;0;" + kHalf + ";1;7;8;9\n"));
  check_says(refusal_of_text("x,y,z,qx,qy,qz\n1,2,3,0,0,0\n"), "line 1 ... qw");
  check_says(refusal_of_text("x,tx,y,z,qx,qy,qz,qw\n"), "line 1");
  check_says(refusal_of_text("x,y,z,qx,qy,qz,qw\n1,2,3,0,0,0,1\n1,2,3,0,0,0,1,5\n"),
             "line 3 ... 8 columns; expected 7");
  check_says(refusal_of_text("x,y,z,qx,qy,qz,qw\n1,2,,0,0,0,1\n"), "line 2 ... column 3");
  check_says(refusal_of_text("1,2,3,0,0,0,1\n", TrajectoryFormat::kCsv), "header");
}

TEST_CASE("columns of a table that make no pose are listed, and a cant is doubted") {
  const auto codes = [](const std::string& more) {
    const ScratchFolder scratch;
    std::vector<Message> remarks;
    const std::string text = "t,x,y,z,qx,qy,qz,qw," + more + "\n1,7,8,9,0,0,0,1,5\n";
    read_trajectory(scratch.write("path.csv", text), {}, &remarks);
    std::string all;
    for (const Message& remark : remarks) {
      all += (remark.severity == Message::Severity::kNote ? "note " : "warning ") + remark.code;
    }
    return all;
  };
  check_equal(codes("station"), "");
  check_equal(codes("name"), "");
  check_equal(codes("speed"), "note unread-columns");
  check_equal(codes("roll"), "note unread-columns");  // the quaternion says it
  check_equal(codes("height"), "note unread-columns");
  check_equal(codes("cant"), "warning unread-columns");
  check_equal(codes("Superelevation [mm]"), "warning unread-columns");
}

TEST_CASE("a quaternion is normalised, and refused far from norm 1") {
  const auto poses = poses_of("0 0 0 0 0 0 0 0.995\n");
  REQUIRE(poses.size() == 1);
  check_equal(poses[0].rotation[0], 1);
  check_says(refusal_of_text("0 0 0 0 0 0 0 1\n0 0 0 0 0 0 0 1.02\n"), "line 2 ... norm 1.02");
  check_says(refusal_of_text("0 0 0 0 0 0 0 0\n"), "norm 0");
  check_says(refusal_of_text("0 nan 0 0 0 0 0 1\n"), "finite");
  check_says(refusal_of_text("0 0 0 0 0 0 0 1\ninf 0 0 0 0 0 0 1\n"), "finite");
}

TEST_CASE("a matrix that is not rigid is refused with its line and singular values") {
  const std::string stretched = "1.001 0 0 0 0 1 0 0 0 0 1 0";
  const std::string message = refusal_of_text(kIdentity + "\n" + stretched + "\n");
  check_says(message, "line 2 ... 1.001");
  check_equal(poses_of(stretched, TrajectoryFormat::kMatrix, true).size(), 1);
  const std::string mirrored = "-1 0 0 0 0 1 0 0 0 0 1 0";
  check_says(refusal_of_text(mirrored), "determinant -1");
  check_equal(poses_of(mirrored, TrajectoryFormat::kAuto, true).size(), 1);
  for (const std::string singular : {"1 0 0 0 0 1 0 0 1 1 0 0", "0 0 0 0 0 0 0 0 0 0 0 0"}) {
    check_says(refusal_of_text(singular), "line 1 ... invertible");
    check_says(refusal_of_text(singular, TrajectoryFormat::kAuto, true), "invertible");
  }
  CHECK_FALSE(
      refusal_of_text("1e308 1e308 0 0 1e308 1e308 0 0 0 0 1 0", TrajectoryFormat::kAuto, true)
          .empty());
  check_says(refusal_of_text("1 0 0 nan 0 1 0 0 0 0 1 0", TrajectoryFormat::kAuto, true), "finite");
}

TEST_CASE("rotations printed with six digits are rigid") {
  for (int i = 0; i < 100; ++i) {
    char row[200];
    const double a = 0.0628 * i;
    std::snprintf(row, sizeof row, "%.6f %.6f 0 0 %.6f %.6f 0 0 0 0 1 0", std::cos(a), -std::sin(a),
                  std::sin(a), std::cos(a));
    check_equal(poses_of(row).size(), 1);
  }
}

TEST_CASE("decimal commas and matrices column by column are named, with what to write instead") {
  check_says(refusal_of_text("1,5 0,0 0,0 2,5 0,0 1,0 0,0 3,5 0,0 0,0 1,0 4,5\n"),
             "line 1 ... decimal commas ... as in 0.25");
  check_says(refusal_of_text("x;y;z;qx;qy;qz;qw\n1,5;2;3;0;0;0;1\n"),
             "line 2 ... column 1 has a decimal comma");
  check_says(refusal_of_text("1 0 0 0 0 1 0 0 0 0 1 0 5 6 7 1\n"),
             "stands column by column ... r31 r32 r33 z 0 0 0 1");
  check_says(refusal_of_text("0 1 0 -1 0 0 0 0 1 5 6 7\n"),
             "first nine numbers are a rotation, and the last three a position");
}

TEST_CASE("malformed trajectories are refused with their line") {
  check_says(refusal_of_text(kIdentity + "\n" + kIdentity + " 0 0 0 1\n"),
             "line 2 ... 16 numbers; expected 12");
  check_says(refusal_of_text(kIdentity + "\n" + kIdentity + " x\n"), "line 2");
  check_says(refusal_of_text(kIdentity + "\n1 0 0 0 0 1 0 0 0 0 1\n"), "11 numbers");
  check_says(refusal_of_text(kIdentity + " 0 0 1 0\n"), "last row");
  check_says(refusal_of_text("1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n"), "line 1 ... several lines");
  check_says(refusal_of_text("0 0 0 0 0 0 0 1\n" + kIdentity + "\n"), "line 2");
  check_says(refusal_of_text("1 2 3 4 5 6 7\n"), "7 numbers");
  check_says(refusal_of_text("1,0,0,0,0,1,0,0,0,0,1,\n"), "line 1");
  check_says(refusal_of_text("1,,0,0,0,1,0,0,0,0,1,0\n"), "line 1");
  check_says(refusal_of_text("hello\n"), "line 1 ... hello");
  check_says(refusal_of_text("hello\n", TrajectoryFormat::kMatrix), "line 1");
  check_says(refusal_of_text(kIdentity, TrajectoryFormat::kTum), "12 numbers; expected 8");
  check_says(refusal_of_text("0 0 0 0 0 0 0 1", TrajectoryFormat::kMatrix), "8 numbers");
  check_says(refusal_of_text("1,2,3\n", TrajectoryFormat::kEuroc), "3 columns");
  check_says(refusal_of_text("1403715524907143168,0,0,0,1,0,0,0\n"), "the format can be tum");
  check_says(refusal_of_text(std::string(70'000, '1')), "65536");
  check_says(refusal_of_text("PK\x03\x04..."), "ZIP archive ... as CSV");
  check_says(refusal_of_text(std::string("\0\0\x27\x0A\0\0", 6)), "is a shapefile");
  check_says(refusal_of_text("\x89HDF\r\n"), "as stores and results are");
  check_says(refusal_of_text("\xFE\xFF" + std::string("\0001\0 ", 4)), "UTF-16");
}
