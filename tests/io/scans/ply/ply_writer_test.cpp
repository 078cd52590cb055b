#include "io/scans/ply/ply_writer.hpp"

#include <stdexcept>

#include "support/bytes/pcd_bytes.hpp"
#include "support/bytes/written_bytes.hpp"
#include "support/catch.hpp"

using namespace clearway;
using namespace clearway::test;

TEST_CASE("a double PLY holds header and coordinates bit for bit") {
  const File file = nameless_file();
  PlyWriter writer(file, {.points = 2, .comments = {"a body"}});
  writer.write(std::vector<Vec3>{{0.1, -2, 1e300}});
  writer.write(std::vector<Vec3>{{5, 6, 7}});
  writer.finish();
  CHECK(WrittenBytes(file).all() ==
        "ply\nformat binary_little_endian 1.0\ncomment a body\nelement vertex 2\n"
        "property double x\nproperty double y\nproperty double z\nend_header\n" +
            raw(0.1, -2., 1e300, 5., 6., 7.));
}

TEST_CASE("a float PLY with first poses") {
  const File file = nameless_file();
  PlyWriter writer(
      file, {.points = 1, .coordinates = PlyCoordinates::kFloat32, .fields = {{"first_pose"}}});
  const std::vector<std::uint32_t> pose{4000000000u};
  const FieldValues field = std::span<const std::uint32_t>(pose);
  writer.write(std::vector<Vec3>{{0.1, -2, 3}}, std::span(&field, 1));
  writer.finish();
  CHECK(WrittenBytes(file).all() ==
        "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty float x\n"
        "property float y\nproperty float z\nproperty uint first_pose\nend_header\n" +
            raw(0.1F, -2.F, 3.F, 4000000000u));
}

TEST_CASE("a PLY with another number of points than promised is refused") {
  const File file = nameless_file();
  PlyWriter writer(file, {.points = 2});
  writer.write(std::vector<Vec3>{{1, 2, 3}});
  CHECK_THROWS_AS(writer.finish(), std::logic_error);
  const std::vector<std::uint32_t> pose{0};
  const FieldValues field = std::span<const std::uint32_t>(pose);
  CHECK_THROWS_AS(writer.write(std::vector<Vec3>{{1, 2, 3}}, std::span(&field, 1)),
                  std::logic_error);
}
