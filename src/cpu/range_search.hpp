#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "clearway/query.hpp"
#include "core/cloud/block_positions.hpp"
#include "core/cloud/packed_cloud.hpp"
#include "core/geometry/rigid.hpp"
#include "core/page/page.hpp"
#include "core/trajectory/motion_tree.hpp"
#include "cpu/environment_tree.hpp"
#include "cpu/model_spheres.hpp"

namespace clearway {

/// The model and the trajectory as range searches need them, the same for every page. The query and
/// the tree of its poses must outlive it.
struct SpheresOnPath {
  SpheresOnPath(const Query& query, const MotionTree& motion);

  std::uint64_t allocated_bytes() const {
    return spheres.allocated_bytes() + bounds.capacity() * sizeof(PoseBound);
  }

  const Query& query;
  const MotionTree& motion;
  ModelSpheres spheres;
  std::vector<PoseBound> bounds;  ///< one for each pose
  std::size_t levels;             ///< the most levels of a descent through spheres and poses
};

/// Coherent fixed-range searches in the cells of a page: a descent through poses, model and a
/// cell's implicit tree at once. A range of poses and a sphere of the model inherit from their
/// parents the part of the cell within reach, so that whatever is far is dismissed for many
/// searches together. The predicate decides what is left. For one thread. Filters:
/// docs/design/numerics.md, "Spheres of the model". Source: Schauer et al. (the paper), section 3.1
/// (kd-CD-simple).
class RangeSearch {
 public:
  /// Both arguments must outlive this object. It allocates its memory.
  RangeSearch(const PackedCloud& cloud, const SpheresOnPath& path);

  /// Finds the points of a cell of the page that collide: sets hits[block] to their bits.
  void search(const PageRef& page, std::uint32_t index, std::span<std::uint64_t> hits);

  /// Number of pairs of pose and model point that no filter dismissed for a cell.
  std::uint64_t tested_searches() const { return tested_searches_; }

  /// Bytes of memory that one of these takes.
  static std::uint64_t most_bytes(const PackedCloud& cloud, const SpheresOnPath& path);

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
    std::uint32_t node;  ///< of the motion tree
    const MotionNode& poses;
    const ModelSphere& sphere;
    Vec3 centre;           ///< the sphere's centre at the middle pose
    double reach_squared;  ///< points whose d2 to the centre is above this are not touched
    bool at_leaves() const { return poses.count == 1 && sphere.children == 0; }
  };

  SearchTask make_task(std::uint32_t node, const ModelSphere& sphere) const;
  template <typename Visit>
  void for_each_half(const SearchTask& task, Visit visit);

  void search_nodes(const SearchTask& task, std::size_t begin, std::size_t end);
  void add_candidate(const SearchTask& task, const Candidate& candidate);
  bool dismiss_or_take(const SearchTask& task, const Candidate& candidate);
  void take_all(const EnvironmentNode& node);
  void gather(const SearchTask& task, std::size_t begin, std::size_t end);
  void gather_node(const SearchTask& task, const Candidate& candidate);
  void gather_block(const SearchTask& task, std::uint32_t block);
  void flush(const SearchTask& task);

  void search_points(const SearchTask& task, Points points);
  void refine_points(const SearchTask& task, Points points);
  void test_points(const SearchTask& task, Points points);

  /// The points of a block that are to be searched and have not collided yet.
  std::uint64_t open_points(std::uint32_t block) const {
    return page_.searched(index_, block) & ~hits_[block];
  }
  /// True only if all points of a node have collided or are not searched.
  bool is_done(const EnvironmentNode& node) const {
    if (node.is_block()) return open_points(node.first_block) == 0;
    return inner_done_[EnvironmentTree::inner_in_cell(node)] != 0;
  }
  bool is_done(std::uint32_t point) const {
    return (hits_[point / kBlockPoints] >> (point % kBlockPoints) & 1) != 0;
  }
  void mark(std::uint32_t point) {
    hits_[point / kBlockPoints] |= std::uint64_t{1} << (point % kBlockPoints);
  }

  Candidate candidate_of(const EnvironmentNode& node) const {
    return {node, environment_.box(node, inner_boxes_)};
  }
  /// Calls visit(child) for each child of an inner node, which is done if all of them are then.
  template <typename Visit>
  void for_each_child(const EnvironmentNode& node, const Visit& visit) {
    bool done = true;
    for (const EnvironmentNode& child : environment_.children(node)) {
      visit(candidate_of(child));
      done = done && is_done(child);
    }
    if (done) inner_done_[EnvironmentTree::inner_in_cell(node)] = 1;
  }
  Columns positions_of(std::uint32_t block);
  void put_point(std::size_t to, Columns from, std::size_t i, std::uint32_t point) {
    x_[to] = from.x[i];
    y_[to] = from.y[i];
    z_[to] = from.z[i];
    points_[to] = point;
  }
  Columns columns(Points points) const {
    return {x_.data() + points.begin, y_.data() + points.begin, z_.data() + points.begin};
  }

  const PackedCloud& cloud_;
  const EnvironmentTree environment_;
  const SpheresOnPath& path_;
  const Query& query_;
  double radius_squared_;

  // What follows, up to the stacks, belongs to the cell that is searched.
  PageRef page_{};
  std::uint32_t index_ = 0, cell_ = 0;
  std::array<PackedChunk<std::int32_t>, 3> chunks_;
  std::span<std::uint64_t> hits_;
  std::vector<BlockBox> inner_boxes_;
  std::vector<std::uint8_t> inner_done_;
  std::vector<std::uint8_t> decoded_;  ///< whether positions_ holds the points of a block
  std::vector<BlockPositions> positions_;

  std::vector<Candidate> candidates_;  ///< stack of candidates
  std::uint64_t candidate_points_ = 0;
  std::vector<double> x_, y_, z_;  ///< stack of points in columns
  std::vector<std::uint32_t> points_;
  std::size_t gathered_ = 0;  ///< number of points at the bottom of the stack
  std::vector<double> squared_;
  std::vector<std::uint8_t> hit_;
  std::vector<double> moved_x_, moved_y_, moved_z_;
  std::uint64_t tested_searches_ = 0;
};

}  // namespace clearway
