// Results as LAS, PLY, XYZ and CSV.
#include "io/result/export/export_result.hpp"

#include <cmath>
#include <sstream>

#include "clearway/error.hpp"
#include "io/result/sample_result.hpp"
#include "io/scans/requantize.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/file_size_limit.hpp"
#include "support/leaks_of_hdf5.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

constexpr std::size_t kMany = 65'600;  // more than a batch

struct ExportedResult : SampleResult {
  ExportedResult(bool first_pose, std::size_t count, bool depth = false)
      : SampleResult(sample_header(first_pose), count) {
    if (depth) add_sample_depths(header, rows);
  }

  /// The bytes of the exported file.
  std::string exported(const std::string& name, bool overwrite = false) const {
    write();
    NoProgress progress;
    export_result(ResultReader(path()), path(name), overwrite, progress);
    CHECK_FALSE(std::filesystem::exists(path(name + ".partial")));
    return bytes_of(path(name));
  }
  /// The words of each line of the exported file.
  std::vector<std::vector<std::string>> table(const std::string& name, char separator) const {
    std::vector<std::vector<std::string>> out;
    std::istringstream lines(exported(name));
    for (std::string line; std::getline(lines, line);) {
      auto& words = out.emplace_back();
      std::istringstream cells(line + separator);
      for (std::string word; std::getline(cells, word, separator);) words.push_back(word);
    }
    return out;
  }

  /// Whether texts read back as the stored integers of a point.
  bool is_position(std::size_t row, const std::string* xyz) const {
    const Quantisation& quantisation = header.quantisation;
    bool same = true;
    for (int k = 0; k < 3; ++k) {
      const double steps = (std::stod(xyz[k]) - quantisation.offset[k]) / quantisation.scale[k];
      same = same && quantum_at(quantisation, k, rows.xyz[row][k]).value() == std::nearbyint(steps);
    }
    return same;
  }
  bool is_depth(std::size_t row, double depth) const {
    return depth == rows.depth[row] || (std::isnan(depth) && std::isnan(rows.depth[row]));
  }
};

}  // namespace

TEST_CASE("CSV holds every column in full, and nothing where no point is free") {
  const bool first_pose = GENERATE(false, true), depth = GENERATE(false, true);
  const ExportedResult s(first_pose, GENERATE(0u, 3u, kMany), depth);
  const auto rows = s.table("out.csv", ',');
  REQUIRE(rows.size() == s.rows.size() + 1);
  std::vector<std::string> header{"source", "x", "y", "z"};
  if (first_pose) header.push_back("first_pose");
  if (depth) header.insert(header.end(), {"depth", "depth_source"});
  check_equal(rows[0], header);
  for (std::size_t i = 0; i < s.rows.size(); ++i) {
    const auto& row = rows[i + 1];
    REQUIRE(row.size() == header.size());
    REQUIRE(std::stoull(row[0]) == s.rows.source[i]);
    REQUIRE(s.is_position(i, &row[1]));
    if (first_pose) REQUIRE(std::stoul(row[4]) == s.rows.first_pose[i]);
    if (!depth) continue;
    const std::size_t at = row.size() - 2;
    REQUIRE(row[at].empty() == std::isnan(s.rows.depth[i]));
    REQUIRE(row[at].empty() == row[at + 1].empty());
    if (row[at].empty()) continue;
    REQUIRE(std::stod(row[at]) == s.rows.depth[i]);
    REQUIRE(std::stoull(row[at + 1]) == s.rows.depth_source[i]);
  }
}

TEST_CASE("XYZ holds the coordinates in full, and nothing else") {
  const ExportedResult s(GENERATE(false, true), GENERATE(0u, kMany));
  const auto rows = s.table("out.xyz", ' ');
  REQUIRE(rows.size() == s.rows.size());
  for (std::size_t i = 0; i < s.rows.size(); ++i) {
    REQUIRE(rows[i].size() == 3);
    REQUIRE(s.is_position(i, rows[i].data()));
  }
}

TEST_CASE("PLY holds doubles, first poses and depths") {
  const bool first_pose = GENERATE(false, true), depth = GENERATE(false, true);
  const ExportedResult s(first_pose, GENERATE(0u, kMany), depth);
  const std::string bytes = s.exported("out.PLY");
  const std::size_t header = bytes.find("end_header\n") + 11;
  check_says(bytes.substr(0, header),
             "ply\nformat binary_little_endian 1.0\nelement vertex " +
                 std::to_string(s.rows.size()) +
                 "\nproperty double x\nproperty double y\nproperty double z\n" +
                 (first_pose ? "property uint first_pose\n" : "") +
                 (depth ? "property double depth\n ... depth_source\n" : "") + "end_header\n");
  if (s.rows.size() == 0) return;
  const std::size_t row_bytes = (bytes.size() - header) / s.rows.size();
  REQUIRE(row_bytes == 24u + (first_pose ? 4 : 0) + (depth ? 16 : 0));
  for (std::size_t i = 0; i < s.rows.size(); ++i) {
    const std::size_t at = header + row_bytes * i;
    REQUIRE(value_at<Vec3>(bytes, at) == s.rows.xyz[i]);
    if (first_pose) REQUIRE(value_at<std::uint32_t>(bytes, at + 24) == s.rows.first_pose[i]);
    if (depth) REQUIRE(s.is_depth(i, value_at<double>(bytes, at + row_bytes - 16)));
  }
}

