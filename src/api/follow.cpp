#include "clearway/follow.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <thread>

#include "clearway/error.hpp"
#include "core/trajectory/follow/follow_path.hpp"
#include "core/util/format.hpp"

namespace clearway {
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
