#include "core/trajectory/follow/follow_path.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>
#include <thread>

#include "clearway/error.hpp"
#include "clearway/follow.hpp"
#include "core/util/format.hpp"

namespace clearway {
namespace {

using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

enum State : std::uint8_t { kOffPath = 1, kUndefined = 2, kFolded = 4, kTurned = 8 };

/// Least cosine of the angle between two axes that count as parallel: that of 60 degrees.
constexpr double kAlong = 0.5;
/// Least sine of the angle between two axes that count as across each other: that of 30 degrees.
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

namespace {

/// The poses as text, such as "poses 0-99, 901-1000", or the first few of many such runs.
std::string listed(const std::vector<std::uint64_t>& indices) {
  constexpr std::size_t kMost = 4;
  const auto ranges = number_ranges(indices);
  std::string text = indices.size() == 1 ? "pose " : "poses ";
  for (std::size_t k = 0; k < std::min(ranges.size(), kMost); ++k) {
    text += (k > 0 ? ", " : "") + ranges[k];
  }
  return ranges.size() > kMost ? text + " and others" : text;
}

/// A length in metres as text, rounded to a millimetre.
std::string metres_text(double metres) { return format_number(std::round(metres * 1e3) / 1e3); }

/// Whether the given poses, which ascend, all belong to runs at the beginning or the end of the
/// path.
bool only_at_ends(const std::vector<std::uint64_t>& poses, std::size_t count) {
  std::size_t first = 0, last = 0;
  while (first < poses.size() && poses[first] == first) ++first;
  while (last < poses.size() && poses[poses.size() - 1 - last] == count - 1 - last) ++last;
  return first + last >= poses.size();
}

Message message(Message::Severity severity, const std::string& code, const std::string& text,
                const std::vector<std::uint64_t>& poses) {
  return {severity,
          code,
          text,
          {{"poses", static_cast<double>(poses.size())},
           {"first", static_cast<double>(poses.front())},
           {"last", static_cast<double>(poses.back())}}};
}

/// "body wagon: 6 of 21 poses of the path (poses 0-5, from 0): ".
std::string share_text(const std::string& name, const std::vector<std::uint64_t>& poses,
                       std::size_t count) {
  return name + ": " + format_count(poses.size()) + " of " + counted(count, "pose") +
         " of the path (" + listed(poses) + ", from 0): ";
}

}  // namespace

Message off_path_message(const std::string& name, const std::vector<std::uint64_t>& missing,
                         std::size_t path_poses, const std::string& why,
                         const std::string& remedy) {
  // A wagon on pivots leaves the ends of any path, and the verdict says how much of it was
  // searched. A body that is missing on most of the path is different, because the answer is hardly
  // about it.
  const bool mostly = missing.size() > path_poses / 2;
  const bool expected = !mostly && only_at_ends(missing, path_poses);
  return message(expected ? Message::Severity::kNote : Message::Severity::kWarning, "body-off-path",
                 share_text(name, missing, path_poses) + "the body has no pose there, " + why +
                     ". " + (mostly ? "Most of the path is not searched for this body. " : "") +
                     remedy,
                 missing);
}

std::vector<Message> doubts_about(const FollowedPath& followed, const PathStations& path,
                                  const BodyMount& mount, const std::string& name) {
  std::vector<Message> doubts;
  const std::size_t count = path.poses().size();
  const auto warn = [&](const std::string& code, const std::vector<std::uint64_t>& poses,
                        const std::string& what) {
    if (poses.empty()) return;
    doubts.push_back(
        message(Message::Severity::kWarning, code, share_text(name, poses, count) + what, poses));
  };
  const bool pivots = std::holds_alternative<BodyPivots>(mount);
  if (!followed.off_path.empty()) {
    const bool mostly = followed.off_path.size() > count / 2;
    doubts.push_back(off_path_message(name, followed.off_path, count,
                                      std::string("as ") + (pivots ? "a pivot" : "its station") +
                                          " is off the path, which is " +
                                          metres_text(path.length()) + " m long",
                                      mostly ? "Check its stations, or make the path longer"
                                             : "Make the path longer to search there too"));
  }
  warn("body-undefined", followed.undefined,
       "the body has no pose there. Its pivots are at one place, or one is above the other. The "
       "path turns back there, or stands on its end");
  warn("body-folded", followed.folded,
       "the path turns back between the pivots. They are closer together than half their way "
       "along the path. Split the path where it turns back");
  warn("body-turned", followed.turned,
       pivots
           ? "the path's x axis is more than 60 degrees from the body's, or its z axis within 30. "
             "If the path is driven backwards, give the pivots the other way round. Otherwise its "
             "poses may have other axes than x forward and z up"
           : "the path is driven against its x axis. Stations ahead are behind the model there");
  return doubts;
}

namespace {

void check_mount(const BodyMount& mount) {
  const auto* pivots = std::get_if<BodyPivots>(&mount);
  const auto* station = std::get_if<BodyStation>(&mount);
  const bool finite = pivots != nullptr
                          ? std::isfinite(pivots->front) && std::isfinite(pivots->rear)
                          : std::isfinite(station->at);
  if (!finite) throw UsageError("a station or a pivot has to be a finite number of metres");
  if (pivots != nullptr && pivots->front == pivots->rear) {
    throw UsageError("both pivots are " + format_number(pivots->front) +
                     " m ahead; expected two different places");
  }
}

}  // namespace

Body follow(Body body, const std::vector<Pose>& path, const BodyMount& mount,
            std::vector<Message>* warnings) {
  check_mount(mount);
  const int threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  const PathStations stations(path, threads);
  FollowedPath followed = follow_path(stations, mount, threads);
  const std::string name = "body " + body.name;
  if (followed.poses.empty() && !path.empty()) {
    throw InputError(name + ": the path is " + format_brief(stations.length()) +
                     " m long, and the body has a pose nowhere on it");
  }
  if (warnings != nullptr) {
    for (Message& doubt : doubts_about(followed, stations, mount, name)) {
      warnings->push_back(std::move(doubt));
    }
  }
  body.poses = std::move(followed.poses);
  body.path_pose.assign(followed.of.begin(), followed.of.end());
  return body;
}

}  // namespace clearway
