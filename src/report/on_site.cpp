#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <optional>
#include <span>
#include <variant>
#include <vector>

#include "clearway/follow.hpp"
#include "core/describe/labels.hpp"
#include "core/geometry/axes.hpp"
#include "core/trajectory/chainage.hpp"
#include "report/report_facts.hpp"

namespace clearway {
namespace {

/// The box of a body with x ahead, y to the left and z up.
Box turned_box(const Box& box, const ModelAxes& axes) {
  const Vec3 a = turned(box.lo, axes), b = turned(box.hi, axes);
  Box out{a, a};
  out.extend(b);
  return out;
}

void add_mount(Json& json, const BodyMount& mount) {
  if (const auto* station = std::get_if<BodyStation>(&mount)) {
    if (station->at != 0) json["at"] = station->at;
  } else if (const auto* pivots = std::get_if<BodyPivots>(&mount)) {
    json["pivots"] = Json::array({pivots->front, pivots->rear});
  } else if (const auto* towed = std::get_if<BodyTowed>(&mount)) {
    json["towed_by"] = towed->by;
    json["coupled_at"] = towed->at;
    json["hitch"] = towed->hitch;
    json["axle"] = towed->axle;
  }
}

Json json_of_bodies_on_site(const ReportFacts& facts, const ModelAxes& axes) {
  const std::vector<BodyMount>& mounts = facts.options.mounts;
  Json out = Json::array();
  for (std::size_t i = 0; i < facts.bodies.size(); ++i) {
    const Box box = turned_box(facts.bodies[i].box, axes);
    Json& body =
        out.emplace_back(Json{{"name", facts.bodies[i].name}, {"lo", box.lo}, {"hi", box.hi}});
    if (i < mounts.size()) add_mount(body, mounts[i]);
  }
  return out;
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

Json json_of_place(const ReportFacts& facts, std::size_t pose, const ModelAxes& axes) {
  const Pose& at = facts.poses[pose];
  const double* r = at.rotation;
  const double start = facts.options.conflicts.chainage_start;
  Json out{{"pose", pose}, {"chainage", start + (pose > 0 ? facts.searched.path : 0)}};
  for_each_label({LabelPlace::kBesideChainage}, [&](const auto& label) {
    const auto& values = label.of(facts.options.labels);
    if (!values.empty()) out[label.key] = values[pose];
  });
  out["position"] = at.position();
  const std::optional<Vec3> travel = travel_direction(facts.poses, pose);
  const int line = line_of(axes.forward);
  const double sign = is_negative(axes.forward) ? -1 : 1;
  const Vec3 ahead{sign * r[line], sign * r[3 + line], sign * r[6 + line]};
  out["bearing"] = or_null(travel ? bearing_of(*travel) : std::nullopt);
  out["front_bearing"] = or_null(bearing_of(ahead));
  return out;
}

/// A bend of the path: the radius of the circle through three places of it, seen from above.
struct Bend {
  double radius = std::numeric_limits<double>::infinity();
  std::size_t pose = 0;
  double over = 0;  ///< length of path between the outer two of the places
};

double radius_through(const Pose& a, const Pose& b, const Pose& c) {
  const Vec3 ab = b.position() - a.position(), bc = c.position() - b.position();
  const Vec3 ac = c.position() - a.position();
  const double doubled_area = std::abs(ab.x * bc.y - ab.y * bc.x);
  return std::hypot(ab.x, ab.y) * std::hypot(bc.x, bc.y) * std::hypot(ac.x, ac.y) /
         (2 * doubled_area);
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
    if (radius < best.radius) best = {radius, i, chainage[after] - chainage[before]};
  }
  return best;
}

/// The tightest bend; null where the path is straight or too short.
Json json_of_bend(const ReportFacts& facts, const ModelAxes& axes) {
  constexpr double kStraight = 5000;  // metres
  const double metre = 1 / facts.store.metres_per_unit();
  double longest = 0;
  for (const DrawnBody& body : facts.bodies) {
    const int line = line_of(axes.forward);
    longest = std::max(longest, body.box.hi[line] - body.box.lo[line]);
  }
  const Bend bend = tightest_bend(facts.poses, std::max(metre, longest / 4));
  if (!(bend.radius < kStraight * metre)) return {};
  const double at = path_length(facts.poses.first(bend.pose + 1));
  return {{"radius", bend.radius},
          {"over", bend.over},
          {"chainage", facts.options.conflicts.chainage_start + at}};
}

}  // namespace

Json on_site(const ReportFacts& facts) {
  const ModelAxes axes{facts.options.conflicts.forward, facts.options.conflicts.up};
  Json out{{"bodies", json_of_bodies_on_site(facts, axes)}};
  if (facts.poses.empty()) return out;
  out["first"] = json_of_place(facts, 0, axes);
  out["last"] = json_of_place(facts, facts.poses.size() - 1, axes);
  out["bend"] = json_of_bend(facts, axes);
  return out;
}

}  // namespace clearway
