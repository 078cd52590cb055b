// Budgets of device memory, and how much of it the CUDA grid engine takes. Runs on a device only.
#include "gpu/grid_engine.hpp"

#include "clearway/error.hpp"
#include "support/catch.hpp"
#include "support/engines/brute_force.hpp"
#include "support/engines/grid_runs.hpp"
#include "support/memory_cloud.hpp"
#include "support/scenes.hpp"

using namespace clearway;

namespace {

const Quantisation kMillimetre{{1e-3, 1e-3, 1e-3}, {0, 0, 0}};

struct Scene {
  Random random{5};
  std::vector<Quantum> points =
      quantise(random_points(random, {{-4, -3, -1}, {5, 4, 2}}, 20'000), kMillimetre);
  std::vector<Vec3> model = random_points(random, {{-0.6, -0.4, -0.3}, {0.7, 0.5, 0.2}}, 2000);
  std::vector<Pose> poses = smooth_path(random, {{-4, -3, -1}, {5, 4, 2}}, 200);
  MemoryCloud cloud{points, kMillimetre, {1000, 0}};

  /// The number of points that an engine with such a layout answers wrongly.
  std::uint64_t wrong(std::uint32_t cells_a_page, std::uint32_t slots) const {
    const Query query{model, poses, {.radius = 0.1}};
    const GridRun run{.cells_a_page = cells_a_page};
    const HitSet hits =
        run_grid(cloud, query, run,
                 [&](const GridScene& scene, std::uint64_t page_bytes, const auto& run_in) {
                   const SlotLayout layout{slots, page_bytes, run.cells_a_page};
                   CudaGridEngine engine(0, scene, layout);
                   CHECK(engine.slots() == slots);
                   CHECK(engine.device_bytes() ==
                         cuda_grid_bytes(scene) + slots * cuda_grid_slot_bytes(scene, layout));
                   HitSet found = run_in(engine);
                   CHECK(engine.statistics().searches > 0);
                   return found;
                 });
    const auto expected = brute_force_first_poses(positions_of(points, kMillimetre), query);
    std::uint64_t count = 0;
    for (std::uint64_t slot = 0; slot < cloud.entry_count(); ++slot) {
      if (!cloud.is_used(slot)) continue;
      count += hits.contains(slot) != (expected[cloud.source(slot)] != kNoPose);
    }
    return count;
  }
};

}  // namespace

TEST_CASE("several slots in flight") {
  const Scene scene;
  for (const std::uint32_t slots : {1, 3}) {
    CHECK(scene.wrong(4, slots) == 0);
    CHECK(scene.wrong(1, slots) == 0);
  }
}
