// Forms of poses beyond the plain text formats: unit, lever arm, quaternions without time, 3DTK.
#include <algorithm>
#include <cmath>

#include "clearway/error.hpp"
#include "clearway/trajectory.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/reader_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

std::vector<Pose> poses_of(const std::string& text, const TrajectoryOptions& options = {},
                           const std::string& name = "path.txt") {
  const ScratchFolder scratch;
  return read_trajectory(scratch.write(name, text), options);
}

std::string refusal(const std::string& text, const TrajectoryOptions& options = {},
                    const std::string& name = "path.txt") {
  try {
    poses_of(text, options, name);
  } catch (const InputError& error) {
    return error.what();
  }
  FAIL("read");
  return {};
}

const std::string kTurn = "0 -1 0 7 1 0 0 8 0 0 1 9\n";  // a quarter turn about z, to (7, 8, 9)

}  // namespace

TEST_CASE("lines that start with // are comments") {
  check_equal(poses_of("// made by hand\n" + kTurn + "  // again\n" + kTurn).size(), 2);
}

TEST_CASE("a position and a quaternion without time: the order is to be named") {
  const std::string row = "7 8 9 0.8 0 0 0.6\n";
  check_says(refusal(row), "pose-xyzw ... pose-wxyz");
  const Pose xyzw = poses_of(row, {.format = TrajectoryFormat::kPoseXyzw}).at(0);
  CHECK(xyzw.rotation[8] == Approx(1 - 2 * 0.64));  // a turn about x
  CHECK(xyzw.rotation[0] == Approx(1));
  const Pose wxyz = poses_of(row, {.format = TrajectoryFormat::kPoseWxyz}).at(0);
  CHECK(wxyz.rotation[8] == Approx(1));  // a turn about z
  CHECK(wxyz.rotation[0] == Approx(1 - 2 * 0.36));
  check_equal(wxyz.translation[2], 9);
  check_says(refusal("1 2 3\n", {.format = TrajectoryFormat::kPoseXyzw}), "7: x y z qx qy qz qw");
  check_says(refusal("1 2 3 0 0 0\n"), "6 numbers ... heading_deg");
}

TEST_CASE("a unit scales positions alone") {
  const Pose pose =
      poses_of("0 -1 0 7000 1 0 0 8000 0 0 1 9000\n", {.metres_per_unit = 0.001}).at(0);
  check_equal(pose.translation[0], 7);
  check_equal(pose.translation[2], 9);
  check_equal(pose.rotation[1], -1);
  const std::string quaternion = ",qx,qy,qz,qw\n7000,8000,9000,0,0,0,1\n";
  check_equal(poses_of("x[mm],y[mm],z[mm]" + quaternion).at(0).translation[1], 8);
  check_equal(poses_of("x_cm,y_cm,z_cm" + quaternion).at(0).translation[1], 80);
  CHECK(poses_of("x (ft),y (ft),z (ft)" + quaternion).at(0).translation[0] == 7000 * 0.3048);
  check_says(refusal("x[mm],y[m],z[mm]" + quaternion), "several units");
  check_says(refusal("x[px],y[px],z[px]" + quaternion), "px");
  check_says(refusal("x[mm],y[mm],z[mm]" + quaternion, {.metres_per_unit = 1}), "was declared");
}

TEST_CASE("positions of a known unit are converted into the environment's") {
  const std::string row = "1 0 0 9 0 1 0 3.048 0 0 1 0\n";
  check_equal(poses_of(row, {.environment_unit = 0.3048}).at(0).translation[1], 3.048);
  const TrajectoryOptions metres{.metres_per_unit = 1, .environment_unit = 0.3048};
  CHECK(poses_of(row, metres).at(0).translation[1] == Approx(10));
  const std::string named = "x_ft,y_ft,z_ft,qx,qy,qz,qw\n10,20,30,0,0,0,1\n";
  CHECK(poses_of(named, {.environment_unit = 0.3048}).at(0).translation[2] == Approx(30));
  const TrajectoryOptions arm{.environment_unit = 0.3048, .lever_arm = {0, 4, 0}};
  CHECK(poses_of(named, arm).at(0).translation[1] == Approx(16));
  // 9 mm become the double nearest to 0.009, as for models.
  check_equal(poses_of(row, {.metres_per_unit = 0.001}).at(0).translation[0], 0.009);
  check_says(refusal("x_ft,y_ft,z,qx,qy,qz,qw\n10,20,30,0,0,0,1\n"), "some of the positions");
}

