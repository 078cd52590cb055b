#pragma once

#include <cstdint>

#include "core/query/profile_set.hpp"
#include "core/sweep/sweep_page.hpp"
#include "core/util/device_bits.hpp"
#include "core/util/shared_double.hpp"

namespace clearway {

/// What is known of every pose so far, where all who search share it: on the host, or on one
/// device. A value that is out of date is larger, which only costs time.
struct ProfileBests {
  double limit;     ///< the square of the distance asked for
  double* of_pose;  ///< least d2 found, at first `limit`
  double* of_node;  ///< a distance beyond which nothing matters to any pose of a motion node
};

/// Of a page under search on a device: where found points go. What finds no room is counted.
struct ProfileList {
  ProfileFact* facts;
  ProfileCounts* counts;
  std::uint32_t capacity;
};

/// Of several points with the same d2 takes any, and says so: no source is at hand.
class UnresolvedTies {
 public:
  CLEARWAY_HD explicit UnresolvedTies(const ProfileList& list) : list_(list) {}

  CLEARWAY_HD void enter_cell(std::uint32_t, const PageCell&) {}
  CLEARWAY_HD void restart() { points_ = 0; }

  /// Points `first` + i of a page, for each bit i, that have the least d2 found so far.
  CLEARWAY_HD void add(std::uint32_t first, std::uint32_t bits) {
    if (points_ == 0) point_ = first + lowest_bit(bits);
    points_ += count_of(bits);
  }

  /// By one lane.
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
