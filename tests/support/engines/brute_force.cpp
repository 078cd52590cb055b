#include "support/engines/brute_force.hpp"

#include <algorithm>
#include <limits>
#include <type_traits>

#include "core/geometry/inside.hpp"
#include "core/geometry/point_box.hpp"
#include "core/geometry/predicate.hpp"
#include "core/geometry/triangle.hpp"
#include "core/query/search_result.hpp"

namespace clearway {
namespace {

constexpr std::size_t kPairsWorthThreads = 1'000'000;

/// The elements that the model consists of: points or triangles.
template <typename Element>
std::vector<Element> elements_of(const Model& model) {
  if constexpr (std::is_same_v<Element, Vec3>) {
    return model.vertices;
  } else {
    std::vector<Triangle> triangles;
    for (const auto& [a, b, c] : model.triangles) {
      triangles.emplace_back(model.vertices.at(a), model.vertices.at(b), model.vertices.at(c));
    }
    return triangles;
  }
}

/// The model of a query: its elements, and the lattice in which the winding of solids is decided.
template <typename Element>
struct Body {
  explicit Body(const Query& asked) : query(asked), elements(elements_of<Element>(asked.model)) {
    std::vector<Vec3> corners;
    if constexpr (std::is_same_v<Element, Triangle>) {
      for (std::size_t i = 0; i < query.model.solid_of.size(); ++i) {
        if (query.model.solid_of[i] == kNoSolid) continue;
        corners.insert(corners.end(), {elements[i].a, elements[i].b, elements[i].c});
      }
    }
    if (!corners.empty()) lattice = SolidLattice(box_of(corners));
  }

  const Query& query;
  std::vector<Element> elements;
  SolidLattice lattice;
};

/// A model at a pose.
template <typename Element>
struct AtPose {
  AtPose(const Body<Element>& of, const Pose& at) : body(of), pose(at) {
    for (const Element& element : body.elements) moved.push_back(transform(pose, element));
  }

  /// Whether the pair of the pose and e counts: e is not below the floor there.
  bool counts(const Vec3& e) const {
    return !body.query.floor || pulled_back(pose, e).z >= *body.query.floor;
  }

  /// Whether e is touched, or lies inside a solid.
  bool touches(const Vec3& e) const {
    return std::ranges::any_of(
               moved,
               [&](const Element& element) { return collides(e, element, body.query.radius); }) ||
           !solids_around(e).empty();
  }

  /// Whether e is touched on the way to the next pose, both included, and counts at either.
  bool touches_on_way(const AtPose& next, const Vec3& e) const {
    if (!counts(e) && !next.counts(e)) return false;
    if constexpr (std::is_same_v<Element, Vec3>) {
      for (std::size_t m = 0; m < moved.size(); ++m) {
        if (collides(e, moved[m], body.query.radius) ||
            collides_inside(e, moved[m], next.moved[m], body.query.radius) ||
            collides(e, next.moved[m], body.query.radius)) {
          return true;
        }
      }
    }
    return false;
  }

  /// The least d2 to an element; inside solids the signed square v of docs/design/model.md, which
  /// is below 0.
  double squared(const Vec3& e) const {
    double least = std::numeric_limits<double>::infinity(), deepest = 0;
    for (const Element& element : moved) least = std::min(least, squared_distance(e, element));
    for (const std::uint32_t solid : solids_around(e)) {
      double depth = std::numeric_limits<double>::infinity();
      for (std::size_t i = 0; i < moved.size(); ++i) {
        if (body.query.model.solid_of[i] == solid) {
          depth = std::min(depth, squared_distance(e, moved[i]));
        }
      }
      deepest = std::max(deepest, depth);
    }
    return deepest > 0 ? -deepest : least;
  }

