#include "io/scans/ply/ply_reader.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/reader_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

template <typename Number>
std::string bytes_of(Number value, bool big_endian) {
  std::string bytes(sizeof value, '\0');
  std::memcpy(bytes.data(), &value, sizeof value);
  if (big_endian) std::reverse(bytes.begin(), bytes.end());
  return bytes;
}

std::string header(const std::string& format, const std::string& body) {
  return "ply\nformat " + format + " 1.0\n" + body + "end_header\n";
}

std::string refusal_of_bytes(const std::string& bytes) {
  ScratchFolder scratch;
  const auto path = scratch.write("a.ply", bytes);
  const std::string refusal = refusal_of(path);
  check_says(refusal, path.string());
  return refusal;
}

const std::string kXyz = "property float x\nproperty float y\nproperty float z\n";

/// A file of one vertex (1, 2, -3) whose coordinates have the type.
template <typename Number>
void check_type(const std::vector<std::string>& spellings) {
  ScratchFolder scratch;
  const Number z = std::is_signed_v<Number> ? static_cast<Number>(-3) : static_cast<Number>(200);
  for (const std::string& type : spellings) {
    for (const bool big : {false, true}) {
      std::string body = "element vertex 1\nproperty uchar a\n";
      for (const char axis : {'z', 'x', 'y'})
        body.append("property ").append(type).append({' ', axis, '\n'});
      const std::string data =
          std::string("A") + bytes_of(z, big) + bytes_of(Number{1}, big) + bytes_of(Number{2}, big);
      const std::string format = big ? "binary_big_endian" : "binary_little_endian";
      const auto cloud = read_all(scratch.write("a.ply", header(format, body) + data));
      REQUIRE(cloud.positions.size() == 1);
      CHECK(cloud.positions[0] == Vec3{1, 2, static_cast<double>(z)});
    }
  }
}

}  // namespace

TEST_CASE("coordinates of every type and spelling, in either byte order") {
  check_type<std::int8_t>({"char", "int8"});
  check_type<std::uint8_t>({"uchar", "uint8"});
  check_type<std::int16_t>({"short", "int16"});
  check_type<std::uint16_t>({"ushort", "uint16"});
  check_type<std::int32_t>({"int", "int32"});
  check_type<std::uint32_t>({"uint", "uint32"});
  check_type<float>({"float", "float32"});
  check_type<double>({"double", "float64"});
}

TEST_CASE("lists and other elements around the vertices are skipped") {
  ScratchFolder scratch;
  const bool big = GENERATE(false, true);
  const bool list_in_vertex = GENERATE(false, true);
  const std::string body =
      "comment any\nobj_info any\nelement camera 2\nproperty list uchar short a\nproperty double "
      "b\n"
      "element vertex 2\n" +
      kXyz + (list_in_vertex ? "property list int double n\n" : "") +
      "element face 1\nproperty list uchar int vertex_indices\n";
  std::string data;
  for (const int items : {0, 3}) {
    data += static_cast<char>(items) + std::string(items * 2u, 'i') + std::string(8, 'b');
  }
  for (const float x : {1.5f, -2.5f}) {
    for (const float c : {x, 10 * x, 100 * x}) data += bytes_of(c, big);
    if (list_in_vertex) data += bytes_of(std::int32_t{2}, big) + std::string(16, 'n');
  }
  data += '\1' + bytes_of(std::int32_t{0}, big);
  const std::string head = header(big ? "binary_big_endian" : "binary_little_endian", body);
  const auto reader = open_point_file(scratch.write("a.ply", head + data));
  check_equal(reader->info().declared_points, 2u);
  for (int pass = 0; pass < 2; ++pass) {
    const auto cloud = read_all(*reader);
    REQUIRE(cloud.positions.size() == 2);
    CHECK(cloud.positions[0] == Vec3{1.5, 15, 150});
    CHECK(cloud.positions[1] == Vec3{-2.5, -25, -250});
    reader->rewind();
  }
}

