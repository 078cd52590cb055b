#include "support/engines/brute_force.hpp"

#include <algorithm>
#include <limits>

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
std::vector<Element> elements_of(const Query& query);

template <>
std::vector<Vec3> elements_of(const Query& query) {
  return query.model.vertices;
}

template <>
std::vector<Triangle> elements_of(const Query& query) {
  std::vector<Triangle> triangles;
  for (const auto& [a, b, c] : query.model.triangles) {
    triangles.emplace_back(query.model.vertices.at(a), query.model.vertices.at(b),
                           query.model.vertices.at(c));
  }
  return triangles;
}

template <typename Element>
std::vector<Element> moved(const std::vector<Element>& elements, const Pose& pose) {
  std::vector<Element> moved;
  moved.reserve(elements.size());
  for (const Element& element : elements) moved.push_back(transform(pose, element));
  return moved;
}

template <typename Element>
bool touched(const Vec3& e, const std::vector<Element>& moved, double radius) {
  for (const Element& element : moved) {
    if (collides(e, element, radius)) return true;
  }
  return false;
}

/// Whether the pair of a pose and e counts: e is not below the floor there.
bool counts(const Query& query, std::size_t pose, const Vec3& e) {
  return !query.floor || pulled_back(query.poses[pose], e).z >= *query.floor;
}

/// Whether e collides on the way from a pose to the next, both included.
bool touched_on_way(const Vec3& e, const std::vector<Vec3>& from, const std::vector<Vec3>& to,
                    double radius) {
  for (std::size_t m = 0; m < to.size(); ++m) {
    if (collides(e, from[m], radius) || collides_inside(e, from[m], to[m], radius) ||
        collides(e, to[m], radius)) {
      return true;
    }
  }
  return false;
}

template <typename Element>
std::vector<std::uint32_t> first_poses(std::span<const Vec3> environment, const Query& query) {
  std::vector<std::uint32_t> first(environment.size(), kNoPose);
  const std::vector<Element> model = elements_of<Element>(query);
  const bool worth_threads = environment.size() * model.size() > kPairsWorthThreads;
  for (std::uint32_t i = 0; i < query.poses.size(); ++i) {
    const std::vector<Element> at_pose = moved(model, query.poses[i]);
#pragma omp parallel for schedule(static) if (worth_threads)
    for (std::size_t e = 0; e < environment.size(); ++e) {
      if (first[e] == kNoPose && touched(environment[e], at_pose, query.radius) &&
          counts(query, i, environment[e])) {
        first[e] = i;
      }
    }
  }
  return first;
}

std::vector<std::uint32_t> first_poses_of_ways(std::span<const Vec3> environment,
                                               const Query& query) {
  std::vector<std::uint32_t> first(environment.size(), kNoPose);
  const bool worth_threads = environment.size() * query.model.vertices.size() > kPairsWorthThreads;
  for (std::uint32_t i = 0; i < query.poses.size(); ++i) {
    const bool moves_on = i + 1 < query.poses.size();
    const std::vector<Vec3> from = moved(query.model.vertices, query.poses[i]);
    const std::vector<Vec3> to =
        moves_on ? moved(query.model.vertices, query.poses[i + 1]) : std::vector<Vec3>();
#pragma omp parallel for schedule(static) if (worth_threads)
    for (std::size_t e = 0; e < environment.size(); ++e) {
      if (first[e] != kNoPose) continue;
      const Vec3& point = environment[e];
      if (!counts(query, i, point) && !(moves_on && counts(query, i + 1, point))) continue;
      if (moves_on ? touched_on_way(point, from, to, query.radius)
                   : touched(point, from, query.radius)) {
        first[e] = i;
      }
    }
  }
  return first;
}

template <typename Element>
std::vector<Clearance> clearances(std::span<const Vec3> environment, const Query& query) {
  std::vector<Clearance> least(environment.size());
  const std::vector<Element> model = elements_of<Element>(query);
  for (std::uint32_t i = 0; i < query.poses.size(); ++i) {
    for (const Element& element : moved(model, query.poses[i])) {
      for (std::size_t e = 0; e < environment.size(); ++e) {
        const double squared = squared_distance(environment[e], element);
        if (squared < least[e].squared && counts(query, i, environment[e])) {
          least[e] = {squared, i};
        }
      }
    }
  }
  return least;
}

/// The triangles of each solid, and the lattice over all of them.
struct SolidTriangles {
  std::vector<std::vector<Triangle>> solids;
  SolidLattice lattice;

  explicit SolidTriangles(const Query& query) {
    std::vector<Vec3> corners;
    const std::vector<Triangle> triangles = elements_of<Triangle>(query);
    for (std::size_t i = 0; i < query.model.solid_of.size(); ++i) {
      const std::uint32_t solid = query.model.solid_of[i];
      if (solid == kNoSolid) continue;
      if (solid >= solids.size()) solids.resize(solid + std::size_t{1});
      solids[solid].push_back(triangles[i]);
      corners.insert(corners.end(), {triangles[i].a, triangles[i].b, triangles[i].c});
    }
    if (!corners.empty()) lattice = SolidLattice(box_of(corners));
  }

