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

bool SampleSet::gather(const Box& box, std::vector<Vec3>& near) const {
  near.clear();
  const auto may_reach = [&](const Vec3& p) {
    return p.x >= box.lo.x - reach_ && p.x <= box.hi.x + reach_ && p.y >= box.lo.y - reach_ &&
           p.y <= box.hi.y + reach_ && p.z >= box.lo.z - reach_ && p.z <= box.hi.z + reach_;
  };
  std::uint32_t looks = 0;
  const Cell lo = cell_of(box.lo), hi = cell_of(box.hi);
  for (std::int64_t x = lo.x - 1; x <= hi.x + 1; ++x) {
    for (std::int64_t y = lo.y - 1; y <= hi.y + 1; ++y) {
      for (std::int64_t z = lo.z - 1; z <= hi.z + 1; ++z) {
        for (std::uint32_t i = heads_[slot_of({x, y, z})]; i != kNone; i = next_[i]) {
          if (++looks == kMostLooks) return false;
          if (may_reach(points_[i])) near.push_back(points_[i]);
        }
      }
    }
  }
  return true;
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
