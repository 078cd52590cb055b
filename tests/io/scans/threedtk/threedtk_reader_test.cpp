#include "io/scans/threedtk/threedtk_reader.hpp"

#include <cmath>

#include "io/scans/threedtk/threedtk_frame.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/reader_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

const std::string kMoved = "100 200 300\n0 0 0\n";
const std::string kFrames =
    "1 0 0 0 0 1 0 0 0 0 1 0 9 9 9 1 2\n1 0 0 0 0 1 0 0 0 0 1 0 0 0 500 1 1\n";

bool has(const ReadCloud& cloud, const std::string& code, Message::Severity severity) {
  for (const Message& remark : cloud.info.remarks) {
    if (remark.code == code && remark.severity == severity) return true;
  }
  return false;
}

}  // namespace

TEST_CASE("a scan of 3DTK is placed by its .pose in right-handed metres") {
  ScratchFolder scratch;
  const auto path = scratch.write("scan000.3d", "100 0 0\n0 100 0 0.5\n0 0 100 1 2 3\n");
  scratch.write("scan000.pose", kMoved);
  const auto reader = open_point_file(path);
  for (int pass = 0; pass < 2; ++pass) {
    const auto cloud = read_all(*reader);
    check_equal(cloud.positions, {{3, -2, 2}, {3, -1, 3}, {4, -1, 2}});
    REQUIRE(cloud.info.remarks.size() == 1);
    CHECK(has(cloud, "scan-placed", Message::Severity::kNote));
    check_says(cloud.info.remarks[0].text, "scan000.pose");
    reader->rewind();
  }
}

TEST_CASE("the last line of .frames counts more than .pose") {
  ScratchFolder scratch;
  const auto path = scratch.write("scan007.3d", "0 0 0\n");
  scratch.write("scan007.pose", kMoved);
  scratch.write("scan007.frames", kFrames);
  const auto cloud = read_all(path);
  check_equal(cloud.positions, {{5, 0, 0}});
  check_says(cloud.info.remarks[0].text, "the last line of scan007.frames");
  // The neighbouring scan has no .frames, so that it may not be registered.
  const auto other = scratch.write("scan008.3d", "0 0 0\n");
  scratch.write("scan008.pose", kMoved);
  CHECK(has(read_all(other), "scan-not-registered", Message::Severity::kWarning));
}

TEST_CASE("a scan without a pose is refused, unless it is alone") {
  ScratchFolder scratch;
  const auto path = scratch.write("scan000.3d", "0 0 100\n");
  scratch.write("readme.txt", "");
  const auto cloud = read_all(path);
  check_equal(cloud.positions, {{1, 0, 0}});
  CHECK(has(cloud, "scan-without-pose", Message::Severity::kWarning));
  const std::string other = GENERATE("scan001.3d", "scan001.pose", "scan001.frames");
  scratch.write(other, "0 0 0\n");
  check_says(refusal_of(path), std::string(path.string()) + " ... scan000.frames or");
}

TEST_CASE("lines before the first point of a 3DTK scan are passed over, ten at most") {
  ScratchFolder scratch;
  scratch.write("scan000.pose", "0 0 0 0 0 0\n");
  const auto cloud = read_all(scratch.write("scan000.3d", "361 225\n# c\nx y z\n0 0 100\n"));
  check_equal(cloud.positions, {{1, 0, 0}});
  std::string many;
  for (int i = 0; i < 11; ++i) many += "header\n";
  check_says(refusal_of(scratch.write("scan000.3d", many + "0 0 100\n")), "line 11");
  check_says(refusal_of(scratch.write("scan000.3d", "0 0 100\n1 2\n")), "line 2");
}

TEST_CASE("a malformed pose refuses its scan") {
  ScratchFolder scratch;
  const auto path = scratch.write("scan000.3d", "0 0 100\n");
  scratch.write("scan000.pose", "0 0 0 0 0\n");
  check_says(refusal_of(path), "scan000.pose ... 5 numbers");
  CHECK(threedtk_pose_file(path) == scratch.folder() / "scan000.pose");
  scratch.write("scan000.frames", "");
  check_says(refusal_of(path), "scan000.frames ... no pose");
}

namespace {

Pose pose_in(const std::string& text) {
  ScratchFolder scratch;
  InputBuffer input(File::open_regular(scratch.write("scan000.pose", text)),
                    InputBuffer::Access::kSeek);
  return read_threedtk_pose(input);
}

Pose frames_in(const std::string& text) {
  ScratchFolder scratch;
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
  check_says(refusal(""), "0 numbers ... expected six");
  check_says(refusal("1 2 3\n4 5\n"), "5 numbers");
  check_says(refusal("1 2 3\n4 5 6 7 8\n"), "line 2");
  check_says(refusal("1 2 3\n4 5 x\n"), "line 2");
  check_says(refusal("1 2 3\n4 5 nan\n"), "finite");
  check_says(refusal("1 2 3\n4 5 1e400\n"), "line 2");
}

TEST_CASE("a malformed .frames file is refused with its line") {
  const auto refusal = [](const std::string& text) { return refusal_in(frames_in, text); };
  check_says(refusal("\n"), "holds no pose");
  check_says(refusal(kIdentity + " 2\n1 0 0 0\n"), "line 2 ... 4 numbers");
  check_says(refusal("1 0 0 5 0 1 0 6 0 0 1 7 0 0 0 1 2\n" + kIdentity + "\n"),
             "line 1 ... column by column");
  check_says(refusal("2 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 2\n"), "rigid");
  check_says(refusal("-1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 2\n"), "determinant -1");
  check_says(refusal(kIdentity + " 2 3\n"), "expected 17 numbers");
  check_says(refusal("one\n"), "line 1");
}
