#include "findings/certain_points.hpp"

#include <algorithm>

#include "core/query/error_budget.hpp"
#include "findings/group/point_groups.hpp"
#include "findings/row_pieces.hpp"

namespace clearway {
namespace {

/// Groups are first looked for among this many points, and then whenever there are twice as many. A
/// real obstacle shows at once, so that a scan that is hit everywhere is not held in memory.
constexpr std::size_t kFirstLook = std::size_t{1} << 16;

}  // namespace

CertainGroup::CertainGroup(const Quantisation& quantisation, double gap, Progress& progress)
    : quantisation_(quantisation), gap_(gap), progress_(progress) {}

void CertainGroup::add(const QuantumPoint& point) {
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
  const PointGroups groups =
      group_points(points_, Neighbourhood(quantisation_, gap_), kLeastCertainGroup, progress_);
  const bool any = groups.count > 0;
  if (any) points_ = {};
  return any;
}

std::vector<bool> in_certain_groups(std::span<const QuantumPoint> points,
                                    const Quantisation& quantisation, double gap,
                                    Progress& progress, const GroupingLimit& limit,
                                    const std::vector<bool>* only) {
  const PointGroups groups = group_points(points, Neighbourhood(quantisation, gap),
                                          kLeastCertainGroup, progress, limit, only);
  std::vector<bool> out;
  for (const std::uint32_t group : groups.of_point) out.push_back(!PointGroups::is_small(group));
  return out;
}

CertainPoints certain_points_in(std::span<const ResultReader> results, Progress& progress) {
  const ResultHeader& header = results.front().header();
  CertainGroup group(header.quantisation, header.gap, progress);
  for (const ResultReader& result : results) {
    RowStream<Collisions> stream(result);
    for (Collisions rows; stream.read(rows);) {
      std::vector<QuantumPoint> quanta(rows.size());
      requantize(result, rows, quanta);
      for (std::size_t i = 0; i < rows.size(); ++i) {
        if (rows.certain[i] != 0) group.add(quanta[i]);
      }
    }
  }
  return group.found();
}

}  // namespace clearway
