#include "findings/certain_points.hpp"

#include <algorithm>
#include <string>

#include "core/query/error_budget.hpp"
#include "findings/group/cell_grid.hpp"
#include "findings/group/point_groups.hpp"
#include "io/files/input_error.hpp"
#include "io/scans/requantize.hpp"

namespace clearway {
namespace {

/// Groups are first looked for among this many points, and then whenever there are twice as many. A
/// real obstacle shows at once, so that a scan that is hit everywhere is not held in memory.
constexpr std::size_t kFirstLook = std::size_t{1} << 16;

}  // namespace

CertainGroup::CertainGroup(const Quantisation& quantisation, double gap, Progress& progress)
    : quantisation_(quantisation), gap_(gap), progress_(progress) {}

void CertainGroup::add(const std::array<std::int32_t, 3>& point) {
  ++found_.points;
  if (found_.has_group) return;
  points_.push_back(point);
  if (points_.size() >= std::max(kFirstLook, 2 * looked_at_)) found_.has_group = any_group();
}

CertainPoints CertainGroup::found() {
  if (!found_.has_group && points_.size() > looked_at_) found_.has_group = any_group();
  return found_;
}

bool CertainGroup::any_group() {
  looked_at_ = points_.size();
  if (points_.size() < kLeastCertainGroup) return false;
  std::vector<QuantumPoint> quanta;
  quanta.reserve(points_.size());
  for (const auto& p : points_) quanta.push_back({{p[0], p[1], p[2]}});
  const Neighbourhood neighbourhood(quantisation_, gap_);
  CellGrid grid(quanta, neighbourhood, [](std::uint64_t) {});
  UnionFind sets(grid.cells());
  join_cells(grid, neighbourhood, sets, progress_);
  const bool any = number_groups(grid, sets, kLeastCertainGroup).count > 0;
  if (any) points_ = {};
  return any;
}

std::vector<std::uint32_t> members_of_certain_groups(std::span<const QuantumPoint> points,
                                                     const Quantisation& quantisation, double gap,
                                                     Progress& progress) {
  std::vector<std::uint32_t> out;
  if (points.size() < kLeastCertainGroup) return out;
  const Neighbourhood neighbourhood(quantisation, gap);
  CellGrid grid(points, neighbourhood, [](std::uint64_t) {});
  UnionFind sets(grid.cells());
  join_cells(grid, neighbourhood, sets, progress);
  const PointGroups groups = number_groups(grid, sets, kLeastCertainGroup);
  for (std::uint32_t cell = 0; cell < grid.cells(); ++cell) {
    if (PointGroups::is_small(groups.of_cell[cell])) continue;
    for (const GroupedPoint& point : grid.points(cell)) out.push_back(point.row);
  }
  return out;
}

CertainPoints certain_points_in(std::span<const ResultReader> results, Progress& progress) {
  const ResultHeader& header = results.front().header();
  CertainGroup group(header.quantisation, header.gap, progress);
  for (const ResultReader& result : results) {
    RowStream<Collisions> stream(result);
    for (Collisions rows; stream.read(rows);) {
      for (std::size_t i = 0; i < rows.size(); ++i) {
        if (rows.certain[i] == 0) continue;
        std::array<std::int32_t, 3> point{};
        for (int k = 0; k < 3; ++k) {
          const auto q = quantum_at(header.quantisation, k, rows.xyz[i][k]);
          if (!q) {
            refuse(result.name(), "/collisions/xyz, source " + std::to_string(rows.source[i]) +
                                      ": expected a whole multiple of the scale above the offset");
          }
          point[static_cast<std::size_t>(k)] = *q;
        }
        group.add(point);
      }
    }
  }
  return group.found();
}

}  // namespace clearway
