#include <cmath>
#include <functional>

#include "clearway/error.hpp"
#include "io/result/export/export_scan_records.hpp"
#include "io/scans/point_reader.hpp"
#include "support/bytes/las_bytes.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/result_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

constexpr unsigned kOwn = 28 + 3;  // bytes of a record of format 1 with three extra bytes

/// Two scans, of which the second has another offset, and the result of points 1, 3 and 4.
struct Scans {
  Scans() {
    first.format = second.format = 1;
    first.extra_bytes = second.extra_bytes = 3;
    first.global_encoding = second.global_encoding = 1;
    second.offset[0] += 7;
    for (auto& q : second.points) q[0] -= 7000;
    second.points[1] = {3, 4, 5};
    second.points[2] = {-6, -7, -8};
    header.environment_points = 6;
    header.poses = 100;
    header.clearance = 0.5;
    for (int k = 0; k < 3; ++k) {
      header.quantisation.scale[k] = first.scale[static_cast<std::size_t>(k)];
      header.quantisation.offset[k] = first.offset[static_cast<std::size_t>(k)];
    }
    rows.source = {1, 3, 4};
    rows.first_pose = {9, 0, 41};
    for (const auto& [x, y, z] : {first.points[1], first.points[0], std::array{7003, 4, 5}}) {
      rows.xyz.push_back(position(header.quantisation, x, y, z));
    }
    clearances = {{3, 4, 5}, {rows.xyz[1], rows.xyz[2], {}}, {0.25, 0.0625, 0.375}, {1, 2, 3}};
  }

  std::string exported(const std::string& name = "out.las") const {
    std::filesystem::create_directory(folder / "scans");
    put_bytes(folder / "scans/a.las", first.build());
    put_bytes(folder / "scans/b.las", second.build());
    write_result(folder / "out.h5", header, rows, 1000, clearances);
    NoProgress progress;
    export_scan_records(ResultReader(folder / "out.h5"), {folder / "scans"}, folder / name, true,
                        progress);
    return bytes_of(folder / name);
  }

  ScratchFolder folder;
  LasBytes first, second;
  ResultHeader header = sample_header(true);
  Collisions rows;
  Clearances clearances;
};

}  // namespace

TEST_CASE("records of scans are copied with all their bytes, before pose, depth and distance") {
  Scans scans;
  const bool depth = GENERATE(false, true);
  if (depth) add_sample_depths(scans.header, scans.rows);
  const std::size_t record = kOwn + (depth ? 28 : 12);
  const std::string bytes = scans.exported();
  const auto points = value_at<std::uint32_t>(bytes, 96);
  check_equal(value_at<std::uint8_t>(bytes, 25), 4);
  check_equal(value_at<std::uint16_t>(bytes, 6), 1);  // adjusted GPS time
  check_equal(value_at<std::uint8_t>(bytes, 104), 1);
  REQUIRE(value_at<std::uint16_t>(bytes, 105) == record);
  check_equal(value_at<std::uint32_t>(bytes, 107), 3);
  check_equal(value_at<std::uint32_t>(bytes, 111 + 4), 3);  // 'r': all are second returns
  check_equal(value_at<std::uint64_t>(bytes, 247), 3);
  REQUIRE(bytes.size() == points + 3 * record);
  check_says(bytes.substr(0, points), depth ? "first_pose ... depth ... depth_source ... distance"
                                            : "first_pose ... distance");
  CHECK(bytes.substr(points, kOwn) == scans.first.build().substr(227 + kOwn, kOwn));
  const std::array<double, 3> distances{-1, 0.25, 0.0625};  // the first has no clearance
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t at = points + i * record, end = at + record;
    CHECK(bytes.substr(at + 12, kOwn - 12) == std::string(kOwn - 12, 'r'));
    CHECK(value_at<std::uint32_t>(bytes, at + kOwn) == scans.rows.first_pose[i]);
    CHECK(value_at<double>(bytes, end - 8) == distances[i]);
    if (!depth) continue;
    const double found = value_at<double>(bytes, end - 24);
    CHECK((i == 2 ? std::isnan(found) : found == scans.rows.depth[i]));
    CHECK(value_at<std::uint64_t>(bytes, end - 16) == scans.rows.depth_source[i]);
  }
  const auto reader = open_point_file(scans.folder / "out.las");
  PointBatch batch;
  REQUIRE(reader->read(batch));
  REQUIRE(batch.size() == 3);
  for (std::size_t i = 0; i < 3; ++i) {
    const auto& [x, y, z] = batch.quanta[i];
    CHECK(position(*reader->info().quantisation, x, y, z) == scans.rows.xyz[i]);
  }
}

