// Whatever the bytes of a file are, reading it ends with points or with an Error.
#include <catch2/catch.hpp>
#include <random>

#include "clearway/trajectory.hpp"
#include "support/las_bytes.hpp"
#include "support/laz/laz_samples.hpp"
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

std::string ply_sample(const std::string& format) {
  return "ply\nformat " + format +
         " 1.0\nelement a 2\nproperty list uchar int n\nelement vertex 2\nproperty float x\n"
         "property double y\nproperty short z\nproperty list char uchar l\nend_header\n";
}

/// Reads in every way that the file's name allows; anything but an Error fails the test.
void read_anything(const std::filesystem::path& path) {
  const auto attempt = [](auto read) {
    try {
      read();
    } catch (const Error&) {
    }
  };
  attempt([&] { read_all(path); });
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
      {"a.laz", laz_bytes(1, 40).build()},
      {"b.laz", laz_bytes(7, 40).build()},
      {"a.ply", ply_sample("binary_little_endian") + std::string(100, '\1')},
      {"b.ply", ply_sample("binary_big_endian") + std::string(100, '\1')},
      {"c.ply", ply_sample("ascii") + "0\n1 7\n1 2 3 0\n4 5 6 1 9\n"},
      {"a.pts", "2\n1 2 3 4\n5 6 7 8\n"},
      {"a.csv", "t,x,y,z,qx,qy,qz,qw\n1,2,3,4,0,0,0,1\n"},
      {"a.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n"}};
  ReaderScratch scratch;
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
