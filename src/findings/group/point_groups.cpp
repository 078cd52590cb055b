#include "findings/group/point_groups.hpp"

namespace clearway {

PointGroups number_groups(const CellGrid& grid, UnionFind& sets, std::uint64_t min_points) {
  PointGroups out;
  // A root is the first cell of its set, so it gets its number before the set's other cells ask for
  // it.
  std::vector<std::uint32_t> points(grid.cells());  // at the index of a root, the points of its set
  for (std::uint32_t cell = 0; cell < grid.cells(); ++cell) {
    points[sets.find(cell)] += static_cast<std::uint32_t>(grid.points(cell).size());
  }
  out.of_cell.resize(grid.cells());
  for (std::uint32_t cell = 0; cell < grid.cells(); ++cell) {
    const std::uint32_t root = sets.find(cell);
    if (root != cell) {
      out.of_cell[cell] = out.of_cell[root];
    } else if (points[cell] >= min_points) {
      out.of_cell[cell] = out.count++;
    } else {
      out.of_cell[cell] = PointGroups::kSmall | static_cast<std::uint32_t>(out.small_groups++);
      out.small_points += points[cell];
    }
  }
  return out;
}

}  // namespace clearway
