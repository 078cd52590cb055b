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
#include "support/engines/answer_sets.hpp"
#include "support/memory_cloud.hpp"

namespace clearway {

/// An engine under test. Every engine runs through the same cases, against brute force.
struct Engine {
  std::string name;
  SearchResult (*run)(const PackedCloud& cloud, const Query& query, int threads);
  /// Whether it finds more than which points collide with a model of points at its poses
  bool finds_all;
  /// Searches within a tolerance; null where an engine cannot
  SearchResult (*run_within)(const PackedCloud& cloud, const Query& query, int threads,
                             double tolerance) = nullptr;
};

std::span<const Engine> engines();

/// Makes a sweep engine of points, of triangles or of solids. What the engine is given outlives it.
struct MakeSweep {
  template <typename Element>
  using Of = std::function<std::unique_ptr<PageEngine>(
      const SweepFilterOf<Element>& filter, const PackedCloud& cloud, const SlotLayout& layout)>;

  /// make: a function that takes filters of any element.
  template <typename Make>
  MakeSweep(Make make) : points(make), triangles(make), solids(make) {}  // NOLINT(*-explicit-*)

  Of<Vec3> points;
  Of<Triangle> triangles;
  Of<SolidTriangle> solids;
};

/// Runs an engine that can search within a tolerance without one.
template <auto run_within>
SearchResult run_exactly(const PackedCloud& cloud, const Query& query, int threads) {
  return run_within(cloud, query, threads, 0);
}

/// Plans the query, and runs it in an engine whose numbers of slots and of cells a page follow from
/// the cloud's size, so that all of them occur. whole_field: for an engine that cannot make parts
/// of the field. tolerance: metres; 0: the search is exact.
SearchResult run_sweep(const PackedCloud& cloud, const Query& query, int threads, double tolerance,
                       const MakeSweep& make, bool whole_field = false);

/// Makes engines() return these from now on.
void test_only(std::vector<Engine> engines);

/// Runs every engine on the points, packed in several ways, and checks the answers against brute
/// force: the set at poses, and where an engine finds all, with first poses, between poses for a
/// model of points, and clearances below and above the radius. Returns the
/// number of points that collide at a pose.
std::uint64_t check_engines(std::span<const Quantum> points, const Quantisation& quantisation,
                            const Query& query);

/// Checks every engine, as the other check_engines do, on points with classes of which the query
/// ignores some, by class or box. Returns the number of points that collide at a pose and are not
/// ignored.
std::uint64_t check_engines(std::span<const Quantum> points, std::span<const std::uint8_t> classes,
                            const Quantisation& quantisation, const Query& query);

/// Checks every engine between poses alone, with the points packed in one way. Returns every
/// point's first pose, or kNoPose.
std::vector<std::uint32_t> check_between_poses(std::span<const Quantum> points,
                                               const Quantisation& quantisation, Query query);

/// Checks every engine, as the other check_engines do, on points that are packed in one way.
std::uint64_t check_engines(std::span<const Quantum> points, const Quantisation& quantisation,
                            const Query& query, const MemoryCloudOptions& packing);

/// Checks the clearances that the query asks for. Returns how many there are.
std::uint64_t check_clearances(std::span<const Quantum> points, const Quantisation& quantisation,
                               const Query& query);

/// Checks the profile that the query asks for, with the points packed in several ways. Returns how
/// many poses have a point.
std::uint64_t check_profile(std::span<const Quantum> points, const Quantisation& quantisation,
                            const Query& query);

}  // namespace clearway
