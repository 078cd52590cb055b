#include "io/result/export/export_result.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <csignal>
#include <cstring>
#include <sstream>

#include "clearway/error.hpp"
#include "io/scans/requantize.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/file_size_limit.hpp"
#include "support/leaks_of_hdf5.hpp"
#include "support/result_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// The value that starts at a byte of a file.
template <typename Value>
Value value_at(const std::string& bytes, std::size_t at) {
  REQUIRE(at + sizeof(Value) <= bytes.size());
  Value value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

struct Sample {
  ResultHeader header;
  Collisions rows;
};

Sample sample_to_export(bool first_pose, std::size_t count, const std::string& crs = "") {
  Sample out{sample_header(first_pose), {}};
  out.header.crs_wkt = crs;
  out.rows = sample_rows(out.header, count);
  return out;
}

/// The bytes of a sample's exported file.
std::string exported(const Sample& sample_to_export, const std::string& name) {
  const ScratchFolder folder;
  write_result(folder / "out.h5", sample_to_export.header, sample_to_export.rows);
  NoProgress progress;
  export_result(ResultReader(folder / "out.h5"), folder / name, false, progress);
  CHECK_FALSE(std::filesystem::exists(folder / (name + ".partial")));
  return bytes_of(folder / name);
}

/// The words of each line of a text, separated by `separator`.
std::vector<std::vector<std::string>> table(const std::string& text, char separator) {
  std::vector<std::vector<std::string>> out;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    auto& words = out.emplace_back();
    std::istringstream cells(line);
    for (std::string word; std::getline(cells, word, separator);) words.push_back(word);
  }
  return out;
}

/// Whether a text reads back as the stored integer of a coordinate.
bool same_quantum(const Sample& sample_to_export, int axis, const std::string& text,
                  double coordinate) {
  const Quantisation& quantisation = sample_to_export.header.quantisation;
  const double steps = (std::stod(text) - quantisation.offset[axis]) / quantisation.scale[axis];
  return quantum_at(quantisation, axis, coordinate).value() == std::nearbyint(steps);
}

constexpr std::size_t kMany = 65'600;  // more than a batch

}  // namespace

TEST_CASE("CSV holds every column in full") {
  const bool first_pose = GENERATE(false, true);
  const Sample s = sample_to_export(first_pose, GENERATE(0u, 3u, kMany));
  const auto rows = table(exported(s, "out.csv"), ',');
  REQUIRE(rows.size() == s.rows.size() + 1);
  std::vector<std::string> header{"source", "x", "y", "z"};
  if (first_pose) header.push_back("first_pose");
  CHECK(rows[0] == header);
  for (std::size_t i = 0; i < s.rows.size(); ++i) {
    const auto& row = rows[i + 1];
    REQUIRE(row.size() == header.size());
    REQUIRE(std::stoull(row[0]) == s.rows.source[i]);
    for (int k = 0; k < 3; ++k) {
      REQUIRE(same_quantum(s, k, row[static_cast<std::size_t>(1 + k)], s.rows.xyz[i][k]));
    }
    if (first_pose) REQUIRE(std::stoul(row[4]) == s.rows.first_pose[i]);
  }
}

TEST_CASE("XYZ holds the coordinates in full, and nothing else") {
  const Sample s = sample_to_export(GENERATE(false, true), GENERATE(0u, kMany));
  const auto rows = table(exported(s, "out.xyz"), ' ');
  REQUIRE(rows.size() == s.rows.size());
  for (std::size_t i = 0; i < s.rows.size(); ++i) {
    REQUIRE(rows[i].size() == 3);
    for (int k = 0; k < 3; ++k) {
      REQUIRE(same_quantum(s, k, rows[i][static_cast<std::size_t>(k)], s.rows.xyz[i][k]));
    }
  }
}

