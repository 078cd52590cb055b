#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <mutex>
#include <vector>

namespace clearway {

/// A fact that a search found for a pose: a point of the environment, and the least computed d2
/// between it and the model at that pose, square metres.
struct ProfileFact {
  double squared;
  std::uint32_t pose;
  std::uint32_t point;  ///< slot in the page, numbered as first poses are
  /// 1 if other points of the cell have the same d2, and source indices were not compared
  std::uint32_t tied;
};

/// Counters of a page that a device searches.
struct ProfileCounts {
  std::uint32_t facts;  ///< facts found, which may be more than the list holds
  std::uint32_t tasks;  ///< tasks taken
};

/// The point nearest to the model at a pose; of several, the one with the smallest source index.
struct ProfilePoint {
  double squared = std::numeric_limits<double>::infinity();
  std::uint64_t source = std::numeric_limits<std::uint64_t>::max();
  std::uint64_t entry = 0;  ///< entry of the point in a PackedCloud
  bool found() const { return squared < std::numeric_limits<double>::infinity(); }
  friend bool operator==(const ProfilePoint&, const ProfilePoint&) = default;
};

/// The nearest point of every pose, 24 bytes each; none if no point is below the distance asked
/// for. Offers are thread safe and may come in any order.
class ProfileSet {
 public:
  ProfileSet() = default;
  explicit ProfileSet(std::uint64_t poses)
      : points_(poses), mutex_(std::make_unique<std::mutex>()) {}

  std::uint64_t poses() const { return points_.size(); }

  void offer(std::uint32_t pose, const ProfilePoint& point) {
    const std::lock_guard lock(*mutex_);
    ProfilePoint& known = points_[pose];
    if (point.squared < known.squared ||
        (point.squared == known.squared && point.source < known.source)) {
      known = point;
    }
  }

  /// Whether this entry is the best one so far.
  bool holds(std::uint32_t pose, std::uint64_t entry) const {
    const std::lock_guard lock(*mutex_);
    return points_[pose].found() && points_[pose].entry == entry;
  }

  /// The nearest point of a pose. Must not be called while others offer.
  const ProfilePoint& at(std::uint64_t pose) const { return points_[pose]; }

  std::uint64_t count() const {
    std::uint64_t total = 0;
    for (const ProfilePoint& point : points_) total += point.found();
    return total;
  }

  std::uint64_t allocated_bytes() const { return points_.capacity() * sizeof(ProfilePoint); }

 private:
  std::vector<ProfilePoint> points_;
  std::unique_ptr<std::mutex> mutex_;
};

}  // namespace clearway
