// The store's order of points, against a plain rewriting of the rule.
#include <catch2/catch.hpp>

#include "support/clouds.hpp"
#include "support/store_order.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

std::vector<StoredPoint> plainly_ordered(const std::vector<Quantum>& points,
                                         std::uint32_t cell_points, const Quantisation& scale) {
  std::vector<StoredPoint> ordered(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) ordered[i] = {i, points[i]};
  order_plainly(ordered, cell_points, scale);
  return ordered;
}

void check_order(const std::vector<Quantum>& points, std::uint32_t cell_points,
                 const Quantisation& quantisation) {
  const ScratchFolder folder;
  write_las(folder / "a.las", points, quantisation);
  convert_quietly(conversion_of({folder / "a.las"}, folder / "a.h5", cell_points));
  const StoreReader store(folder / "a.h5");
  CHECK(store.quantisation() == quantisation);
  CHECK(stored_points(store) == plainly_ordered(points, cell_points, quantisation));
  CHECK(structure_faults(store).empty());
  CHECK(faults_of(store).empty());
  CHECK(store.cells().size() == (points.size() + cell_points - 1) / cell_points);
}

}  // namespace

TEST_CASE("points stand in the order of the rule") {
  const Quantisation unlike{{0.001, 0.01, 0.0025}, {5e6, -2e6, 0.5}};
  std::uint64_t seed = 1;
  for (const std::size_t count : {1u, 2u, 64u, 65u, 1000u, 5003u, 20011u}) {
    for (const auto& [name, points] : hard_clouds(count, seed++)) {
      CAPTURE(name, count);
      check_order(points, count % 2 == 0 ? 64 : 1000, count % 3 == 0 ? unlike : kMillimetres);
    }
  }
}

TEST_CASE("points stand in the order of the rule for every size of cell") {
  const auto points = hard_clouds(9000, 77)[6].points;
  for (const std::uint32_t cell_points : {64u, 65u, 100u, 1000u, 8999u, 9000u, 65536u, 1u << 20}) {
    CAPTURE(cell_points);
    check_order(points, cell_points, kMillimetres);
  }
}

TEST_CASE("a large bucket, ordered by several threads, stands in the order of the rule") {
  check_order(cube_cloud(150000, -2000, 2000, 9), 1000, kMillimetres);
}
