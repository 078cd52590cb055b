// Seen space of a real scan, against the answers of an independent program.
#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>
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

/// FNV-1a with 64 bits over numbers of eight bytes.
class Fnv {
 public:
  void add(std::int64_t number) {
    for (unsigned byte = 0; byte < 8; ++byte) {
      hash_ = (hash_ ^ (static_cast<std::uint64_t>(number) >> 8 * byte & 0xFF)) * 1099511628211U;
    }
  }
  std::uint64_t hash() const { return hash_; }

 private:
  std::uint64_t hash_ = 1469598103934665603U;
};

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
  std::uint64_t next = 0;  // of the rows of origins, which may be for no record that is left
  std::string last;
  const auto end_row = [&](std::uint64_t end) {
    if (!last.empty() && next < (end + 3) / 4) rows += std::to_string(next) + last + "\n";
  };
  while (std::getline(origins, line)) {
    const std::size_t comma = line.find(',');
    const std::uint64_t first = std::stoull(line.substr(0, comma));
    end_row(first);
    next = (first + 3) / 4;
    last = line.substr(comma);
  }
  end_row(records);
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
  struct Group {
    std::int64_t size = 0, first_pose = 0;
    std::array<std::int32_t, 3> least{};
  };
  std::vector<Group> groups(seen.groups);
  Fnv of_cubes, of_groups;
  for (std::size_t i = 0; i < cubes.size(); ++i) {
    for (const std::int32_t index : cubes.cube[i]) of_cubes.add(index);
    Group& group = groups.at(cubes.group[i] - 1);
    const std::int64_t pose = cubes.first_pose[i];
    group.first_pose = group.size == 0 ? pose : std::min(group.first_pose, pose);
    if (group.size++ == 0) group.least = cubes.cube[i];
  }
  check_equal(of_cubes.hash(), 0x996a07796a9f6230U);
  for (const Group& group : groups) {
    of_groups.add(group.size);
    of_groups.add(group.first_pose);
    for (const std::int32_t index : group.least) of_groups.add(index);
  }
  check_equal(of_groups.hash(), 0x5bcaa6be3b3ec5f9U);
}
