// The nearest free points of colliding points against all pairs, in clouds in memory.
#include "cpu/nearest_free.hpp"

#include <bit>
#include <cmath>
#include <limits>
#include <vector>

#include "clearway/error.hpp"
#include "support/catch.hpp"
#include "support/memory_cloud.hpp"
#include "support/scenes.hpp"

using namespace clearway;

namespace {

/// A cloud of which random points collide, collide without a floor, or are ignored. On its coarse
/// lattices many distances are equal and many points are at the same place.
struct FreeScene {
  explicit FreeScene(std::uint64_t seed) : random(seed) {
    const auto sizes = {1, 2, 63, 64, 65, 300, 900};
    const std::uint64_t count = *(sizes.begin() + static_cast<int>(below(random, sizes.size())));
    const std::int32_t steps[] = {1, 4, 30, 100'000};
    const std::int32_t side = steps[below(random, 4)];
    for (std::uint64_t i = 0; i < count; ++i) {
      Quantum q;
      for (std::int32_t& value : q) {
        value = static_cast<std::int32_t>(below(random, static_cast<std::uint64_t>(side)));
      }
      points.push_back(q);
      classes.push_back(static_cast<std::uint8_t>(below(random, 3)));
    }
    if (below(random, 3) == 0) quantisation.offset[0] = 5e5 + 0.1;
    if (below(random, 3) == 0) query.ignore_classes = {1};
    has_floor = below(random, 3) == 0;
    // Rows in a ball collide, so that most free points are beyond others that are not free.
    const Vec3 middle = place(below(random, count));
    const double reach = uniform(random, 0, 1.5) * side * quantisation.scale[0];
    for (std::uint64_t i = 0; i < count; ++i) {
      const bool inside = std::sqrt(squared_distance(place(i), middle)) <= reach;
      const bool searched = query.ignore_classes.empty() || classes[i] != 1;
      collides.push_back(searched && inside && below(random, 4) != 0);
      below_floor.push_back(has_floor && searched && !collides[i] && below(random, 4) == 0);
    }
  }

  Vec3 place(std::uint64_t i) const {
    return position(quantisation, points[i][0], points[i][1], points[i][2]);
  }

  Depth by_hand(std::uint64_t of) const {
    double least = std::numeric_limits<double>::infinity();
    Depth depth;
    for (std::uint64_t i = 0; i < points.size(); ++i) {
      const bool ignored = !query.ignore_classes.empty() && classes[i] == 1;
      if (collides[i] || below_floor[i] || ignored) continue;
      const double squared = squared_distance(place(i), place(of));
      if (!(squared < least)) continue;
      least = squared;
      depth = {std::sqrt(squared), i};
    }
    return depth;
  }

  Random random;
  std::vector<Quantum> points;
  std::vector<std::uint8_t> classes;
  std::vector<bool> collides, below_floor;
  bool has_floor = false;
  Quantisation quantisation{{0.01, 0.01, 0.01}, {0, 0, 0}};
  QueryParameters query;
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
    HitSet hits(cloud.entry_count(), false);
    std::vector<std::uint64_t> taken(cloud.entry_count() / kBlockPoints);
    for (std::uint64_t entry = 0; entry < cloud.entry_count(); ++entry) {
      if (!cloud.is_used(entry)) continue;
      const bool collides = scene.collides[cloud.source(entry)];
      if (collides) hits.mark(entry);
      if (collides || (scene.has_floor && scene.below_floor[cloud.source(entry)])) {
        taken[entry / kBlockPoints] |= std::uint64_t{1} << entry % kBlockPoints;
      }
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
    std::vector<Depth> depths(cloud.entry_count());
    std::array<Depth, kBlockPoints> found;
    for (std::uint64_t word = 0; word < cloud.entry_count() / kBlockPoints; ++word) {
      if (hits.word(word) == 0) continue;
      nearest.search(static_cast<std::uint32_t>(word / cloud.blocks_per_cell()),
                     static_cast<std::uint32_t>(word % cloud.blocks_per_cell()), hits.word(word),
                     found);
      for (std::uint32_t i = 0; i < kBlockPoints; ++i) {
        const std::uint64_t entry = word * kBlockPoints + i;
        if (hits.contains(entry)) depths[entry] = found[i];
      }
    }
    for (std::uint64_t entry = 0; entry < cloud.entry_count(); ++entry) {
      if (!hits.contains(entry)) continue;
      const Depth expected = scene.by_hand(cloud.source(entry));
      const Depth& depth = depths[entry];
      ++compared;
      without += expected.source == Depth::kNoPoint;
      if (depth.source == expected.source &&
          (depth.distance == expected.distance || std::isnan(expected.distance))) {
        continue;
      }
      CAPTURE(cloud.source(entry), depth.distance, expected.distance);
      REQUIRE(depth.source == expected.source);
      REQUIRE(depth.distance == expected.distance);
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
  const QueryParameters query;
  free.add_cell(0, taken, IgnoredPoints(cloud, query));
  free.finish();
  cloud.damage(0);
  std::array<Depth, kBlockPoints> found;
  CHECK_THROWS_AS(NearestFree(tree, free).search(0, 0, 1, found), InputError);
}
