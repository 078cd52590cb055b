#include "io/scans/threedtk/threedtk_frame.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "support/reader_fixture.hpp"

using namespace clearway;
using namespace clearway::test;
using Catch::Matchers::Contains;

namespace {

Pose pose_in(const std::string& text) {
  ReaderScratch scratch;
  InputBuffer input(File::open_regular(scratch.write("scan000.pose", text)),
                    InputBuffer::Access::kSeek);
  return read_threedtk_pose(input);
}

Pose frames_in(const std::string& text) {
  ReaderScratch scratch;
  InputBuffer input(File::open_regular(scratch.write("scan000.frames", text)),
                    InputBuffer::Access::kSeek);
  return read_threedtk_frames(input);
}

template <typename Read>
std::string refusal_in(Read read, const std::string& text) {
  try {
    read(text);
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

Vec3 placed(const Pose& pose, const Vec3& p) {
  const double* r = pose.rotation;
  return {r[0] * p.x + r[1] * p.y + r[2] * p.z + pose.translation[0],
          r[3] * p.x + r[4] * p.y + r[5] * p.z + pose.translation[1],
          r[6] * p.x + r[7] * p.y + r[8] * p.z + pose.translation[2]};
}

void check_near(const Vec3& found, const Vec3& expected) {
  for (int axis = 0; axis < 3; ++axis) {
    CHECK(found[axis] == Approx(expected[axis]).margin(1e-12));
  }
}

const std::string kIdentity = "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1";

}  // namespace

TEST_CASE("3DTK's axes are x right, y up, z forward, ours x forward, y left, z up") {
  CHECK(from_threedtk(Vec3{100, 0, 0}) == Vec3{0, -1, 0});
  CHECK(from_threedtk(Vec3{0, 100, 0}) == Vec3{0, 0, 1});
  CHECK(from_threedtk(Vec3{0, 0, 100}) == Vec3{1, 0, 0});
}

TEST_CASE("a pose that is moved only") {
  const Pose pose = pose_in("100 200 300\n0 0 0\n");
  check_near(placed(pose, {0, 0, 0}), {3, -1, 2});
  check_near(placed(pose, {1, 0, 0}), {4, -1, 2});
}

// Turns as in 3DTK's EulerToMatrix4 and transform3: about x, y goes to z; about y, z to x; about z,
// x to y.
TEST_CASE("a turn about each of 3DTK's axes") {
  const Vec3 right = from_threedtk(Vec3{100, 0, 0});
  const Vec3 up = from_threedtk(Vec3{0, 100, 0});
  const Vec3 forward = from_threedtk(Vec3{0, 0, 100});
  check_near(placed(pose_in("0 0 0 90 0 0"), up), forward);
  check_near(placed(pose_in("0 0 0 0 90 0"), forward), right);
  check_near(placed(pose_in("0 0 0 0 0 90"), right), up);
  // The turn about x comes last: that about z takes right to up, then that about x takes up to
  // forward.
  check_near(placed(pose_in("0 0 0 90 0 90"), right), forward);
}

TEST_CASE("a pose and the same motion as a frame are equal") {
  const double position[3]{-7.99848, -15.3529, 337.973};
  const double angles[3]{1.11333, -0.470508, -179.479231};
  const ThreedtkMatrix matrix = threedtk_matrix(position, angles);
  Pose euler{}, frame{};
  CHECK(pose_of_threedtk_euler(std::vector<double>{position[0], position[1], position[2], angles[0],
                                                   angles[1], angles[2]},
                               euler)
            .text.empty());
  CHECK(pose_of_threedtk_frame(matrix, false, frame).text.empty());
  CHECK(euler == frame);
}

TEST_CASE("the last line of a .frames file counts, with or without the colour") {
  const std::string moved = "1 0 0 0 0 1 0 0 0 0 1 0 100 200 300 1";
  check_near(placed(frames_in(kIdentity + " 2\n" + moved + " 1\n\n"), {0, 0, 0}), {3, -1, 2});
  check_near(placed(frames_in(kIdentity + "\n" + moved), {0, 0, 0}), {3, -1, 2});
}

TEST_CASE("a malformed .pose file is refused") {
  const auto refusal = [](const std::string& text) { return refusal_in(pose_in, text); };
  CHECK(refusal("\xEF\xBB\xBF 1 2 3\r\n4 5 6 1234.5\r\n").empty());
  CHECK_THAT(refusal(""), Contains("0 numbers") && Contains("expected six"));
  CHECK_THAT(refusal("1 2 3\n4 5\n"), Contains("5 numbers"));
  CHECK_THAT(refusal("1 2 3\n4 5 6 7 8\n"), Contains("line 2"));
  CHECK_THAT(refusal("1 2 3\n4 5 x\n"), Contains("line 2"));
  CHECK_THAT(refusal("1 2 3\n4 5 nan\n"), Contains("finite"));
  CHECK_THAT(refusal("1 2 3\n4 5 1e400\n"), Contains("line 2"));
}

TEST_CASE("a malformed .frames file is refused with its line") {
  const auto refusal = [](const std::string& text) { return refusal_in(frames_in, text); };
  CHECK_THAT(refusal("\n"), Contains("holds no pose"));
  CHECK_THAT(refusal(kIdentity + " 2\n1 0 0 0\n"), Contains("line 2") && Contains("4 numbers"));
  CHECK_THAT(refusal("1 0 0 5 0 1 0 6 0 0 1 7 0 0 0 1 2\n" + kIdentity + "\n"),
             Contains("line 1") && Contains("column by column"));
  CHECK_THAT(refusal("2 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 2\n"), Contains("rigid"));
  CHECK_THAT(refusal("-1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 2\n"), Contains("determinant -1"));
  CHECK_THAT(refusal(kIdentity + " 2 3\n"), Contains("expected 17 numbers"));
  CHECK_THAT(refusal("one\n"), Contains("line 1"));
}
