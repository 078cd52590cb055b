#include "core/trajectory/follow/follow_path.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "clearway/error.hpp"

namespace clearway {
namespace {

using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

enum State : std::uint8_t { kOffPath = 1, kUndefined = 2, kFolded = 4, kTurned = 8 };

/// Cosine from which on two axes count as along each other: that of 60 degrees.
constexpr double kAlong = 0.5;
/// Sine from which on an axis counts as across another: that of 30 degrees.
constexpr double kAcross = 0.5;
/// Least chord, as a share of the way between the pivots, whose direction means anything.
constexpr double kLeastChord = 1e-6;
/// Least sine between the up direction and the chord for the up direction to mean anything.
constexpr double kLeastUp = 1e-6;

Eigen::Vector3d position_of(const Pose& pose) {
  return Eigen::Map<const Eigen::Vector3d>(pose.translation);
}

Eigen::Vector3d axis_of(const Pose& pose, int axis) {
  return Eigen::Map<const RowMajor>(pose.rotation).col(axis).normalized();
}

Pose pose_of(const Eigen::Vector3d& x, const Eigen::Vector3d& up, const Eigen::Vector3d& origin) {
  RowMajor rotation;
  rotation << x, up.cross(x), up;
  Pose pose{};
  std::copy_n(rotation.data(), 9, pose.rotation);
  std::copy_n(origin.data(), 3, pose.translation);
  return pose;
}

/// The pose of a body that belongs to one pose of the path.
struct BodyPose {
  Pose pose{};
  std::uint8_t state = 0;
};

BodyPose at_station(const PathStations& path, std::size_t i, const BodyStation& station) {
  BodyPose body;
  const auto place = path.ahead_of(i, station.at);
  if (!place) return {.state = kOffPath};
  body.pose = path.pose_at(*place);
  const Vec3 way = path.direction_at(*place);
  const Eigen::Vector3d along(way.x, way.y, way.z);
  // On a path that is driven backwards, places ahead are behind the model.
  const bool backwards = along.dot(axis_of(body.pose, 0)) < -kAlong * along.norm();
  if (station.at != 0 && backwards) body.state = kTurned;
  return body;
}

BodyPose on_pivots(const PathStations& path, std::size_t i, const BodyPivots& pivots) {
  const auto front_place = path.ahead_of(i, pivots.front);
  const auto rear_place = path.ahead_of(i, pivots.rear);
  if (!front_place || !rear_place) return {.state = kOffPath};
  const Pose front = path.pose_at(*front_place), rear = path.pose_at(*rear_place);
  const Eigen::Vector3d chord = position_of(front) - position_of(rear);
  const double length = chord.norm(), way = std::abs(pivots.front - pivots.rear);
  if (!(length > kLeastChord * way)) return {.state = kUndefined};
  const Eigen::Vector3d x = chord / length;
  const Eigen::Vector3d mean_up = (axis_of(front, 2) + axis_of(rear, 2)) / 2;
  const Eigen::Vector3d up = mean_up - mean_up.dot(x) * x;
  if (!(up.norm() > kLeastUp)) return {.state = kUndefined};
  const double share = -pivots.rear / (pivots.front - pivots.rear);
  BodyPose body;
  body.pose = pose_of(x, up.normalized(), position_of(rear) + share * chord);
  if (length < way / 2) body.state |= kFolded;
  // A frame with another axis forward or up, such as a camera's, gives no frame of the body.
  if (x.dot(axis_of(path.poses()[i], 0)) < kAlong || up.norm() < kAcross) body.state |= kTurned;
  return body;
}

void refuse_mirroring(const PathStations& path, const BodyMount& mount) {
  if (!std::holds_alternative<BodyPivots>(mount) || path.poses().empty()) return;
  // Paths of which only some poses mirror were refused before.
  if (Eigen::Map<const RowMajor>(path.poses()[0].rotation).determinant() > 0) return;
  throw InputError(
      "the poses mirror the model; a body on two pivots is placed by a rotation; expected "
      "poses that do not mirror");
}

}  // namespace

FollowedPath follow_path(const PathStations& path, const BodyMount& mount, int threads) {
  refuse_mirroring(path, mount);
  std::vector<BodyPose> bodies(path.poses().size());
#pragma omp parallel for schedule(static, 256) num_threads(threads)
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const auto* pivots = std::get_if<BodyPivots>(&mount);
    bodies[i] = pivots != nullptr ? on_pivots(path, i, *pivots)
                                  : at_station(path, i, std::get<BodyStation>(mount));
  }
  FollowedPath followed;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const std::uint8_t state = bodies[i].state;
    if ((state & kOffPath) != 0) followed.off_path.push_back(i);
    if ((state & kUndefined) != 0) followed.undefined.push_back(i);
    if ((state & kFolded) != 0) followed.folded.push_back(i);
    if ((state & kTurned) != 0) followed.turned.push_back(i);
    if ((state & (kOffPath | kUndefined)) != 0) continue;
    followed.poses.push_back(bodies[i].pose);
    followed.of.push_back(i);
  }
  return followed;
}

}  // namespace clearway
