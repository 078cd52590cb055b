// Whatever the bytes of a file are, reading it ends with points or with an Error. The files of
// tests/formats are damaged too.
#include <random>

#include "clearway/model.hpp"
#include "clearway/trajectory.hpp"
#include "support/bytes/e57_bytes.hpp"
#include "support/bytes/las_bytes.hpp"
#include "support/bytes/laz/laz_samples.hpp"
#include "support/bytes/mesh_bytes.hpp"
#include "support/bytes/pcd_bytes.hpp"
#include "support/bytes/sbet_bytes.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/reader_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

std::string las_sample() {
  LasBytes las;
  las.minor = 4;
  las.format = 6;
  las.vlrs = {{"LASF_Projection", 34735, std::string("\1\0\1\0\0\0\1\0\0\4\0\0\1\0\1\0", 16)},
              {"LASF_Projection", 2112, "PROJCS[\"a\",GEOGCS[\"b\"],UNIT[\"metre\",1]]"}};
  las.evlrs = {{"LASF_Projection", 2112, "LOCAL_CS[\"b\"]"}};
  return las.build();
}

/// Reads a file in every way that its name allows; anything but an Error fails the test.
void read_anything(const std::filesystem::path& path) {
  const auto attempt = [](auto read) {
    try {
      read();
    } catch (const Error&) {
    }
  };
  attempt([&] { read_all(path); });
  attempt([&] { read_model_points(path); });
  attempt([&] { read_stream(path); });
  for (const auto format : {TrajectoryFormat::kAuto, TrajectoryFormat::kCsv}) {
    attempt([&] { read_trajectory(path, {format, true}); });
  }
}

}  // namespace

TEST_CASE("flipped bytes and shuffled ends never do worse than a refusal") {
  E57Bytes e57;
  e57.scans = {e57_scan({1, 2}, {3, 4}, {5, 6})};
  const std::pair<const char*, std::string> samples[] = {
      {"a.las", las_sample()},
      {"a.e57", e57.build()},  // checksums are wrong after a change; e57_hostile_test.cpp has both
      {"a.laz", laz_bytes(1, 40).build()},
      {"b.laz", laz_bytes(7, 40).build()},
      {"a.stl", binary_stl(unit_cube())},
      {"e.ply", ply_mesh(unit_cube(), "binary_little_endian")},
      {"c.pcd", PcdHeaderText().build("binary_compressed") + compressed(std::string(24, '\1'))},
      {"a.csv", "t,x,y,z,qx,qy,qz,qw\n1,2,3,4,0,0,0,1\n"},
      {"b.csv", "x[mm],y[mm],z[mm],roll_deg,pitch_deg,heading_deg\n1,2,3,4,5,6\n"},
      {"a.sbet", SbetRecord().bytes() + SbetRecord().bytes()},
      {"a.pose", "1 2 3\n10 20 30\n"},
      {"a.frames", "1 0 0 0 0 1 0 0 0 0 1 0 1 2 3 1 2\n"},
      {"a.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n"}};
  ScratchFolder scratch;
  std::mt19937 random(1);
  for (const auto& [name, sample] : samples) {
    for (int round = 0; round < 600; ++round) {
      std::string bytes = sample;
      const int flips = 1 + static_cast<int>(random() % 4);
      for (int i = 0; i < flips; ++i) {
        bytes[random() % bytes.size()] = static_cast<char>(random() % 3 ? random() : 0xFF);
      }
      if (random() % 8 == 0) bytes.resize(random() % bytes.size());
      CHECK_NOTHROW(read_anything(scratch.write(name, bytes)));
    }
  }
}