  bool contains(const std::vector<Triangle>& solid, const Vec3& x) const {
    if (!lattice.has_in_box(x)) return false;
    int sum = 0;
    for (const Triangle& t : solid) sum += winding_above(lattice, lattice.place_of(x), t);
    return sum != 0;
  }

  /// The signed square v of docs/design/solids.md if e lies inside a solid; otherwise 0.
  double inside_square(const Vec3& e, const Pose& pose) const {
    double deepest = 0;
    for (const std::vector<Triangle>& solid : solids) {
      if (!contains(solid, pulled_back(pose, e))) continue;
      double least = std::numeric_limits<double>::infinity();
      for (const Triangle& t : solid) {
        least = std::min(least, squared_distance(e, transform(pose, t)));
      }
      deepest = std::max(deepest, least);
    }
    return 0 - deepest;
  }

  bool contains(const Vec3& e, const Pose& pose) const {
    return std::ranges::any_of(
        solids, [&](const auto& solid) { return contains(solid, pulled_back(pose, e)); });
  }
};

/// The first poses of a solid's surface, or earlier poses at which a solid contains the point.
std::vector<std::uint32_t> first_poses_of_solids(std::span<const Vec3> environment,
                                                 const Query& query) {
  std::vector<std::uint32_t> first = first_poses<Triangle>(environment, query);
  const SolidTriangles solids(query);
  for (std::size_t e = 0; e < environment.size(); ++e) {
    for (std::uint32_t i = 0; i < std::min<std::size_t>(first[e], query.poses.size()); ++i) {
      if (counts(query, i, environment[e]) && solids.contains(environment[e], query.poses[i])) {
        first[e] = i;
      }
    }
  }
  return first;
}

std::vector<Clearance> clearances_of_solids(std::span<const Vec3> environment, const Query& query) {
  std::vector<Clearance> least = clearances<Triangle>(environment, query);
  const SolidTriangles solids(query);
  for (std::size_t e = 0; e < environment.size(); ++e) {
    for (std::uint32_t i = 0; i < query.poses.size(); ++i) {
      if (!counts(query, i, environment[e])) continue;
      const double square = solids.inside_square(environment[e], query.poses[i]);
      if (square < 0 && square < least[e].squared) least[e] = {square, i};
    }
  }
  return least;
}

template <typename Element>
std::vector<NearestPoint> profile_of(std::span<const Vec3> environment, const Query& query) {
  const double limit = rounded_product(query.profile, query.profile);
  const std::vector<Element> model = elements_of<Element>(query);
  std::vector<NearestPoint> profile(query.poses.size());
#pragma omp parallel for schedule(dynamic, 1)
  for (std::size_t i = 0; i < query.poses.size(); ++i) {
    NearestPoint best{std::numeric_limits<double>::infinity(), ~std::uint64_t{0}};
    const std::vector<Element> at_pose = moved(model, query.poses[i]);
    for (std::size_t e = 0; e < environment.size(); ++e) {
      for (const Element& element : at_pose) {
        const double squared = squared_distance(environment[e], element);
        if (squared < limit && squared < best.squared && counts(query, i, environment[e])) {
          best = {squared, e};
        }
      }
    }
    profile[i] = best;
  }
  return profile;
}

std::vector<NearestPoint> profile_of_solids(std::span<const Vec3> environment, const Query& query) {
  std::vector<NearestPoint> profile = profile_of<Triangle>(environment, query);
  const SolidTriangles solids(query);
  for (std::size_t i = 0; i < query.poses.size(); ++i) {
    for (std::size_t e = 0; e < environment.size(); ++e) {
      if (!counts(query, i, environment[e])) continue;
      const double square = solids.inside_square(environment[e], query.poses[i]);
      if (square < 0 && square < profile[i].squared) profile[i] = {square, e};
    }
  }
  return profile;
}

}  // namespace

std::vector<std::uint32_t> brute_force_first_poses(std::span<const Vec3> environment,
                                                   const Query& query) {
  if (query.between_poses) return first_poses_of_ways(environment, query);
  if (query.model.is_solid()) return first_poses_of_solids(environment, query);
  return query.model.is_surface() ? first_poses<Triangle>(environment, query)
                                  : first_poses<Vec3>(environment, query);
}

std::vector<Clearance> brute_force_clearances(std::span<const Vec3> environment,
                                              const Query& query) {
  if (query.model.is_solid()) return clearances_of_solids(environment, query);
  return query.model.is_surface() ? clearances<Triangle>(environment, query)
                                  : clearances<Vec3>(environment, query);
}

std::vector<NearestPoint> brute_force_profile(std::span<const Vec3> environment,
                                              const Query& query) {
  if (query.model.is_solid()) return profile_of_solids(environment, query);
  return query.model.is_surface() ? profile_of<Triangle>(environment, query)
                                  : profile_of<Vec3>(environment, query);
}

}  // namespace clearway
