#include "io/scans/point_reader.hpp"
#include "support/bytes/e57_bytes.hpp"
#include "support/bytes/las_bytes.hpp"
#include "support/bytes/laz/laz_samples.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/reader_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// Writes empty files.
void write_all(const ScratchFolder& scratch, const std::vector<std::string>& names) {
  for (const std::string& name : names) scratch.write(name, "");
}

}  // namespace

TEST_CASE("content counts more than the ending of the name") {
  const ScratchFolder scratch;
  E57Bytes e57;
  e57.scans = {e57_scan({1, 2}, {3, 4}, {5, 6})};
  const std::tuple<const char*, std::string, std::size_t> rows[] = {
      {"a.ply", laz_bytes(0, 20).build(), 20},
      {"a.xyz", LasBytes().build(), 3},
      {"a.las", e57.build(), 2},
      {"b",
       "ply\nformat ascii 1.0\nelement vertex 0\nproperty int x\nproperty int y\nproperty int z\n"
       "end_header\n",
       0},
      {"a.xyz", "# .PCD v.7\nFIELDS x y z\nPOINTS 1\nDATA ascii\n1 2 3\n", 1},
      {"scan000.3D", "0 0 100\n", 1}};  // by its name alone
  for (const auto& [name, bytes, points] : rows) {
    check_equal(read_all(scratch.write(name, bytes)).size(), points);
  }
}

TEST_CASE("what is not read is refused by the name of its format, with advice") {
  const std::tuple<const char*, std::string, const char*> rows[] = {
      {"c.e57", "", "E57 header"},
      {"c.obj", "v 1 2 3\n", "mesh ... expected points"},
      // A mesh that is not read cannot be sampled before it is exported.
      {"c.glb", "glTF", "not read ... STL, OBJ or PLY first"},
      {"c.gltf", "glTF", "not read ... STL, OBJ or PLY first"},
      {"c.dae", "glTF", "not read ... STL, OBJ or PLY first"},
      {"c.las", "1 2 3\n", "LAS header"},
      {"d.las", std::string(500, ' '), "LASF"},
      {"c.ply", "1 2 3\n", "`ply`"},
      {"c.unknown", "1 2 3\n", "unknown format"},
      {"c.shp", std::string("\0\0\x27\x0A\0\0", 6), "is a shapefile ... as CSV or LAS"},
      {"c.gpkg", std::string("SQLite format 3\0", 16), "is a GeoPackage"}};
  for (const auto& [name, bytes, words] : rows) check_says(refusal_of_file(name, bytes), words);
}

TEST_CASE("what is left out of a folder is said, poses of 3DTK scans are not left out") {
  const ScratchFolder scratch;
  std::vector<Message> remarks;
  write_all(scratch, {"a.las", "scan000.3d", "scan000.pose", "scan000.frames"});
  check_equal(list_point_files({scratch.folder()}, &remarks).size(), 2);
  CHECK(remarks.empty());
  write_all(scratch, {"1.txt", "2.csv", "3.obj", "4", "5.md", "scan001.pose", ".hidden"});
  std::filesystem::create_directory(scratch.folder() / "more");
  check_equal(list_point_files({scratch.folder(), scratch.folder() / "1.txt"}, &remarks).size(), 3);
  REQUIRE(codes_of(remarks) == "note left-out");
  check_says(remarks[0].text,
             "left out 6 files (1.txt, 2.csv, 3.obj, 4, 5.md and 1 more) and 1 folder");
  CHECK(remarks[0].numbers ==
        std::vector<std::pair<std::string, double>>{{"files", 6}, {"folders", 1}});
}

TEST_CASE("what is left out of a folder although it has points is warned of, with its name") {
  const ScratchFolder scratch;
  const std::string points = "1.5 2.5 3.5\n1.6 2.5 3.5\n1.7 2.5 3.5\n";
  for (const char* name : {"north.txt", "south.csv"}) scratch.write(name, points);
  scratch.write("readme.txt", "scanned in May\n");
  scratch.write("view.json", "{}");
  for (const char* name : {"old/deep", "photos"}) {
    std::filesystem::create_directories(scratch.folder() / name);
  }
  write_all(scratch, {"a.las", "old/deep/b.laz"});
  std::vector<Message> remarks;
  check_equal(list_point_files({scratch.folder()}, &remarks).size(), 1);
  REQUIRE(codes_of(remarks) == "left-out, note left-out");
  check_says(remarks[0].text,
             "left out 1 folder that holds point files (old) and 2 files that look like points "
             "(north.txt, south.csv)");
  check_says(remarks[1].text, "left out 2 files (readme.txt, view.json) and 1 folder (photos)");
}

TEST_CASE("poses beside scans that are not placed by them are warned of") {
  const ScratchFolder scratch;
  std::vector<Message> remarks;
  write_all(scratch, {"scan000.xyz", "scan000.pose", "scan001.pts", "scan001.frames"});
  check_equal(list_point_files({scratch.folder()}, &remarks).size(), 2);
  REQUIRE(codes_of(remarks) == "poses-not-applied");
  check_says(remarks[0].text, "2 files ... scan000.pose, scan001.frames");
}

TEST_CASE("the files with the poses of scans are among those that are read") {
  const ScratchFolder scratch;
  const auto first = scratch.write("scan000.3d", ""), pose = scratch.write("scan000.pose", "");
  const auto other = scratch.write("a.las", ""), second = scratch.write("scan001.3d", "");
  CHECK(with_pose_files({first, other, second}) ==
        std::vector<std::filesystem::path>{first, other, second, pose});
}

TEST_CASE("a folder's point files count in byte order of their names") {
  const ScratchFolder scratch;
  std::filesystem::create_directories(scratch.folder() / "tiles" / "sub.las");
  for (const std::string name :
       {"b.las", "B.las", "a10.ply", "a2.XYZ", "\xC3\xA4.las", ".hidden.las", "readme.md",
        "readme.txt", "path.csv", "z.e57", "none"}) {
    scratch.write("tiles/" + name, "");
  }
  const auto single = scratch.write("named.txt", "");
  std::vector<std::string> names;
  for (const auto& path : list_point_files({single, scratch.folder() / "tiles", single})) {
    names.push_back(path.filename().string());
  }
  check_equal(names, {"named.txt", "B.las", "a10.ply", "a2.XYZ", "b.las", "z.e57", "\xC3\xA4.las",
                      "named.txt"});
}

TEST_CASE("a missing input and a folder without points are refused") {
  const ScratchFolder scratch;
  CHECK_THROWS_AS(list_point_files({scratch.folder() / "missing.las"}), ResourceError);
  CHECK_THROWS_AS(list_point_files({scratch.folder()}), InputError);
  CHECK(list_point_files({}).empty());
}