TEST_CASE("a last number that ends with its point is warned of") {
  const ScratchFolder scratch;
  const std::string row = "1 0 0 9 0 1 0 3 0 0 1 3";
  std::vector<Message> remarks;
  read_trajectory(scratch.write("a.txt", row + "\n" + row), {}, &remarks);
  const auto cut = [&] {
    return std::any_of(remarks.begin(), remarks.end(),
                       [](const Message& m) { return m.code == "cut-text"; });
  };
  CHECK_FALSE(cut());
  read_trajectory(scratch.write("b.txt", row + "\n" + row + "."), {}, &remarks);
  CHECK(cut());
}

TEST_CASE("a lever arm leads from the trajectory's point back to the model's origin") {
  // The antenna is 2 m ahead of the origin and 1 m above; the model looks along y.
  const Pose pose = poses_of(kTurn, {.lever_arm = {2, 0, 1}}).at(0);
  check_equal(pose.translation[0], 7);
  check_equal(pose.translation[1], 6);
  check_equal(pose.translation[2], 8);
  const Vec3 arm{0.3, -1.2, 0.7};
  const Pose moved = poses_of(kTurn, {.lever_arm = arm}).at(0);
  for (int row = 0; row < 3; ++row) {  // the antenna is at the file's position
    const double* r = moved.rotation + 3 * row;
    const double antenna = r[0] * arm.x + r[1] * arm.y + r[2] * arm.z + moved.translation[row];
    CHECK(antenna == Approx(7 + row));
  }
}

TEST_CASE("3DTK: a .pose is one pose, in our frame") {
  // A pose of 3DTK: 100 to the right, 200 up, 300 ahead, and a quarter turn about its y axis.
  const Pose pose = poses_of("100 200 300\n0 90 0\n", {}, "scan000.pose").at(0);
  CHECK(pose.translation[0] == Approx(3));
  CHECK(pose.translation[1] == Approx(-1));
  CHECK(pose.translation[2] == Approx(2));
  // The turn about up is left-handed, so the front turns to the right, which is -y.
  CHECK(pose.rotation[3] == Approx(-1));
  CHECK(pose.rotation[8] == Approx(1));
  check_says(refusal("1 2 3\n", {}, "scan000.pose"), "expected six");
  CHECK_THROWS_AS(poses_of("1 2 3 0 0 0\n", {.metres_per_unit = 0.01}, "a.pose"), UsageError);
}

TEST_CASE("3DTK: the last line of a .frames counts") {
  const std::string first = "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 1\n";
  const std::string last = "1 0 0 0 0 1 0 0 0 0 1 0 100 200 300 1 2\n";
  const auto poses = poses_of(first + last, {}, "scan000.frames");
  REQUIRE(poses.size() == 1);
  check_equal(poses[0].translation[0], 3);
  check_equal(poses[0].translation[1], -1);
}

TEST_CASE("3DTK: a folder is a trajectory in the order of its numbers") {
  const ScratchFolder scratch;
  scratch.write("scan002.pose", "0 0 200\n0 0 0\n");
  scratch.write("scan010.pose", "0 0 1000\n0 0 0\n");
  scratch.write("scan000.pose", "0 0 0\n0 0 0\n");
  scratch.write("scan000.3d", "1 2 3\n");
  scratch.write("readme.pose", "hello\n");
  std::vector<Message> remarks;
  const auto poses = read_trajectory(scratch.folder(), {}, &remarks);
  REQUIRE(poses.size() == 3);
  check_equal(poses[1].translation[0], 2);
  check_equal(poses[2].translation[0], 10);
  check_equal(remarks.at(0).code, "model-frame");

  const std::string frame = "1 0 0 0 0 1 0 0 0 0 1 0 0 0 500 1 2\n";
  scratch.write("scan000.frames", frame);
  check_refused([&] { return read_trajectory(scratch.folder()); }, "scan002.pose has no .frames");
  check_equal(read_trajectory(scratch.folder(), {.format = TrajectoryFormat::kThreedtkPose}).size(),
              3);
  scratch.write("scan002.frames", frame);
  scratch.write("scan010.frames", frame);
  check_equal(read_trajectory(scratch.folder()).at(0).translation[0], 5);
  scratch.write("scan10.pose", "0 0 0\n0 0 0\n");
  check_refused([&] { return read_trajectory(scratch.folder()); }, "the same number");
  const ScratchFolder empty;
  check_refused([&] { return read_trajectory(empty.folder()); }, "scan000.pose");
}

TEST_CASE("doubts reach the remarks") {
  const ScratchFolder scratch;
  std::string text;
  for (int i = 0; i < 100; ++i) {
    const double a = 0.01 * i;
    text += "1 0 0 " + std::to_string(50 * std::cos(a)) + " 0 1 0 " +
            std::to_string(50 * std::sin(a)) + " 0 0 1 0\n";
  }
  std::vector<Message> remarks;
  read_trajectory(scratch.write("path.txt", text), {}, &remarks);
  REQUIRE(remarks.size() == 1);
  check_equal(remarks[0].code, "rotation-missing");
}
