#include "core/page/page_pool.hpp"

#include <catch2/catch.hpp>
#include <cstdint>

#include "planned_scene.hpp"

using namespace clearway;
using namespace clearway::test;

TEST_CASE("slots are disjoint, aligned and as large as they say") {
  const PlannedScene scene;
  for (const bool first_pose : {false, true}) {
    for (const double clearance : {0.0, 0.5}) {
      Query query = scene.query;
      query.first_pose = first_pose;
      query.clearance = clearance;
      const SlotLayout layout{3, 1001, 5};
      PagePool pool(scene.cloud, query, layout);
      std::uint64_t bytes = 0;
      const std::byte* last = nullptr;
      for (std::uint32_t slot = 0; slot < 3; ++slot) {
        const auto page = pool.page(slot);
        CHECK(page.size() >= 1001);
        CHECK(reinterpret_cast<std::uintptr_t>(page.data()) % kPageAlignment == 0);
        CHECK((last == nullptr || page.data() >= last));
        last = page.data() + page.size();
        CHECK(pool.hits(slot).size() == 5 * scene.cloud.blocks_per_cell());
        CHECK(pool.first_poses(slot).size() == (first_pose ? 5 * scene.cloud.cell_entries() : 0));
        CHECK(pool.clearances(slot).size() == (clearance > 0 ? 5 * scene.cloud.cell_entries() : 0));
        std::uint64_t found = 0;
        for (const std::uint64_t size :
             {pool.hits(slot).size_bytes(), pool.clearances(slot).size_bytes(),
              pool.first_poses(slot).size_bytes()}) {
          if (size > 0)
            found = divide_up(found, ArrayRun::kAlignment) * ArrayRun::kAlignment + size;
        }
        bytes += page.size() + found;
      }
      CHECK(bytes == 3 * PagePool::slot_bytes(scene.cloud, query, layout));
    }
  }
}
