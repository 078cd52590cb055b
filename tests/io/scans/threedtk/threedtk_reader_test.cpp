#include "io/scans/threedtk/threedtk_reader.hpp"

#include <catch2/catch.hpp>

#include "support/reader_fixture.hpp"

using namespace clearway;
using namespace clearway::test;
using Catch::Matchers::Contains;

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
  ReaderScratch scratch;
  const auto path = scratch.write("scan000.3d", "100 0 0\n0 100 0 0.5\n0 0 100 1 2 3\n");
  scratch.write("scan000.pose", kMoved);
  const auto reader = open_point_file(path);
  for (int pass = 0; pass < 2; ++pass) {
    const auto cloud = read_all(*reader);
    CHECK(cloud.positions == std::vector<Vec3>{{3, -2, 2}, {3, -1, 3}, {4, -1, 2}});
    REQUIRE(cloud.info.remarks.size() == 1);
    CHECK(has(cloud, "scan-placed", Message::Severity::kNote));
    CHECK_THAT(cloud.info.remarks[0].text, Contains("scan000.pose"));
    reader->rewind();
  }
}

TEST_CASE("the last line of .frames counts more than .pose") {
  ReaderScratch scratch;
  const auto path = scratch.write("scan007.3d", "0 0 0\n");
  scratch.write("scan007.pose", kMoved);
  scratch.write("scan007.frames", kFrames);
  const auto cloud = read_all(path);
  CHECK(cloud.positions == std::vector<Vec3>{{5, 0, 0}});
  CHECK_THAT(cloud.info.remarks[0].text, Contains("the last line of scan007.frames"));
  // The neighbouring scan has no .frames, so that it may not be registered.
  const auto other = scratch.write("scan008.3d", "0 0 0\n");
  scratch.write("scan008.pose", kMoved);
  CHECK(has(read_all(other), "scan-not-registered", Message::Severity::kWarning));
}

TEST_CASE("a scan without a pose is refused, unless it is alone") {
  ReaderScratch scratch;
  const auto path = scratch.write("scan000.3d", "0 0 100\n");
  scratch.write("readme.txt", "");
  const auto cloud = read_all(path);
  CHECK(cloud.positions == std::vector<Vec3>{{1, 0, 0}});
  CHECK(has(cloud, "scan-without-pose", Message::Severity::kWarning));
  const std::string other = GENERATE("scan001.3d", "scan001.pose", "scan001.frames");
  scratch.write(other, "0 0 0\n");
  CHECK_THAT(refusal_of(path), Contains(path.string()) && Contains("scan000.frames or"));
}

TEST_CASE("lines before the first point of a 3DTK scan are passed over, ten at most") {
  ReaderScratch scratch;
  scratch.write("scan000.pose", "0 0 0 0 0 0\n");
  const auto cloud = read_all(scratch.write("scan000.3d", "361 225\n# c\nx y z\n0 0 100\n"));
  CHECK(cloud.positions == std::vector<Vec3>{{1, 0, 0}});
  std::string many;
  for (int i = 0; i < 11; ++i) many += "header\n";
  CHECK_THAT(refusal_of(scratch.write("scan000.3d", many + "0 0 100\n")), Contains("line 11"));
  CHECK_THAT(refusal_of(scratch.write("scan000.3d", "0 0 100\n1 2\n")), Contains("line 2"));
}

TEST_CASE("a malformed pose refuses its scan") {
  ReaderScratch scratch;
  const auto path = scratch.write("scan000.3d", "0 0 100\n");
  scratch.write("scan000.pose", "0 0 0 0 0\n");
  CHECK_THAT(refusal_of(path), Contains("scan000.pose") && Contains("5 numbers"));
  CHECK(threedtk_pose_file(path) == scratch.folder() / "scan000.pose");
  scratch.write("scan000.frames", "");
  CHECK_THAT(refusal_of(path), Contains("scan000.frames") && Contains("no pose"));
}
