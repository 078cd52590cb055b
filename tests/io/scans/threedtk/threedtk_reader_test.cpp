// How 3DTK's axes and poses become ours; its files are in tests/formats/threedtk.case.
#include "io/scans/threedtk/threedtk_reader.hpp"

#include "io/scans/threedtk/threedtk_frame.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/reader_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

TEST_CASE("a pose of 3DTK and the same motion as a frame are equal") {
  const double position[3]{-7.99848, -15.3529, 337.973};
  const double angles[3]{1.11333, -0.470508, -179.479231};
  Pose euler{}, frame{};
  CHECK(pose_of_threedtk_euler(std::vector<double>{position[0], position[1], position[2], angles[0],
                                                   angles[1], angles[2]},
                               euler)
            .text.empty());
  CHECK(pose_of_threedtk_frame(threedtk_matrix(position, angles), false, frame).text.empty());
  CHECK(euler == frame);
}

TEST_CASE("the pose of a scan of 3DTK is in the file of its number") {
  const ScratchFolder scratch;
  scratch.write("scan000.pose", "0 0 0 0 0 0\n");
  CHECK(threedtk_pose_file(scratch.write("scan000.3d", "")) == scratch.folder() / "scan000.pose");
}