TEST_CASE("PLY holds doubles and first poses") {
  const bool first_pose = GENERATE(false, true);
  const Sample s = sample_to_export(first_pose, GENERATE(0u, kMany));
  const std::string bytes = exported(s, "out.PLY");
  const std::string header = "ply\nformat binary_little_endian 1.0\nelement vertex " +
                             std::to_string(s.rows.size()) +
                             "\nproperty double x\nproperty double y\nproperty double z\n" +
                             (first_pose ? "property uint first_pose\n" : "") + "end_header\n";
  REQUIRE(bytes.substr(0, header.size()) == header);
  const std::size_t row_bytes = 24 + (first_pose ? 4 : 0);
  REQUIRE(bytes.size() == header.size() + row_bytes * s.rows.size());
  for (std::size_t i = 0; i < s.rows.size(); ++i) {
    const std::size_t at = header.size() + row_bytes * i;
    REQUIRE(value_at<Vec3>(bytes, at) == s.rows.xyz[i]);
    if (first_pose) REQUIRE(value_at<std::uint32_t>(bytes, at + 24) == s.rows.first_pose[i]);
  }
}

TEST_CASE("LAS holds the source's integers, scale, offset, CRS and first poses") {
  const bool first_pose = GENERATE(false, true);
  const std::string crs = GENERATE(std::string(), std::string("PROJCS[\"somewhere\"]"));
  const Sample s = sample_to_export(first_pose, GENERATE(0u, kMany), crs);
  const std::string bytes = exported(s, "out.las");
  REQUIRE(bytes.substr(0, 4) == "LASF");
  const bool version_14 = value_at<std::uint8_t>(bytes, 25) == 4;
  CHECK(version_14 == (first_pose || !crs.empty()));
  const auto points_at = value_at<std::uint32_t>(bytes, 96);
  const auto row_bytes = value_at<std::uint16_t>(bytes, 105);
  CHECK((version_14 ? value_at<std::uint64_t>(bytes, 247) : value_at<std::uint32_t>(bytes, 107)) ==
        s.rows.size());
  REQUIRE(bytes.size() == points_at + row_bytes * s.rows.size());
  CHECK((bytes.find(crs) < points_at));
  CHECK((bytes.find("first_pose") < points_at) == first_pose);

  const auto read = value_at<Quantisation>(bytes, 131);
  CHECK(read == s.header.quantisation);
  Vec3 lo = s.rows.size() == 0 ? Vec3{} : s.rows.xyz[0], hi = lo;
  for (std::size_t i = 0; i < s.rows.size(); ++i) {
    const std::size_t at = points_at + row_bytes * i;
    const auto q = value_at<std::array<std::int32_t, 3>>(bytes, at);
    REQUIRE(position(read, q[0], q[1], q[2]) == s.rows.xyz[i]);
    if (first_pose) {
      REQUIRE(value_at<std::uint32_t>(bytes, at + row_bytes - 4) == s.rows.first_pose[i]);
    }
    for (int k = 0; k < 3; ++k) {
      lo[k] = std::min(lo[k], s.rows.xyz[i][k]);
      hi[k] = std::max(hi[k], s.rows.xyz[i][k]);
    }
  }
  for (int k = 0; k < 3; ++k) {
    const std::size_t at = 179 + 16 * static_cast<std::size_t>(k);
    CHECK(value_at<double>(bytes, at) == hi[k]);
    CHECK(value_at<double>(bytes, at + 8) == lo[k]);
  }
}

TEST_CASE("LAS, PLY and CSV hold depths, also of points without a free one") {
  Sample s = sample_to_export(GENERATE(false, true), 5);
  add_sample_depths(s.header, s.rows);
  const std::size_t pose_bytes = s.header.first_pose ? 4 : 0;
  const auto check_at = [&](const std::string& bytes, std::size_t at, std::size_t row) {
    const double depth = value_at<double>(bytes, at);
    CHECK((depth == s.rows.depth[row] || (std::isnan(depth) && std::isnan(s.rows.depth[row]))));
    CHECK(value_at<std::uint64_t>(bytes, at + 8) == s.rows.depth_source[row]);
  };
  const std::string las = exported(s, "out.las");
  const auto points_at = value_at<std::uint32_t>(las, 96);
  const auto las_bytes = value_at<std::uint16_t>(las, 105);
  REQUIRE(las.size() == points_at + las_bytes * s.rows.size());
  CHECK(las.find("depth_source") < points_at);
  for (std::size_t i = 0; i < s.rows.size(); ++i) {
    check_at(las, points_at + las_bytes * (i + 1) - 16, i);
  }
  const std::string csv = exported(s, "out.csv");
  const auto table_rows = table(csv, ',');
  CHECK(table_rows[0].back() == "depth_source");
  CHECK(table_rows[0][table_rows[0].size() - 2] == "depth");
  CHECK(std::stod(table_rows[1][4 + pose_bytes / 4]) == s.rows.depth[0]);
  CHECK(std::stoull(table_rows[1].back()) == s.rows.depth_source[0]);
  CHECK(csv.find(",,\n") != std::string::npos);  // without a free point
  const std::string ply = exported(s, "out.ply");
  const std::size_t rows_at = ply.find("end_header\n") + 11;
  CHECK(ply.find("property double depth\n") < rows_at);
  CHECK(ply.find("depth_source\n") < rows_at);
  const std::size_t ply_bytes = (ply.size() - rows_at) / s.rows.size();
  for (std::size_t i = 0; i < s.rows.size(); ++i) {
    const std::size_t at = rows_at + ply_bytes * i;
    REQUIRE(value_at<Vec3>(ply, at) == s.rows.xyz[i]);
    const double depth = value_at<double>(ply, at + 24 + pose_bytes);
    CHECK((depth == s.rows.depth[i] || (std::isnan(depth) && std::isnan(s.rows.depth[i]))));
  }
}

