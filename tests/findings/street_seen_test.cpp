// Seen space of a real scan, against the answers of an independent program.
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "clearway/clearway.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/store_fixture.hpp"
#include "support/test_data.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

std::filesystem::path street_file(const std::string& name) {
  return data_folder() / "street" / name;
}

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

/// The street's scan with the records whose index is a multiple of `stride`, at most `most` of
/// them, and their origins.
class ThinnedStreet {
 public:
  ThinnedStreet(std::uint64_t stride, std::uint64_t most, const std::string& origins) {
    std::ifstream in(street_file("street.las"), std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(in), {}};
    const auto begin = number<std::uint32_t>(bytes, 96);
    const auto record = number<std::uint16_t>(bytes, 105);
    records_ = number<std::uint32_t>(bytes, 107);
    const std::uint64_t kept = std::min(most, (records_ + stride - 1) / stride);
    std::string out = bytes.substr(0, begin);
    for (const std::size_t place : {107U, 111U}) {
      const auto count = static_cast<std::uint32_t>(kept);
      std::memcpy(out.data() + place, &count, sizeof count);
    }
    for (std::uint64_t i = 0; i < kept; ++i)
      out += bytes.substr(begin + i * stride * record, record);
    put_bytes(folder / "scan.las", out);
    put_bytes(folder / "origins.csv", origins.empty() ? origins_every(stride) : origins);
    ConvertOptions how;
    how.threads = 2;
    how.origins = folder / "origins.csv";
    convert({folder / "scan.las"}, folder / "scan.h5", how);
  }

  Result seen() const {
    Model model{read_model_points(street_file("beetle.ply"))};
    std::erase_if(model.vertices, [](const Vec3& m) { return m.z < 0.3; });
    QueryParameters parameters{.radius = 0.1, .between_poses = true};
    parameters.seen = true;
    parameters.seen_cube = 0.1;
    const Query query(std::move(model), read_trajectory(street_file("trajectory.txt")), parameters);
    search(Store(folder / "scan.h5"), query, folder / "out.h5",
           {.device = Device::kCpu, .threads = 2, .overwrite = true});
    return Result(folder / "out.h5");
  }

 private:
  template <typename T>
  static T number(const std::string& bytes, std::size_t at) {
    T out{};
    std::memcpy(&out, bytes.data() + at, sizeof out);
    return out;
  }

  /// The rows of the street's file of origins, by the numbers of the records that are left.
  std::string origins_every(std::uint64_t stride) const {
    std::ifstream in(street_file("origins.csv"));
    std::string line, out = "first,x,y,z\n";
    std::getline(in, line);
    std::vector<std::pair<std::uint64_t, std::string>> rows;
    while (std::getline(in, line)) {
      const std::size_t comma = line.find(',');
      rows.emplace_back(std::stoull(line.substr(0, comma)), line.substr(comma));
    }
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const std::uint64_t end = i + 1 < rows.size() ? rows[i + 1].first : records_;
      const auto first = (rows[i].first + stride - 1) / stride;
      if (first < (end + stride - 1) / stride) out += std::to_string(first) + rows[i].second + "\n";
    }
    return out;
  }

  std::uint64_t records_ = 0;
  ScratchFolder folder;
};

}  // namespace

TEST_CASE("the cubes that a car sweeps in the street are those of an independent program") {
  // One point, whose scanner stands where the point is: nothing is seen, so all that is swept is
  // unseen.
  std::ifstream in(street_file("street.las"), std::ios::binary);
  std::string bytes(400, 0);
  in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  std::uint32_t begin = 0;
  double scale[3], offset[3];
  std::int32_t q[3];
  std::memcpy(&begin, bytes.data() + 96, sizeof begin);
  std::memcpy(scale, bytes.data() + 131, sizeof scale);
  std::memcpy(offset, bytes.data() + 155, sizeof offset);
  REQUIRE(begin + sizeof q <= bytes.size());
  std::memcpy(q, bytes.data() + begin, sizeof q);
  std::ostringstream origin;
  origin.precision(17);
  origin << "first,x,y,z\n0";
  for (int k = 0; k < 3; ++k) origin << "," << q[k] * scale[k] + offset[k];
  const ThinnedStreet one(1, 1, origin.str() + "\n");
  const UnseenCubes cubes = one.seen().unseen();
  check_equal(cubes.size(), 151'369);
  Fnv fnv;
  for (std::size_t i = 0; i < cubes.size(); ++i) {
    for (const std::int32_t index : cubes.cube[i]) fnv.add(index);
    fnv.add(cubes.first_pose[i]);
  }
  check_equal(fnv.hash(), 0x8c24e48ecaca8481U);
}

TEST_CASE("with a quarter of the street's beams the unseen cubes are those of another program") {
  const ThinnedStreet quarter(4, ~std::uint64_t{0}, "");
  const Result result = quarter.seen();
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

TEST_CASE("all of the street's beams see all that the car sweeps") {
  const ThinnedStreet whole(1, ~std::uint64_t{0}, "");
  const Result result = whole.seen();
  check_equal(result.answer().seen->swept, 151'369);
  check_equal(result.unseen().size(), 0);
}
