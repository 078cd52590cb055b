// Whatever the bytes of a file are, reading it ends with points or with an Error.
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

/// A small E57 file. Its checksums are wrong after any change; e57_hostile_test.cpp corrects them.
std::string e57_sample() {
  E57Bytes file;
  file.scans = {e57_scan({1, 2}, {3, 4}, {5, 6})};
  return file.build();
}

std::string ply_sample(const std::string& format) {
  return "ply\nformat " + format +
         " 1.0\nelement a 2\nproperty list uchar int n\nelement vertex 2\nproperty float x\n"
         "property double y\nproperty short z\nproperty list char uchar l\nend_header\n";
}

std::string ptx_sample() {
  return "1\n2\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n1 2 3 4\n"
         "0 0 0 0.5\n";
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
  if (path.stem() == "scan000") attempt([&] { read_all(path.parent_path() / "scan000.3d"); });
  attempt([&] {
    read_all(
        *open_las_stream(File::open_for_reading(path), std::filesystem::temp_directory_path()));
  });
  for (const auto format : {TrajectoryFormat::kAuto, TrajectoryFormat::kCsv}) {
    attempt([&] { read_trajectory(path, {format, true}); });
  }
}

}  // namespace

TEST_CASE("flipped bytes and shuffled ends never do worse than a refusal") {
  const std::pair<const char*, std::string> samples[] = {
      {"a.las", las_sample()},
      {"a.e57", e57_sample()},
      {"a.laz", laz_bytes(1, 40).build()},
      {"b.laz", laz_bytes(7, 40).build()},
      {"a.ply", ply_sample("binary_little_endian") + std::string(100, '\1')},
      {"b.ply", ply_sample("binary_big_endian") + std::string(100, '\1')},
      {"c.ply", ply_sample("ascii") + "0\n1 7\n1 2 3 0\n4 5 6 1 9\n"},
      {"a.stl", binary_stl(unit_cube())},
      {"b.stl", ascii_stl(unit_cube())},
      {"a.obj", obj_text(unit_cube())},
      {"a.off", off_text(unit_cube())},
      {"d.ply", ply_mesh(unit_cube(), "ascii")},
      {"e.ply", ply_mesh(unit_cube(), "binary_little_endian")},
      {"a.pts", "2\n1 2 3 4\n5 6 7 8\n"},
      {"a.ptx", ptx_sample()},
      {"a.pcd", PcdHeaderText().build("ascii") + "1 2 3\n4 5 6\n"},
      {"b.pcd", PcdHeaderText().build("binary") + std::string(24, '\1')},
      {"c.pcd", PcdHeaderText().build("binary_compressed") + compressed(std::string(24, '\1'))},
      {"scan000.3d", "# c\n1 2 3 4\n5 6 7 8\n"},
      {"scan000.pose", "1 2 3\n4 5 6\n"},
      {"scan000.frames", "1 0 0 0 0 1 0 0 0 0 1 0 1 2 3 1 2\n"},
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