TEST_CASE("extra bytes of a scan keep their descriptions, and what has none is called so") {
  Scans scans;
  std::string described(192, '\0');
  described[2] = 3;  // uint16
  described.replace(4, 4, "echo");
  const bool with = GENERATE(true, false);
  if (with) scans.first.vlrs = scans.second.vlrs = {{"LASF_Spec", 4, described}};
  const std::string bytes = scans.exported();
  const std::size_t table = 375 + 54;
  CHECK(value_at<std::uint16_t>(bytes, 375 + 20) == 192 * (with ? 4 : 3));
  std::size_t at = table;
  if (with) {
    CHECK(bytes.substr(at, 192) == described);
    at += 192;
  }
  check_equal(bytes.substr(at + 4, 12), "undocumented");
  check_equal(value_at<std::uint8_t>(bytes, at + 2), 0);
  CHECK(value_at<std::uint8_t>(bytes, at + 3) == (with ? 1 : 3));
  check_equal(bytes.substr(at + 192 + 4, 10), "first_pose");
  check_equal(bytes.substr(at + 2 * 192 + 4, 8), "distance");
  check_equal(value_at<std::uint8_t>(bytes, at + 2 * 192 + 3), 1);
  check_equal(value_at<double>(bytes, at + 2 * 192 + 40), -1);
}

TEST_CASE("scans of another result, and what cannot be copied, are refused with the difference") {
  const auto check = [](const char* words, const std::function<void(Scans&)>& change) {
    Scans scans;
    change(scans);
    check_refused<InputError>([&] { return scans.exported(); }, words);
    CHECK_FALSE(std::filesystem::exists(scans.folder / "out.las"));
  };
  check("a.las: point 1 (source index 1) ... these are not the scans of this result",
        [](Scans& scans) { scans.first.points[1][2] += 1; });
  // In this file the point is found after rounding.
  check("b.las: point 1 (source index 4)", [](Scans& scans) { scans.second.points[1][0] += 1; });
  check("have 5 points ... has 6 ... same order",
        [](Scans& scans) { scans.second.points.pop_back(); });
  check("point format 3", [](Scans& scans) { scans.second.format = 3; });
  check("records of 32 bytes", [](Scans& scans) { scans.second.extra_bytes = 4; });
  check("GPS week time", [](Scans& scans) { scans.second.global_encoding = 0; });
  check("a.las: its records (point format 4)", [](Scans& scans) { scans.first.format = 4; });
  CHECK_THROWS_AS(Scans().exported("out.ply"), UsageError);
}

TEST_CASE("scans that are no LAS may be among them where no point of theirs is copied") {
  Scans scans;
  scans.rows = {{1}, {scans.rows.xyz[0]}, {9}};
  scans.clearances = {};
  scans.second.format = 3;  // a scan of which no point is needed
  CHECK_FALSE(scans.exported().empty());
  std::filesystem::remove(scans.folder / "scans/b.las");
  put_bytes(scans.folder / "scans/b.xyz", "1 2 3\n4 5 6\n7 8 9\n");
  NoProgress progress;
  const auto copy = [&] {
    export_scan_records(ResultReader(scans.folder / "out.h5"), {scans.folder / "scans"},
                        scans.folder / "out.las", true, progress);
  };
  CHECK_NOTHROW(copy());
  write_result(scans.folder / "out.h5", scans.header, {{4}, {{4, 5, 6}}, {0}});
  check_refused([&] { return copy(); }, "b.xyz: is no LAS file, and 1 of the points");
}

TEST_CASE("nothing to copy gives an empty LAS file") {
  Scans scans;
  scans.rows = {};
  check_equal(value_at<std::uint64_t>(scans.exported(), 247), 0);
}
