#include "core/trajectory/chainage.hpp"

#include <algorithm>
#include <cmath>

#include "core/geometry/predicate.hpp"

namespace clearway {
namespace {

double step_length(const Pose& from, const Pose& to) {
  return std::sqrt(squared_distance(to.position(), from.position()));
}

/// The unit vector from one pose to another; none where they are too close for a direction.
std::optional<Vec3> way(const Pose& from, const Pose& to) {
  const Vec3 out = to.position() - from.position();
  const double size = length(out);
  if (!(size >= 0.1)) return std::nullopt;
  return (1 / size) * out;
}

}  // namespace

std::vector<double> chainage_of(std::span<const Pose> poses) {
  std::vector<double> chainage(poses.size());
  for (std::size_t i = 1; i < poses.size(); ++i) {
    chainage[i] = chainage[i - 1] + step_length(poses[i - 1], poses[i]);
  }
  return chainage;
}

double path_length(std::span<const Pose> poses) {
  double length = 0;
  for (std::size_t i = 1; i < poses.size(); ++i) length += step_length(poses[i - 1], poses[i]);
  return length;
}

double value_at(std::span<const double> chainage, std::span<const double> values, double at) {
  const auto next = std::upper_bound(chainage.begin(), chainage.end(), at);
  if (next == chainage.end()) return values.back();
  if (next == chainage.begin()) return values.front();
  const auto i = static_cast<std::size_t>(next - chainage.begin());
  const double part = (at - chainage[i - 1]) / (chainage[i] - chainage[i - 1]);
  return values[i - 1] + part * (values[i] - values[i - 1]);
}

std::optional<Vec3> travel_direction(std::span<const Pose> poses, std::size_t at) {
  std::optional<Vec3> in, out;
  std::size_t before = at, after = at;
  while (!in && before > 0) in = way(poses[--before], poses[at]);
  while (!out && after + 1 < poses.size()) out = way(poses[at], poses[++after]);
  if (!in || !out) return in ? in : out;
  if (dot(*in, *out) <= 0) return in;  // turns back
  return way(poses[before], poses[after]);
}

}  // namespace clearway
