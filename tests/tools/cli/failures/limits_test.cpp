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

const std::string kPose = "1 0 0 0 0 1 0 0 0 0 1 0\n";

}  // namespace

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
                    .blocks = {},
                    .chunks = {}};
  packed.blocks.push_back(encode_block_box(packed.cell.box, packed.cell.box));
  std::vector<std::int32_t> along(64), zero(64);
  std::vector<std::uint64_t> sources(64);
  for (std::uint32_t i = 0; i < 64; ++i) {
    const std::uint32_t point = std::min(i, points - 1);
    along[i] = static_cast<std::int32_t>(point);
    sources[i] = first_source + point;
  }
  append_packed_chunk<std::int32_t>(along, packed.chunks[0]);
  append_packed_chunk<std::int32_t>(zero, packed.chunks[1]);
  append_packed_chunk<std::int32_t>(zero, packed.chunks[2]);
  append_packed_chunk<std::uint64_t>(sources, packed.chunks[3]);
  hash_chunks(packed);
  StoreWriter writer(path, metadata, 1);
  writer.append(packed);
  writer.finish({{0, 1, 0}});
}

TEST_CASE("sources above 2^32 of a store come through a run, an export and a comparison") {
  constexpr std::uint64_t kFirst = (std::uint64_t{5} << 32) + 7;
  const Place place;
  write_line(place.folder / "line.h5", 50, kFirst);
  place.put("path.txt", "1 0 0 20 0 1 0 0 0 0 1 0\n1 0 0 40 0 1 0 0 0 0 1 0\n");
  check_outcome(place.run("verify line.h5"), 0);
  CHECK(place.answer("info --json line.h5")["non_finite_points"] == kFirst);
  const std::string options =
      GENERATE("--first-pose --clearance 2.5", "--engine grid", "--engine kdtree");
  check_json(place.search("line.h5", "path.txt", "--radius 1.5 " + options, "out.h5"),
             R"({"colliding_points": 6})");
  const ResultReader result(place.folder / "out.h5");
  CHECK(result.header().environment_points == kFirst + 50);
  const Collisions rows = read_rows(result);
  std::vector<std::uint64_t> expected;
  for (const std::uint64_t at : {19, 20, 21, 39, 40, 41}) expected.push_back(kFirst + at);
  CHECK(rows.source == expected);
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
  constexpr std::int32_t kSide = 3163;  // a floor of points, 1 mm apart
  const Place place;
  const Quantisation millimetres{{0.001, 0.001, 0.001}, {0, 0, 0}};
  std::vector<Quantum> floor;
  floor.reserve(std::size_t{kSide} * kSide);
  for (std::int32_t y = 0; y < kSide; ++y) {
    for (std::int32_t x = 0; x < kSide; ++x) floor.push_back({x, y, 0});
  }
  write_las(place.folder / "model.las", floor, millimetres);
  std::vector<Quantum> above;
  for (std::int32_t i = 0; i < 20'000; ++i) above.push_back({i % 3001, i * 7 % 3001, i % 23});
  write_las(place.folder / "above.las", above, millimetres);
  place.put("pose.txt", kPose);
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