TEST_CASE("LAS holds the source's integers, scale, offset, CRS, first poses and depths") {
  const bool first_pose = GENERATE(false, true), depth = GENERATE(false, true);
  ExportedResult s(first_pose, GENERATE(0u, kMany), depth);
  const std::string crs = GENERATE("", "PROJCS[\"somewhere\"]");
  s.header.crs_wkt = crs;
  const std::string bytes = s.exported("out.las");
  REQUIRE(bytes.substr(0, 4) == "LASF");
  const bool version_14 = value_at<std::uint8_t>(bytes, 25) == 4;
  CHECK(version_14 == (first_pose || depth || !crs.empty()));
  const auto points_at = value_at<std::uint32_t>(bytes, 96);
  const auto row_bytes = value_at<std::uint16_t>(bytes, 105);
  CHECK((version_14 ? value_at<std::uint64_t>(bytes, 247) : value_at<std::uint32_t>(bytes, 107)) ==
        s.rows.size());
  REQUIRE(bytes.size() == points_at + row_bytes * s.rows.size());
  CHECK((bytes.find(crs) < points_at));
  CHECK((bytes.find("first_pose") < points_at) == first_pose);
  CHECK((bytes.find("depth_source") < points_at) == depth);

  const auto read = value_at<Quantisation>(bytes, 131);
  CHECK(read == s.header.quantisation);
  Vec3 lo = s.rows.size() == 0 ? Vec3{} : s.rows.xyz[0], hi = lo;
  for (std::size_t i = 0; i < s.rows.size(); ++i) {
    const std::size_t at = points_at + row_bytes * i, end = at + row_bytes;
    const auto q = value_at<std::array<std::int32_t, 3>>(bytes, at);
    REQUIRE(position(read, q[0], q[1], q[2]) == s.rows.xyz[i]);
    if (first_pose) {
      REQUIRE(value_at<std::uint32_t>(bytes, end - (depth ? 20 : 4)) == s.rows.first_pose[i]);
    }
    if (depth) {
      REQUIRE(s.is_depth(i, value_at<double>(bytes, end - 16)));
      REQUIRE(value_at<std::uint64_t>(bytes, end - 8) == s.rows.depth_source[i]);
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

TEST_CASE(
    "what cannot be exported is refused, and an existing output stays unless asked otherwise") {
  ExportedResult s(false, 5);
  put_bytes(s.path("out.xyz"), "mine");
  CHECK_THROWS_AS(s.exported("out.xyz"), UsageError);
  check_equal(bytes_of(s.path("out.xyz")), "mine");
  check_lacks(s.exported("out.xyz", true), "mine");
  for (const std::string name : {"out", "out.laz", "out.h5", "las", "out.csv.gz"}) {
    check_refused<UsageError>([&] { s.exported(name); },
                              name + " ... .las ... .ply ... .xyz ... .csv");
  }
  s.rows.xyz[3].y += 0.00005;  // no multiple of the scale
  check_refused<InputError>([&] { s.exported("out.las"); },
                            "out.h5 ... source " + std::to_string(s.rows.source[3]));
  CHECK_NOTHROW(s.exported("out.csv"));
}

TEST_CASE("a disk that fills up leaves nothing under the output's name") {
  const ExportedResult s(true, kMany);
  s.write();
  const ResultReader reader(s.path());
  const std::string name = GENERATE("out.las", "out.ply", "out.xyz", "out.csv");
  NoProgress progress;
  {
    const FileSizeLimit limit(1'000'000);
    CHECK_THROWS_AS(export_result(reader, s.path(name), false, progress), ResourceError);
  }
  CHECK_FALSE(std::filesystem::exists(s.path(name)));
  CHECK_FALSE(std::filesystem::exists(s.path(name + ".partial")));
}

TEST_CASE("a result for which the disk has no room is not finished") {
  const LeaksOfHdf5 ignored;
  const SampleResult s(sample_header(GENERATE(false, true)), GENERATE(1'000u, kMany, 3 * kMany));
  s.write();
  const auto size = std::filesystem::file_size(s.path());
  for (const auto bytes : {size / 50, size / 2, size - 1}) {
    const FileSizeLimit limit(bytes);
    CHECK_THROWS_AS(s.write(), ResourceError);
  }
  s.write();
  CHECK(std::filesystem::file_size(s.path()) == size);
}
