#include <map>
#include <optional>
#include <vector>

#include "core/seen/beams.hpp"
#include "support/beam_scenes.hpp"
#include "support/catch.hpp"
#include "support/engines/page_runs.hpp"
#include "support/memory_cloud.hpp"
#include "support/section_scene.hpp"

using namespace clearway;

namespace {

/// A cloud of the points of beams, each with the number of its origin.
struct BeamCloud {
  BeamCloud(BeamScene& scene, double most_length)
      : quantisation{{0.01, 0.02, 0.005}, {0, 0, 0}}, most(most_length) {
    std::vector<Quantum> points;
    std::vector<std::uint32_t> origin_of;
    for (int i = 0; i < 40; ++i) {
      const Beam beam = scene.beam();
      const std::int64_t kind = scene.pick(0, 19);
      if (i == 0 || i % 8 != 0) {  // several beams have one origin
        for (int k = 0; k < 3; ++k) origins.push_back(beam.origin[k]);
        if (kind == 0) origins[origins.size() - 1] = std::int64_t{3000000000};
      }
      const std::int64_t* const origin = origins.data() + origins.size() - 3;
      Quantum q{};
      for (std::size_t k = 0; k < 3; ++k) {
        q[k] = static_cast<std::int32_t>(kind == 1 ? origin[k] : beam.origin[k] + beam.way[k]);
      }
      points.push_back(q);
      origin_of.push_back(kind == 2 ? 0 : static_cast<std::uint32_t>(origins.size() / 3));
      expect(q, kind == 2 ? nullptr : origin);
    }
    cloud.emplace(points, quantisation, MemoryCloudOptions{.cell_points = 11});
    for (std::uint32_t cell = 0; cell < cloud->cells().size(); ++cell) {
      std::vector<std::uint32_t> numbers(cloud->cell_points(), 1);
      for (std::uint32_t i = 0; i < cloud->cells()[cell].count; ++i) {
        numbers[i] = origin_of[cloud->source_of(cell, i)];
      }
      append_packed_chunk<std::uint32_t>(numbers, chunks.emplace_back());
    }
  }

  Beams beams(const BrickMap& map) const {
    Beams out{.ref = {.map = map.ref(),
                      .origins = origins.data(),
                      .origin_count = static_cast<std::uint32_t>(origins.size() / 3),
                      .quantisation = quantisation,
                      .most_squared = most * most},
              .map = map,
              .origins_of = [this](std::uint32_t cell) {
                return PackedChunk<std::uint32_t>(chunks[cell], cloud->cell_points());
              }};
    for (std::uint32_t cell = 0; cell < chunks.size(); ++cell) {
      out.origin_minbits = std::max(out.origin_minbits, out.origins_of(cell).minbits());
    }
    return out;
  }

  Quantisation quantisation;
  double most;
  std::vector<std::int64_t> origins;
  std::vector<Beam> followed;  ///< the beams that may see something
  BeamCounts left_out;
  std::optional<MemoryCloud> cloud;
  std::vector<std::vector<std::byte>> chunks;

 private:
  void expect(const Quantum& q, const std::int64_t* origin) {
    Beam beam{};
    double squared = 0;
    bool is_short = true, is_point = true;
    for (int k = 0; k < 3 && origin != nullptr; ++k) {
      beam.origin[k] = origin[k];
      beam.way[k] = q[static_cast<std::size_t>(k)] - origin[k];
      is_short = is_short && std::abs(beam.way[k]) < (1LL << 30);
      is_point = is_point && beam.way[k] == 0;
      const double length = static_cast<double>(beam.way[k]) * quantisation.scale[k];
      squared += length * length;
    }
    const bool is_too_long = !is_short || squared > most * most;
    left_out.without_origin += origin == nullptr;
    left_out.too_long += is_too_long;
    if (!is_too_long && !is_point) followed.push_back(beam);
  }
};

}  // namespace

TEST_CASE("what the beams of pages see in random scenes is what the definition says") {
  std::uint64_t seen = 0, unseen = 0, without_origin = 0, too_long = 0;
  for (unsigned seed = 0; seed < 1000; ++seed) {
    INFO("scene " << seed);
    BeamScene scene(seed);
    if (scene.bricks.empty()) continue;
    const BrickMap map(scene.lattice, scene.bricks, scene.words);
    const BeamCloud points(scene, seed % 3 == 0 ? 50000 : 1e9);
    const BeamRun found = follow_pages(*points.cloud, points.beams(map));
    check_words(scene, points.followed, found.words, seen, unseen);
    REQUIRE(found.left_out.without_origin == points.left_out.without_origin);
    REQUIRE(found.left_out.too_long == points.left_out.too_long);
    without_origin += found.left_out.without_origin;
    too_long += found.left_out.too_long;
  }
  CHECK(seen > 10000);
  CHECK(unseen > 100000);
  CHECK(without_origin > 1000);
  CHECK(too_long > 1000);
}

// The bodies of the section's kernel against every pair of a point and a pose: on the host, and in
// the suite of the CUDA engines on a device.

TEST_CASE("pages block in random scenes what every pair of a point and a pose blocks") {
  Random random(20261124);
  std::size_t blocked = 0, empty = 0, ignoring = 0;
  for (int i = 0; i < 400; ++i) {
    INFO("scene " << i);
    const SectionScene scene = random_section_scene(random);
    double along = 0;
    if (below(random, 3) == 0) along = section_motion(scene.load(), scene.asked).along;
    SectionOfScene search(scene, along);
    block_pages(search.cloud, IgnoredPoints(search.cloud, search.query), search.section);
    const Blocked expected = by_brute_force(scene, along);
    CHECK((search.blocked() == expected));
    blocked += expected.size();
    empty += expected.empty() ? 1 : 0;
    ignoring += scene.ignored.empty() ? 0 : 1;
  }
  CHECK(blocked > 50000);
  CHECK(empty > 5);
  CHECK(ignoring > 50);
}
