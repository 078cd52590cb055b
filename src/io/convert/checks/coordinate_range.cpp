#include "io/convert/checks/coordinate_range.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace clearway {
namespace {

bool comes_before(const InputPoint& a, const InputPoint& b) {
  return std::tie(a.file, a.point) < std::tie(b.file, b.point);
}

bool is_same(const InputPoint& a, const InputPoint& b) {
  return a.file == b.file && a.point == b.point;
}

}  // namespace

void CoordinateRange::add(const Vec3& p, std::size_t file, std::uint64_t point) {
  if ((count_++ & sample_mask_) == 0) {
    if (samples_.size() == kMostSamples) {
      for (std::size_t i = 0; 2 * i < samples_.size(); ++i) samples_[i] = samples_[2 * i];
      samples_.resize(samples_.size() / 2);
      sample_mask_ = 2 * sample_mask_ + 1;
    }
    samples_.push_back(p);
  }
  for (int axis = 0; axis < 3; ++axis) {
    const auto& least = extremes_[side(axis, false)];
    const auto& greatest = extremes_[side(axis, true)];
    if (least.size() < kKept || p[axis] < least.back().at[axis]) {
      keep(side(axis, false), axis, false, {p, file, point});
    }
    if (greatest.size() < kKept || p[axis] > greatest.back().at[axis]) {
      keep(side(axis, true), axis, true, {p, file, point});
    }
  }
}

void CoordinateRange::keep(std::size_t side, int axis, bool greatest, const InputPoint& p) {
  auto& kept = extremes_[side];
  if (kept.size() == kKept) kept.pop_back();
  const auto behind = [=](const InputPoint& a, const InputPoint& b) {
    return greatest ? a.at[axis] > b.at[axis] : a.at[axis] < b.at[axis];
  };
  kept.insert(std::upper_bound(kept.begin(), kept.end(), p, behind), p);
}

double CoordinateRange::median(int axis) const {
  std::vector<double> values;
  for (const Vec3& p : samples_) values.push_back(p[axis]);
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

CoordinateRange::Far CoordinateRange::far_points(double reach) const {
  Far far;
  if (empty()) return far;
  for (int axis = 0; axis < 3; ++axis) {
    const double middle = median(axis);
    for (const bool greatest : {false, true}) {
      const auto& kept = extremes_[side(axis, greatest)];
      const auto is_far = [&](const InputPoint& p) {
        return std::abs(p.at[axis] - middle) > reach;
      };
      std::copy_if(kept.begin(), kept.end(), std::back_inserter(far.points), is_far);
      far.more = far.more || std::all_of(kept.begin(), kept.end(), is_far);
    }
  }
  std::sort(far.points.begin(), far.points.end(), comes_before);
  far.points.erase(std::unique(far.points.begin(), far.points.end(), is_same), far.points.end());
  for (int axis = 0; axis < 3 && !far.more; ++axis) {
    for (const bool greatest : {false, true}) {
      const auto& kept = extremes_[side(axis, greatest)];
      const auto rest = std::find_if(kept.begin(), kept.end(), [&](const InputPoint& p) {
        return !std::binary_search(far.points.begin(), far.points.end(), p, comes_before);
      });
      far.more = far.more || rest == kept.end();
      if (rest != kept.end()) (greatest ? far.hi : far.lo)[axis] = rest->at[axis];
    }
  }
  return far;
}

}  // namespace clearway
