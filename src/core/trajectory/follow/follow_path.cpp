#include "core/trajectory/follow/follow_path.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>

#include "clearway/error.hpp"
#include "core/geometry/angle.hpp"
#include "core/messages/messages.hpp"
#include "core/trajectory/eigen_pose.hpp"
#include "core/trajectory/pose_ranges.hpp"
#include "core/util/format.hpp"

namespace clearway {
namespace {

using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

/// Least cosine of the angle between two axes that count as parallel: that of 60 degrees.
constexpr double kAlong = 0.5;
/// Least sine of the angle between two axes that count as across each other: that of 30 degrees.
constexpr double kAcross = 0.5;
/// Least chord, as a share of the way between the pivots, whose direction means anything.
constexpr double kLeastChord = 1e-6;
/// Least sine between the up direction and the chord for the up direction to mean anything.
constexpr double kLeastUp = 1e-6;

Eigen::Vector3d as_eigen(const Vec3& v) { return {v.x, v.y, v.z}; }
Vec3 as_vec3(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

Eigen::Vector3d axis_of(const Pose& pose, int axis) {
  return Eigen::Map<const RowMajor>(pose.rotation).col(axis).normalized();
}

}  // namespace

BodyPose framed(const Vec3& along, const Vec3& mean, const Vec3& origin) {
  const Eigen::Vector3d x = as_eigen(along), mean_up = as_eigen(mean);
  const Eigen::Vector3d up = mean_up - mean_up.dot(x) * x;
  if (!(up.norm() > kLeastUp)) return {.state = kUndefined};
  const Eigen::Vector3d z = up.normalized();
  RowMajor rotation;
  rotation << x, z.cross(x), z;
  BodyPose body;
  std::copy_n(rotation.data(), 9, body.pose.rotation);
  for (int axis = 0; axis < 3; ++axis) body.pose.translation[axis] = origin[axis];
  if (up.norm() < kAcross) body.state = kTurned;
  return body;
}

namespace {

/// The place `ahead` metres ahead of a moment, or none if that is off the path. For 0 it is the
/// moment's own place.
std::optional<PathStations::Place> ahead_of(const PathStations& path, const PathMoment& moment,
                                            double ahead) {
  if (ahead == 0) return moment.place;
  return path.at_station(moment.station + ahead);
}

BodyPose at_station(const PathStations& path, const PathMoment& moment,
                    const BodyStation& station) {
  BodyPose body;
  const auto place = ahead_of(path, moment, station.at);
  if (!place) return {.state = kOffPath};
  body.pose = path.pose_at(*place);
  const Vec3 way = path.direction_at(*place);
  const Eigen::Vector3d along = as_eigen(way);
  // On a path that is driven backwards, places ahead are behind the model.
  const bool backwards = along.dot(axis_of(body.pose, 0)) < -kAlong * along.norm();
  if (station.at != 0 && backwards) body.state = kTurned;
  return body;
}

BodyPose on_pivots(const PathStations& path, const PathMoment& moment, const BodyPivots& pivots) {
  const auto front_place = ahead_of(path, moment, pivots.front);
  const auto rear_place = ahead_of(path, moment, pivots.rear);
  if (!front_place || !rear_place) return {.state = kOffPath};
  const Pose front = path.pose_at(*front_place), rear = path.pose_at(*rear_place);
  const Eigen::Vector3d chord = position_of(front) - position_of(rear);
  const double length = chord.norm(), way = std::abs(pivots.front - pivots.rear);
  if (!(length > kLeastChord * way)) return {.state = kUndefined};
  const Eigen::Vector3d x = chord / length;
  const double share = -pivots.rear / (pivots.front - pivots.rear);
  BodyPose body = framed(as_vec3(x), as_vec3((axis_of(front, 2) + axis_of(rear, 2)) / 2),
                         as_vec3(position_of(rear) + share * chord));
  if (!body.exists()) return body;
  if (length < way / 2) body.state |= kFolded;
  // A frame with another axis forward or up, such as a camera's, gives no frame of the body.
  if (x.dot(axis_of(path.poses()[moment.place.way], 0)) < kAlong) body.state |= kTurned;
  return body;
}

}  // namespace

BodyPose body_pose_at(const PathStations& path, const PathMoment& moment, const BodyMount& mount) {
  if (const auto* pivots = std::get_if<BodyPivots>(&mount)) return on_pivots(path, moment, *pivots);
  return at_station(path, moment, std::get<BodyStation>(mount));
}

void refuse_mirroring(const PathStations& path) {
  if (path.poses().empty()) return;
  // Paths of which only some poses mirror were refused before.
  if (Eigen::Map<const RowMajor>(path.poses()[0].rotation).determinant() > 0) return;
  throw InputError(
      "the poses mirror the model; a body on two pivots is placed by a rotation; expected "
      "poses that do not mirror");
}

void add_pose(FollowedPath& followed, std::uint64_t index, const BodyPose& body) {
  if ((body.state & kOffPath) != 0) followed.off_path.push_back(index);
  if ((body.state & kUndefined) != 0) followed.undefined.push_back(index);
  if ((body.state & kFolded) != 0) followed.folded.push_back(index);
  if ((body.state & kTurned) != 0) followed.turned.push_back(index);
  if (!body.exists()) return;
  followed.poses.push_back(body.pose);
  followed.of.push_back(index);
}

FollowedPath follow_path(const PathStations& path, const BodyMount& mount, int threads) {
  if (std::holds_alternative<BodyPivots>(mount)) refuse_mirroring(path);
  std::vector<BodyPose> bodies(path.poses().size());
#pragma omp parallel for schedule(static, 256) num_threads(threads)
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    bodies[i] = body_pose_at(path, {{i, 0}, path.of_pose(i)}, mount);
  }
  FollowedPath followed;
  for (std::size_t i = 0; i < bodies.size(); ++i) add_pose(followed, i, bodies[i]);
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

/// The numbers of a message about these poses.
MessageNumbers numbers_of(const std::vector<std::uint64_t>& poses) {
  return {{"poses", static_cast<double>(poses.size())},
          {"first", static_cast<double>(poses.front())},
          {"last", static_cast<double>(poses.back())}};
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
  return warning_or_note(
      !expected, "body-off-path",
      share_text(name, missing, path_poses) + "the body has no pose there, " + why + ". " +
          (mostly ? "Most of the path is not searched for this body. " : "") + remedy,
      numbers_of(missing), pose_ranges(missing));
}

namespace {

/// The texts about a body that depend on how it moves.
struct MountTexts {
  const char *off_path, *undefined, *turned;
};

constexpr MountTexts kAtStation{
    "its station is off the path", "",
    "the path is driven against its x axis. Stations ahead are behind the model there"};
constexpr MountTexts kOnPivots{
    "a pivot is off the path",
    "Its pivots are at one place, or one is above the other. The path turns back there, or stands "
    "on its end",
    "the path's x axis is more than 60 degrees from the body's, or its z axis within 30. "
    "If the path is driven backwards, give the pivots the other way round. Otherwise its "
    "poses may have other axes than x forward and z up"};
constexpr MountTexts kTowed{
    "its tower has none, because a station or a pivot is off the path",
    "Its tower has none, or its hitch has no direction up",
    "the tower's x axis is more than 60 degrees from where the hitch goes first, or its z axis "
    "within 30 of the body's x axis. The path's poses may have other axes than x forward and z up"};

const MountTexts& texts_of(const BodyMount& mount) {
  if (std::holds_alternative<BodyTowed>(mount)) return kTowed;
  return std::holds_alternative<BodyPivots>(mount) ? kOnPivots : kAtStation;
}

/// What is said of the beginning of a towed body. A warning where its tower turns meanwhile,
/// because then the body was hardly in line with it.
Message transient_message(const FollowedPath& followed, const std::string& where) {
  constexpr double kStraight = 5 * kDegree;
  const bool bends = followed.transient_turn > kStraight;
  Message out = warning_or_note(
      bends, "body-transient",
      where +
          "where the body stands when the path begins is not known, so it begins in line with its "
          "tower. That still matters while the hitch goes three times as far as from the hitch to "
          "the axle" +
          (bends ? ", and the tower turns by " + format_brief(followed.transient_turn / kDegree) +
                       " degrees meanwhile, so where the body is there is a guess"
                 : std::string()) +
          ". Begin the path earlier, where it is straight",
      numbers_of(followed.transient), pose_ranges(followed.transient));
  out.numbers.push_back({"turn_degrees", followed.transient_turn / kDegree});
  return out;
}

}  // namespace

std::vector<Message> doubts_about(const FollowedPath& followed, const PathStations& path,
                                  const BodyMount& mount, const std::string& name) {
  std::vector<Message> doubts;
  const std::size_t count = path.poses().size();
  const MountTexts& texts = texts_of(mount);
  const auto warn = [&](WarningCode code, const std::vector<std::uint64_t>& poses,
                        const std::string& what) {
    if (poses.empty()) return;
    doubts.push_back(warning(code, share_text(name, poses, count) + what, numbers_of(poses),
                             pose_ranges(poses)));
  };
  if (!followed.off_path.empty()) {
    const bool mostly = followed.off_path.size() > count / 2;
    doubts.push_back(off_path_message(name, followed.off_path, count,
                                      std::string("as ") + texts.off_path + ", which is " +
                                          metres_text(path.length()) + " m long",
                                      mostly ? "Check its stations, or make the path longer"
                                             : "Make the path longer to search there too"));
  }
  warn("body-undefined", followed.undefined,
       std::string("the body has no pose there. ") + texts.undefined);
  warn("body-folded", followed.folded,
       "the path turns back between the pivots. They are closer together than half their way "
       "along the path. Split the path where it turns back");
  warn("body-turned", followed.turned, texts.turned);
  if (!followed.transient.empty()) {
    doubts.push_back(transient_message(followed, share_text(name, followed.transient, count)));
  }
  return doubts;
}

}  // namespace clearway
