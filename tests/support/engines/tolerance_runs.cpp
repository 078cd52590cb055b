#include "support/engines/tolerance_runs.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "support/catch.hpp"
#include "support/engines/brute_force.hpp"
#include "support/engines/engines.hpp"

namespace clearway {
namespace {

/// Whether each point is a hit, by its index in the cloud's input.
std::vector<bool> by_source(const MemoryCloud& cloud, const HitSet& hits) {
  std::vector<bool> out(cloud.point_count());
  for (std::uint64_t slot = 0; slot < cloud.entry_count(); ++slot) {
    if (cloud.is_used(slot)) out[cloud.source(slot)] = hits.contains(slot);
  }
  return out;
}

/// The largest |d - radius| of the wrong answers, rounded up, and 0 without any; computed with more
/// digits than the engines use.
double farthest_difference(const std::vector<bool>& answer, const std::vector<bool>& expected,
                           const std::vector<Clearance>& least, double radius) {
  long double farthest = 0;
  for (std::size_t i = 0; i < answer.size(); ++i) {
    if (answer[i] == expected[i]) continue;
    const long double d = std::sqrt(static_cast<long double>(least[i].squared));
    farthest = std::max(farthest, std::abs(d - radius));
  }
  const auto rounded = static_cast<double>(farthest);
  return rounded < farthest ? std::nextafter(rounded, HUGE_VAL) : rounded;
}

}  // namespace

ToleratedResults check_tolerance(std::span<const Quantum> points, const Quantisation& quantisation,
                                 const Query& query, double tolerance) {
  const std::vector<Clearance> least =
      brute_force_clearances(positions_of(points, quantisation), query);
  ToleratedResults out;
  std::vector<bool> expected;
  for (const Clearance& c : least) {
    expected.push_back(c.squared < query.radius * query.radius);
    out.colliding += expected.back();
  }
  for (const Engine& engine : engines()) {
    if (engine.run_within == nullptr) continue;
    std::vector<bool> first;
    int threads = 1;
    for (const MemoryCloudOptions& packing :
         {MemoryCloudOptions{64, 0}, MemoryCloudOptions{1000, 0}, MemoryCloudOptions{128, 300}}) {
      const MemoryCloud cloud(points, quantisation, packing);
      const std::vector<bool> answer =
          by_source(cloud, engine.run_within(cloud, query, threads++, tolerance).hits);
      const double farthest = farthest_difference(answer, expected, least, query.radius);
      CAPTURE(engine.name, packing.cell_points, query.radius, tolerance);
      CHECK(farthest <= tolerance);
      if (first.empty()) first = answer;
      CHECK((answer == first));
    }
    for (std::size_t i = 0; i < first.size(); ++i) out.differing += first[i] != expected[i];
  }
  return out;
}

}  // namespace clearway
