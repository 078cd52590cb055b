// What docs/user-guide.md, "Limits", says of sizes and names.
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "program.hpp"
#include "support/store_fixture.hpp"

using namespace clearway;
using namespace clearway::test;
using Catch::Contains;
using nlohmann::json;

namespace {

struct Place {
  Outcome run(const std::string& arguments) const { return run_program(folder, arguments); }
  std::string path(const std::string& name) const { return quoted(folder / name); }
  /// A run of a model of one point at its origin; its report.
  json search(const std::string& environment, const std::string& trajectory,
              const std::string& options, const std::string& output) const {
    put_bytes(folder / "model.xyz", "0 0 0\n");
    const Outcome outcome =
        run("run --env " + path(environment) + " --model " + path("model.xyz") + " --trajectory " +
            path(trajectory) + " --json -o " + path(output) + " " + options);
    INFO(outcome.err);
    REQUIRE(outcome.exit_code == 0);
    return json::parse(outcome.out);
  }

  ScratchFolder folder;
};

const std::string kPose = "1 0 0 0 0 1 0 0 0 0 1 0\n";

}  // namespace

TEST_CASE("names with blanks, quotes and UTF-8 are names like others") {
  const Place place;
  const std::string scan = "Prüf strecke \xE2\x84\xA6 \"1\" $HOME;.xyz";
  put_bytes(place.folder / scan, "0 0 0\n5 5 5\n");
  put_bytes(place.folder / "der weg \xC3\xA4.txt", kPose);
  REQUIRE(
      place.run("convert " + place.path(scan) + " -o " + place.path("s \xC3\xBC.h5")).exit_code ==
      0);
  const json report =
      place.search("s \xC3\xBC.h5", "der weg \xC3\xA4.txt", "--radius 1", "aus gabe \xC3\x9F.h5");
  CHECK(report["colliding_points"] == 1);
  REQUIRE(place
              .run("export " + place.path("aus gabe \xC3\x9F.h5") + " -o " +
                   place.path("-\xC3\x9F x.csv"))
              .exit_code == 0);
  CHECK(place.run("verify " + place.path("s \xC3\xBC.h5")).exit_code == 0);
  CHECK_THAT(place.run("info " + place.path("s \xC3\xBC.h5")).out, Contains(scan));
}

TEST_CASE("no points and no poses have an empty answer") {
  const Place place;
  write_las(place.folder / "none.las", {});
  put_bytes(place.folder / "scan.xyz", "0 0 0\n");
  put_bytes(place.folder / "none.txt", "");
  put_bytes(place.folder / "path.txt", kPose);
  REQUIRE(
      place.run("convert " + place.path("none.las") + " -o " + place.path("none.h5")).exit_code ==
      0);
  REQUIRE(
      place.run("convert " + place.path("scan.xyz") + " -o " + place.path("scan.h5")).exit_code ==
      0);
  const std::string engine = GENERATE("sweep", "grid", "kdtree");
  const std::string options = "--radius 1 --engine " + engine;
  CHECK(place.search("none.h5", "path.txt", options, "a.h5")["colliding_points"] == 0);
  CHECK(place.search("scan.h5", "none.txt", options, "b.h5")["colliding_points"] == 0);
  CHECK(place.run("verify " + place.path("a.h5")).exit_code == 0);
  CHECK(place.run("export " + place.path("b.h5") + " -o " + place.path("b.las")).exit_code == 0);
}

TEST_CASE("more than 2^16 cells, and more than 10^6 poses") {
  constexpr std::size_t kPoints = 64 * 65'600;
  constexpr std::size_t kPoses = 1'100'000;
  const Place place;
  std::vector<Quantum> points(kPoints);
  for (std::size_t i = 0; i < kPoints; ++i) {
    points[i] = {static_cast<std::int32_t>(i % 2000) * 1000,
                 static_cast<std::int32_t>(i / 2000) * 1000, 0};
  }
  write_las(place.folder / "a.las", points, {{0.001, 0.001, 0.001}, {0, 0, 0}});
  REQUIRE(place.run("convert " + place.path("a.las") + " --cell-points 64 -o " + place.path("a.h5"))
              .exit_code == 0);
  // Along the first row and back, millimetre by millimetre; the last pose at the last point.
  std::string path;
  for (std::size_t i = 0; i + 1 < kPoses; ++i) {
    path += "1 0 0 " + std::to_string(static_cast<double>(i) * 0.001) + " 0 1 0 0 0 0 1 0\n";
  }
  path += "1 0 0 " + std::to_string((kPoints - 1) % 2000) + " 0 1 0 " +
          std::to_string((kPoints - 1) / 2000) + " 0 0 1 0\n";
  put_bytes(place.folder / "path.txt", path);
  const json report = place.search("a.h5", "path.txt", "--radius 0.0105 --first-pose", "out.h5");
  CHECK(report["cells_total"] > 65'536);
  CHECK(report["poses"] == kPoses);
  const ResultRows rows = read_rows(ResultReader(place.folder / "out.h5"));
  REQUIRE(rows.size() == 1102);
  CHECK(rows.source.back() == kPoints - 1);
  CHECK(rows.first_pose.back() == kPoses - 1);
  CHECK(rows.first_pose[1000] == 999'990);  // 1 cm before it
}

TEST_CASE("sources above 2^32 come back from a result and its export") {
  const Place place;
  ResultHeader header = sample_header(true);
  header.environment_points = std::uint64_t{1} << 34;
  ResultRows rows = sample_rows(header, 10);
  for (std::uint64_t& source : rows.source) source += std::uint64_t{1} << 32;
  write_result(place.folder / "big.h5", header, rows);
  CHECK((read_rows(ResultReader(place.folder / "big.h5")).source == rows.source));
  REQUIRE(place.run("export " + place.path("big.h5") + " -o " + place.path("big.csv")).exit_code ==
          0);
  CHECK_THAT(bytes_of(place.folder / "big.csv"),
             Contains("\n" + std::to_string(rows.source[3]) + ","));
}
