// A file that declares how much it holds is refused wherever it is cut.
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
void check_every_cut(const std::string& name, const std::string& bytes, std::size_t spare = 0,
                     bool as_stream = false) {
  const RowName row(name + (as_stream ? " as a stream: " : ": ") + bytes.substr(0, 300));
  const ScratchFolder scratch;
  const auto path = scratch.write(name, bytes);
  for (std::size_t size = bytes.size() + 1; size-- > 0;) {
    std::filesystem::resize_file(path, size);
    const std::string message = as_stream ? stream_refusal_of(path) : refusal_of(path);
    if (size + spare >= bytes.size()) {
      check_equal(message, "");
    } else if (message.find(path.string()) == std::string::npos) {
      FAIL("not refused when cut to " << size << " of " << bytes.size() << " bytes");
    }
  }
}

std::string ply(const std::string& format, const std::string& elements, const std::string& body) {
  return "ply\nformat " + format + " 1.0\n" + elements + "end_header\n" + body;
}

const std::string kXyz = "property float x\nproperty float y\nproperty float z\n";
const std::string kFace = "element face 1\nproperty list uchar int n\n";

}  // namespace

TEST_CASE("a cut LAS file is refused at every byte, and so is a cut stream") {
  std::vector<LasBytes> files(5);
  for (LasBytes& las : files) {
    las.vlrs = {{"someone", 7, "payload"}, {"LASF_Projection", 2112, "LOCAL_CS[\"a\"]"}};
  }
  files[0].minor = 0;
  files[0].format = 1;
  files[0].padding = 2;
  files[1].format = 3;
  files[1].extra_bytes = 5;
  files[2].minor = 3;
  files[2].format = 4;
  files[2].global_encoding = 2;
  files[2].evlrs = {{"LASF_Spec", 65535, "waveforms"}};
  files[3].minor = 4;
  files[3].format = 6;
  files[3].evlrs = {{"someone", 1, "payload"}, {"LASF_Projection", 2112, "LOCAL_CS[\"b\"]"}};
  files[4].minor = 4;
  files[4].format = 10;
  files[4].points.clear();
  for (const LasBytes& las : files) {
    for (const bool as_stream : {false, true}) check_every_cut("a.las", las.build(), 0, as_stream);
  }
}

TEST_CASE("a cut binary file is refused at every byte") {
  E57Bytes e57;
  e57.page = 128;
  e57.scans = {e57_scan({1, 2}, {3, 4}, {5, 6}), e57_scan({}, {}, {})};
  check_every_cut("a.e57", e57.build());
  const std::string rows = raw(1.F, 2.F, 3.F, 4.F, 5.F, 6.F);
  check_every_cut("a.pcd", PcdHeaderText().build("binary") + rows);
  check_every_cut("a.pcd", PcdHeaderText().build("binary_compressed") + compressed(rows));
  for (const std::string format : {"binary_little_endian", "binary_big_endian"}) {
    const std::string vertices(36, 'v'), three = "element vertex 3\n" + kXyz;
    check_every_cut("a.ply", ply(format, three, vertices));
    check_every_cut("a.ply", ply(format, "element vertex 0\n" + kXyz, ""));
    // The list has 0x0101 = 257 two-byte items in either byte order.
    const std::string list = "\1\1" + std::string(514, 'i');
    const std::string property = "property list ushort short a\n";
    check_every_cut("a.ply",
                    ply(format, "element a 1\n" + property + "element vertex 1\n" + kXyz + property,
                        list + std::string(12, 'v') + list));
    // Elements behind the vertices are not read.
    check_every_cut("a.ply", ply(format, three + kFace, vertices + std::string(9, 'f')), 9);
  }
}

// A text that lacks its last line break is read where all values of its last line are present,
// because missing digits of the last number cannot be noticed.
TEST_CASE("a cut text that declares its points is refused at every byte before its last number") {
  const std::string two = "element a 1\nproperty list uchar int n\nelement vertex 2\n" + kXyz;
  const std::string rows = "1.25 2.25 3.25\n4.25 5.25 625\n";
  check_every_cut("a.ply", ply("ascii", two, "2 10 11\n" + rows), 3);
  check_every_cut("a.ply", ply("ascii", two + kFace, "2 10 11\n" + rows + "3 10 11 12\n"), 11);
  check_every_cut("a.pcd", PcdHeaderText().build("ascii") + rows, 3);
  std::string pts = "12\n";
  for (int i = 0; i < 12; ++i) pts += "1.25 2.25 3.25 100 200 255\n";
  check_every_cut("a.pts", pts, 3);
  const std::string matrix = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";
  check_every_cut("a.ptx",
                  "3\n2\n" + matrix + "1.25 2.25 3.25 0.5\n0 0 0 0.5\n" +
                      "1 2 3 0.5\n1 2 3 0.5\n1 2 3 0.5\n1 2 3 975\n",
                  3);
}
