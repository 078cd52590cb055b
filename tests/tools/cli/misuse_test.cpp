#include <sys/stat.h>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "clearway/error.hpp"
#include "io/files/pending_file.hpp"
#include "io/store/store_reader.hpp"
#include "tools/cli/support/program.hpp"

using namespace clearway;
using namespace clearway::test;
using Catch::Contains;

namespace {

/// A folder with a few points as text, a store of them and one pose.
struct Site {
  Site() {
    std::string points;
    for (int i = 0; i < 500; ++i) {
      points += std::to_string(i % 25) + " " + std::to_string(i / 25) + " 0.5\n";
    }
    put_bytes(folder / "scan.xyz", points);
    put_bytes(folder / "model.xyz", "1 1 0.5\n");
    put_bytes(folder / "path.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n");
    REQUIRE(run("convert " + path("scan.xyz") + " -o " + path("site.h5")).exit_code == 0);
  }

  Outcome run(const std::string& arguments) const { return run_program(folder, arguments); }
  std::string path(const std::string& name) const { return quoted(folder / name); }
  Outcome search(const std::string& options) const {
    return run("run --env " + path("site.h5") + " --model " + path("model.xyz") + " --trajectory " +
               path("path.txt") + " " + options);
  }

  ScratchFolder folder;
};

}  // namespace

TEST_CASE("a radius that is no finite length above 0 is refused") {
  const Site site;
  for (const char* radius : {"nan", "inf", "0", "-1", "0.1x", "0,1", "1e400"}) {
    const Outcome outcome =
        site.search(std::string("--radius ") + radius + " -o " + site.path("r.h5"));
    INFO(radius);
    CHECK(outcome.exit_code == 2);
    CHECK_THAT(outcome.err, Contains("expected a finite number of metres above 0"));
    CHECK_FALSE(std::filesystem::exists(site.folder / "r.h5"));
  }
}

TEST_CASE("a memory bound takes sizes and nothing else") {
  const Site site;
  const std::string convert =
      "convert " + site.path("scan.xyz") + " --force -o " + site.path("m.h5");
  for (const char* size : {"-1", "G", "4X", "nan", "1 2", "99999999T", "4GG"}) {
    INFO(size);
    const Outcome outcome = site.run(convert + " --memory '" + size + "'");
    CHECK(outcome.exit_code == 2);
    CHECK_THAT(outcome.err, Contains("expected a size in bytes"));
  }
  for (const char* size : {"224M", "0.5G", "1GiB", "1gb", "300000000"}) {
    INFO(size);
    CHECK(site.run(convert + " --memory " + size).exit_code == 0);
  }
}

TEST_CASE("an unknown command is named") {
  const Site site;
  const Outcome outcome = site.run("covert scan.las");
  CHECK(outcome.exit_code == 2);
  CHECK_THAT(outcome.err, Contains("covert: no such command") && Contains("convert, run"));
}

TEST_CASE("forcing does not overwrite an input") {
  const Site site;
  const std::string scan = bytes_of(site.folder / "scan.xyz");
  const std::string store = bytes_of(site.folder / "site.h5");
  CHECK(site.run("convert " + site.path("scan.xyz") + " --force -o " + site.path("scan.xyz"))
            .exit_code == 2);
  CHECK(site.search("--radius 1 --force -o " + site.path("site.h5")).exit_code == 2);
  CHECK(site.search("--radius 1 --force -o " + site.path("model.xyz")).exit_code == 2);
  REQUIRE(site.search("--radius 1 -o " + site.path("r.csv")).exit_code == 0);
  const std::string result = bytes_of(site.folder / "r.csv");
  CHECK(site.run("export " + site.path("r.csv") + " --force -o " + site.path("r.csv")).exit_code ==
        2);
  CHECK(bytes_of(site.folder / "scan.xyz") == scan);
  CHECK(bytes_of(site.folder / "site.h5") == store);
  CHECK(bytes_of(site.folder / "r.csv") == result);
}

TEST_CASE("an input that has the name of an unfinished output is not overwritten") {
  const Site site;
  const std::filesystem::path model = site.folder / "r.h5.partial";
  std::filesystem::copy_file(site.folder / "model.xyz", model);
  const Outcome refused =
      site.run("run --env " + site.path("site.h5") + " --model " + quoted(model) +
               " --trajectory " + site.path("path.txt") + " --radius 0.1 -o " + site.path("r.h5"));
  CHECK(refused.exit_code == 2);
  CHECK_THAT(refused.err, Contains("is an input too"));
  CHECK(std::filesystem::exists(model));
}

