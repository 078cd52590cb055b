#pragma once

#include <cstdint>
#include <vector>

#include "clearway/query.hpp"
#include "core/geometry/floor.hpp"
#include "core/query/pose_journal.hpp"
#include "cpu/cell_search.hpp"
#include "cpu/environment_tree.hpp"
#include "cpu/kdtree_engine.hpp"
#include "cpu/model_spheres.hpp"
#include "cpu/resolved_points.hpp"

namespace clearway {

/// The coherent fixed-range searches of one thread: a descent through poses, model and environment
/// at once. A range of poses and a sphere of the model inherit from their parents the part of the
/// environment within reach, so that whatever is far is dismissed for many searches together. The
/// predicate decides what is left. Filters: docs/design/numerics.md, "Spheres of the model".
class RangeSearch {
 public:
  /// All arguments must outlive this object. It allocates its caches: about 3 MiB, and a little for
  /// the largest leaf of the model. marks: receives every point that is marked.
  RangeSearch(const EnvironmentTree& environment, ResolvedPoints& resolved,
              const ModelSpheres& model, const Query& query, PoseMarkLog& marks);

  /// Searches for every model point below `sphere` at every pose of `poses`. Throws InputError for
  /// a damaged cell.
  void search(const PoseTree& poses, const ModelSphere& sphere);

  /// Number of pairs of pose and model point that no filter dismissed.
  std::uint64_t tested_searches() const { return tested_searches_; }
  std::uint64_t allocated_bytes() const;

 private:
  struct Candidate {
    EnvironmentNode node;
    Box box;
  };

  /// A range of the stack of points.
  struct Points {
    std::size_t begin;
    std::size_t count;
  };

  /// A task of the descent: one sphere of the model over a range of poses.
  struct SearchTask {
    const PoseNode& poses;
    const ModelSphere& sphere;
    Vec3 centre;           ///< the sphere's centre at the reference pose
    double reach_squared;  ///< points whose d2 to the centre is above this are not touched
    bool hit_is_final;     ///< true if no pose of the range precedes the reference pose
    bool at_leaves() const { return poses.count == 1 && sphere.children == 0; }
  };

  SearchTask make_task(const PoseNode& poses, const ModelSphere& sphere) const;
  template <typename Visit>
  void for_each_half(const SearchTask& task, Visit visit);

  void search_nodes(const SearchTask& task, std::size_t begin, std::size_t end);
  void add_candidate(const SearchTask& task, const Candidate& candidate);
  bool dismiss_or_take(const SearchTask& task, const Candidate& candidate);
  void gather(const SearchTask& task, std::size_t begin, std::size_t end);
  void gather_node(const SearchTask& task, const Candidate& candidate);
  void gather_block(const SearchTask& task, const EnvironmentNode& block);
  void flush(const SearchTask& task);

  void search_points(const SearchTask& task, Points points);
  void refine_points(const SearchTask& task, Points points);
  void test_points(const SearchTask& task, Points points);
  void mark(std::uint64_t slot, std::uint32_t pose) {
    resolved_.mark(slot, pose);
    marks_.add(slot / kBlockPoints, std::uint64_t{1} << slot % kBlockPoints, pose);
  }
  void mark_node(const EnvironmentNode& node, std::uint32_t pose) {
    resolved_.mark_node(
        node, pose, [&](std::uint64_t word, std::uint64_t bits) { marks_.add(word, bits, pose); });
  }
  /// Whether the pair of point i and a pose counts.
  bool counts(Columns from, std::size_t i, std::uint32_t pose) const {
    return !query_.floor ||
           is_above_floor(query_.poses[pose], {from.x[i], from.y[i], from.z[i]}, *query_.floor);
  }
  void put_point(std::size_t to, Columns from, std::size_t i, std::uint64_t slot) {
    x_[to] = from.x[i];
    y_[to] = from.y[i];
    z_[to] = from.z[i];
    slots_[to] = slot;
  }

  Columns columns(Points points) const {
    return {x_.data() + points.begin, y_.data() + points.begin, z_.data() + points.begin};
  }

  const EnvironmentTree& environment_;
  ResolvedPoints& resolved_;
  const ModelSpheres& model_;
  const Query& query_;
  PoseMarkLog& marks_;
  double radius_squared_;
  const PoseTree* pose_tree_ = nullptr;

  BlockCache cache_;
  std::vector<Candidate> candidates_;  ///< stack of candidates
  std::uint64_t candidate_points_ = 0;
  std::vector<double> x_, y_, z_;  ///< stack of points in columns
  std::vector<std::uint64_t> slots_;
  std::size_t gathered_ = 0;  ///< number of points at the bottom of the stack
  std::vector<double> squared_;
  std::vector<std::uint8_t> hit_;
  std::vector<double> moved_x_, moved_y_, moved_z_;
  /// Moved points at the next pose; only between poses
  std::vector<double> next_x_, next_y_, next_z_;
  std::uint64_t tested_searches_ = 0;
};

}  // namespace clearway
