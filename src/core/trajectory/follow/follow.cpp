#include "clearway/follow.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <initializer_list>
#include <numeric>
#include <optional>
#include <string>
#include <thread>

#include "clearway/error.hpp"
#include "core/trajectory/follow/follow_path.hpp"
#include "core/trajectory/follow/towed.hpp"
#include "core/util/format.hpp"
#include "core/util/threads.hpp"

namespace clearway {
namespace {

void check_finite(std::initializer_list<double> lengths) {
  for (const double length : lengths) {
    if (!std::isfinite(length)) {
      throw UsageError("a station or a pivot has to be a finite number of metres");
    }
  }
}

void check_mount(const BodyMount& mount) {
  if (const auto* station = std::get_if<BodyStation>(&mount)) check_finite({station->at});
  if (const auto* pivots = std::get_if<BodyPivots>(&mount)) {
    check_finite({pivots->front, pivots->rear});
    if (pivots->front == pivots->rear) {
      throw UsageError("both pivots are " + format_number(pivots->front) +
                       " m ahead; expected two different places");
    }
  }
  if (const auto* tow = std::get_if<BodyTowed>(&mount)) {
    for (const double x : {tow->at, tow->hitch, tow->axle}) {
      if (std::abs(x) <= kFarthestHitch) continue;
      throw UsageError("a hitch or an axle is at x = " + format_number(x) +
                       "; expected at most 1000 km from the origin of the body");
    }
    if (!(tow->hitch > tow->axle)) {
      throw UsageError("the hitch of a towed body is at x = " + format_number(tow->hitch) +
                       ", its axle at " + format_number(tow->axle) +
                       "; expected the axle behind the hitch");
    }
  }
}

/// Places the bodies of a vehicle that follow a path.
class Follower {
 public:
  Follower(const std::vector<Pose>& path, std::vector<Message>* warnings)
      : threads_(std::max(1, static_cast<int>(std::thread::hardware_concurrency()))),
        path_(path, started(threads_)),
        warnings_(warnings) {}

  const PathStations& path() const { return path_; }
  int threads() const { return threads_; }

  /// Gives the body the poses that were found for it.
  void place(Body& body, const BodyMount& mount, FollowedPath followed) const {
    const std::string name = body_words(body.name);
    if (followed.pushed_from) throw InputError(name + ": " + pushed_text(followed, path_));
    if (followed.poses.empty() && !path_.poses().empty()) {
      throw InputError(name + ": the path is " + format_brief(path_.length()) +
                       " m long, and the body has a pose nowhere on it");
    }
    if (warnings_ != nullptr) {
      for (Message& doubt : doubts_about(followed, path_, mount, name)) {
        doubt.body = body.name;
        warnings_->push_back(std::move(doubt));
      }
    }
    body.poses = std::move(followed.poses);
    body.path_pose.assign(followed.of.begin(), followed.of.end());
  }

 private:
  static int started(int threads) {
    check_threads(threads);
    return threads;
  }

  int threads_;
  PathStations path_;
  std::vector<Message>* warnings_;
};

/// Throws UsageError unless the poses that a body has of its own belong to poses of the path.
void check_own_poses(const Body& body, std::size_t path_poses) {
  const std::vector<std::uint32_t>& path_pose = body.path_pose;
  const std::size_t known = path_pose.empty() ? path_poses : path_pose.size();
  const bool ascends =
      std::ranges::adjacent_find(path_pose, std::greater_equal<>()) == path_pose.end();
  if (body.poses.size() == known && ascends &&
      (path_pose.empty() || path_pose.back() < path_poses)) {
    return;
  }
  throw UsageError(body_words(body.name) + ": keeps " + counted(body.poses.size(), "pose") +
                   ", which do not belong to the " + counted(path_poses, "pose") +
                   " of the path; expected one for each, or path_pose in the order of the path");
}

/// Numbers the poses of a body that has all poses of the path.
void number_poses(Body& body) {
  body.path_pose.resize(body.poses.size());
  std::iota(body.path_pose.begin(), body.path_pose.end(), 0);
}

Towing checked_towing(const std::vector<Body>& bodies, const std::vector<BodyMount>& mounts) {
  if (mounts.size() != bodies.size()) {
    throw UsageError("expected a mount for each body: " + counted(bodies.size(), "body", "bodies") +
                     ", " + counted(mounts.size(), "mount"));
  }
  std::vector<std::string> names;
  for (const Body& body : bodies) names.push_back(body.name);
  for (const BodyMount& mount : mounts) check_mount(mount);
  Towing towing = towing_of(names, mounts);
  if (towing.fault) {
    throw UsageError(body_words(names[towing.fault->body]) + ": " + towing.fault->what);
  }
  return towing;
}

}  // namespace

std::vector<Body> follow(std::vector<Body> bodies, const std::vector<Pose>& path,
                         const std::vector<BodyMount>& mounts, std::vector<Message>* warnings) {
  const Towing towing = checked_towing(bodies, mounts);
  const Follower follower(path, warnings);
  std::vector<MountedBody> mounted;
  std::vector<PathStations> own;
  own.reserve(bodies.size());
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    mounted.push_back({mounts[i], &follower.path(), {}});
    if (std::holds_alternative<BodyTowed>(mounts[i])) continue;
    if (std::holds_alternative<BodyOwnPoses>(mounts[i])) {
      check_own_poses(bodies[i], path.size());
      own.emplace_back(bodies[i].poses, follower.threads());
      mounted.back().path = &own.back();
      if (bodies[i].path_pose.empty()) number_poses(bodies[i]);
      mounted.back().path_pose = bodies[i].path_pose;
    } else {
      follower.place(bodies[i], mounts[i],
                     follow_path(follower.path(), mounts[i], follower.threads()));
    }
  }
  std::vector<FollowedPath> towed = follow_towed(mounted, towing, 1, follower.threads());
  for (const std::size_t i : towing.order) {
    follower.place(bodies[i], mounts[i], std::move(towed[i]));
  }
  return bodies;
}

Body follow(Body body, const std::vector<Pose>& path, const BodyMount& mount,
            std::vector<Message>* warnings) {
  std::vector<Body> one;
  one.push_back(std::move(body));
  return std::move(follow(std::move(one), path, {mount}, warnings).front());
}

}  // namespace clearway
