#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/query/clearance_set.hpp"
#include "core/sweep/sweep_filter.hpp"

namespace clearway {

/// The exact clearance of one environment point after the other. Points that are neighbours should
/// follow each other: the answer for one is tried first for the next.
template <typename Element>
class ClearanceSearchOf {
 public:
  /// The filter, whose query asks for clearances, outlives it.
  explicit ClearanceSearchOf(const SweepFilterOf<Element>& filter);

  /// Over the poses of `nodes`; not found where there is no d2 below the squared clearance asked
  /// for. Inside solids below 0.
  Clearance nearest(const Vec3& e, std::span<const std::uint32_t> nodes,
                    SweepStatistics& statistics);

 private:
  const SweepRefOf<Element>& sweep_;
  const double limit_;  ///< the square of the clearance asked for
  std::uint32_t guess_pose_ = 0;
  bool guess_is_inside_ = false;
  Element guess_;  ///< of the model, of the last answer that was not inside
};

extern template class ClearanceSearchOf<Vec3>;
extern template class ClearanceSearchOf<Triangle>;
extern template class ClearanceSearchOf<SolidTriangle>;

}  // namespace clearway
