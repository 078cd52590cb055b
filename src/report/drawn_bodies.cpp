#include "report/drawn_bodies.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/geometry/inside.hpp"
#include "core/geometry/point_box.hpp"
#include "core/geometry/predicate.hpp"
#include "core/geometry/solid_parts.hpp"
#include "core/geometry/triangle.hpp"
#include "core/query/body_numbers.hpp"
#include "io/models/sample_mesh.hpp"
#include "report/shown_poses.hpp"

namespace clearway {
namespace {

/// With more bodies than this, fewer poses are shown.
constexpr std::size_t kBodiesOfAllPoses = 8;

/// Appends at most `most` points of a model, evenly spaced in their order along the curve.
void append_points(std::span<const Vec3> model, std::size_t most, std::uint8_t tag,
                   const PageLattice& lattice, std::vector<PagePoint>& out) {
  std::vector<PagePoint> all;
  all.reserve(model.size());
  for (const Vec3& m : model) all.push_back(page_point(lattice, m, tag));
  sort_along_curve(all);
  const std::size_t kept = std::min(most, all.size());
  for (std::size_t i = 0; i < kept; ++i) out.push_back(all[i * all.size() / kept]);
}

/// Points on a body's surface for the page to show.
std::vector<Vec3> surface_points(const DrawnBody& body, std::size_t most) {
  return drawn_points({body.model.vertices, body.model.triangles}, static_cast<double>(most));
}

/// The square of the greatest depth of a place in the solids of a body at a pose; 0 outside.
double squared_depth(const DrawnBody& body, const Vec3& place, const Pose& pose) {
  if (!body.model.is_solid()) return 0;
  const SolidParts solids(body.model);
  const SolidPartsRef ref = solids.ref();
  double deepest = 0;
  const auto look = [&](std::uint32_t solid) {
    const SolidPart& part = ref.parts[solid];
    double least = std::numeric_limits<double>::infinity();
    for (const Triangle& t : std::span(ref.triangles + part.first, part.count)) {
      least = std::min(least, squared_distance(place, transform(pose, t)));
    }
    deepest = std::max(deepest, least);
    return false;
  };
  ref.any_with(
      pulled_back(pose, place), [](std::uint32_t) { return false; }, look);
  return deepest;
}

}  // namespace

double DrawnBody::distance_to(const Vec3& place, std::uint32_t pose) const {
  double least = std::numeric_limits<double>::infinity();
  const Pose* there = pose_at(pose);
  if (there == nullptr) return least;
  if (const double inside = squared_depth(*this, place, *there); inside > 0) {
    return -std::sqrt(inside);
  }
  const auto note = [&](const auto& part) {
    least = std::min(least, squared_distance(place, transform(*there, part)));
  };
  const std::vector<Vec3>& corners = model.vertices;
  for (const auto& [a, b, c] : model.triangles) note(Triangle{corners[a], corners[b], corners[c]});
  if (!model.is_surface()) std::ranges::for_each(corners, note);
  return std::sqrt(least);
}

std::vector<DrawnBody> drawn_bodies(const Model& model, const std::vector<Pose>& poses,
                                    const ReportOptions& options) {
  std::vector<DrawnBody> bodies;
  for (const MovingBody& body : moving_bodies(model, poses, options.bodies)) {
    bodies.push_back({body, box_of(body.model.vertices)});
  }
  return bodies;
}

Box box_around(std::span<const DrawnBody> bodies) {
  Box box = bodies.front().box;
  for (const DrawnBody& body : bodies) box = box.united(body.box);
  return box;
}

std::vector<PagePoint> points_of_bodies(std::span<DrawnBody> bodies, const PageLattice& lattice,
                                        std::size_t most) {
  const std::size_t of_each = most / bodies.size();
  std::vector<PagePoint> out;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    DrawnBody& body = bodies[i];
    const std::size_t before = out.size();
    std::vector<Vec3> surface;
    if (body.model.is_surface()) surface = surface_points(body, of_each);
    append_points(body.model.is_surface() ? surface : body.model.vertices, of_each,
                  static_cast<std::uint8_t>(i), lattice, out);
    body.shown_points = out.size() - before;
  }
  return out;
}

std::size_t most_shown_poses(std::size_t bodies) {
  return std::min(kMostShownPoses, kBodiesOfAllPoses * kMostShownPoses / bodies);
}

}  // namespace clearway
