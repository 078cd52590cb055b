#include <sys/stat.h>

#include <nlohmann/json.hpp>

#include "clearway/error.hpp"
#include "io/files/pending_file.hpp"
#include "io/store/store_reader.hpp"
#include "support/catch.hpp"
#include "tools/cli/support/program.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// A folder with a few points as text, a store of them and one pose.
struct Site : Workplace {
  Site() {
    std::string points;
    for (int i = 0; i < 500; ++i) {
      points += std::to_string(i % 25) + " " + std::to_string(i / 25) + " 0.5\n";
    }
    put("scan.xyz", points);
    put("model.xyz", "1 1 0.5\n");
    put("path.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n");
    require_success(run("convert scan.xyz -o site.h5"));
  }

  Outcome search(const std::string& options) const {
    return run("run --env site.h5 --model model.xyz --trajectory path.txt " + options);
  }
};

}  // namespace

TEST_CASE("a radius that is no finite length above 0 is refused") {
  const Site site;
  for (const std::string radius : {"nan", "inf", "0", "-1", "0.1x", "0,1", "1e400"}) {
    const Outcome outcome = site.search(std::string("--radius ") + radius + " -o r.h5");
    INFO(radius);
    check_outcome(outcome, 2, "expected a finite number of metres above 0");
    CHECK_FALSE(site.has("r.h5"));
  }
}

TEST_CASE("a memory bound takes sizes and nothing else") {
  const Site site;
  const std::string convert = "convert scan.xyz --force -o m.h5";
  for (const std::string size : {"-1", "G", "4X", "nan", "1 2", "99999999T", "4GG"}) {
    INFO(size);
    check_outcome(site.run(convert + " --memory '" + size + "'"), 2, "expected a size in bytes");
  }
  for (const std::string size : {"224M", "0.5G", "1GiB", "1gb", "300000000"}) {
    INFO(size);
    check_outcome(site.run(convert + " --memory " + size), 0);
  }
}

TEST_CASE("an unknown command is named") {
  const Site site;
  check_outcome(site.run("covert scan.las"), 2, "covert: no such command ... convert, run");
}

TEST_CASE("forcing does not overwrite an input") {
  const Site site;
  const std::string scan = site.bytes("scan.xyz");
  const std::string store = site.bytes("site.h5");
  check_outcome(site.run("convert scan.xyz --force -o scan.xyz"), 2);
  check_outcome(site.search("--radius 1 --force -o site.h5"), 2);
  check_outcome(site.search("--radius 1 --force -o model.xyz"), 2);
  require_success(site.search("--radius 1 -o r.csv"));
  const std::string result = site.bytes("r.csv");
  check_outcome(site.run("export r.csv --force -o r.csv"), 2);
  check_same(site.bytes("scan.xyz"), scan);
  check_same(site.bytes("site.h5"), store);
  check_same(site.bytes("r.csv"), result);
}

TEST_CASE("an input that has the name of an unfinished output is not overwritten") {
  const Site site;
  const std::filesystem::path model = site.folder / "r.h5.partial";
  std::filesystem::copy_file(site.folder / "model.xyz", model);
  check_outcome(site.run("run --env site.h5 --model " + quoted(model) +
                         " --trajectory path.txt --radius 0.1 -o r.h5"),
                2, "is an input too");
  CHECK(std::filesystem::exists(model));
}

TEST_CASE("an output that is a device, empty or a dangling link is refused") {
  const Site site;
  const std::string convert = "convert scan.xyz -o ";
  check_outcome(site.run(convert + "/dev/full"), 2);
  check_outcome(site.run(convert + "''"), 2);
  std::filesystem::create_symlink("nowhere", site.folder / "link.h5");
  check_outcome(site.run(convert + "link.h5"), 2);
}

TEST_CASE("two writers of one output: the second is refused and leaves the first alone") {
  const Site site;
  const std::string convert = "convert scan.xyz --force -o two.h5";
  {
    const PendingFile first(site.folder / "two.h5", true);
    check_outcome(site.run(convert), 4, "another process is writing it");
    CHECK(std::filesystem::exists(first.partial()));
  }
  CHECK_FALSE(site.has("two.h5.partial"));
  site.put("two.h5.partial", "left by one that was killed");
  check_outcome(site.run(convert), 0);
  check_same(site.bytes("two.h5"), site.bytes("site.h5"));
}

TEST_CASE("a missing file is exit code 4 for every command") {
  const Site site;
  require_success(site.search("--radius 1 -o r.h5"));
  const std::string missing = "missing";
  for (const std::string& arguments :
       {"info " + missing, "verify " + missing, "export " + missing + " -o x.las",
        "compare " + missing + " r.h5", "convert " + missing + " -o x.h5",
        "info " + quoted(site.folder / "")}) {
    INFO(arguments);
    const Outcome outcome = site.run(arguments);
    check_outcome(outcome, 4);
    CHECK(outcome.out.empty());
  }
}