TEST_CASE("an output that is a device, empty or a dangling link is refused") {
  const Site site;
  const std::string convert = "convert " + site.path("scan.xyz") + " -o ";
  CHECK(site.run(convert + "/dev/full").exit_code == 2);
  CHECK(site.run(convert + "''").exit_code == 2);
  std::filesystem::create_symlink("nowhere", site.folder / "link.h5");
  CHECK(site.run(convert + site.path("link.h5")).exit_code == 2);
}

TEST_CASE("two writers of one output: the second is refused and leaves the first alone") {
  const Site site;
  const std::string convert =
      "convert " + site.path("scan.xyz") + " --force -o " + site.path("two.h5");
  {
    const PendingFile first(site.folder / "two.h5", true);
    const Outcome second = site.run(convert);
    CHECK(second.exit_code == 4);
    CHECK_THAT(second.err, Contains("another process is writing it"));
    CHECK(std::filesystem::exists(first.partial()));
  }
  CHECK_FALSE(std::filesystem::exists(site.folder / "two.h5.partial"));
  put_bytes(site.folder / "two.h5.partial", "left by one that was killed");
  CHECK(site.run(convert).exit_code == 0);
  CHECK(bytes_of(site.folder / "two.h5") == bytes_of(site.folder / "site.h5"));
}

TEST_CASE("a missing file is exit code 4 for every command") {
  const Site site;
  REQUIRE(site.search("--radius 1 -o " + site.path("r.h5")).exit_code == 0);
  const std::string missing = site.path("missing");
  for (const std::string& arguments :
       {"info " + missing, "verify " + missing, "export " + missing + " -o x.las",
        "compare " + missing + " " + site.path("r.h5"),
        "convert " + missing + " -o " + site.path("x.h5"), "info " + quoted(site.folder / "")}) {
    INFO(arguments);
    const Outcome outcome = site.run(arguments);
    CHECK(outcome.exit_code == 4);
    CHECK(outcome.out.empty());
  }
}

TEST_CASE("info --json prints names that are not UTF-8") {
  const Site site;
  const std::string name = "scan\xff.xyz";
  std::filesystem::copy_file(site.folder / "scan.xyz", site.folder / name);
  REQUIRE(site.run("convert " + site.path(name) + " -o " + site.path("b.h5")).exit_code == 0);
  const Outcome outcome = site.run("info --json " + site.path("b.h5"));
  CHECK(outcome.exit_code == 0);
  CHECK(nlohmann::json::parse(outcome.out)["points"] == 500);
}

TEST_CASE("a regular layout cuts at the faces of its cubes only") {
  const Site site;  // 25 x 20 m, so cubes of 10 m are 3 x 2
  REQUIRE(site.run("convert " + site.path("scan.xyz") +
                   " --layout regular:10 --cell-points 128 -o " + site.path("cubes.h5"))
              .exit_code == 0);
  const Outcome outcome = site.run("info --json " + site.path("cubes.h5"));
  CHECK(nlohmann::json::parse(outcome.out)["cells"] == 6);
  CHECK(site.run("verify " + site.path("cubes.h5")).exit_code == 0);
}

TEST_CASE("a model among the scans is asked about") {
  const Site site;
  REQUIRE(site.run("scene hall --points 500 --model-points 50 --poses 2 -o " + site.path("hall"))
              .exit_code == 0);
  const Outcome outcome = site.run("convert " + site.path("hall") + " -o " + site.path("h.h5"));
  CHECK(outcome.exit_code == 0);
  CHECK_THAT(outcome.err, Contains("warning: ") && Contains("model.ply") &&
                              Contains("Is one of them the model?"));
  CHECK(site.run("convert --strict " + site.path("hall") + " -o " + site.path("s.h5")).exit_code ==
        3);
}

TEST_CASE("what is in the place of a temporary file and is no file is refused and left alone") {
  const Site site;
  put_bytes(site.folder / "precious", "mine");
  std::filesystem::create_symlink("precious", site.folder / "a.h5.partial");
  std::filesystem::create_symlink("nowhere", site.folder / "b.h5.partial");
  REQUIRE(::mkfifo((site.folder / "c.h5.partial").c_str(), 0600) == 0);
  for (const char* name : {"a.h5", "b.h5", "c.h5"}) {
    INFO(name);
    for (const Outcome& outcome :
         {site.search("--radius 0.1 -o " + site.path(name)),
          site.run("convert " + site.path("scan.xyz") + " -o " + site.path(name))}) {
      CHECK(outcome.exit_code == 2);
      CHECK_THAT(outcome.err, Contains("is where this output's temporary file has to be"));
    }
    CHECK_FALSE(std::filesystem::exists(site.folder / name));
  }
  CHECK(bytes_of(site.folder / "precious") == "mine");
  CHECK_FALSE(std::filesystem::exists(site.folder / "nowhere"));
}

