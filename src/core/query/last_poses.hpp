#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>

#include "clearway/query.hpp"
#include "core/query/body_numbers.hpp"
#include "core/query/hit_set.hpp"

namespace clearway {

/// The question with the poses in reverse order, whose first poses tell the last poses of `query`.
/// It asks for nothing else.
Query backwards(const Query& query);

/// The greatest pose that touches each colliding point. Between poses it is the start of the last
/// way that touches it (docs/design/findings.md, "Last poses").
class LastPoses {
 public:
  /// answer: the hits of backwards(query).
  LastPoses(const Query& query, HitSet answer)
      : answer_(std::move(answer)),
        numbers_(query),
        last_(static_cast<std::uint32_t>(std::max<std::size_t>(query.poses.size(), 1) - 1)),
        ways_(query.between_poses && last_ > 0 ? 1 : 0) {}

  /// The last pose of an entry. first: the point's first pose.
  std::uint32_t at(std::uint64_t entry, std::uint32_t first) const {
    if (!answer_.contains(entry)) return first;
    const std::uint32_t before = numbers_.pose_of(answer_.first_pose(entry)) + ways_;
    return before > last_ ? first : std::max(first, last_ - before);
  }

 private:
  HitSet answer_;
  BodyNumbers numbers_;
  std::uint32_t last_;
  std::uint32_t ways_;  ///< 1 if a pose stands for the way from it to the next, otherwise 0
};

}  // namespace clearway
