#include "io/scans/point_reader.hpp"
#include "support/bytes/e57_bytes.hpp"
#include "support/bytes/las_bytes.hpp"
#include "support/bytes/laz/laz_samples.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/reader_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

TEST_CASE("content counts more than the ending of the name") {
  ScratchFolder scratch;
  check_equal(read_all(scratch.write("a.ply", laz_bytes(0, 20).build())).quanta.size(), 20);
  check_equal(read_all(scratch.write("a.xyz", LasBytes().build())).quanta.size(), 3);
  E57Bytes e57;
  e57.scans = {e57_scan({1, 2}, {3, 4}, {5, 6})};
  check_equal(read_all(scratch.write("a.las", e57.build())).positions.size(), 2);
  check_equal(read_all(scratch.write("b",
                                     "ply\nformat ascii 1.0\nelement vertex 0\nproperty int x\n"
                                     "property int y\nproperty int z\nend_header\n"))
                  .size(),
              0);
}

TEST_CASE("what is not read is refused by the name of its format, with advice") {
  ScratchFolder scratch;
  const auto refusal = [&](const std::string& name, const std::string& bytes) {
    const auto path = scratch.write(name, bytes);
    const std::string message = refusal_of(path);
    check_says(message, path.string());
    return message;
  };
  check_says(refusal("c.e57", ""), "E57 header");
  check_says(refusal("c.obj", "v 1 2 3\n"), "mesh ... expected points");
  for (const std::string name : {"c.glb", "c.gltf", "c.dae"}) {
    // A mesh that is not read cannot be sampled before it is exported.
    check_says(refusal(name, "glTF"), "not read ... STL, OBJ or PLY first");
  }
  check_says(refusal("c.las", "1 2 3\n"), "LAS header");
  check_says(refusal("d.las", std::string(500, ' ')), "LASF");
  check_says(refusal("c.ply", "1 2 3\n"), "`ply`");
  check_says(refusal("c.unknown", "1 2 3\n"), "unknown format");
  check_says(refusal("c.shp", std::string("\0\0\x27\x0A\0\0", 6)),
             "is a shapefile ... as CSV or LAS");
  check_says(refusal("c.gpkg", std::string("SQLite format 3\0", 16)), "is a GeoPackage");
}

TEST_CASE("PCD is read by its content too, 3DTK scans by their name") {
  ScratchFolder scratch;
  const std::string pcd = "# .PCD v.7\nFIELDS x y z\nPOINTS 1\nDATA ascii\n1 2 3\n";
  check_equal(read_all(scratch.write("a.xyz", pcd)).positions, {{1, 2, 3}});
  CHECK(read_all(scratch.write("scan000.3D", "0 0 100\n")).positions ==
        std::vector<Vec3>{{1, 0, 0}});
}

TEST_CASE("what is left out of a folder is said, poses of 3DTK scans are not left out") {
  ScratchFolder scratch;
  std::vector<Message> remarks;
  for (const char* name : {"a.las", "scan000.3d", "scan000.pose", "scan000.frames"}) {
    scratch.write(name, "");
  }
  check_equal(list_point_files({scratch.folder()}, &remarks).size(), 2);
  CHECK(remarks.empty());
  for (const char* name : {"1.txt", "2.csv", "3.obj", "4", "5.md", "scan001.pose", ".hidden"}) {
    scratch.write(name, "");
  }
  std::filesystem::create_directory(scratch.folder() / "more");
  check_equal(list_point_files({scratch.folder(), scratch.folder() / "1.txt"}, &remarks).size(), 3);
  REQUIRE(remarks.size() == 1);
  CHECK(remarks[0].severity == Message::Severity::kNote);
  check_equal(remarks[0].code, "left-out");
  check_says(remarks[0].text,
             "left out 6 files (1.txt, 2.csv, 3.obj, 4, 5.md and 1 more) and 1 folder");
  CHECK(remarks[0].numbers ==
        std::vector<std::pair<std::string, double>>{{"files", 6}, {"folders", 1}});
}

TEST_CASE("what is left out of a folder although it has points is warned of, with its name") {
  ScratchFolder scratch;
  scratch.write("a.las", "");
  const std::string points = "1.5 2.5 3.5\n1.6 2.5 3.5\n1.7 2.5 3.5\n";
  for (const char* name : {"north.txt", "south.csv"}) scratch.write(name, points);
  scratch.write("readme.txt", "scanned in May\n");
  scratch.write("view.json", "{}");
  for (const char* name : {"old/deep", "photos"}) {
    std::filesystem::create_directories(scratch.folder() / name);
  }
  scratch.write("old/deep/b.laz", "");
  std::vector<Message> remarks;
  check_equal(list_point_files({scratch.folder()}, &remarks).size(), 1);
  REQUIRE(remarks.size() == 2);
  CHECK(remarks[0].severity == Message::Severity::kWarning);
  check_equal(remarks[0].code, "left-out");
  check_says(remarks[0].text,
             "left out 1 folder that holds point files (old) and 2 files that look like points "
             "(north.txt, south.csv)");
  CHECK(remarks[1].severity == Message::Severity::kNote);
  check_says(remarks[1].text, "left out 2 files (readme.txt, view.json) and 1 folder (photos)");
}

TEST_CASE("poses beside scans that are not placed by them are warned of") {
  ScratchFolder scratch;
  std::vector<Message> remarks;
  for (const char* name : {"scan000.xyz", "scan000.pose", "scan001.pts", "scan001.frames"}) {
    scratch.write(name, "");
  }
  check_equal(list_point_files({scratch.folder()}, &remarks).size(), 2);
  REQUIRE(remarks.size() == 1);
  CHECK(remarks[0].severity == Message::Severity::kWarning);
  check_equal(remarks[0].code, "poses-not-applied");
  check_says(remarks[0].text, "2 files ... scan000.pose, scan001.frames");
}

TEST_CASE("the files with the poses of scans are among those that are read") {
  ScratchFolder scratch;
  const auto first = scratch.write("scan000.3d", ""), pose = scratch.write("scan000.pose", "");
  const auto other = scratch.write("a.las", ""), second = scratch.write("scan001.3d", "");
  CHECK(with_pose_files({first, other, second}) ==
        std::vector<std::filesystem::path>{first, other, second, pose});
}

TEST_CASE("a folder's point files count in byte order of their names") {
  ScratchFolder scratch;
  std::filesystem::create_directory(scratch.folder() / "tiles");
  std::filesystem::create_directory(scratch.folder() / "tiles" / "sub.las");
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
  ScratchFolder scratch;
  CHECK_THROWS_AS(list_point_files({scratch.folder() / "missing.las"}), ResourceError);
  CHECK_THROWS_AS(list_point_files({scratch.folder()}), InputError);
  CHECK(list_point_files({}).empty());
}
