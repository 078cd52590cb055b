// A file that declares how much it holds is refused wherever it is cut.
#include <fstream>

#include "support/bytes/e57_bytes.hpp"
#include "support/bytes/las_bytes.hpp"
#include "support/bytes/pcd_bytes.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/reader_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// Requires that the whole file is read, and that it is refused when cut at any byte, except within
/// its last `spare` bytes, without which it has the same number of points.
void check_every_cut(const std::string& name, const std::string& bytes, bool as_stream,
                     std::size_t spare = 0) {
  ScratchFolder scratch;
  const auto path = scratch.write(name, bytes);
  const auto refusal = [&] { return as_stream ? stream_refusal_of(path) : refusal_of(path); };
  REQUIRE(refusal().empty());
  for (std::size_t size = bytes.size(); size-- > 0;) {
    std::filesystem::resize_file(path, size);
    const std::string message = refusal();
    if (size + spare >= bytes.size()) {
      CHECK(message.empty());
      continue;
    }
    if (message.find(path.string()) == std::string::npos) {
      FAIL("not refused when cut to " << size << " of " << bytes.size() << " bytes");
    }
  }
}

const std::string kXyz = "property float x\nproperty float y\nproperty float z\n";

}  // namespace

TEST_CASE("a cut LAS file is refused at every byte") {
  const bool as_stream = GENERATE(false, true);
  LasBytes las;
  las.vlrs = {{"someone", 7, "payload"}, {"LASF_Projection", 2112, "LOCAL_CS[\"a\"]"}};
  SECTION("1.0, format 1, signature before the points") {
    las.minor = 0;
    las.format = 1;
    las.padding = 2;
  }
  SECTION("1.2, format 3, extra bytes") {
    las.format = 3;
    las.extra_bytes = 5;
  }
  SECTION("1.3, format 4, waveforms") {
    las.minor = 3;
    las.format = 4;
    las.global_encoding = 2;
    las.evlrs = {{"LASF_Spec", 65535, "waveforms"}};
  }
  SECTION("1.4, format 6, extended records") {
    las.minor = 4;
    las.format = 6;
    las.evlrs = {{"someone", 1, "payload"}, {"LASF_Projection", 2112, "LOCAL_CS[\"b\"]"}};
  }
  SECTION("1.4, format 10, no points") {
    las.minor = 4;
    las.format = 10;
    las.points.clear();
  }
  check_every_cut("a.las", las.build(), as_stream);
}

TEST_CASE("a cut E57 file is refused at every byte") {
  E57Bytes file;
  file.page = 128;
  file.scans = {e57_scan({1, 2}, {3, 4}, {5, 6}), e57_scan({}, {}, {})};
  check_every_cut("a.e57", file.build(), false);
}

TEST_CASE("a cut binary PLY file is refused at every byte") {
  const std::string format = GENERATE("binary_little_endian", "binary_big_endian");
  const std::string head = "ply\nformat " + format + " 1.0\n";
  SECTION("fixed size") {
    check_every_cut(
        "a.ply", head + "element vertex 3\n" + kXyz + "end_header\n" + std::string(36, 'v'), false);
  }
  SECTION("lists around the vertices and in them") {
    // The list has 0x0101 = 257 two-byte items in either byte order.
    const std::string list = "\1\1" + std::string(514, 'i');
    const std::string property = "property list ushort short a\n";
    check_every_cut("a.ply",
                    head + "element a 1\n" + property + "element vertex 1\n" + kXyz + property +
                        "end_header\n" + list + std::string(12, 'v') + list,
                    false);
  }
  SECTION("elements behind the vertices are not looked at") {
    check_every_cut("a.ply",
                    head + "element vertex 3\n" + kXyz +
                        "element face 1\nproperty list uchar int n\nend_header\n" +
                        std::string(36, 'v') + std::string(9, 'f'),
                    false, 9);
  }
  SECTION("no vertices") {
    check_every_cut("a.ply", head + "element vertex 0\n" + kXyz + "end_header\n", false);
  }
}

// A text that lacks its last line break is read where all values of its last line are present,
// because missing digits of the last number cannot be noticed.
TEST_CASE("a cut ASCII PLY file is refused at every byte before its last number") {
  const std::string head =
      "ply\nformat ascii 1.0\nelement a 1\nproperty list uchar int n\n"
      "element vertex 2\n" +
      kXyz;
  const std::string rows = "2 10 11\n1.25 2.25 3.25\n4.25 5.25 625\n";
  check_every_cut("a.ply", head + "end_header\n" + rows, false, 3);
  // Elements behind the vertices are not read, but the last vertex must be complete.
  check_every_cut(
      "a.ply",
      head + "element face 1\nproperty list uchar int n\nend_header\n" + rows + "3 10 11 12\n",
      false, 11);
}

TEST_CASE("a cut PTS file is refused at every byte before its last number") {
  std::string text = "12\n";
  for (int i = 0; i < 12; ++i) text += "1.25 2.25 3.25 100 200 255\n";
  check_every_cut("a.pts", text, false, 3);
}

TEST_CASE("a text that ends within a number is refused, one without a line break is read") {
  ScratchFolder scratch;
  const std::string ply = "ply\nformat ascii 1.0\nelement vertex 1\n" + kXyz + "end_header\n";
  CHECK(refusal_of(scratch.write("a.ply", ply + "1 2 3.")) != "");
  CHECK(refusal_of(scratch.write("a.pts", "1\n1 2 3.")) != "");
  for (const auto& path :
       {scratch.write("b.ply", ply + "1 2 3.5"), scratch.write("b.pts", "1\n1 2 3.5")}) {
    const ReadCloud cloud = read_all(path);
    check_equal(cloud.positions, {{1, 2, 3.5}});
    CHECK(cloud.info.remarks.empty());
  }
}

TEST_CASE("a text without a count whose last line lacks values may be cut") {
  ScratchFolder scratch;
  CHECK(read_all(scratch.write("a.xyz", "1 2 3 4\n1 2 3 4")).info.remarks.empty());
  const ReadCloud cloud = read_all(scratch.write("b.xyz", "1 2 3 4\n1 2 3"));
  check_equal(cloud.positions.size(), 2);
  REQUIRE(cloud.info.remarks.size() == 1);
  CHECK(cloud.info.remarks[0].severity == Message::Severity::kWarning);
  check_equal(cloud.info.remarks[0].code, "cut-text");
}

TEST_CASE("a cut PTX file is refused at every byte before its last number") {
  const std::string matrix = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";
  check_every_cut("a.ptx",
                  "3\n2\n" + matrix + "1.25 2.25 3.25 0.5\n0 0 0 0.5\n" +
                      "1 2 3 0.5\n1 2 3 0.5\n1 2 3 0.5\n1 2 3 975\n",
                  false, 3);
}

TEST_CASE("a cut PCD file is refused at every byte") {
  PcdHeaderText header;
  const std::string rows = raw(1.F, 2.F, 3.F, 4.F, 5.F, 6.F);
  SECTION("ascii") {
    check_every_cut("a.pcd", header.build("ascii") + "1.25 2.25 3.25\n4.25 5.25 625\n", false, 3);
  }
  SECTION("binary") { check_every_cut("a.pcd", header.build("binary") + rows, false); }
  SECTION("compressed") {
    check_every_cut("a.pcd", header.build("binary_compressed") + compressed(rows), false);
  }
}