  /// The numbers of the solids that contain e.
  std::vector<std::uint32_t> solids_around(const Vec3& e) const {
    std::vector<std::uint32_t> around;
    if constexpr (std::is_same_v<Element, Triangle>) {
      if (!body.query.model.is_solid()) return around;
      const Vec3 x = pulled_back(pose, e);
      if (!body.lattice.has_in_box(x)) return around;
      std::vector<int> winding(body.query.model.solid_count());
      for (std::size_t i = 0; i < moved.size(); ++i) {
        const std::uint32_t solid = body.query.model.solid_of[i];
        if (solid == kNoSolid) continue;
        winding[solid] += winding_above(body.lattice, body.lattice.place_of(x), body.elements[i]);
      }
      for (std::uint32_t solid = 0; solid < winding.size(); ++solid) {
        if (winding[solid] != 0) around.push_back(solid);
      }
    }
    return around;
  }

  const Body<Element>& body;
  const Pose& pose;
  std::vector<Element> moved;
};

/// Calls visit(e) for every point of the environment, on all cores where that is worth it.
template <typename Visit>
void for_points(std::span<const Vec3> environment, std::size_t elements, const Visit& visit) {
  const bool worth_threads = environment.size() * elements > kPairsWorthThreads;
#pragma omp parallel for schedule(static) if (worth_threads)
  for (std::size_t e = 0; e < environment.size(); ++e) visit(e);
}

template <typename Element>
std::vector<std::uint32_t> first_poses(std::span<const Vec3> environment, const Query& query) {
  std::vector<std::uint32_t> first(environment.size(), kNoPose);
  const Body<Element> body(query);
  for (std::uint32_t i = 0; i < query.poses.size(); ++i) {
    const AtPose<Element> at(body, query.poses[i]);
    const bool moves_on = query.between_poses && i + 1 < query.poses.size();
    const AtPose<Element> next(body, query.poses[moves_on ? i + 1 : i]);
    for_points(environment, body.elements.size(), [&](std::size_t e) {
      const Vec3& point = environment[e];
      if (first[e] == kNoPose &&
          (moves_on ? at.touches_on_way(next, point) : at.touches(point) && at.counts(point))) {
        first[e] = i;
      }
    });
  }
  return first;
}

template <typename Element>
std::vector<Clearance> clearances(std::span<const Vec3> environment, const Query& query) {
  std::vector<Clearance> least(environment.size());
  const Body<Element> body(query);
  for (std::uint32_t i = 0; i < query.poses.size(); ++i) {
    const AtPose<Element> at(body, query.poses[i]);
    for_points(environment, body.elements.size(), [&](std::size_t e) {
      const double squared = at.squared(environment[e]);
      if (squared < least[e].squared && at.counts(environment[e])) least[e] = {squared, i};
    });
  }
  return least;
}

template <typename Element>
std::vector<NearestPoint> profile(std::span<const Vec3> environment, const Query& query) {
  const double limit = rounded_product(query.profile, query.profile);
  const NearestPoint none{std::numeric_limits<double>::infinity(), ~std::uint64_t{0}};
  std::vector<NearestPoint> nearest(query.poses.size(), none);
  const Body<Element> body(query);
#pragma omp parallel for schedule(dynamic, 1)
  for (std::size_t i = 0; i < query.poses.size(); ++i) {
    const AtPose<Element> at(body, query.poses[i]);
    for (std::size_t e = 0; e < environment.size(); ++e) {
      const double squared = at.squared(environment[e]);
      const bool is_best = squared < limit && squared < nearest[i].squared;
      if (is_best && at.counts(environment[e])) nearest[i] = {squared, e};
    }
  }
  return nearest;
}

}  // namespace

std::vector<std::uint32_t> brute_force_first_poses(std::span<const Vec3> environment,
                                                   const Query& query) {
  return query.model.is_surface() ? first_poses<Triangle>(environment, query)
                                  : first_poses<Vec3>(environment, query);
}

std::vector<Clearance> brute_force_clearances(std::span<const Vec3> environment,
                                              const Query& query) {
  return query.model.is_surface() ? clearances<Triangle>(environment, query)
                                  : clearances<Vec3>(environment, query);
}

std::vector<NearestPoint> brute_force_profile(std::span<const Vec3> environment,
                                              const Query& query) {
  return query.model.is_surface() ? profile<Triangle>(environment, query)
                                  : profile<Vec3>(environment, query);
}

}  // namespace clearway
