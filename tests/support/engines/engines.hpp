#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "clearway/query.hpp"
#include "core/page/page_pool.hpp"
#include "core/query/search_result.hpp"
#include "core/sweep/sweep_filter.hpp"
#include "support/memory_cloud.hpp"

namespace clearway {

/// An engine under test. Every one runs through the same cases, against brute force.
struct Engine {
  std::string name;
  SearchResult (*run)(const PackedCloud& cloud, const Query& query, int threads);
  bool between_poses;  ///< whether it answers such queries
  bool clearances;     ///< likewise, and profiles
  bool tolerance;      ///< likewise
  bool surfaces;       ///< likewise
};

std::span<const Engine> engines();

/// Makes a sweep engine, of points, of triangles and of solids; what it is given outlives it.
struct MakeSweep {
  template <typename Element>
  using Of = std::function<std::unique_ptr<PageEngine>(
      const SweepFilterOf<Element>& filter, const PackedCloud& cloud, const SlotLayout& layout)>;

  /// make: a generic function.
  template <typename Make>
  MakeSweep(Make make) : points(make), triangles(make), solids(make) {}  // NOLINT(*-explicit-*)

  Of<Vec3> points;
  Of<Triangle> triangles;
  Of<SolidTriangle> solids;
};

/// Plans the query, and runs it in an engine of as many slots and cells a page as the cloud's
/// size makes them, so that all occur. whole_field: for an engine that cannot make parts of it.
SearchResult run_sweep(const PackedCloud& cloud, const Query& query, int threads,
                       const MakeSweep& make, bool whole_field = false);

/// From now on engines() are these.
void test_only(std::vector<Engine> engines);

/// Runs every engine on the points, packed in several ways, as a set and with first poses, at
/// poses and, with a model of points, between them, and checks the answers against brute force;
/// likewise clearances below and above the radius, where an engine has them. Returns the number of
/// points that collide at a pose.
std::uint64_t check_engines(std::span<const Quantum> points, const Quantisation& quantisation,
                            const Query& query);

/// The same of points with classes, some of which the query ignores, by class or box. Returns the
/// number of points that collide at a pose and are not ignored.
std::uint64_t check_engines(std::span<const Quantum> points, std::span<const std::uint8_t> classes,
                            const Quantisation& quantisation, const Query& query);

/// Only between poses, in one packing. Returns every point's first pose, or HitSet::kNever.
std::vector<std::uint32_t> check_between_poses(std::span<const Quantum> points,
                                               const Quantisation& quantisation, Query query);

/// The same as check_engines above for one way of packing them.
std::uint64_t check_engines(std::span<const Quantum> points, const Quantisation& quantisation,
                            const Query& query, const MemoryCloudOptions& packing);

/// The clearances that the query asks for. Returns how many there are.
std::uint64_t check_clearances(std::span<const Quantum> points, const Quantisation& quantisation,
                               const Query& query);

/// The profile that the query asks for, in several packings. Returns how many poses have a point.
std::uint64_t check_profile(std::span<const Quantum> points, const Quantisation& quantisation,
                            const Query& query);

}  // namespace clearway
