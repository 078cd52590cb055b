#include "search/check_corridor.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "clearway/error.hpp"
#include "core/geometry/rigid.hpp"
#include "core/util/format.hpp"
#include "io/scans/length_unit.hpp"
#include "search/check_query.hpp"

namespace clearway {
namespace {

/// Covers the rounding of the few sums and products that a bound consists of.
constexpr double kUp = 1 + 0x1p-40;

/// How far from its model a query looks. radius: the greatest that is searched.
double reach_of(const Query& query, double radius) {
  return std::max({radius, query.radius, query.clearance, query.profile});
}

double farthest_of(const Model& model) {
  double squared = 0;
  for (const Vec3& m : model.vertices) squared = std::max(squared, dot(m, m));
  return std::sqrt(squared) * kUp;
}

}  // namespace

CorridorCheck::CorridorCheck(const StoreMetadata& store) {
  if (!store.near) return;
  corridor_.emplace(store.near->path, store.near->within);
  metre_ = metre_in_units_of(metres_of(store.unit));
}

/// The least D that does for a body, without what lies around it: at every pose the distance of its
/// position to the path and that of its farthest place to its position; on the way to the next pose
/// the positions are on a chord, no place of which is farther than half of both distances and the
/// chord together.
CorridorCheck::Need CorridorCheck::need_of(std::span<const Pose> poses,
                                           std::span<const std::uint32_t> path_pose,
                                           double farthest_of_model, bool between_poses) const {
  Need worst;
  const Vec3 reach{farthest_of_model, farthest_of_model, farthest_of_model};
  double before = 0, extent_before = 0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Pose& pose = poses[i];
    const double away = corridor_->distance_above(pose.position());
    const double extent =
        greatest_stretch_bound(pose) * farthest_of_model + 2 * transform_rounding(reach, pose);
    double distance = away + extent;
    if (between_poses && i > 0) {
      const double chord = length(pose.position() - poses[i - 1].position()) * kUp;
      distance = std::max(distance, (before + away + chord) / 2 + std::max(extent, extent_before));
    }
    before = away;
    extent_before = extent;
    if (!(distance <= worst.distance)) {
      worst = {distance, path_pose.empty() ? i : path_pose[i]};
    }
  }
  return worst;
}

void CorridorCheck::refuse(const Need& need, double reach, const std::string& what) const {
  const double wanted = (need.distance + reach) * kUp;
  if (wanted <= corridor_->within()) return;
  const double metres = std::ceil(wanted / metre_ * 1000 + 0.5) / 1000;
  throw InputError(
      "the environment holds only points within " + format_number(corridor_->within() / metre_) +
          " m of a path, and " + what + " at pose " + std::to_string(need.pose) +
          " reaches farther, so that points which were left out could change the answer",
      Remedy::kWiderCorridor, metres);
}

void CorridorCheck::check(std::span<const MovingBody> bodies, bool between_poses,
                          double reach) const {
  if (!corridor_) return;
  for (const MovingBody& body : bodies) {
    const Need need = need_of(body.poses, body.path_pose, farthest_of(body.model), between_poses);
    const std::string name =
        body.name.empty() ? "the question" : "the question about " + body_words(body.name);
    refuse(need, reach, name);
  }
}

void CorridorCheck::check(const Query& query, double radius) const {
  refuse_seen(query.seen);
  check(moving_bodies(query), query.between_poses, reach_of(query, radius));
}

void CorridorCheck::check(const SectionParameters& asked, const Body& load) const {
  if (!corridor_) return;
  refuse_seen(asked.seen);
  // Points count that lie before the rear or behind the front by up to the margin, and between
  // poses the load grows along and across its way, at most by the way to the next pose.
  const SectionWindow& window = *asked.window;
  const double x = std::max(std::abs(asked.rear), std::abs(asked.front)) + asked.margin;
  const double y = std::max(std::abs(window.y_from), std::abs(window.y_to)) + asked.margin;
  const double z = std::max(std::abs(window.z_from), std::abs(window.z_to)) + asked.margin;
  double grown = 0;
  if (asked.between_poses) {
    const Vec3 corner{x, y, z};
    const Box box{{-corner.x, -corner.y, -corner.z}, corner};
    for (std::size_t i = 1; i < load.poses.size(); ++i) {
      grown = std::max(grown, displacement_bound(box, load.poses[i - 1], load.poses[i]));
    }
  }
  const double farthest = std::sqrt(x * x + y * y + z * z) * kUp + asked.cell + grown;
  refuse(need_of(load.poses, load.path_pose, farthest, asked.between_poses), 0, "the section");
}

double CorridorCheck::wanted(const Query& query, std::vector<Vec3> path, double radius) {
  CorridorCheck check;
  check.corridor_.emplace(std::move(path), 0);
  double wanted = 0;
  for (const MovingBody& body : moving_bodies(query)) {
    const Need need =
        check.need_of(body.poses, body.path_pose, farthest_of(body.model), query.between_poses);
    wanted = std::max(wanted, need.distance);
  }
  return (wanted + reach_of(query, radius)) * kUp;
}

void CorridorCheck::refuse_seen(bool seen) const {
  if (!corridor_ || !seen) return;
  throw UsageError(
      "the environment holds only points near a path, and seen space needs the whole scans: which "
      "beams passed where is not known without the points that they met. Convert without --near");
}

bool looks_stay_near(const StoreMetadata& store, double looked, MessageLog& log) {
  if (!store.near || store.near->within >= looked) return true;
  const double metre = metre_in_units_of(metres_of(store.unit));
  log.add(note("near-store",
               "the environment holds only points within " +
                   format_number(store.near->within / metre) +
                   " m of a path. So it is not checked whether the path leaves the scans, how high "
                   "above the ground the vehicle is, and whether anything was scanned below and "
                   "beside it",
               {{"within", store.near->within}}));
  return false;
}

}  // namespace clearway