TEST_CASE("options that do not go together are refused before an input is looked at") {
  const Site site;
  const std::string run =
      "run --env none.h5 --model none.ply --trajectory none.txt --radius 0.1 -o " +
      site.path("r.h5") + " ";
  for (const char* options : {"--clearance 1 --between-poses", "--engine kdtree --clearance 1",
                              "--engine kdtree --device-memory 1G"}) {
    INFO(options);
    CHECK(site.run(run + options).exit_code == 2);
  }
  CHECK(site.run("compare a.h5 b.h5 --show -1").exit_code == 2);
  CHECK_THAT(site.run("export a.h5 -o x.csv -o x.csv").err,
             Contains("--output: given more than once"));
  CHECK_THAT(site.run("export a.h5 -o x.csv --chainage-start 5").err, Contains("--what profile"));
  CHECK(site.run("scene hall --seed -1 -o " + site.path("s")).exit_code == 2);
}

TEST_CASE("faces of a mesh are read for a model, not for an environment, which is said") {
  const Site site;
  put_bytes(site.folder / "mesh.ply",
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
            "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
            "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  const Outcome outcome =
      site.run("run --env " + site.path("site.h5") + " --model " + site.path("mesh.ply") +
               " --trajectory " + site.path("path.txt") + " --radius 0.1 -o " + site.path("m.h5"));
  CHECK(outcome.exit_code == 0);
  CHECK_THAT(outcome.err, Contains("a mesh of 1 triangle, searched as it is"));
  const Outcome convert =
      site.run("convert " + site.path("mesh.ply") + " -o " + site.path("m2.h5"));
  CHECK_THAT(convert.err, Contains("its 1 faces are not read, its vertices are"));
}

TEST_CASE("a resumed conversion leaves the store of the same inputs alone, and no other") {
  const Site site;
  const std::string convert =
      "convert " + site.path("scan.xyz") + " -o " + site.path("site.h5") + " --resume";
  const std::string before = bytes_of(site.folder / "site.h5");
  const Outcome again = site.run(convert);
  CHECK(again.exit_code == 0);
  CHECK_THAT(again.err, Contains("is the store of these inputs already"));
  for (const char* other : {" --cell-points 128", " --layout regular:5", " --scale 0.5"}) {
    const Outcome refused = site.run(convert + other);
    CHECK(refused.exit_code == 2);
    CHECK_THAT(refused.err, Contains("site.h5: holds other scans than these, or they were") &&
                                Contains("--force instead of --resume overwrites it"));
  }
  put_bytes(site.folder / "scan.xyz", bytes_of(site.folder / "scan.xyz") + "0 0 0\n");
  CHECK(site.run(convert).exit_code == 2);
  CHECK((bytes_of(site.folder / "site.h5") == before));
}

TEST_CASE("a resumed conversion does not call a damaged store done") {
  const Site site;
  const std::string convert = "convert " + site.path("scan.xyz") + " -o " + site.path("site.h5");
  const std::string sound = bytes_of(site.folder / "site.h5");
  const std::vector<std::uint64_t> chunks = StoreReader(site.folder / "site.h5").index().address;
  REQUIRE(chunks.size() == 4);  // x, y, z and the source indices of one cell
  for (const std::uint64_t chunk : chunks) {
    std::string damaged = sound;
    damaged[chunk + 20] = static_cast<char>(damaged[chunk + 20] ^ 1);
    put_bytes(site.folder / "site.h5", damaged);
    const Outcome refused = site.run(convert + " --resume");
    CHECK(refused.exit_code == 2);
    CHECK_THAT(refused.err, Contains("site.h5: cell 0: ") && Contains("is damaged") &&
                                Contains("--force instead of --resume overwrites it"));
    CHECK((bytes_of(site.folder / "site.h5") == damaged));
  }
  CHECK(site.run(convert + " --force").exit_code == 0);
  CHECK((bytes_of(site.folder / "site.h5") == sound));
}
