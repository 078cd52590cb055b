#include "findings/path_rows.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "clearway/error.hpp"
#include "clearway/stations.hpp"
#include "core/geometry/predicate.hpp"
#include "core/util/format.hpp"

namespace clearway {
namespace {

/// Metres: a rest of the path that is shorter belongs to the stretch before it, because sums of
/// steps are not exact.
constexpr double kRest = 1e-6;

/// Metres by which distances are taken for shorter than they are computed, because of roundings.
constexpr double kRounding = 1e-6;

std::size_t count_of(double length, double every) {
  if (!(every > 0) || !std::isfinite(every)) {
    throw UsageError("stretches of " + format_number(every) +
                     " m; expected a finite length above 0");
  }
  const double count = std::max(1.0, std::ceil((length - kRest) / every));
  if (count <= static_cast<double>(kMostStationRows)) return static_cast<std::size_t>(count);
  throw UsageError("stretches of " + format_number(every) + " m cut a path of " +
                   format_brief(length) + " m into more than " + format_count(kMostStationRows) +
                   "; expected at least " +
                   format_brief(length / static_cast<double>(kMostStationRows)) + " m");
}

}  // namespace

PathRows::PathRows(std::vector<double> chainage, double every)
    : chainage_(std::move(chainage)), every_(every) {
  const std::size_t count = count_of(chainage_.empty() ? 0 : chainage_.back(), every);
  if (chainage_.empty()) return;
  size_ = count;
  of_pose_.reserve(chainage_.size());
  for (const double at : chainage_) {
    const double row = std::min(std::floor(at / every), static_cast<double>(size_ - 1));
    of_pose_.push_back(static_cast<std::uint32_t>(row));
  }
}

BoxReach::BoxReach(std::span<const MovingBody> bodies, std::span<const Box> boxes,
                   const PathRows& rows, bool ways)
    : rows_(rows), ways_(ways) {
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    Track track{.poses = bodies[b].poses, .box = boxes[b]};
    track.path_pose.assign(bodies[b].path_pose.begin(), bodies[b].path_pose.end());
    for (std::size_t k = track.path_pose.size(); k < track.poses.size(); ++k) {
      track.path_pose.push_back(static_cast<std::uint32_t>(k));
    }
    follow(track);
    tracks_.push_back(std::move(track));
  }
}

/// Fills in what follows from the poses and the box of a body.
void BoxReach::follow(Track& track) const {
  const std::size_t poses = track.poses.size();
  track.way.resize(poses);
  track.slack.resize(poses);
  for (std::size_t k = 0; k < poses; ++k) {
    const Pose& pose = track.poses[k];
    const Pose& before = track.poses[k > 0 ? k - 1 : 0];
    double moves = 0;
    for (unsigned c = 0; c < 8; ++c) {
      const Vec3 corner = transform(pose, track.box.corner(c));
      track.radius = std::max(track.radius, length(corner - pose.position()));
      moves = std::max(moves, length(corner - transform(before, track.box.corner(c))));
    }
    if (k == 0) continue;
    track.way[k] = track.way[k - 1] + length(pose.position() - before.position());
    if (!ways_) continue;
    // What is near on a way is near to a model point, which is at most half of `moves` away from
    // where it is at the nearer of the two poses.
    track.slack[k - 1] = std::max(track.slack[k - 1], moves / 2);
    track.slack[k] = moves / 2;
  }
  for (const double slack : track.slack) track.most_slack = std::max(track.most_slack, slack);
  track.first_of_row.assign(rows_.size() + 1, poses);
  for (std::size_t k = poses; k-- > 0;) track.first_of_row[rows_.of_pose(track.path_pose[k])] = k;
  for (std::size_t row = rows_.size(); row-- > 0;) {
    track.first_of_row[row] = std::min(track.first_of_row[row], track.first_of_row[row + 1]);
  }
}

/// Whether the box at a pose, with every side moved outwards by the distance, holds the place. The
/// distances are measured in the environment, whatever the pose scales.
bool BoxReach::is_near(const Track& track, std::size_t pose, const Vec3& place,
                       double distance) const {
  const Pose& at = track.poses[pose];
  const double* r = at.rotation;
  const Vec3 columns[3] = {{r[0], r[3], r[6]}, {r[1], r[4], r[7]}, {r[2], r[5], r[8]}};
  const Vec3 from = place - transform(at, track.box.centre());
  const double reach = distance + track.slack[pose] + kRounding;
  for (int k = 0; k < 3; ++k) {
    Vec3 normal = cross(columns[(k + 1) % 3], columns[(k + 2) % 3]);
    const double size = length(normal);
    if (!(size > 0)) continue;
    normal = (1 / size) * normal;
    const double half = std::abs(dot(normal, columns[k])) * (track.box.hi[k] - track.box.lo[k]) / 2;
    if (std::abs(dot(normal, from)) > half + reach) return false;
  }
  return true;
}

/// The next pose at which the box may be near. A place cannot be near before the body has moved as
/// far as the place is out of its reach.
std::size_t BoxReach::next_near(const Track& track, std::size_t pose, const Vec3& place,
                                double distance) const {
  const double apart = length(place - track.poses[pose].position()) - track.radius - distance -
                       track.most_slack - kRounding;
  if (!(apart > 0)) return pose + 1;
  const double way = track.way[pose] + apart * (1 - 1e-9);
  const auto next = std::lower_bound(track.way.begin() + static_cast<std::ptrdiff_t>(pose) + 1,
                                     track.way.end(), way);
  return static_cast<std::size_t>(next - track.way.begin());
}

void BoxReach::add_near(const Vec3& place, double distance, std::size_t from, std::size_t to,
                        RowSet& set) const {
  const std::uint32_t beside = ways_ ? 1 : 0;
  // The first pose of a row, or the one before it, whose way leads into the row.
  const auto first_into = [&](const Track& track, std::size_t row) {
    const std::size_t pose = track.first_of_row[row];
    return pose - std::min<std::size_t>(pose, beside);
  };
  for (const Track& track : tracks_) {
    std::size_t row = set.next_outside(from);
    std::size_t pose = row < to ? first_into(track, row) : track.poses.size();
    while (pose < track.poses.size()) {
      const std::uint32_t at = track.path_pose[pose];
      const std::size_t first = rows_.of_pose(at - std::min(at, beside));
      const std::size_t last = rows_.of_pose(std::min<std::size_t>(at + beside, rows_.poses() - 1));
      row = set.next_outside(std::max(first, from));
      if (row >= to) break;
      if (row > last) {
        pose = std::max(pose + 1, first_into(track, row));
      } else if (is_near(track, pose, place, distance)) {
        for (; row <= last && row < to; ++row) set.add(row);
      } else {
        pose = next_near(track, pose, place, distance);
      }
    }
  }
}

}  // namespace clearway
