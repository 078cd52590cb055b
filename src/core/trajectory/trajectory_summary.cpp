#include "core/trajectory/trajectory_summary.hpp"

#include <algorithm>
#include <cmath>

#include "core/geometry/rigid.hpp"

namespace clearway {

double motion_bound(const Box& model, const Pose& a, const Pose& b) {
  return a == b ? 0 : displacement_bound(model, a, b);
}

double largest_motion(const Box& model, std::span<const Pose> poses) {
  double largest = 0;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    largest = std::max(largest, motion_bound(model, poses[i - 1], poses[i]));
  }
  return largest;
}

namespace {

double distance(const Vec3& a, const Vec3& b) {
  return std::hypot(b.x - a.x, b.y - a.y, b.z - a.z);
}

double skew_of(const Pose& pose) {
  double worst = 0;
  for (int i = 0; i < 3; ++i) {
    for (int k = i; k < 3; ++k) {
      double product = i == k ? -1 : 0;
      for (int row = 0; row < 3; ++row) {
        product += pose.rotation[3 * row + i] * pose.rotation[3 * row + k];
      }
      worst = std::max(worst, std::abs(product));
    }
  }
  return worst;
}

/// The axis with the greatest components. sums: weighted sums of the components; sizes: weighted
/// sums of their absolute values.
BodyAxis axis_of(const Vec3& sums, const Vec3& sizes, double weight) {
  if (!(weight > 0)) return {};
  int axis = 0;
  for (int k = 1; k < 3; ++k) {
    if (sizes[k] > sizes[axis]) axis = k;
  }
  return {axis, sums[axis] < 0, std::abs(sums[axis]) / weight};
}

void add_steps(std::span<const Pose> poses, TrajectorySummary& out) {
  std::vector<double> moving;
  for (std::size_t i = 0; i + 1 < poses.size(); ++i) {
    const double step = distance(poses[i].position(), poses[i + 1].position());
    out.length += step;
    if (step > out.largest_step) {
      out.largest_step = step;
      out.largest_step_pose = i;
    }
    if (step > 0) moving.push_back(step);
    const double turn = turn_between(poses[i], poses[i + 1]);
    out.total_turn += turn;
    if (turn > out.largest_turn) {
      out.largest_turn = turn;
      out.largest_turn_pose = i;
    }
  }
  if (!poses.empty()) out.still_steps = poses.size() - 1 - moving.size();
  if (moving.empty()) return;
  const auto middle = moving.begin() + static_cast<std::ptrdiff_t>(moving.size() / 2);
  std::nth_element(moving.begin(), middle, moving.end());
  out.median_step = *middle;
}

BodyAxis up_axis(std::span<const Pose> poses) {
  Vec3 sums{};
  Vec3 sizes{};
  for (const Pose& pose : poses) {
    for (int k = 0; k < 3; ++k) {
      sums[k] += pose.rotation[6 + k];
      sizes[k] += std::abs(pose.rotation[6 + k]);
    }
  }
  return axis_of(sums, sizes, static_cast<double>(poses.size()));
}

BodyAxis forward_axis(std::span<const Pose> poses, double length) {
  constexpr double kPieces = 1000;
  Vec3 sums{};
  Vec3 sizes{};
  double weight = 0;
  for (const Chord& chord : chords_of(poses, length / kPieces)) {
    const Vec3 direction = poses[chord.middle].rotated_back(chord.direction);
    for (int k = 0; k < 3; ++k) {
      sums[k] += chord.length * direction[k];
      sizes[k] += chord.length * std::abs(direction[k]);
    }
    weight += chord.length;
  }
  return axis_of(sums, sizes, weight);
}

}  // namespace

double turn_between(const Pose& a, const Pose& b) {
  // |A - B| is 2 sqrt 2 sin(angle / 2) in the Frobenius norm, which is accurate for small angles,
  // too.
  double square = 0;
  for (int k = 0; k < 9; ++k) {
    const double difference = a.rotation[k] - b.rotation[k];
    square += difference * difference;
  }
  return 2 * std::asin(std::min(1.0, std::sqrt(square / 8)));
}

std::vector<Chord> chords_of(std::span<const Pose> poses, double least) {
  std::vector<Chord> chords;
  for (std::size_t start = 0, i = 1; i < poses.size(); ++i) {
    const Vec3 a = poses[start].position();
    const Vec3 b = poses[i].position();
    const double length = distance(a, b);
    if (!(length >= least) || !(length > 0) || !std::isfinite(length)) continue;
    chords.push_back({{(b.x - a.x) / length, (b.y - a.y) / length, (b.z - a.z) / length},
                      length,
                      start + (i - start) / 2});
    start = i;
  }
  return chords;
}

Box box_of_positions(std::span<const Pose> poses) {
  Box box{poses[0].position(), poses[0].position()};
  for (const Pose& pose : poses) box.extend(pose.position());
  return box;
}

TrajectorySummary summarize_trajectory(std::span<const Pose> poses) {
  TrajectorySummary out;
  out.poses = poses.size();
  if (poses.empty()) return out;
  out.box = box_of_positions(poses);
  for (const Pose& pose : poses) out.skew = std::max(out.skew, skew_of(pose));
  add_steps(poses, out);
  out.up = up_axis(poses);
  out.forward = forward_axis(poses, out.length);
  return out;
}

}  // namespace clearway
