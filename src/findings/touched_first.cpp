#include "findings/touched_first.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "core/geometry/axes.hpp"

namespace clearway {
namespace {

/// A place in the frame of a pose. Solved by Cramer's rule, because rotations from text are not
/// quite orthonormal.
Vec3 in_model_frame(const Vec3& place, const Pose& pose) {
  const double* r = pose.rotation;
  const Vec3 from = place - pose.position();
  const Vec3 x{r[0], r[3], r[6]}, y{r[1], r[4], r[7]}, z{r[2], r[5], r[8]};
  const double volume = dot(x, cross(y, z));
  return {dot(from, cross(y, z)) / volume, dot(x, cross(from, z)) / volume,
          dot(x, cross(y, from)) / volume};
}

}  // namespace

Vec3 direction_to_left(Axis forward, Axis up) {
  return cross(direction_of(up), direction_of(forward));
}

Vec3 direction_ahead(const Pose& pose, Axis forward) {
  const Vec3 ahead = direction_of(forward);
  const double* r = pose.rotation;
  return {dot({r[0], r[1], r[2]}, ahead), dot({r[3], r[4], r[5]}, ahead),
          dot({r[6], r[7], r[8]}, ahead)};
}

Vec3 ahead_left_up(const Vec3& place, const Pose& pose, Axis forward, Axis up) {
  const Vec3 there = in_model_frame(place, pose);
  const Vec3 ahead = direction_of(forward), above = direction_of(up);
  return {dot(there, ahead), dot(there, cross(above, ahead)), dot(there, above)};
}

Box turned(const Box& box, Axis forward, Axis up) {
  const Vec3 ahead = direction_of(forward), above = direction_of(up);
  const Vec3 axes[3] = {ahead, cross(above, ahead), above};
  Box out{};
  for (int k = 0; k < 3; ++k) {
    const double a = dot(box.lo, axes[k]), b = dot(box.hi, axes[k]);
    out.lo[k] = std::min(a, b);
    out.hi[k] = std::max(a, b);
  }
  return out;
}

Side side_of(const Box& seen, const Box& model, Axis forward, Axis up) {
  const Box box = turned(model, forward, up);
  const std::array<std::pair<Side, double>, 6> beyond{{{Side::kLeft, seen.lo.y - box.hi.y},
                                                       {Side::kRight, box.lo.y - seen.hi.y},
                                                       {Side::kAbove, seen.lo.z - box.hi.z},
                                                       {Side::kBelow, box.lo.z - seen.hi.z},
                                                       {Side::kFront, seen.lo.x - box.hi.x},
                                                       {Side::kBehind, box.lo.x - seen.hi.x}}};
  const auto farther = [](const auto& a, const auto& b) { return a.second < b.second; };
  const auto across = std::max_element(beyond.begin(), beyond.begin() + 4, farther);
  if (across->second > 0) return across->first;
  const auto along = std::max_element(beyond.begin() + 4, beyond.end(), farther);
  if (along->second > 0) return along->first;
  return std::max_element(beyond.begin(), beyond.end(), farther)->first;
}

PathStretches::PathStretches(const std::vector<double>& chainage, double split) {
  if (split == 0) return;
  number_.resize(chainage.size());
  for (std::size_t i = 1; i < chainage.size(); ++i) {
    const bool cut = std::floor(chainage[i] / split) != std::floor(chainage[i - 1] / split);
    number_[i] = number_[i - 1] + (cut ? 1 : 0);
  }
}

}  // namespace clearway