TEST_CASE("info --json prints names that are not UTF-8") {
  const Site site;
  const std::string name = "scan\xff.xyz";
  std::filesystem::copy_file(site.folder / "scan.xyz", site.folder / name);
  site.succeed("convert " + name + " -o b.h5");
  check_json(json_of(check_outcome(site.run("info --json b.h5"), 0)), R"({"points": 500})");
}

TEST_CASE("a regular layout cuts at the faces of its cubes only") {
  const Site site;  // 25 x 20 m, so cubes of 10 m are 3 x 2
  site.succeed("convert scan.xyz --layout regular:10 --cell-points 128 -o cubes.h5");
  check_json(json_of(site.run("info --json cubes.h5")), R"({"cells": 6})");
  check_outcome(site.run("verify cubes.h5"), 0);
}

TEST_CASE("a model among the scans is asked about") {
  const Site site;
  site.succeed("scene hall --points 500 --model-points 50 --poses 2 -o hall");
  check_outcome(site.run("convert hall -o h.h5"), 0,
                "warning:  ... model.ply ... Is one of them the model?");
  check_outcome(site.run("convert --strict hall -o s.h5"), 3);
}

TEST_CASE("what is in the place of a temporary file and is no file is refused and left alone") {
  const Site site;
  site.put("precious", "mine");
  std::filesystem::create_symlink("precious", site.folder / "a.h5.partial");
  std::filesystem::create_symlink("nowhere", site.folder / "b.h5.partial");
  REQUIRE(::mkfifo((site.folder / "c.h5.partial").c_str(), 0600) == 0);
  for (const std::string name : {"a.h5", "b.h5", "c.h5"}) {
    INFO(name);
    for (const Outcome& outcome :
         {site.search("--radius 0.1 -o " + name), site.run("convert scan.xyz -o " + name)}) {
      check_outcome(outcome, 2, "is where this output's temporary file has to be");
    }
    CHECK_FALSE(site.has(name));
  }
  check_same(site.bytes("precious"), "mine");
  CHECK_FALSE(site.has("nowhere"));
}

TEST_CASE("options that do not go together are refused before an input is looked at") {
  const Site site;
  const std::string run =
      "run --env none.h5 --model none.ply --trajectory none.txt --radius 0.1 -o r.h5 ";
  for (const char* options : {"--clearance 1 --between-poses", "--engine kdtree --clearance 1",
                              "--engine kdtree --device-memory 1G"}) {
    INFO(options);
    check_outcome(site.run(run + options), 2);
  }
  check_outcome(site.run("compare a.h5 b.h5 --show -1"), 2);
  check_says(site.run("export a.h5 -o x.csv -o x.csv").err, "--output: given more than once");
  check_says(site.run("export a.h5 -o x.csv --chainage-start 5").err, "--what profile");
  check_outcome(site.run("scene hall --seed -1 -o s"), 2);
}

TEST_CASE("faces of a mesh are read for a model, not for an environment, which is said") {
  const Site site;
  site.put("mesh.ply",
           "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
           "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
           "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  check_outcome(
      site.run("run --env site.h5 --model mesh.ply --trajectory path.txt --radius 0.1 -o m.h5"), 0,
      "a mesh of 1 triangle, searched as it is");
  check_says(site.run("convert mesh.ply -o m2.h5").err,
             "its 1 faces are not read, its vertices are");
}

TEST_CASE("a resumed conversion leaves the store of the same inputs alone, and no other") {
  const Site site;
  const std::string convert = "convert scan.xyz -o site.h5 --resume";
  const std::string before = site.bytes("site.h5");
  check_outcome(site.run(convert), 0, "is the store of these inputs already");
  for (const char* other : {" --cell-points 128", " --layout regular:5", " --scale 0.5",
                            " --columns 1,2,3", " --unit ft", " --near path.txt --within 9"}) {
    check_outcome(site.run(convert + other), 2,
                  "site.h5: was converted with other options: its ... --force instead of "
                  "--resume overwrites it");
  }
  site.put("scan.xyz", site.bytes("scan.xyz") + "0 0 0\n");
  check_outcome(site.run(convert), 2, "site.h5: holds other scans than these");
  check_same(site.bytes("site.h5"), before);
}

TEST_CASE("a resumed conversion does not call a damaged store done") {
  const Site site;
  const std::string convert = "convert scan.xyz -o site.h5";
  const std::string sound = site.bytes("site.h5");
  const std::vector<std::uint64_t> chunks = StoreReader(site.folder / "site.h5").index().address;
  REQUIRE(chunks.size() == 4);  // x, y, z and the source indices of one cell
  for (const std::uint64_t chunk : chunks) {
    std::string damaged = sound;
    damaged[chunk + 20] = static_cast<char>(damaged[chunk + 20] ^ 1);
    site.put("site.h5", damaged);
    check_outcome(site.run(convert + " --resume"), 2,
                  "site.h5: cell 0:  ... is damaged ... --force instead of --resume overwrites it");
    check_same(site.bytes("site.h5"), damaged);
  }
  check_outcome(site.run(convert + " --force"), 0);
  check_same(site.bytes("site.h5"), sound);
}