TEST_CASE("many vertices with extra properties arrive in order") {
  ScratchFolder scratch;
  std::string bytes =
      header("binary_little_endian", "element vertex 100001\nproperty uchar a\n" + kXyz);
  for (int i = 0; i < 100'001; ++i) {
    bytes += 'a';
    for (int k = 1; k < 4; ++k) bytes += bytes_of(static_cast<float>(i * k), false);
  }
  const auto cloud = read_all(scratch.write("a.ply", bytes));
  REQUIRE(cloud.positions.size() == 100'001);
  for (int i = 0; i < 100'001; ++i) {
    const Vec3 expected{1.0 * i, 2.0 * i, 3.0 * i};
    if (!(cloud.positions[static_cast<std::size_t>(i)] == expected)) FAIL("vertex " << i);
  }
}

TEST_CASE("the binary data of a PLY start behind the line break of its header") {
  ScratchFolder scratch;
  // The first byte of the vertex is that of LF.
  const std::string data = bytes_of(1.5f + 10 * 0x1p-23f, false) + std::string(8, '\0');
  REQUIRE(data[0] == '\n');
  const std::string text = header("binary_little_endian", "element vertex 1\n" + kXyz);
  for (const std::string line_break : {"\n", "\r", "\r\n"}) {
    std::string head;
    for (const char c : text) head += c == '\n' ? line_break : std::string(1, c);
    const auto cloud = read_all(scratch.write("a.ply", head + data));
    check_equal(cloud.positions, {{1.5 + 10 * 0x1p-23, 0, 0}});
  }
}

TEST_CASE("an ASCII PLY with line ends of any kind") {
  ScratchFolder scratch;
  std::string text =
      header("ascii",
             "element camera 1\nproperty list int float a\nproperty uchar b\n"
             "element vertex 3\nproperty uchar red\n" +
                 kXyz +
                 "property list uchar int n\nelement face 1\n"
                 "property list uchar int vertex_indices\n") +
      "2 0.5 0.5 255\n255 1 2.25 -3e2 0\n\n  0 +4\t5 6  2 7 8 \n1 nan -inf 1e-400 0\n"
      "3 0 1 2\n";
  const std::string line_break = GENERATE("\n", "\r", "\r\n");
  for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos;
       at += line_break.size()) {
    text.replace(at, 1, line_break);
  }
  const auto reader = open_point_file(scratch.write("a.ply", text));
  for (int pass = 0; pass < 2; ++pass) {
    const auto cloud = read_all(*reader);
    REQUIRE(cloud.positions.size() == 3);
    CHECK(cloud.positions[0] == Vec3{1, 2.25, -300});
    CHECK(cloud.positions[1] == Vec3{4, 5, 6});
    CHECK(std::isnan(cloud.positions[2].x));
    CHECK(cloud.positions[2].y == -std::numeric_limits<double>::infinity());
    check_equal(cloud.positions[2].z, 0);
    reader->rewind();
  }
}

TEST_CASE("a PLY without vertices is valid and empty") {
  ScratchFolder scratch;
  const std::string format = GENERATE("ascii", "binary_little_endian");
  const auto path = scratch.write("a.ply", header(format, "element vertex 0\n" + kXyz));
  check_equal(read_all(path).size(), 0);
}

TEST_CASE("a comment that moves the points is named") {
  ScratchFolder scratch;
  const auto unplaced = [&](const std::string& comment) {
    const auto path = scratch.write("a.ply", "ply\nformat ascii 1.0\ncomment " + comment +
                                                 "\nelement vertex 1\nproperty float x\n"
                                                 "property float y\nproperty float z\n"
                                                 "end_header\n1 2 3\n");
    return open_point_file(path)->info().unplaced;
  };
  check_says(unplaced("frame_to_world_scale 0.181985"), "frame_to_world_scale");
  check_says(unplaced("frame_to_world_translation 0 -31.8 1"), "frame_to_world_translation");
  for (const std::string still : {"frame_to_world_scale 1", "frame_to_world_translation 0 0 0",
                                  "frame_to_world", "scale 2"}) {
    check_equal(unplaced(still), "");
  }
}

TEST_CASE("a malformed PLY header is refused with its line") {
  check_says(refusal_of_bytes(""), "`ply`");
  check_says(refusal_of_bytes("ply\nformat ascii 2.0\n"), "line 2 ... format");
  check_says(refusal_of_bytes("ply\nformat binary 1.0\n"), "line 2");
  const auto refusal = [](const std::string& body) {
    return refusal_of_bytes(header("ascii", body) + "1 2 3\n");
  };
  check_says(refusal(""), "line 3 ... vertex");
  check_says(refusal("element vertex\n"), "line 3 ... element NAME COUNT");
  check_says(refusal("element vertex -1\n"), "line 3");
  check_says(refusal("element vertex 99999999999999999999\n"), "line 3");
  check_says(refusal("element vertex 9999999999999999999\n" + kXyz), "can hold");
  check_says(refusal("property float x\n"), "line 3 ... before");
  check_says(refusal("element vertex 1\nproperty half x\n"), "line 4 ... type");
  check_says(refusal("element vertex 1\nproperty list float int x\n"), "integer");
  check_says(refusal("element vertex 1\nproperty float\n"), "line 4");
  check_says(refusal("element vertex 1\nfoo\n"), "line 4 ... foo");
  check_says(refusal("element vertex 1\nproperty float x\nproperty float y\n"), "no property z");
  check_says(refusal("element vertex 1\nproperty float x\n" + kXyz), "one property x");
  check_says(refusal("element vertex 1\nproperty list uchar float x\nproperty float y\n"
                     "property float z\n"),
             "list");
  check_says(refusal("element vertex 1\n" + kXyz + "element vertex 1\n" + kXyz), "two");
  check_says(refusal("element none 1\nelement vertex 1\n" + kXyz), "no property");
}

