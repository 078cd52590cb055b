#include "support/engines/check_profile.hpp"

#include <limits>

#include "core/geometry/predicate.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/engines/engines.hpp"

namespace clearway {
using namespace test;
namespace {

/// Checks the nearest point of every pose that one engine finds. Returns how many poses have a
/// point.
std::uint64_t check_profile(const Engine& engine, const MemoryCloud& cloud,
                            const std::vector<NearestPoint>& expected, const Query& query) {
  static int runs = 0;
  const int threads = ++runs % 5 == 0 ? 3 : 1;
  const SearchResult answer = engine.run(cloud, query, threads);
  CAPTURE(engine.name, threads, query.profile, query.clearance, query.radius, query.first_pose,
          cloud.cell_points());
  REQUIRE(answer.profile.poses() == (query.model.empty() ? 0 : expected.size()));
  std::uint64_t wrong = 0, found = 0;
  for (std::size_t pose = 0; pose < answer.profile.poses(); ++pose) {
    const ProfilePoint point = answer.profile.at(pose);
    wrong += point.squared != expected[pose].squared || point.source != expected[pose].source;
    if (!point.found()) continue;
    ++found;
    wrong += !cloud.is_used(point.entry) || cloud.source(point.entry) != point.source;
  }
  check_equal(wrong, 0);
  CHECK(answer.profile.count() == found);
  return found;
}

}  // namespace

std::vector<NearestPoint> nearest_points(const std::vector<Vec3>& positions, Query query) {
  query.profile = 1e200;  // its square is infinite
  return brute_force_profile(positions, query);
}

std::uint64_t check_profile(const MemoryCloud& cloud, std::vector<NearestPoint> nearest,
                            const Query& query) {
  const double limit = rounded_product(query.profile, query.profile);
  for (NearestPoint& point : nearest) {
    if (!(point.squared < limit)) {
      point = {std::numeric_limits<double>::infinity(), ~std::uint64_t{0}};
    }
  }
  std::uint64_t found = 0;
  for (const Engine& engine : engines()) {
    if (engine.finds_all) found = check_profile(engine, cloud, nearest, query);
  }
  return found;
}

Query with_profile(Query query, std::size_t variant) {
  constexpr double kOfRadius[] = {0.3, 1, 1.7, 6, 40};
  query.profile = kOfRadius[variant % 5] * query.radius;
  query.clearance = variant % 3 == 0 ? 0.8 * query.radius : 0;
  query.first_pose = variant % 2 == 0;
  return query;
}

std::uint64_t check_profile(std::span<const Quantum> points, const Quantisation& quantisation,
                            const Query& query) {
  const auto nearest = brute_force_profile(positions_of(points, quantisation), query);
  std::uint64_t found = 0;
  for (const std::uint32_t cell_points : {64U, 256U, 65536U}) {
    found = check_profile(MemoryCloud(points, quantisation, {cell_points, 0}), nearest, query);
  }
  return found;
}

}  // namespace clearway
