#include "search/checks/check_floor.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "clearway/error.hpp"
#include "core/cloud/scan_points.hpp"
#include "core/geometry/point_box.hpp"
#include "core/geometry/predicate.hpp"
#include "core/util/format.hpp"
#include "search/checks/question.hpp"

namespace clearway {
namespace {

constexpr std::size_t kLooks = 16;
/// Height of the part of a body in which the ground is looked for, metres.
constexpr double kLowest = 0.3;
/// Steps in which a floor is proposed, metres.
constexpr double kFloorStep = 0.05;
/// Points that are tested at a pose: more would hold up the search.
constexpr std::uint64_t kMostTested = 20'000;

std::string who(const MovingBody& body) {
  return body.name.empty() ? "" : body_words(body.name) + ": ";
}

/// Whether the model is within the radius of x, in the model's frame.
bool is_near(const ModelIndex& index, const Vec3& x, double radius) {
  const double squared = radius * radius;
  if (index.triangles.size() > 0) {
    return index.solids.ref().contains(x) ||
           squared_distance(x, index.triangles.element(index.triangles.nearest(x).element)) <
               squared;
  }
  return squared_distance(x, index.points.element(index.points.nearest(x).element)) < squared;
}

/// Warns where the floor leaves out much of the body.
void check_height(const MovingBody& body, double radius, LengthUnit unit, double metre,
                  MessageLog& log) {
  constexpr double kHigh = 0.5, kShare = 1.0 / 3;  // metres; of the body's height
  if (body.model.vertices.empty()) return;
  const Box box = box_of(body.model.vertices);
  const std::string what = body.name.empty() ? "the model" : "the body";
  const std::string range = what + " reaches from " + format_digits(box.lo.z, 6) + " to " +
                            format_digits(box.hi.z, 6) + " " + unit_name(unit) + " of its frame";
  if (*body.floor >= box.hi.z + radius) {
    throw UsageError(who(body) + "with a floor of " + format_digits(*body.floor, 6) + " " +
                     unit_name(unit) + " nothing can collide: " + range);
  }
  const double cut = *body.floor - box.lo.z;
  if (cut <= std::max(kHigh * metre, kShare * (box.hi.z - box.lo.z))) return;
  Message message =
      warning("floor-high",
              who(body) + "the floor is " + length_text(cut, unit) + " above the lowest part of " +
                  what + ", and nothing below it is judged: " + range +
                  ". A floor is a height of that frame, whose z = 0 need not be the ground",
              {{"height", cut}, {"lowest", box.lo.z}});
  message.body = body.name;
  log.add(std::move(message));
}

}  // namespace

void check_floor(const MovingBody& body, double radius, LengthUnit unit, double metre,
                 MessageLog& log) {
  if (!body.floor) return;
  check_height(body, radius, unit, metre, log);
  if (body.poses.empty()) return;
  const auto leans = static_cast<std::size_t>(std::ranges::count_if(body.poses, [](const Pose& p) {
    const double* r = p.rotation;
    return !(r[8] > std::sqrt(0.5 * squared_length(r[2], r[5], r[8])));
  }));
  if (2 * leans <= body.poses.size()) return;
  Message message = warning(
      "floor-axis",
      who(body) + "at " + format_count(leans) + " of " + counted(body.poses.size(), "pose") +
          " the z axis is more than 45 degrees from the scan's up, so that a floor, which is a "
          "height along that axis, does not leave out the ground. Check --up, or the poses",
      {{"poses", static_cast<double>(leans)}});
  message.body = body.name;
  log.add(std::move(message));
}

void look_for_ground(const PackedCloud& cloud, LengthUnit unit, double metre,
                     const QueryParameters& query, double more, const MovingBody& body,
                     const ModelIndex& index, MessageLog& log) {
  if (body.floor || query.ignores_points() || body.poses.empty() || cloud.tree().empty()) return;
  Box under = index.box();
  const double bottom = under.lo.z;
  under.lo.z = bottom - query.radius;
  under.hi.z = std::min(under.hi.z, bottom + kLowest * metre);
  const ScanPoints points(cloud);
  const std::size_t looks = std::min(kLooks, body.poses.size());
  std::size_t with_ground = 0;
  double highest = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < looks; ++i) {
    const Pose& pose = body.poses[(2 * i + 1) * body.poses.size() / (2 * looks)];
    std::uint64_t tested = 0;
    bool found = false;
    try {
      points.visit(under, pose, [&](const Vec3& x, auto...) {
        if (is_near(index, x, query.radius)) {
          found = true;
          highest = std::max(highest, x.z);
        }
        return ++tested < kMostTested;
      });
    } catch (const InputError&) {
      return;
    }
    with_ground += found;
  }
  if (2 * with_ground <= looks) return;
  const double step = kFloorStep * metre;
  const double floor = (std::floor((highest + more) / step) + 1) * step;
  const std::string length = length_text(kLowest * metre, unit);
  Message message = note(
      "ground-collides",
      who(body) + "at " + std::to_string(with_ground) + " of " + counted(looks, "pose") +
          " that were looked at, points under the " + (body.name.empty() ? "model" : "body") +
          " are within the radius, in its lowest " + length +
          ", as the ground is under wheels: they will collide. If that is not the question, " +
          (body.name.empty()
               ? "--floor " + format_digits(floor, 6)
               : "\"floor\": " + format_digits(floor, 6) + " in the vehicle's file, or --floor") +
          " leaves them out: it is " + length_text(floor - bottom, unit) +
          " above the lowest part of the " + (body.name.empty() ? "model" : "body"),
      {{"floor", floor}, {"poses", static_cast<double>(with_ground)}});
  message.body = body.name;
  log.add(std::move(message));
}

}  // namespace clearway
