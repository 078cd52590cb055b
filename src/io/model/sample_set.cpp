#include "io/model/sample_set.hpp"

#include <cmath>

namespace clearway {

SampleSet::Cell SampleSet::cell_of(const Vec3& point) const {
  return {static_cast<std::int64_t>(std::floor(point.x / reach_)),
          static_cast<std::int64_t>(std::floor(point.y / reach_)),
          static_cast<std::int64_t>(std::floor(point.z / reach_))};
}

void SampleSet::add(const Vec3& point) {
  if (points_.size() == heads_.size()) grow();
  std::uint32_t& head = heads_[slot_of(cell_of(point))];
  next_.push_back(head);
  head = static_cast<std::uint32_t>(points_.size());
  points_.push_back(point);
}

void SampleSet::grow() {
  heads_.assign(2 * heads_.size(), kNone);
  for (std::uint32_t i = 0; i < points_.size(); ++i) {
    std::uint32_t& head = heads_[slot_of(cell_of(points_[i]))];
    next_[i] = head;
    head = i;
  }
}

}  // namespace clearway
