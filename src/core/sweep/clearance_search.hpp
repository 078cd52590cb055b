#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/query/search_result.hpp"
#include "core/sweep/sweep_filter.hpp"

namespace clearway {

/// Finds the exact clearances of environment points, one after another. Neighbouring points should
/// follow each other, because the answer for one is tried first for the next.
template <typename Element>
class ClearanceSearchOf {
 public:
  /// filter: its query asks for clearances; it must outlive this object.
  explicit ClearanceSearchOf(const SweepFilterOf<Element>& filter);

  /// The clearance of e over the poses of `nodes`; without a pose if no d2 is below the squared
  /// clearance asked for. Its `squared` is below 0 if e is inside a solid.
  Clearance nearest(const Vec3& e, std::span<const std::uint32_t> nodes,
                    SweepStatistics& statistics);

 private:
  const SweepRefOf<Element>& sweep_;
  const double limit_;  ///< square of the clearance asked for
  std::uint32_t guess_pose_ = 0;
  bool guess_is_inside_ = false;
  Element guess_;  ///< element of the last answer that was not inside
};

extern template class ClearanceSearchOf<Vec3>;
extern template class ClearanceSearchOf<Triangle>;
extern template class ClearanceSearchOf<SolidTriangle>;

}  // namespace clearway
