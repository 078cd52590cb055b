// What is found in a real street, against definitions and against an independent program.
#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>
#include <string>
#include <utility>

#include "clearway/clearway.hpp"
#include "findings/conflict_fixture.hpp"
#include "findings/station_oracle.hpp"
#include "io/scans/requantize.hpp"
#include "support/compare.hpp"
#include "support/store_fixture.hpp"
#include "support/test_data.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

std::filesystem::path street(const std::string& name) { return data_folder() / "street" / name; }

std::vector<Pose> street_path() { return read_trajectory(street("trajectory.txt")); }

/// The car's points above a height.
Model beetle(double above) {
  Model model{read_model_points(street("beetle.ply"))};
  std::erase_if(model.vertices, [&](const Vec3& m) { return m.z < above; });
  return model;
}

/// The colliding points, at the radius, in a part of the street.
Found crop(const Store& store, double radius, const ScratchFolder& folder, const Box& part) {
  const Query query(read_model_points(street("beetle.ply")), street_path(),
                    {.radius = radius, .first_pose = true});
  search(store, query, folder / "out.h5", {.threads = 2, .overwrite = true});
  const Result result(folder / "out.h5");
  Found out;
  out.quantisation = result.reader().header().quantisation;
  for (const Vec3& p : result.xyz()) {
    if (p.x < part.lo.x || p.x > part.hi.x || p.y < part.lo.y || p.y > part.hi.y) continue;
    auto& q = out.quanta.emplace_back();
    for (int k = 0; k < 3; ++k) {
      q[static_cast<std::size_t>(k)] = quantum_at(out.quantisation, k, p[k]).value();
    }
  }
  return out;
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

TEST_CASE("groups of the street are those of all pairs") {
  const ScratchFolder folder;
  convert({street("street.las")}, folder / "street.h5", {.threads = 2});
  const Store store(folder / "street.h5");
  for (const auto& [radius, part] : {std::pair(0.1, Box{{20, 0, 0}, {22.5, 30, 0}}),
                                     std::pair(0.5, Box{{20, 0, 0}, {21, 30, 0}})}) {
    Found found = crop(store, radius, folder, part);
    REQUIRE(found.quanta.size() > 2000);
    REQUIRE(found.quanta.size() < 9000);
    for (const Vec3& offset : {Vec3{0, 0, 0}, Vec3{500'000, 4'000'000, 100}}) {
      for (int k = 0; k < 3; ++k) found.quantisation.offset[k] = offset[k];
      for (const double gap : {0.1, 0.3, 1.0}) check_groups(found, gap);
    }
  }
}

TEST_CASE("the station table of the street is that of its clearances and contacts") {
  const ScratchFolder folder;
  convert({street("street.las")}, folder / "street.h5", {.threads = 2});
  // The lower part stands on the ground, so that nothing would be clear.
  const Query query(beetle(-1), street_path(),
                    {.radius = 0.1, .first_pose = true, .clearance = 0.5});
  search(Store(folder / "street.h5"), query, folder / "out.h5", {.threads = 2});
  const Result result(folder / "out.h5");
  const auto first = result.first_pose(), last = result.last_pose();
  REQUIRE(first.size() > 100);
  for (const double every : {0.5, 5.0, 50.0}) {
    CAPTURE(every);
    const StationTable table = station_table(result, query.poses, {.every = every});
    check_distances(table, expected_rows(result, query, every), query.radius);
    const std::vector<std::size_t> row_of = rows_of(query.poses, every);
    std::vector<bool> at_ends(table.rows.size()), between(table.rows.size());
    for (std::size_t i = 0; i < first.size(); ++i) {
      at_ends[row_of[first[i]]] = at_ends[row_of[last[i]]] = true;
      for (std::size_t row = row_of[first[i]]; row <= row_of[last[i]]; ++row) between[row] = true;
    }
    for (std::size_t row = 0; row < table.rows.size(); ++row) {
      const Verdict verdict = table.rows[row].verdict;
      if (at_ends[row]) CHECK(verdict == Verdict::kConflict);
      if (!between[row]) CHECK(verdict != Verdict::kConflict);
    }
  }
}

TEST_CASE("with a quarter of the street's beams the unseen cubes are those of another program") {
  const ScratchFolder folder;
  convert_a_quarter(folder.folder());
  QueryParameters parameters{.radius = 0.1, .between_poses = true};
  parameters.seen = true;
  parameters.seen_cube = 0.1;
  search(Store(folder / "scan.h5"), Query(beetle(0.3), street_path(), parameters),
         folder / "out.h5", {.device = Device::kCpu, .threads = 2});
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
