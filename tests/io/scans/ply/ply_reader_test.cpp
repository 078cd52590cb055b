#include "io/scans/ply/ply_reader.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <limits>

#include "support/reader_fixture.hpp"

using namespace clearway;
using namespace clearway::test;
using Catch::Matchers::Contains;

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
  ReaderScratch scratch;
  const auto path = scratch.write("a.ply", bytes);
  const std::string refusal = refusal_of(path);
  CHECK_THAT(refusal, Contains(path.string()));
  return refusal;
}

const std::string kXyz = "property float x\nproperty float y\nproperty float z\n";

/// A file of one vertex (1, 2, -3) whose coordinates have the type.
template <typename Number>
void check_type(const std::vector<std::string>& spellings) {
  ReaderScratch scratch;
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
  ReaderScratch scratch;
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
  CHECK(reader->info().declared_points == 2u);
  for (int pass = 0; pass < 2; ++pass) {
    const auto cloud = read_all(*reader);
    REQUIRE(cloud.positions.size() == 2);
    CHECK(cloud.positions[0] == Vec3{1.5, 15, 150});
    CHECK(cloud.positions[1] == Vec3{-2.5, -25, -250});
    reader->rewind();
  }
}

TEST_CASE("many vertices with extra properties arrive in order") {
  ReaderScratch scratch;
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

TEST_CASE("an ASCII PLY with line ends of either kind") {
  ReaderScratch scratch;
  std::string text =
      header("ascii",
             "element camera 1\nproperty list int float a\nproperty uchar b\n"
             "element vertex 3\nproperty uchar red\n" +
                 kXyz +
                 "property list uchar int n\nelement face 1\n"
                 "property list uchar int vertex_indices\n") +
      "2 0.5 0.5 255\n255 1 2.25 -3e2 0\n\n  0 +4\t5 6  2 7 8 \n1 nan -inf 1e-400 0\n"
      "3 0 1 2\n";
  if (GENERATE(false, true)) {
    for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos; at += 2) {
      text.insert(at, 1, '\r');
    }
  }
  const auto reader = open_point_file(scratch.write("a.ply", text));
  for (int pass = 0; pass < 2; ++pass) {
    const auto cloud = read_all(*reader);
    REQUIRE(cloud.positions.size() == 3);
    CHECK(cloud.positions[0] == Vec3{1, 2.25, -300});
    CHECK(cloud.positions[1] == Vec3{4, 5, 6});
    CHECK(std::isnan(cloud.positions[2].x));
    CHECK(cloud.positions[2].y == -std::numeric_limits<double>::infinity());
    CHECK(cloud.positions[2].z == 0);
    reader->rewind();
  }
}

TEST_CASE("a PLY without vertices is valid and empty") {
  ReaderScratch scratch;
  const std::string format = GENERATE("ascii", "binary_little_endian");
  const auto path = scratch.write("a.ply", header(format, "element vertex 0\n" + kXyz));
  CHECK(read_all(path).size() == 0);
}

TEST_CASE("a malformed PLY header is refused with its line") {
  CHECK_THAT(refusal_of_bytes(""), Contains("`ply`"));
  CHECK_THAT(refusal_of_bytes("ply\nformat ascii 2.0\n"), Contains("line 2") && Contains("format"));
  CHECK_THAT(refusal_of_bytes("ply\nformat binary 1.0\n"), Contains("line 2"));
  const auto refusal = [](const std::string& body) {
    return refusal_of_bytes(header("ascii", body) + "1 2 3\n");
  };
  CHECK_THAT(refusal(""), Contains("line 3") && Contains("vertex"));
  CHECK_THAT(refusal("element vertex\n"), Contains("line 3") && Contains("element NAME COUNT"));
  CHECK_THAT(refusal("element vertex -1\n"), Contains("line 3"));
  CHECK_THAT(refusal("element vertex 99999999999999999999\n"), Contains("line 3"));
  CHECK_THAT(refusal("element vertex 9999999999999999999\n" + kXyz), Contains("can hold"));
  CHECK_THAT(refusal("property float x\n"), Contains("line 3") && Contains("before"));
  CHECK_THAT(refusal("element vertex 1\nproperty half x\n"),
             Contains("line 4") && Contains("type"));
  CHECK_THAT(refusal("element vertex 1\nproperty list float int x\n"), Contains("integer"));
  CHECK_THAT(refusal("element vertex 1\nproperty float\n"), Contains("line 4"));
  CHECK_THAT(refusal("element vertex 1\nfoo\n"), Contains("line 4") && Contains("foo"));
  CHECK_THAT(refusal("element vertex 1\nproperty float x\nproperty float y\n"),
             Contains("no property z"));
  CHECK_THAT(refusal("element vertex 1\nproperty float x\n" + kXyz), Contains("one property x"));
  CHECK_THAT(refusal("element vertex 1\nproperty list uchar float x\nproperty float y\n"
                     "property float z\n"),
             Contains("list"));
  CHECK_THAT(refusal("element vertex 1\n" + kXyz + "element vertex 1\n" + kXyz), Contains("two"));
  CHECK_THAT(refusal("element none 1\nelement vertex 1\n" + kXyz), Contains("no property"));
}

