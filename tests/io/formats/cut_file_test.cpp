// A file that declares how much it holds is refused wherever it is cut.
#include <catch2/catch.hpp>
#include <fstream>

#include "support/e57_bytes.hpp"
#include "support/las_bytes.hpp"
#include "support/reader_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// Requires that the file is read whole, and refused when cut at any byte.
void check_every_cut(const std::string& name, const std::string& bytes, bool as_stream) {
  ReaderScratch scratch;
  const auto path = scratch.write(name, bytes);
  const auto refusal = [&] { return as_stream ? stream_refusal_of(path) : refusal_of(path); };
  REQUIRE(refusal().empty());
  for (std::size_t size = bytes.size(); size-- > 0;) {
    std::filesystem::resize_file(path, size);
    const std::string message = refusal();
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
    // A list of 0x0101 = 257 two-byte items in either byte order.
    const std::string list = "\1\1" + std::string(514, 'i');
    const std::string property = "property list ushort short a\n";
    check_every_cut("a.ply",
                    head + "element a 1\n" + property + "element vertex 1\n" + kXyz + property +
                        "element b 1\n" + property + "end_header\n" + list + std::string(12, 'v') +
                        list + list,
                    false);
  }
  SECTION("no vertices") {
    check_every_cut("a.ply", head + "element vertex 0\n" + kXyz + "end_header\n", false);
  }
}

// A text that lacks its last line break counts as cut too: its last number may lack digits.
TEST_CASE("a cut ASCII PLY file is refused at every byte") {
  const std::string text =
      "ply\nformat ascii 1.0\nelement a 1\nproperty list uchar int n\n"
      "element vertex 2\n" +
      kXyz + "element face 1\nproperty list uchar int n\nend_header\n";
  check_every_cut("a.ply", text + "2 10 11\n1.25 2.25 3.25\n4.25 5.25 6.25\n3 10 11 12\n", false);
}

TEST_CASE("a cut PTS file is refused at every byte") {
  std::string text = "12\n";
  for (int i = 0; i < 12; ++i) text += "1.25 2.25 3.25 100 200 255\n";
  check_every_cut("a.pts", text, false);
}
