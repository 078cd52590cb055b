// Seen space of a real scan, against the answers of an independent program.
#include <cstring>
#include <fstream>
#include <map>
#include <string>
#include <utility>

#include "clearway/clearway.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/store_fixture.hpp"
#include "support/test_data.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

std::filesystem::path street(const std::string& name) { return data_folder() / "street" / name; }

/// A fourth of the street's beams: the records of its scan whose index is a multiple of 4, with
/// their origins.
void convert_a_quarter(const std::filesystem::path& folder) {
  std::ifstream in(street("street.las"), std::ios::binary), origins(street("origins.csv"));
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  const auto number = [&](std::size_t at) {
    std::uint32_t out = 0;
    std::memcpy(&out, bytes.data() + at, sizeof out);
    return out;
  };
  const std::uint32_t begin = number(96), record = number(105) & 0xFFFF, records = number(107);
  const std::uint32_t kept = (records + 3) / 4;
  std::string out = bytes.substr(0, begin), line, rows = "first,x,y,z\n";
  for (const std::size_t place : {107U, 111U}) std::memcpy(out.data() + place, &kept, sizeof kept);
  for (std::size_t i = 0; i < kept; ++i) out += bytes.substr(begin + i * 4 * record, record);
  std::getline(origins, line);
  std::map<std::uint64_t, std::string> row_of;  // of the records that are left, the last that holds
  while (std::getline(origins, line)) {
    const std::size_t comma = line.find(',');
    row_of[(std::stoull(line.substr(0, comma)) + 3) / 4] = line.substr(comma);
  }
  for (const auto& [first, row] : row_of) {
    if (first < kept) rows += std::to_string(first) + row + "\n";
  }
  put_bytes(folder / "scan.las", out);
  put_bytes(folder / "origins.csv", rows);
  convert({folder / "scan.las"}, folder / "scan.h5",
          {.threads = 2, .origins = folder / "origins.csv"});
}

}  // namespace

TEST_CASE("with a quarter of the street's beams the unseen cubes are those of another program") {
  const ScratchFolder folder;
  convert_a_quarter(folder.folder());
  Model car{read_model_points(street("beetle.ply"))};
  std::erase_if(car.vertices, [](const Vec3& m) { return m.z < 0.3; });
  QueryParameters parameters{.radius = 0.1, .between_poses = true};
  parameters.seen = true;
  parameters.seen_cube = 0.1;
  const Query query(std::move(car), read_trajectory(street("trajectory.txt")), parameters);
  search(Store(folder / "scan.h5"), query, folder / "out.h5",
         {.device = Device::kCpu, .threads = 2});
  const Result result(folder / "out.h5");
  const UnseenCubes cubes = result.unseen();
  const SeenSummary seen = *result.answer().seen;
  check_equal(seen.swept, 151'369);
  check_equal(cubes.size(), 269);
  check_equal(seen.groups, 185);
  check_equal(seen.listed_groups, 0);
  check_equal(seen.not_scanned_length, 0);
  // Their sums are those of the cubes whose hash another program confirmed.
  std::vector<double> sums(4);
  for (std::size_t i = 0; i < cubes.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) sums[k] += cubes.cube[i][k];
    sums[3] += 1.0 * cubes.first_pose[i] * cubes.group[i];
  }
  check_equal(sums, {62625, 11381, -3831, 2177370});
}
