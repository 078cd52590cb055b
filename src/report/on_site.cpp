#include "report/on_site.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <optional>
#include <span>
#include <utility>
#include <variant>
#include <vector>

#include "clearway/follow.hpp"
#include "core/geometry/axes.hpp"
#include "core/trajectory/chainage.hpp"

namespace clearway {
namespace {

/// The box of a body with x ahead, y to the left and z up.
Box turned_box(const Box& box, const ModelAxes& axes) {
  const Vec3 a = turned(box.lo, axes), b = turned(box.hi, axes);
  Box out{a, a};
  out.extend(b);
  return out;
}

void write_mount(JsonText& json, const BodyMount& mount) {
  if (const auto* station = std::get_if<BodyStation>(&mount)) {
    if (station->at != 0) json.field("at", station->at);
  } else if (const auto* pivots = std::get_if<BodyPivots>(&mount)) {
    json.key("pivots").begin('[').value(pivots->front).value(pivots->rear).end(']');
  } else if (const auto* towed = std::get_if<BodyTowed>(&mount)) {
    json.field("towed_by", towed->by).field("coupled_at", towed->at);
    json.field("hitch", towed->hitch).field("axle", towed->axle);
  }
}

void write_bodies(JsonText& json, const ReportFacts& facts, const ModelAxes& axes) {
  const std::vector<BodyMount>& mounts = facts.options.mounts;
  json.key("bodies").begin('[');
  for (std::size_t i = 0; i < facts.bodies.size(); ++i) {
    const Box box = turned_box(facts.bodies[i].box, axes);
    json.begin('{').field("name", facts.bodies[i].name).field("lo", box.lo).field("hi", box.hi);
    if (i < mounts.size()) write_mount(json, mounts[i]);
    json.end('}');
  }
  json.end(']');
}

/// Degrees clockwise from the environment's y axis, from 0 to below 360; none for a direction that
/// is within a degree of straight up or down.
std::optional<double> bearing_of(const Vec3& direction) {
  constexpr double kDegrees = 180 / std::numbers::pi;
  const double flat = std::hypot(direction.x, direction.y);
  if (!(flat > std::sin(1 / kDegrees) * std::hypot(flat, direction.z))) return std::nullopt;
  const double bearing = std::atan2(direction.x, direction.y) * kDegrees;
  return bearing < 0 ? bearing + 360 : bearing;
}

void write_place(JsonText& json, const char* name, const ReportFacts& facts, std::size_t pose,
                 const ModelAxes& axes) {
  const Pose& at = facts.poses[pose];
  const double* r = at.rotation;
  const std::vector<double>& stations = facts.options.labels.station;
  const double start = facts.options.conflicts.chainage_start;
  json.key(name).begin('{').field("pose", std::uint64_t{pose});
  json.field("chainage", start + (pose > 0 ? facts.searched.path : 0));
  if (!stations.empty()) json.field("station", std::optional(stations[pose]));
  json.field("position", Vec3{at.translation[0], at.translation[1], at.translation[2]});
  const std::optional<Vec3> travel = travel_direction(facts.poses, pose);
  const int line = line_of(axes.forward);
  const double sign = is_negative(axes.forward) ? -1 : 1;
  const Vec3 ahead{sign * r[line], sign * r[3 + line], sign * r[6 + line]};
  json.field("bearing", travel ? bearing_of(*travel) : std::nullopt);
  json.field("front_bearing", bearing_of(ahead)).end('}');
}

/// A bend of the path: the radius of the circle through three places of it, seen from above.
struct Bend {
  double radius = std::numeric_limits<double>::infinity();
  std::size_t pose = 0;
};

double radius_through(const Pose& a, const Pose& b, const Pose& c) {
  const auto way = [](const Pose& from, const Pose& to) {
    return std::pair(to.translation[0] - from.translation[0],
                     to.translation[1] - from.translation[1]);
  };
  const auto [abx, aby] = way(a, b);
  const auto [bcx, bcy] = way(b, c);
  const auto [acx, acy] = way(a, c);
  const double doubled_area = std::abs(abx * bcy - aby * bcx);
  return std::hypot(abx, aby) * std::hypot(bcx, bcy) * std::hypot(acx, acy) / (2 * doubled_area);
}

/// The tightest bend, by places that are at least `arm` apart along the path. The noise of recorded
/// positions hardly matters over the length of a vehicle, and nothing shorter is a bend for it.
Bend tightest_bend(std::span<const Pose> poses, double arm) {
  const std::vector<double> chainage = chainage_of(poses);
  Bend best;
  std::size_t before = 0, after = 0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    while (before + 1 < i && chainage[i] - chainage[before + 1] >= arm) ++before;
    while (after < poses.size() && chainage[after] - chainage[i] < arm) ++after;
    if (after == poses.size()) break;
    if (chainage[i] - chainage[before] < arm) continue;
    const double radius = radius_through(poses[before], poses[i], poses[after]);
    if (radius < best.radius) best = {radius, i};
  }
  return best;
}

/// Writes the tightest bend; null where the path is straight or too short to tell.
void write_bend(JsonText& json, const ReportFacts& facts, const ModelAxes& axes) {
  constexpr double kStraight = 5000;  // metres
  const double metre = 1 / facts.store.metres_per_unit();
  double longest = 0;
  for (const DrawnBody& body : facts.bodies) {
    const Box box = turned_box(body.box, axes);
    longest = std::max(longest, box.hi.x - box.lo.x);
  }
  const Bend bend = tightest_bend(facts.poses, std::max(metre, longest / 4));
  json.key("bend");
  if (!(bend.radius < kStraight * metre)) {
    json.raw("null");
    return;
  }
  const double at = path_length(facts.poses.first(bend.pose + 1));
  json.begin('{').field("radius", bend.radius);
  json.field("chainage", facts.options.conflicts.chainage_start + at).end('}');
}

}  // namespace

void write_on_site(JsonText& json, const ReportFacts& facts) {
  const ModelAxes axes{facts.options.conflicts.forward, facts.options.conflicts.up};
  json.key("on_site").begin('{');
  write_bodies(json, facts, axes);
  if (!facts.poses.empty()) {
    write_place(json, "first", facts, 0, axes);
    write_place(json, "last", facts, facts.poses.size() - 1, axes);
    write_bend(json, facts, axes);
  }
  json.end('}');
}

}  // namespace clearway
