#include "io/scans/text/xyz_reader.hpp"

#include <cmath>

#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/reader_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

std::vector<Vec3> points_of(const std::string& text) {
  ScratchFolder scratch;
  const auto reader = open_point_file(scratch.write("a.xyz", text));
  const auto first = read_all(*reader).positions;
  reader->rewind();
  check_equal(read_all(*reader).positions.size(), first.size());
  return first;
}

std::string refusal_of_text(const std::string& text) {
  ScratchFolder scratch;
  const auto path = scratch.write("a.xyz", text);
  const std::string refusal = refusal_of(path);
  check_says(refusal, path.string());
  return refusal;
}

const std::vector<Vec3> kTwo{{1, -2.5, 3e2}, {4, 5, 6}};

}  // namespace

TEST_CASE("text in blanks, tabs, commas or semicolons, with anything behind it") {
  CHECK(points_of("1 -2.5 3e2\n4 5 6\n") == kTwo);
  CHECK(points_of("1\t-2.5\t3e2\r\n  4  +5  6 \r\n") == kTwo);
  CHECK(points_of("1,-2.5,3e2,red\n4, 5, 6,\n") == kTwo);
  CHECK(points_of("1;-2.5;3e2;7,5\n4 ;5 ; 6\n") == kTwo);
  CHECK(points_of("1 -2.5 3e2 0.5 255 anything\n4 5 6 # comment") == kTwo);
  CHECK(points_of("\xEF\xBB\xBF"
                  "1 -2.5 3e2\n4 5 6\n") == kTwo);
  CHECK(points_of("sep=;\r\n1;-2.5;3e2\r\n4;5;6\r\n") == kTwo);
  CHECK(points_of("\xEF\xBB\xBFsep=;\nx;y;z\n1;-2.5;3e2\n4;5;6\n") == kTwo);
  CHECK(points_of("# any\n\n// any\n1 -2.5 3e2\n  \n#\n4 5 6\n\n") == kTwo);
  CHECK(points_of("# only a comment").empty());
}

TEST_CASE("a header says where the coordinates stand") {
  CHECK(points_of("x,y,z,r,g,b\n1,-2.5,3e2,0,0,0\n4,5,6,0,0,0\n") == kTwo);
  CHECK(points_of("id;\"Z [m]\";\"X [m]\";Y (m)\na;3e2;1;-2.5\nb;6;4;5\n") == kTwo);
  CHECK(points_of("X Y Z Intensity\n1 -2.5 3e2 9\n4 5 6 9\n") == kTwo);
  CHECK(points_of("//X Y Z\n1 -2.5 3e2\n4 5 6\n") == kTwo);
  CHECK(points_of("//Z X Y R\n3e2 1 -2.5 0\n6 4 5 0\n") == kTwo);
  CHECK(points_of("# columns: x y z\n1 -2.5 3e2\n4 5 6\n") == kTwo);
  check_says(refusal_of_text("id,x,y,z\n1,1,2,3\n2,1,2\n"), "line 3");
  check_says(refusal_of_text("id;x;y;z\n1;1,5;2;3\n"), "line 2");
  check_says(refusal_of_text("x,y,depth\n1,2,3\n"), "line 1 ... header");
}

TEST_CASE("a number of points at the start is required") {
  CHECK(points_of("2\n1 -2.5 3e2 9 9 9\n4 5 6 9 9 9\n") == kTwo);
  CHECK(points_of("# any\n 2 \r\n1 -2.5 3e2\n4 5 6\n\n# end\n") == kTwo);
  CHECK(points_of("0\n").empty());
  ScratchFolder scratch;
  check_equal(open_point_file(scratch.write("a.pts", "1\n1 2 3\n"))->info().declared_points, 1);
  check_says(refusal_of_text("3\n1 2 3 7 8\n4 5 6 7 8\n"), "2 points ... expected 3");
  check_says(refusal_of_text("1\n1 2 3\n4 5 6\n"), "line 3 ... more than");
  check_says(refusal_of_text("18446744073709551615\n1 2 3\n"), "too short");
  std::string many = "65536\n";
  for (int i = 0; i < 65'536; ++i) many += "1 2 3\n";
  check_equal(points_of(many).size(), 65'536);
  check_says(refusal_of_text(many + "1 2 3\n"), "line 65538");
}

TEST_CASE("numbers that are not finite are delivered") {
  const auto points = points_of("nan 0 0\n1 -inf inf\n");
  REQUIRE(points.size() == 2);
  CHECK(std::isnan(points[0].x));
  CHECK(std::isinf(points[1].y));
}

TEST_CASE("malformed text is refused with its line") {
  for (const std::string line :
       {"1 2", "1 2 3x", "1 2 x", "1,,3", "1 2,3", "1,5 2,5 3,5", "1,5;2,5;3,5", "1;2;3,5",
        "1 2 3,5", "1 2 1e999", "1 2 --3", "1 2 +-3", "1 2 0x10", ",1,2,3", "7"}) {
    INFO(line);
    check_says(refusal_of_text("1 2 3\n\n" + line + "\n"), "line 3");
  }
  check_says(refusal_of_text(""), "empty");
  check_says(refusal_of_text("hello\n"), "line 1");
  check_says(refusal_of_text(std::string(100, '\0')), "line 1");
  check_says(refusal_of_text("\xFF\xFE" + std::string("1\0 \0", 4)), "UTF-16");
  check_says(refusal_of_text(std::string("\0001\0 \0002", 6)), "UTF-16");
  check_says(refusal_of_text("PK\x03\x04..."), "ZIP archive");
  check_says(refusal_of_text("\x1F\x8B\x08"), "compressed with gzip");
  check_says(refusal_of_text("1 2 3\n1 2 3 " + std::string(70'000, 'x') + "\n"),
             "line 2 ... 65536");
}

TEST_CASE("lines across the borders of the buffer are whole") {
  std::string text;
  std::size_t count = 0;
  while (text.size() < 700'000) {
    text += std::to_string(count) + " 0.125 " + std::string(count % 50, ' ') + "-7\n";
    ++count;
  }
  const auto points = points_of(text);
  REQUIRE(points.size() == count);
  for (std::size_t i = 0; i < count; ++i) {
    if (!(points[i] == Vec3{static_cast<double>(i), 0.125, -7})) FAIL("line " << i);
  }
}

TEST_CASE("decimal commas are named") {
  check_says(refusal_of_text("1,5 2,5 3,5\n"), "decimal commas");
  check_says(refusal_of_text("1,5;2,5;3,5\n"), "decimal commas");
  check_says(refusal_of_text("x;y;z\n1,5;2,5;3,5\n"), "line 2 ... decimal commas");
  check_lacks(refusal_of_text("hello\n"), "decimal");
}
