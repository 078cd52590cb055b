#include "search/checks/facts/path_cover.hpp"

#include <algorithm>
#include <cmath>

#include "core/geometry/point_box.hpp"

namespace clearway {
namespace {

/// At most this many poses are searched for gaps of the scan.
constexpr std::size_t kCoverPoses = 16'384;
constexpr std::size_t kMeasuredPoses = 64;
// The next three lengths are in metres.
constexpr double kFar = 10;
constexpr double kNear = 3;
constexpr double kLongestBlock = 5;
/// The scan has a gap where it is this many times farther away than is usual on the path.
constexpr double kUnusual = 4;

}  // namespace

std::vector<std::uint32_t> spread_poses(std::size_t poses, std::size_t most) {
  const std::size_t count = std::min(poses, most);
  std::vector<std::uint32_t> out;
  for (std::size_t i = 0; i < count; ++i) {
    out.push_back(static_cast<std::uint32_t>(count == 1 ? 0 : i * (poses - 1) / (count - 1)));
  }
  return out;
}

Box body_slice(const Box& model) {
  Box slice = model;
  const int axis = model.longest_axis();
  const Vec3 centre = model.centre();
  const double half = Sides(model).middle / 2;
  slice.lo[axis] = centre[axis] - half;
  slice.hi[axis] = centre[axis] + half;
  return slice;
}

PathCover::PathCover(const Question& question)
    : scan_(question.cloud, kLongestBlock * question.metre) {
  const double asked = std::max(question.query.radius, question.query.clearance);
  const double coarse = std::max(asked, kUnusual * scan_.typical_block());
  far_ = std::max({kFar * question.metre, Sides(question.model).longest / 2, coarse});
  measure(question);
  reach_ = std::max(std::clamp(kUnusual * usual_, kNear * question.metre, far_), coarse);
  look(question);
}

void PathCover::measure(const Question& question) {
  const Box slice = body_slice(question.model);
  std::vector<double> distances;
  for (const std::uint32_t i : spread_poses(question.query.poses.size(), kMeasuredPoses)) {
    distances.push_back(scan_.nearest(moved(slice, question.query.poses[i]), far_).distance);
  }
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  usual_ = *middle;
}

void PathCover::look(const Question& question) {
  const Box slice = body_slice(question.model);
  const std::vector<Pose>& poses = question.query.poses;
  std::uint32_t before = 0;
  bool was_outside = false;
  for (const std::uint32_t i : spread_poses(poses.size(), kCoverPoses)) {
    const bool is_outside = !scan_.within(moved(slice, poses[i]), reach_);
    const double way = clearway::length(poses[i].position() - poses[before].position());
    length_ += way;
    length_outside_ += way * (int{was_outside} + int{is_outside}) / 2;
    before = i;
    was_outside = is_outside;
    ++looked_at_;
    if (!is_outside) continue;
    if (outside_ == 0) first_outside_ = i;
    last_outside_ = i;
    ++outside_;
  }
}

}  // namespace clearway
