#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <mutex>
#include <vector>

#include "clearway/query.hpp"
#include "core/cloud/packed_cloud.hpp"
#include "core/query/body_numbers.hpp"

namespace clearway {

/// The distance that belongs to a squared distance; both are below 0 inside solids
/// (docs/design/model.md).
inline double signed_root(double squared) {
  return squared < 0 ? -std::sqrt(-squared) : std::sqrt(squared);
}

/// In the place of a pose's number: none.
inline constexpr std::uint32_t kNoPose = std::numeric_limits<std::uint32_t>::max();

/// The least computed d2 between an environment point and the model over all poses, square metres,
/// and the lowest pose that has it. The distance is its root. For a point inside solids it is below
/// 0: minus the square of the greatest depth.
struct Clearance {
  double squared = std::numeric_limits<double>::infinity();
  std::uint32_t pose = std::numeric_limits<std::uint32_t>::max();
  bool found() const { return squared < std::numeric_limits<double>::infinity(); }
  friend bool operator==(const Clearance&, const Clearance&) = default;
};

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
/// for. Offers are thread safe and may come in any order. Source indices are read only where two
/// points have the same distance, and of the points that are handed out.
class ProfileSet {
 public:
  ProfileSet() = default;
  /// The cloud must outlive the set.
  ProfileSet(const PackedCloud& cloud, std::uint64_t poses)
      : cloud_(&cloud), points_(poses), mutex_(std::make_unique<std::mutex>()) {}

  std::uint64_t poses() const { return points_.size(); }

  void offer(std::uint32_t pose, double squared, std::uint64_t entry);

  /// Whether this entry is the best one so far.
  bool holds(std::uint32_t pose, std::uint64_t entry) const {
    const std::lock_guard lock(*mutex_);
    return points_[pose].found() && points_[pose].entry == entry;
  }

  /// The nearest point of a pose. Must not be called while others offer.
  ProfilePoint at(std::uint64_t pose) const {
    ProfilePoint point = points_[pose];
    if (point.found()) point.source = source_of(point);
    return point;
  }

  std::uint64_t count() const {
    std::uint64_t total = 0;
    for (const ProfilePoint& point : points_) total += point.found();
    return total;
  }

 private:
  std::uint64_t source_of(const ProfilePoint& point) const;

  const PackedCloud* cloud_ = nullptr;
  std::vector<ProfilePoint> points_;  ///< with their sources as far as these are known
  std::unique_ptr<std::mutex> mutex_;
};

/// The query with its poses in reverse order, whose first poses give the last poses of `query`. It
/// asks for nothing else.
Query backwards(const Query& query);

/// The greatest index of a pose that touches a colliding point. Between poses it is the start of
/// the last way that touches it (docs/design/findings.md, "Last poses").
class LastPoses {
 public:
  explicit LastPoses(const Query& query)
      : numbers_(query),
        last_(static_cast<std::uint32_t>(std::max<std::size_t>(query.poses.size(), 1) - 1)),
        ways_(query.between_poses && last_ > 0 ? 1 : 0) {}

  /// The last pose of a point. first: its first pose; backward: its number in the answer of
  /// backwards(query).
  std::uint32_t of(std::uint32_t first, std::uint32_t backward) const {
    const std::uint32_t before = numbers_.pose_of(backward) + ways_;
    return before > last_ ? first : std::max(first, last_ - before);
  }

 private:
  BodyNumbers numbers_;
  std::uint32_t last_;
  std::uint32_t ways_;  ///< 1 if a pose stands for the way from it to the next, otherwise 0
};

/// The free point that is nearest to a colliding one (docs/design/pipeline.md).
struct Depth {
  static constexpr std::uint64_t kNoPoint = ~std::uint64_t{0};
  double distance = std::numeric_limits<double>::quiet_NaN();  ///< metres; NaN if none is free
  std::uint64_t source = kNoPoint;  ///< of several the smallest; kNoPoint if none is free
};

}  // namespace clearway
