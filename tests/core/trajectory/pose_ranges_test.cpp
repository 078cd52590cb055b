#include "core/trajectory/pose_ranges.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <set>

#include "support/scenes.hpp"

using namespace clearway;

namespace {

std::vector<PoseRange> random_ranges(Random& random) {
  std::vector<PoseRange> out(random() % 6);
  for (PoseRange& range : out) {
    range.first = static_cast<std::uint32_t>(random() % 21);
    range.last = range.first + static_cast<std::uint32_t>(random() % 7);
  }
  return out;
}

std::set<std::uint32_t> poses_of(const std::vector<PoseRange>& ranges) {
  std::set<std::uint32_t> out;
  for (const PoseRange& range : ranges) {
    for (std::uint32_t pose = range.first; pose <= range.last; ++pose) out.insert(pose);
  }
  return out;
}

}  // namespace

TEST_CASE("stretches of poses are united and taken away as sets of poses are") {
  Random random(1);
  bool united_well = true, taken_well = true;
  for (int trial = 0; trial < 2000; ++trial) {
    const std::vector<PoseRange> a = random_ranges(random), b = random_ranges(random);
    const std::vector<PoseRange> one = united_ranges(a);
    const bool apart = std::ranges::adjacent_find(one, [](const auto& x, const auto& y) {
                         return y.first <= x.last;
                       }) == one.end();
    united_well &= apart && poses_of(one) == poses_of(a);
    std::set<std::uint32_t> rest = poses_of(a);
    for (const std::uint32_t pose : poses_of(b)) rest.erase(pose);
    taken_well &= poses_of(without(a, b)) == rest;
  }
  CHECK(united_well);
  CHECK(taken_well);
}