TEST_CASE("malformed ASCII vertices are refused with their line") {
  const auto refusal = [](const std::string& rows) {
    return refusal_of_bytes(header("ascii", "element vertex 2\n" + kXyz) + rows);
  };
  CHECK_THAT(refusal("1 2 3\n4 5\n"), Contains("line 9") && Contains("\"z\""));
  CHECK_THAT(refusal("1 2 3\n4 5 x\n"), Contains("line 9") && Contains("number"));
  CHECK_THAT(refusal("1 2 3\n4 5 6 7\n"), Contains("line 9") && Contains("end of the line"));
  CHECK_THAT(refusal("1,2,3\n4 5 6\n"), Contains("line 8"));
  CHECK_THAT(refusal("1 2 3\n"), Contains("1 of element") && Contains("expected 2"));
  CHECK_THAT(refusal("1 2 1e999\n4 5 6\n"), Contains("line 8"));
}

TEST_CASE("a list that counts nonsense is refused") {
  const std::string body = "element a 1\nproperty list int double n\nelement vertex 1\n" + kXyz;
  const std::string rest(100, 'x');
  for (const bool big : {false, true}) {
    const std::string head = header(big ? "binary_big_endian" : "binary_little_endian", body);
    CHECK_THAT(refusal_of_bytes(head + bytes_of(std::int32_t{-1}, big) + rest),
               Contains("-1 items") && Contains("byte"));
    CHECK_THAT(refusal_of_bytes(head + bytes_of(std::int32_t{0x7FFFFFFF}, big) + rest),
               Contains("ends at byte"));
  }
  const std::string ascii = header("ascii", body);
  CHECK_THAT(refusal_of_bytes(ascii + "-1\n1 2 3\n"), Contains("line 10"));
  CHECK_THAT(refusal_of_bytes(ascii + "1.5 1\n1 2 3\n"), Contains("whole number"));
  CHECK_THAT(refusal_of_bytes(ascii + "4000000000 1\n1 2 3\n"), Contains("line 10"));
}

TEST_CASE("more data than declared is refused where the vertices end the file") {
  const std::string vertices = "element vertex 1\n" + kXyz;
  const std::string face = "element face 0\nproperty list uchar int n\n";
  for (const std::string& behind : {std::string(), face}) {
    const std::string ascii = header("ascii", vertices + behind) + "1 2 3\n";
    CHECK_THAT(refusal_of_bytes(ascii + "4 5 6\n"), Contains("line") && Contains("more than"));
    CHECK_THAT(refusal_of_bytes(ascii + "\n \n7"), Contains("more than"));
    const std::string binary =
        header("binary_little_endian", vertices + behind) + std::string(12, '\0');
    CHECK_THAT(refusal_of_bytes(binary + "x"), Contains("1 bytes more"));
    CHECK_THAT(refusal_of_bytes(binary + std::string(12, '\0')), Contains("12 bytes more"));
    ReaderScratch scratch;
    CHECK(read_all(scratch.write("a.ply", ascii + " \n\n")).size() == 1);
    CHECK(read_all(scratch.write("b.ply", binary + "\r\n")).size() == 1);
  }
}

TEST_CASE("elements behind the vertices are not looked at") {
  ReaderScratch scratch;
  const std::string body = "element vertex 1\n" + kXyz +
                           "element face 3\nproperty list uchar int n\nelement edge 1\n"
                           "property int a\n";
  for (const std::string tail :
       {"", "3 0 1\n", "no face\n", "3 0 1 2\n3 0 1 2\n3 1 2 3\n1\n9 9\n"}) {
    const auto cloud = read_all(scratch.write("a.ply", header("ascii", body) + "1 2 3\n" + tail));
    CHECK(cloud.positions == std::vector<Vec3>{{1, 2, 3}});
    CHECK(cloud.info.faces == 3);
  }
  for (const std::size_t bytes : {0, 1, 1000}) {
    const auto cloud =
        read_all(scratch.write("b.ply", header("binary_big_endian", body) + std::string(12, '\0') +
                                            std::string(bytes, '\xFF')));
    CHECK(cloud.positions == std::vector<Vec3>{{0, 0, 0}});
  }
}

TEST_CASE("the lines of vertices are told") {
  ReaderScratch scratch;
  const auto path = scratch.write(
      "a.ply", header("ascii", "element vertex 3\n" + kXyz) + "1 2 3\n\n4 5 6\n7 8 9\n");
  const auto reader = open_point_file(path);
  CHECK(reader->lines_of(std::vector<std::uint64_t>{0, 1, 2}) ==
        std::vector<std::uint64_t>{8, 10, 11});
  CHECK(reader->lines_of(std::vector<std::uint64_t>{2}) == std::vector<std::uint64_t>{11});
  reader->rewind();
  CHECK(read_all(*reader).size() == 3);
}
