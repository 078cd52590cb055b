// Groups of colliding points, against all pairs.
#include "findings/conflict_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

std::int32_t within(Random& random, std::int32_t extent) {
  return static_cast<std::int32_t>(below(random, 2 * static_cast<std::uint64_t>(extent) + 1)) -
         extent;
}

/// Loose points, clumps of many, lines and repeated points, some of them far away.
Quanta random_quanta(Random& random, std::size_t count, std::int32_t extent) {
  Quanta out;
  while (out.size() < count) {
    const std::array<std::int32_t, 3> at{within(random, extent), within(random, extent),
                                         within(random, extent / 4)};
    const std::uint64_t kind = below(random, 5);
    const std::uint64_t more = kind == 0 ? 1 : below(random, 40);
    const std::int32_t spread = kind == 1 ? 0 : std::max(1, extent / 40);
    for (std::uint64_t i = 0; i < more && out.size() < count; ++i) {
      auto p = at;
      for (std::int32_t& q : p) q += within(random, spread);
      if (kind == 2) p = {at[0] + static_cast<std::int32_t>(i) * spread, at[1], at[2]};
      out.push_back(p);
    }
  }
  return out;
}

}  // namespace

TEST_CASE("random points are grouped as all pairs are") {
  Random random(1);
  std::size_t groups = 0, scenes = 0;
  for (const std::int32_t extent : {30, 400, 5000, 1'000'000}) {
    for (const double part : {0.002, 0.02, 0.1, 0.7}) {
      Found found;
      found.quanta = random_quanta(random, 300 + below(random, 500), extent);
      const double gap = std::max(1.0, part * extent) * 0.001 * uniform(random, 0.7, 1.3);
      groups += check_groups(found, gap, static_cast<int>(1 + below(random, 4)));
      ++scenes;
    }
  }
  CHECK(groups > 3 * scenes);  // not all points are in one group
}

TEST_CASE("axes of different scales are grouped as all pairs are") {
  Random random(2);
  std::size_t groups = 0;
  for (const double z_scale : {0.0001, 0.01, 0.5}) {
    for (const double gap : {0.004, 0.03, 0.25, 2.0}) {
      Found found;
      found.quantisation = {{0.001, 0.002, z_scale}, {500'000, 4'000'000, 100}};
      found.quanta = random_quanta(random, 500, 2000);
      groups += check_groups(found, gap);
    }
  }
  CHECK(groups > 100);
}

TEST_CASE("points exactly at the gap are neighbours, wherever the scan is") {
  for (const Vec3& offset : {Vec3{0, 0, 0}, Vec3{500'000, 4'000'000, 100}}) {
    for (const double gap : {0.3, 0.1, 1.0, 0.05}) {
      const auto steps = static_cast<std::int32_t>(std::lround(gap / 0.001));
      for (const std::int32_t more : {0, 1}) {
        Found found;
        found.quantisation = {{0.001, 0.001, 0.001}, {offset.x, offset.y, offset.z}};
        // A lattice whose neighbours are as far apart as the gap, or a step more.
        for (std::int32_t i = 0; i < 216; ++i) {
          const std::int32_t edge = steps + more;
          found.quanta.push_back({i % 6 * edge, i / 6 % 6 * edge, i / 36 * edge});
        }
        CHECK(check_groups(found, gap) == (more == 0 ? 1 : 216));
      }
      // Points 0.3 m apart, on the diagonal of 0.1, 0.2 and 0.2.
      Found slanted;
      slanted.quantisation = {{0.001, 0.001, 0.001}, {offset.x, offset.y, offset.z}};
      slanted.quanta = {{0, 0, 0}, {100, 200, 200}, {1000, 0, 0}, {1100, 200, 201}};
      CHECK(check_groups(slanted, 0.3) == 3);
    }
  }
}

TEST_CASE("a gap below the step joins only points at one place") {
  Found found;
  found.quanta = {{0, 0, 0}, {0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {1, 1, 0}, {7, 7, 7}};
  CHECK(check_groups(found, 0.0009) == 4);
  CHECK(check_groups(found, 0.001) == 2);
}

TEST_CASE("integers over their whole range are compared without overflow") {
  constexpr std::int32_t kMost = 2'147'483'647, kLeast = -kMost - 1;
  Found found;
  found.quantisation = {{1, 1, 1}, {0, 0, 0}};
  found.quanta = {{kLeast, kLeast, kLeast}, {kMost, kMost, kMost}, {0, 0, 0}, {kMost, 0, 0}};
  CHECK(check_groups(found, 1e9) == 4);
  CHECK(check_groups(found, 2'147'483'647) == 3);
  CHECK(check_groups(found, 3'719'550'786) == 2);  // sqrt(3) 2^31, rounded down
  CHECK(check_groups(found, 3'719'550'787) == 1);
  CHECK(check_groups(found, 7'439'101'574) == 1);
  CHECK(check_groups(found, 1e30) == 1);
  found.quantisation.scale[2] = 2;
  CHECK(check_groups(found, 1e9) == 4);
  CHECK(check_groups(found, 1e200) == 1);
}

TEST_CASE("dense places that are just too far apart stay apart") {
  // Two tilted plates of many points that are the gap, or a step more, apart.
  for (const std::int32_t more : {0, 1}) {
    Found found;
    for (std::int32_t i = 0; i < 1500; ++i) {
      const std::int32_t x = i % 50, y = i / 50, z = x / 3;
      found.quanta.push_back({x, y, z});
      found.quanta.push_back({x, y, z + 300 + more});
    }
    // The nearest pairs are not straight above each other; all_pairs() decides.
    check_groups(found, 0.3);
    CHECK(check_groups(found, 0.2) == 2);
  }
}

TEST_CASE("many points at few places are grouped fast") {
  Found found;
  for (std::int32_t i = 0; i < 200'000; ++i) found.quanta.push_back({i % 2 * 300, 0, i % 3 * 900});
  const ScratchFolder folder;
  ConflictOptions options;
  options.threads = 2;
  CHECK(find_conflicts(found.write(folder), found.poses, options).groups == 3);
  options.gap = 0.299;
  CHECK(find_conflicts(found.write(folder), found.poses, options).groups == 6);
}
