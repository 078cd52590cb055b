#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "clearway/answer.hpp"
#include "core/geometry/quantisation.hpp"
#include "core/util/progress.hpp"
#include "findings/group/point_groups.hpp"
#include "findings/point_blocks.hpp"
#include "io/result/result.hpp"

namespace clearway {

/// Collects points that are certainly too close and finds out whether ten of them hang together,
/// each at most the gap from the next. Points may come in any order, and no order changes what is
/// found. Once a group has ten, no more points are kept. Runs in the caller's arena of oneTBB.
class CertainGroup {
 public:
  /// gap: in the unit of the scale. quantisation outlives this object.
  CertainGroup(const Quantisation& quantisation, double gap, Progress& progress);

  void add(const QuantumPoint& point);
  /// What the points say so far. Throws Interrupted.
  CertainPoints found();

 private:
  bool any_group();

  const Quantisation& quantisation_;
  double gap_;
  Progress& progress_;
  std::vector<QuantumPoint> points_;
  std::size_t looked_at_ = 0;  ///< number of points when groups were last looked for
  CertainPoints found_;
};

/// Whether each of these points, which are certainly too close, is one of ten or more that hang
/// together, each at most `gap` from the next. limit, only: as group_points() takes them. Runs in
/// the caller's arena of oneTBB. Throws Interrupted.
std::vector<bool> in_certain_groups(std::span<const QuantumPoint> points,
                                    const Quantisation& quantisation, double gap,
                                    Progress& progress, const GroupingLimit& limit,
                                    const std::vector<bool>* only);

/// What the points of all these results together say, each of which has an error budget of the same
/// query. Throws InputError as RowStream does, and Interrupted.
CertainPoints certain_points_in(std::span<const ResultReader> results, Progress& progress);

}  // namespace clearway