namespace {

std::string exchanged(std::string bytes, const std::string& what, const std::string& by) {
  for (std::size_t at = 0; (at = bytes.find(what, at)) != bytes.npos; at += by.size()) {
    bytes.replace(at, what.size(), by);
  }
  return bytes;
}

/// Binary files of 2,000 points whose coordinates hold every byte.
std::vector<std::pair<std::string, std::string>> binary_samples() {
  std::mt19937 random(1);
  LasBytes las;
  std::array<std::vector<double>, 3> axes;
  std::string floats;
  TriangleMesh mesh{{}, {{0, 1, 2}}};
  for (std::size_t i = 0; i < 2000; ++i) {
    Vec3& p = mesh.vertices.emplace_back();
    std::array<std::int32_t, 3>& q = las.points.emplace_back();
    for (int k = 0; k < 3; ++k) {
      const auto axis = static_cast<std::size_t>(k);
      q[axis] = static_cast<std::int32_t>(random() % 4'000'000) - 2'000'000;
      p[k] = q[axis] * 0.001;
      axes[axis].push_back(p[k]);
      floats += raw(static_cast<float>(p[k]));
    }
  }
  E57Bytes e57;
  e57.scans = {e57_scan(axes[0], axes[1], axes[2])};
  PcdHeaderText pcd;
  pcd.width = pcd.points = "2000";
  const std::string ply =
      "ply\nformat binary_little_endian 1.0\nelement vertex 2000\nproperty float x\n"
      "property float y\nproperty float z\nend_header\n";
  return {{"a.las", las.build()},
          {"a.laz", laz_bytes(1, 2000).build()},
          {"a.e57", e57.build()},
          {"a.ply", ply + floats},
          {"b.ply", ply_mesh(mesh, "binary_little_endian")},
          {"a.pcd", pcd.build("binary") + floats},
          {"b.pcd", pcd.build("binary_compressed") + compressed(floats)}};
}

}  // namespace

TEST_CASE("binary files that were copied as text are refused, and the reason is given") {
  ScratchFolder scratch;
  for (const auto& [name, bytes] : binary_samples()) {
    INFO(name);
    REQUIRE(refusal_of(scratch.write(name, bytes)).empty());
    const std::string more = exchanged(bytes, "\n", "\r\n");
    REQUIRE(more.size() > bytes.size());
    check_says(refusal_of(scratch.write(name, more)), name + ": was copied as text");
    std::string low = bytes;
    for (char& c : low) c = static_cast<char>(c & 0x7F);
    const bool is_e57 = name.ends_with("e57");  // whose header says so: 49,152 is 0xC000
    check_says(refusal_of(scratch.write(name, low)),
               is_e57 ? "has 49152 bytes; expected 16384" : "no byte above 127");
    if (name.ends_with("ply")) {
      CHECK_THROWS_AS(read_model_points(scratch.write(name, more)), InputError);
      CHECK_THROWS_AS(read_model_points(scratch.write(name, low)), InputError);
    }
    const std::string fewer = exchanged(exchanged(bytes, "\r\n", "\n"), "\r", "");
    CHECK_FALSE(refusal_of(scratch.write(name, fewer)).empty());
    if (!name.starts_with("a.la")) continue;
    for (const std::string& damaged : {more, low, fewer}) {
      CHECK_FALSE(stream_refusal_of(scratch.write(name, damaged)).empty());
    }
  }
}

TEST_CASE("as many bytes as some records, put in by a copy as text, are never read as points") {
  LasBytes las;
  las.scale = {0.001, 0.001, 0.001};
  las.points.assign(500, {1'000'000, 2'000'000, 3'000'000});
  for (std::size_t i = 0; i < 40; ++i) las.points[12 * i] = {10, 0, 0};  // a line feed in each
  ScratchFolder scratch;
  const auto path = scratch.write("a.las", exchanged(las.build(), "\n", "\r\n"));
  CHECK(std::filesystem::file_size(path) == las.build().size() + 2 * las.record_bytes());
  for (const std::string& refusal : {refusal_of(path), stream_refusal_of(path)}) {
    check_says(refusal, "was copied as text");
  }
}

TEST_CASE("line ends of a header and few bytes say nothing of a copy as text") {
  ScratchFolder scratch;
  const std::string ply =
      "ply\r\nformat binary_little_endian 1.0\r\nelement vertex 2\r\nproperty int x\r\n"
      "property int y\r\nproperty int z\r\nend_header\r\n";
  CHECK(read_all(scratch.write("a.ply", ply + raw(1, 2, 3, 4, 5, 6))).size() == 2);
  CHECK(read_all(scratch.write("b.ply", ply + raw(1, 2, 3, 4, 10, 13))).size() == 2);
}
