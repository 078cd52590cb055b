#pragma once

#include <cstdint>

#include "core/query/search_result.hpp"
#include "core/sweep/sweep_page.hpp"
#include "core/util/device_bits.hpp"
#include "core/util/shared_double.hpp"

namespace clearway {

/// Least values known of every pose so far, shared by all who search on the host or on one device.
/// A value that is out of date is larger, which only costs time.
struct ProfileBests {
  double limit;     ///< square of the distance asked for
  double* of_pose;  ///< least d2 found for each pose, initially `limit`
  double* of_node;  ///< for each motion node, a distance beyond which nothing matters to its poses
};

/// Where the points found go, for a page under search on a device. Points that find no room are
/// counted.
struct ProfileList {
  ProfileFact* facts;
  ProfileCounts* counts;
  std::uint32_t capacity;
};

/// Policy for ties on a device, where no source index is at hand: takes any of several points with
/// the same d2, and marks the fact as tied.
class UnresolvedTies {
 public:
  CLEARWAY_HD explicit UnresolvedTies(const ProfileList& list) : list_(list) {}

  CLEARWAY_HD void enter_cell(std::uint32_t, const PageCell&) {}
  CLEARWAY_HD void restart() { points_ = 0; }

  /// Adds points with the least d2 found so far: point `first` + i of the page for each bit i.
  CLEARWAY_HD void add(std::uint32_t first, std::uint32_t bits) {
    if (points_ == 0) point_ = first + lowest_bit(bits);
    points_ += count_of(bits);
  }

  /// Lists the point found for a pose. To be called by one lane.
  CLEARWAY_HD void keep([[maybe_unused]] std::uint32_t pose,
                        [[maybe_unused]] double squared) const {
#ifdef __CUDA_ARCH__
    const std::uint32_t at = atomicAdd(&list_.counts->facts, 1U);
#else
    const std::uint32_t at = list_.counts->facts++;
#endif
    if (at < list_.capacity) list_.facts[at] = {squared, pose, point_, points_ > 1 ? 1U : 0U};
  }

 private:
  ProfileList list_;
  std::uint32_t point_ = 0, points_ = 0;
};

}  // namespace clearway
