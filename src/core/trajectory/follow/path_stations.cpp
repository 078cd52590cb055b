#include "core/trajectory/follow/path_stations.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <string>

#include "clearway/error.hpp"
#include "core/geometry/predicate.hpp"
#include "core/trajectory/follow/arc_length.hpp"
#include "core/trajectory/pose_spline.hpp"

namespace clearway {
namespace {

/// Rounding of stations, in metres: of the sum of 1e6 ways, and of a station plus a distance.
constexpr double kStationRounding = 1e-9;

std::string two_poses(std::size_t from) {
  return "poses " + std::to_string(from) + " and " + std::to_string(from + 1) +
         " (counting from 0)";
}

bool mirrors(const Pose& pose) {
  return Eigen::Map<const Eigen::Matrix3d>(pose.rotation).determinant() < 0;
}

Vec3 vec3_of(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

/// How far the origin of the model's frame moves on each way, so that a station depends on the path
/// and on no model.
std::vector<double> distances_of(std::span<const Pose> poses) {
  std::vector<double> distances;
  for (std::size_t i = 0; i + 1 < poses.size(); ++i) {
    const double* from = poses[i].translation;
    const double* to = poses[i + 1].translation;
    distances.push_back(
        std::sqrt(squared_length(to[0] - from[0], to[1] - from[1], to[2] - from[2])));
    if (!std::isfinite(distances.back())) {
      throw InputError(two_poses(i) +
                       ": too far apart for the distance between them to be a number");
    }
    if (mirrors(poses[i]) != mirrors(poses[i + 1])) {
      throw InputError(two_poses(i) +
                       ": one mirrors the model, the other does not; nothing leads from one to the "
                       "other");
    }
  }
  return distances;
}

/// Sums of the first 0, 1, 2, ... lengths, as if with twice the digits (Neumaier), because a path
/// may have 1e6 ways.
std::vector<double> sums_of(const std::vector<double>& lengths) {
  std::vector<double> sums{0};
  double sum = 0, lost = 0;
  for (const double length : lengths) {
    const double next = sum + length;
    lost += sum >= length ? (sum - next) + length : (length - next) + sum;
    sum = next;
    // Rounding must not make a station smaller than the one before it.
    sums.push_back(std::max(sums.back(), sum + lost));
  }
  return sums;
}

}  // namespace

PathStations::PathStations(std::span<const Pose> poses, int threads)
    : poses_(poses), spline_(std::make_unique<PoseSpline>(poses, distances_of(poses))) {
  if (poses.empty()) return;
  lengths_.resize(poses.size() - 1);
#pragma omp parallel for schedule(static) num_threads(threads)
  for (std::size_t i = 0; i < lengths_.size(); ++i) {
    lengths_[i] = arc_length(spline_->positions(i), 0, 1);
  }
  of_pose_ = sums_of(lengths_);
}

PathStations::~PathStations() = default;
PathStations::PathStations(PathStations&&) noexcept = default;

std::optional<PathStations::Place> PathStations::ahead_of(std::size_t i, double ahead) const {
  if (ahead == 0) return Place{i, 0};
  return at_station(of_pose_[i] + ahead);
}

std::optional<PathStations::Place> PathStations::at_station(double station) const {
  if (!(station >= -kStationRounding && station <= length() + kStationRounding))
    return std::nullopt;
  const auto next = std::upper_bound(of_pose_.begin(), of_pose_.end(), station);
  if (next == of_pose_.begin()) return Place{0, 0};
  if (next == of_pose_.end()) return Place{poses_.size() - 1, 0};
  const auto way = static_cast<std::size_t>(next - of_pose_.begin()) - 1;
  return on_way(way, station - of_pose_[way]);
}

PathStations::Place PathStations::on_way(std::size_t way, double metres) const {
  return {way, parameter_at(spline_->positions(way), metres, lengths_[way])};
}

Pose PathStations::pose_at(const Place& place) const {
  if (place.t == 0) return poses_[place.way];
  if (place.t == 1) return poses_[place.way + 1];
  return spline_->between(place.way).at(place.t);
}

Vec3 PathStations::position_at(const Place& place) const {
  const Vec3 from = poses_[place.way].position();
  if (place.t == 0) return from;
  return from + vec3_of(spline_->positions(place.way).displacement(place.t));
}

Vec3 PathStations::direction_at(const Place& place) const {
  // A stop has no direction of its own, so it takes that of the next way, or else that of the last
  // one.
  std::size_t way = place.way;
  while (way < lengths_.size() && !(lengths_[way] > 0)) ++way;
  if (way < lengths_.size()) {
    return vec3_of(spline_->positions(way).velocity(way == place.way ? place.t : 0));
  }
  while (way > 0 && !(lengths_[way - 1] > 0)) --way;
  return way > 0 ? vec3_of(spline_->positions(way - 1).velocity(1)) : Vec3{0, 0, 0};
}

}  // namespace clearway