TEST_CASE("a coordinate that is no multiple of the scale is refused as LAS, with its source") {
  Sample s = sample_to_export(false, 5);
  s.rows.xyz[3].y += 0.00005;
  const std::string place = "source " + std::to_string(s.rows.source[3]);
  CHECK_THROWS_AS(exported(s, "out.las"), InputError);
  check_refused([&] { return exported(s, "out.las"); }, std::string("out.h5 ... ") + place);
  CHECK_NOTHROW(exported(s, "out.csv"));
}

TEST_CASE("another ending is refused with the four that are known") {
  const Sample s = sample_to_export(false, 1);
  const std::string name = GENERATE("out", "out.laz", "out.h5", "las", "out.csv.gz");
  CHECK_THROWS_AS(exported(s, name), UsageError);
  check_refused([&] { return exported(s, name); },
                std::string(name) + " ... .las ... .ply ... .xyz ... .csv");
}

TEST_CASE("an existing output is kept unless asked otherwise") {
  const ScratchFolder folder;
  const Sample s = sample_to_export(false, 2);
  write_result(folder / "out.h5", s.header, s.rows);
  const ResultReader reader(folder / "out.h5");
  NoProgress progress;
  put_bytes(folder / "out.xyz", "mine");
  CHECK_THROWS_AS(export_result(reader, folder / "out.xyz", false, progress), UsageError);
  check_equal(bytes_of(folder / "out.xyz"), "mine");
  export_result(reader, folder / "out.xyz", true, progress);
  check_equal(table(bytes_of(folder / "out.xyz"), ' ').size(), 2);
}

TEST_CASE("a disk that fills up leaves nothing under the output's name") {
  const ScratchFolder folder;
  const Sample s = sample_to_export(true, kMany);
  write_result(folder / "out.h5", s.header, s.rows);
  const ResultReader reader(folder / "out.h5");
  const std::string name = GENERATE("out.las", "out.ply", "out.xyz", "out.csv");
  NoProgress progress;
  {
    const FileSizeLimit limit(1'000'000);
    CHECK_THROWS_AS(export_result(reader, folder / name, false, progress), ResourceError);
  }
  CHECK_FALSE(std::filesystem::exists(folder / name));
  CHECK_FALSE(std::filesystem::exists(folder / (name + ".partial")));
}

TEST_CASE("a result for which the disk has no room is not finished") {
  const LeaksOfHdf5 ignored;
  const ScratchFolder folder;
  const bool first_pose = GENERATE(false, true);
  const Sample s = sample_to_export(first_pose, GENERATE(1'000u, kMany, 3 * kMany));
  const auto path = folder / "out.h5";
  write_result(path, s.header, s.rows);
  const auto size = std::filesystem::file_size(path);
  for (const auto bytes : {size / 50, size / 2, size - 1}) {
    const FileSizeLimit limit(bytes);
    CHECK_THROWS_AS(write_result(path, s.header, s.rows), ResourceError);
  }
  write_result(path, s.header, s.rows);
  CHECK(std::filesystem::file_size(path) == size);
}
