// The nearest free points of colliding points against all pairs, in clouds in memory.
#include "cpu/nearest_free.hpp"

#include "clearway/error.hpp"
#include "core/util/lane_bits.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/memory_cloud.hpp"
#include "support/scenes.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

enum class PointState { kFree, kColliding, kBelowFloor, kIgnored };

/// A cloud of which random points collide, collide without a floor, or are ignored. On its coarse
/// lattices many distances are equal and many points are at the same place.
struct FreeScene {
  explicit FreeScene(std::uint64_t seed) {
    Random random(seed);
    constexpr std::size_t kCounts[] = {1, 2, 63, 64, 65, 300, 900};
    constexpr std::int32_t kSides[] = {1, 4, 30, 100'000};
    const std::size_t count = kCounts[below(random, 7)];
    const std::int32_t side = kSides[below(random, 4)];
    for (std::size_t i = 0; i < count; ++i) {
      Quantum& q = points.emplace_back();
      for (auto& value : q) {
        value = static_cast<std::int32_t>(below(random, static_cast<std::uint64_t>(side)));
      }
      classes.push_back(static_cast<std::uint8_t>(below(random, 3)));
    }
    if (below(random, 3) == 0) quantisation.offset[0] = 5e5 + 0.1;
    if (below(random, 3) == 0) query.ignore_classes = {1};
    const bool has_floor = below(random, 3) == 0;
    places = positions_of(points, quantisation);
    // Points in a ball collide, so that most free points are beyond others that are not free.
    const Vec3 middle = places[below(random, count)];
    const double reach = uniform(random, 0, 1.5) * side * quantisation.scale[0];
    for (std::size_t i = 0; i < count; ++i) {
      const bool is_ignored = !query.ignore_classes.empty() && classes[i] == 1;
      const bool is_inside = std::sqrt(squared_distance(places[i], middle)) <= reach;
      states.push_back(is_ignored                           ? PointState::kIgnored
                       : is_inside && below(random, 4) != 0 ? PointState::kColliding
                       : has_floor && below(random, 4) == 0 ? PointState::kBelowFloor
                                                            : PointState::kFree);
    }
  }

  /// The nearest free point of a point; of several, the first.
  Depth nearest_free(std::uint64_t of) const {
    double least = std::numeric_limits<double>::infinity();
    Depth depth;
    for (std::uint64_t i = 0; i < places.size(); ++i) {
      const double squared = squared_distance(places[i], places[of]);
      if (states[i] != PointState::kFree || !(squared < least)) continue;
      least = squared;
      depth = {std::sqrt(squared), i};
    }
    return depth;
  }

  std::vector<Quantum> points;
  std::vector<std::uint8_t> classes;
  Quantisation quantisation{{0.01, 0.01, 0.01}, {0, 0, 0}};
  QueryParameters query;
  std::vector<Vec3> places;
  std::vector<PointState> states;
};

}  // namespace

TEST_CASE("the nearest free points are those of all pairs") {
  std::uint64_t compared = 0, without = 0;
  for (std::uint64_t seed = 1; seed <= 280; ++seed) {
    CAPTURE(seed);
    const FreeScene scene(seed);
    const MemoryCloud cloud(
        scene.points, scene.classes, scene.quantisation,
        {.cell_points = seed % 2 == 0 ? 64U : 256U, .bucket_points = seed % 3 == 0 ? 128U : 0U});
    std::vector<std::uint64_t> hits(cloud.entry_count() / kBlockPoints), taken(hits);
    for (std::uint64_t entry = 0; entry < cloud.entry_count(); ++entry) {
      if (!cloud.is_used(entry)) continue;
      const PointState state = scene.states[cloud.source(entry)];
      const std::uint64_t bit = std::uint64_t{1} << entry % kBlockPoints;
      const bool is_hit = state == PointState::kColliding;
      if (is_hit) hits[entry / kBlockPoints] |= bit;
      if (is_hit || state == PointState::kBelowFloor) taken[entry / kBlockPoints] |= bit;
    }
    const EnvironmentTree tree(cloud);
    const IgnoredPoints ignored(cloud, scene.query);
    const auto taken_of = [&](std::uint32_t cell) {
      return std::span(taken).subspan(cell * cloud.blocks_per_cell(), cloud.blocks_per_cell());
    };
    std::vector<std::uint32_t> cells;
    for (std::uint32_t cell = 0; cell < cloud.cells().size(); ++cell) {
      const auto of_cell = taken_of(cell);
      const bool all_free = std::ranges::count(of_cell, 0) == std::ssize(of_cell) &&
                            !(ignored.any() && ignored.touches(cell));
      if (!all_free || seed % 5 == 0) cells.push_back(cell);
    }
    FreePoints free(tree, cells);
    for (const std::uint32_t cell : cells) free.add_cell(cell, taken_of(cell), ignored);
    free.finish();
    NearestFree nearest(tree, free);
    std::array<Depth, kBlockPoints> found;
    for (std::uint32_t word = 0; word < hits.size(); ++word) {
      if (hits[word] == 0) continue;
      nearest.search(word / cloud.blocks_per_cell(), word % cloud.blocks_per_cell(), hits[word],
                     found);
      for_each_bit(hits[word], [&](std::uint32_t i) {
        const std::uint64_t source = cloud.source(std::uint64_t{word} * kBlockPoints + i);
        const Depth expected = scene.nearest_free(source);
        ++compared;
        const bool is_none = expected.source == Depth::kNoPoint;
        without += is_none;
        CAPTURE(source);
        REQUIRE(found[i].source == expected.source);
        REQUIRE((is_none || found[i].distance == expected.distance));
      });
    }
  }
  CHECK(compared > 10'000);
  CHECK(without > 10);
}

TEST_CASE("a damaged cell is reported while the nearest free points are searched") {
  const std::vector<Quantum> points{{0, 0, 0}, {1, 0, 0}};
  MemoryCloud cloud(points, {{0.01, 0.01, 0.01}, {0, 0, 0}});
  const std::vector<std::uint64_t> taken{1};
  const EnvironmentTree tree(cloud);
  FreePoints free(tree, std::vector<std::uint32_t>{0});
  free.add_cell(0, taken, IgnoredPoints(cloud, {}));
  free.finish();
  cloud.damage(0);
  std::array<Depth, kBlockPoints> found;
  CHECK_THROWS_AS(NearestFree(tree, free).search(0, 0, 1, found), InputError);
}
