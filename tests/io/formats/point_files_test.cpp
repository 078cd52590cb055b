#include <catch2/catch.hpp>

#include "io/formats/point_reader.hpp"
#include "support/las_bytes.hpp"
#include "support/laz/laz_samples.hpp"
#include "support/reader_fixture.hpp"

using namespace clearway;
using namespace clearway::test;
using Catch::Matchers::Contains;

TEST_CASE("content counts more than the ending of the name") {
  ReaderScratch scratch;
  CHECK(read_all(scratch.write("a.ply", laz_bytes(0, 20).build())).quanta.size() == 20);
  CHECK(read_all(scratch.write("a.xyz", LasBytes().build())).quanta.size() == 3);
  CHECK(read_all(scratch.write("b",
                               "ply\nformat ascii 1.0\nelement vertex 0\nproperty int x\n"
                               "property int y\nproperty int z\nend_header\n"))
            .size() == 0);
}

TEST_CASE("what is not read is refused by the name of its format, with advice") {
  ReaderScratch scratch;
  const auto refusal = [&](const std::string& name, const std::string& bytes) {
    const auto path = scratch.write(name, bytes);
    const std::string message = refusal_of(path);
    CHECK_THAT(message, Contains(path.string()));
    return message;
  };
  CHECK_THAT(refusal("a.xyz", "ASTM-E57........"), Contains("E57") && Contains("PDAL"));
  CHECK_THAT(refusal("b.xyz", "# .PCD v0.7\n"), Contains("PCD") && Contains("LAS"));
  CHECK_THAT(refusal("c.e57", ""), Contains("E57"));
  CHECK_THAT(refusal("c.PCD", "1 2 3\n"), Contains("PCD"));
  CHECK_THAT(refusal("c.ptx", "1\n1\n"), Contains("PTX"));
  CHECK_THAT(refusal("c.obj", "v 1 2 3\n"), Contains("mesh") && Contains("PLY"));
  CHECK_THAT(refusal("c.las", "1 2 3\n"), Contains("LAS header"));
  CHECK_THAT(refusal("d.las", std::string(500, ' ')), Contains("LASF"));
  CHECK_THAT(refusal("c.ply", "1 2 3\n"), Contains("`ply`"));
  CHECK_THAT(refusal("c.unknown", "1 2 3\n"), Contains("unknown format"));
}

TEST_CASE("a folder's point files count in byte order of their names") {
  ReaderScratch scratch;
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
  CHECK(names == std::vector<std::string>{"named.txt", "B.las", "a10.ply", "a2.XYZ", "b.las",
                                          "z.e57", "\xC3\xA4.las", "named.txt"});
}

TEST_CASE("a missing input and a folder without points are refused") {
  ReaderScratch scratch;
  CHECK_THROWS_AS(list_point_files({scratch.folder() / "missing.las"}), ResourceError);
  CHECK_THROWS_AS(list_point_files({scratch.folder()}), InputError);
  CHECK(list_point_files({}).empty());
}
