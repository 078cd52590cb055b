// The sizes and names that docs/guide/command-line.md promises under "Limits".
#include <nlohmann/json.hpp>

#include "core/cloud/packed_cloud.hpp"
#include "io/store/store_writer.hpp"
#include "support/catch.hpp"
#include "support/result_fixture.hpp"
#include "support/store_fixture.hpp"
#include "tools/cli/support/program.hpp"

using namespace clearway;
using namespace clearway::test;
using nlohmann::json;

namespace {

struct Place : Workplace {
  /// Runs a search with a model of one point at its origin and returns the report.
  json search(const std::string& environment, const std::string& trajectory,
              const std::string& options, const std::string& output) const {
    put("model.xyz", "0 0 0\n");
    return json_of(
        require_success(run("run --env " + path(environment) + " --model model.xyz --trajectory " +
                            path(trajectory) + " --json -o " + path(output) + " " + options)));
  }
};

/// Writes a floor of points on the ground in rows of `side`, `step` millimetres apart.
void write_floor(const std::filesystem::path& path, std::size_t points, std::size_t side,
                 std::int32_t step) {
  std::vector<Quantum> floor(points);
  for (std::size_t i = 0; i < points; ++i) {
    floor[i] = {static_cast<std::int32_t>(i % side) * step,
                static_cast<std::int32_t>(i / side) * step, 0};
  }
  write_las(path, floor, {{0.001, 0.001, 0.001}, {0, 0, 0}});
}

}  // namespace

TEST_CASE("more than 2^16 cells, and more than 10^6 poses") {
  constexpr std::size_t kPoints = 64 * 65'600;
  constexpr std::size_t kPoses = 1'100'000;
  const Place place;
  write_floor(place.folder / "a.las", kPoints, 2000, 1000);
  place.succeed("convert a.las --cell-points 64 -o a.h5");
  // The path goes along the first row and back, millimetre by millimetre; its last pose is at the
  // last point.
  std::string path;
  for (std::size_t i = 0; i + 1 < kPoses; ++i) {
    path += pose_at(static_cast<double>(i) * 0.001);
  }
  path += pose_at((kPoints - 1) % 2000, (kPoints - 1) / 2000);
  place.put("path.txt", path);
  const json report = place.search("a.h5", "path.txt", "--radius 0.0105 --first-pose", "out.h5");
  CHECK(report["cells_total"] > 65'536);
  CHECK(report["poses"] == kPoses);
  const Collisions rows = read_rows(ResultReader(place.folder / "out.h5"));
  REQUIRE(rows.size() == 1102);
  CHECK(rows.source.back() == kPoints - 1);
  CHECK(rows.first_pose.back() == kPoses - 1);
  CHECK(rows.first_pose[1000] == 999'990);  // 1 cm before the last pose
}

/// Writes a store of one cell: points along x, metre by metre, whose sources begin at
/// `first_source`.
void write_line(const std::filesystem::path& path, std::uint32_t points,
                std::uint64_t first_source) {
  StoreMetadata metadata{};
  metadata.point_count = points;
  metadata.input_points = first_source + points;  // the points before are counted as not finite
  metadata.cell_points = 64;
  metadata.quantisation = {{1, 1, 1}, {0, 0, 0}};
  metadata.layout = "adaptive";
  PackedCell packed{.cell = {points, {{0, 0, 0}, {static_cast<std::int32_t>(points) - 1, 0, 0}}},
                    .chunks = {}};
  std::vector<std::int32_t> along, zero(64);
  std::vector<std::uint64_t> sources;
  for (std::uint32_t i = 0; i < 64; ++i) {
    along.push_back(static_cast<std::int32_t>(std::min(i, points - 1)));
    sources.push_back(first_source + along.back());
  }
  for (int k = 0; k < 3; ++k) {
    append_packed_chunk<std::int32_t>(k == 0 ? along : zero, packed.chunks[k]);
  }
  append_packed_chunk<std::uint64_t>(sources, packed.chunks[3]);
  const BlockBox block = encode_block_box(packed.cell.box, packed.cell.box);
  seal_cell(packed, std::span(&block, 1), 64);
  StoreWriter writer(path, metadata, 1);
  writer.append(packed);
  writer.finish({{0, 1, 0}});
}

TEST_CASE("sources above 2^32 of a store come through a run, an export and a comparison") {
  constexpr std::uint64_t kFirst = (std::uint64_t{5} << 32) + 7;
  const Place place;
  write_line(place.folder / "line.h5", 50, kFirst);
  place.put("path.txt", path_along_x(2, 20, 20));
  check_outcome(place.run("verify line.h5"), 0);
  CHECK(place.answer("info --json line.h5")["non_finite_points"] == kFirst);
  const std::string options =
      GENERATE("--first-pose --clearance 2.5", "--engine grid", "--engine kdtree");
  check_json(place.search("line.h5", "path.txt", "--radius 1.5 " + options, "out.h5"),
             R"({"colliding_points": 6})");
  const ResultReader result(place.folder / "out.h5");
  CHECK(result.header().environment_points == kFirst + 50);
  const Collisions rows = read_rows(result);
  CHECK(rows.source ==
        std::vector{kFirst + 19, kFirst + 20, kFirst + 21, kFirst + 39, kFirst + 40, kFirst + 41});
  check_outcome(place.run("verify out.h5"), 0);
  place.succeed("export out.h5 -o out.csv");
  check_says(place.bytes("out.csv"), "\n" + std::to_string(kFirst + 41) + ",41,0,0");
  if (options.find("--clearance") != std::string::npos) {
    place.succeed("export out.h5 -o far.csv --what clearance");
    check_says(place.bytes("far.csv"), "\n" + std::to_string(kFirst + 42) + ",");
  }
  check_outcome(place.run("compare out.h5 out.h5"), 0);
}

TEST_CASE("a model of 10^7 points is searched, or refused where memory does not do") {
  const Place place;
  write_floor(place.folder / "model.las", 3163 * 3163, 3163, 1);
  std::vector<Quantum> above;
  for (std::int32_t i = 0; i < 20'000; ++i) above.push_back({i % 3001, i * 7 % 3001, i % 23});
  write_las(place.folder / "above.las", above, {{0.001, 0.001, 0.001}, {0, 0, 0}});
  place.put("pose.txt", pose_at(0));
  place.succeed("convert above.las -o above.h5");
  const std::string search =
      "run --env above.h5 --model model.las --trajectory pose.txt --device cpu --radius 0.0105 -o ";
  place.succeed(search + "out.h5");
  const Collisions rows = read_rows(ResultReader(place.folder / "out.h5"));
  std::vector<std::uint64_t> expected;
  for (std::uint64_t i = 0; i < above.size(); ++i) {
    if (above[i][2] <= 10) expected.push_back(i);
  }
  CHECK((rows.source == expected));
  check_outcome(place.run(search + "small.h5 --memory 200M"), 4, "this search needs ... --memory");
}