TEST_CASE("malformed ASCII vertices are refused with their line") {
  const auto refusal = [](const std::string& rows) {
    return refusal_of_bytes(header("ascii", "element vertex 2\n" + kXyz) + rows);
  };
  check_says(refusal("1 2 3\n4 5\n"), "line 9 ... \"z\"");
  check_says(refusal("1 2 3\n4 5 x\n"), "line 9 ... number");
  check_says(refusal("1 2 3\n4 5 6 7\n"), "line 9 ... end of the line");
  check_says(refusal("1,2,3\n4 5 6\n"), "line 8");
  check_says(refusal("1 2 3\n"), "1 of element ... expected 2");
  check_says(refusal("1 2 1e999\n4 5 6\n"), "line 8");
}

TEST_CASE("a list that counts nonsense is refused") {
  const std::string body = "element a 1\nproperty list int double n\nelement vertex 1\n" + kXyz;
  const std::string rest(100, 'x');
  for (const bool big : {false, true}) {
    const std::string head = header(big ? "binary_big_endian" : "binary_little_endian", body);
    check_says(refusal_of_bytes(head + bytes_of(std::int32_t{-1}, big) + rest),
               "byte ... -1 items");
    check_says(refusal_of_bytes(head + bytes_of(std::int32_t{0x7FFFFFFF}, big) + rest),
               "ends at byte");
  }
  const std::string ascii = header("ascii", body);
  check_says(refusal_of_bytes(ascii + "-1\n1 2 3\n"), "line 10");
  check_says(refusal_of_bytes(ascii + "1.5 1\n1 2 3\n"), "whole number");
  check_says(refusal_of_bytes(ascii + "4000000000 1\n1 2 3\n"), "line 10");
}

TEST_CASE("more data than declared is refused where the vertices end the file") {
  const std::string vertices = "element vertex 1\n" + kXyz;
  const std::string face = "element face 0\nproperty list uchar int n\n";
  for (const std::string& behind : {std::string(), face}) {
    const std::string ascii = header("ascii", vertices + behind) + "1 2 3\n";
    check_says(refusal_of_bytes(ascii + "4 5 6\n"), "line ... more than");
    check_says(refusal_of_bytes(ascii + "\n \n7"), "more than");
    const std::string binary =
        header("binary_little_endian", vertices + behind) + std::string(12, '\0');
    check_says(refusal_of_bytes(binary + "x"), "1 bytes more");
    check_says(refusal_of_bytes(binary + std::string(12, '\0')), "12 bytes more");
    ScratchFolder scratch;
    check_equal(read_all(scratch.write("a.ply", ascii + " \n\n")).size(), 1);
    check_equal(read_all(scratch.write("b.ply", binary + "\r\n")).size(), 1);
  }
}

TEST_CASE("elements behind the vertices are not looked at") {
  ScratchFolder scratch;
  const std::string body = "element vertex 1\n" + kXyz +
                           "element face 3\nproperty list uchar int n\nelement edge 1\n"
                           "property int a\n";
  for (const std::string tail :
       {"", "3 0 1\n", "no face\n", "3 0 1 2\n3 0 1 2\n3 1 2 3\n1\n9 9\n"}) {
    const auto cloud = read_all(scratch.write("a.ply", header("ascii", body) + "1 2 3\n" + tail));
    check_equal(cloud.positions, {{1, 2, 3}});
    check_equal(cloud.info.faces, 3);
  }
  for (const std::size_t bytes : {0, 1, 1000}) {
    const auto cloud =
        read_all(scratch.write("b.ply", header("binary_big_endian", body) + std::string(12, '\0') +
                                            std::string(bytes, '\xFF')));
    check_equal(cloud.positions, {{0, 0, 0}});
  }
}

TEST_CASE("the lines of vertices are told") {
  ScratchFolder scratch;
  const auto path = scratch.write(
      "a.ply", header("ascii", "element vertex 3\n" + kXyz) + "1 2 3\n\n4 5 6\n7 8 9\n");
  const auto reader = open_point_file(path);
  CHECK(reader->lines_of(std::vector<std::uint64_t>{0, 1, 2}) ==
        std::vector<std::uint64_t>{8, 10, 11});
  check_equal(reader->lines_of(std::vector<std::uint64_t>{2}), {11});
  reader->rewind();
  check_equal(read_all(*reader).size(), 3);
}
