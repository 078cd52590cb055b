#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "clearway/query.hpp"
#include "core/cloud/packed_cloud.hpp"
#include "core/geometry/model_tree.hpp"
#include "core/geometry/wide_tree.hpp"
#include "core/page/pose_reach.hpp"
#include "core/sweep/field/model_field.hpp"
#include "core/sweep/hit_runs.hpp"
#include "core/sweep/profile/profile_travel.hpp"
#include "core/sweep/sweep_ref.hpp"
#include "core/trajectory/motion_curves.hpp"
#include "core/trajectory/motion_floors.hpp"
#include "core/trajectory/motion_tree.hpp"

namespace clearway {

/// Answers the inverse query for ranges of poses and boxes of environment points at once, by
/// descending the motion tree with the tests of SweepRefOf.
template <typename Element>
class SweepFilterOf final : public PoseReach {
 public:
  /// All arguments must outlive this object. cloud: for the largest coordinates, which the rounding
  /// bound needs. threads: number of threads to build with.
  SweepFilterOf(const Query& query, const MotionTree& motion,
                const ModelTreeOf<StoredElement<Element>>& model, const ModelField& field,
                const PackedCloud& cloud, int threads = 1);

  const Query& query() const { return query_; }
  const SweepRefOf<Element>& ref() const { return ref_; }
  const MotionTree& motion() const override { return motion_; }
  const ModelTreeOf<StoredElement<Element>>& model() const { return model_; }
  /// Only with a profile.
  const ProfileTravel& travel() const { return travel_; }
  std::uint64_t allocated_bytes() const {
    return curves_.allocated_bytes() + floors_.allocated_bytes() + wide_.allocated_bytes() +
           travel_.allocated_bytes() + runs_.most_bytes();
  }

  /// Replaces `out` with those of `nodes` and the nodes below them that may touch a point of the
  /// box or, with a clearance, be the nearest to one; they are as fine as the box is small, and in
  /// the order of the poses if `nodes` are. Returns true, with only some of the nodes, if every
  /// point of the box collides and nothing else is asked.
  bool narrow(const Box& box, std::span<const std::uint32_t> nodes, std::vector<std::uint32_t>& out,
              SweepStatistics& statistics) const;

  /// Narrows nodes for the plan, which with a profile includes those that may be within its
  /// distance.
  void narrow(const Box& box, std::span<const std::uint32_t> nodes,
              std::vector<std::uint32_t>& out) const override;

  /// The halves of a node of more than one pose, in the order of their poses.
  std::array<std::uint32_t, 2> halves(std::uint32_t node) const {
    return {node + 1, motion_.nodes()[node].later};
  }

  /// Whether the model touches e at a pose of a node, or between poses on the way from one of them
  /// to the next. Does not look at the node itself, which was found open.
  bool touches_below(const Vec3& e, std::uint32_t node, SweepStatistics& statistics) const;

  /// Lowers `best` to the first pose of e (clearway/query.hpp) below a node, if that is less.
  /// Does not look at the node itself.
  void lower_first_pose(const Vec3& e, std::uint32_t node, std::uint32_t& best,
                        SweepStatistics& statistics) const;

  /// What tests cost, in look-ups of a point.
  static std::uint64_t cost_of(const SweepStatistics& tests);

  /// Joins nodes that narrow() left for a block into runs of poses, if one of the block's points
  /// has cost so much that it and its neighbours are better searched in runs. Leaves `runs` empty
  /// if it has not, or if runs cannot be searched, or not yet.
  void join_runs(std::uint64_t cost, std::span<const std::uint32_t> nodes,
                 std::vector<std::uint32_t>& runs) const;

  /// Whether the model touches e at a pose of nodes that join_runs() joined.
  bool touches_runs(const Vec3& e, std::span<const std::uint32_t> nodes,
                    SweepStatistics& statistics) const;
  /// The first pose of e, or kNoPose.
  std::uint32_t first_pose_of_runs(const Vec3& e, std::span<const std::uint32_t> nodes,
                                   SweepStatistics& statistics) const;

 private:
  /// How a descent goes on after it has visited a node.
  enum class Step {
    kEnd,     ///< all is known
    kPast,    ///< nothing more is to be found in the node
    kHalves,  ///< the halves of the node have to be visited
  };

  template <typename Visit>
  bool descend_in_order(std::span<const std::uint32_t> nodes, const Visit& visit) const;
  template <typename Visit>
  bool descend_nearer_first(std::uint32_t node, const Visit& visit) const;

  bool narrow(const SweepRefOf<Element>& ref, const Box& box, std::span<const std::uint32_t> nodes,
              double least_distance, bool accept, std::vector<std::uint32_t>& out,
              SweepStatistics& statistics) const;
  Step find_any_pose(const Vec3& e, std::uint32_t node, SweepStatistics& statistics,
                     double& squared_lower) const;
  Step find_first_pose(const Vec3& e, std::uint32_t node, std::uint32_t& best,
                       SweepStatistics& statistics) const;
  Step search_run(Step step, const Vec3& e, std::uint32_t node, bool any, std::uint32_t& end,
                  SweepStatistics& statistics) const;

  const Query& query_;
  const MotionTree& motion_;
  const ModelTreeOf<StoredElement<Element>>& model_;
  SweepRefOf<Element> ref_;
  MotionCurves curves_;                      ///< made only with a clearance
  MotionFloors floors_;                      ///< made only with a floor
  WideTreeOf<StoredElement<Element>> wide_;  ///< made only if ref_.wide is set
  ProfileTravel travel_;                     ///< made only with a profile
  HitRuns<Element> runs_;
  SweepRefOf<Element> for_plan_;  ///< makes no bricks, because cells are too large to need them
};

using SweepFilter = SweepFilterOf<Vec3>;

extern template class SweepFilterOf<Vec3>;
extern template class SweepFilterOf<Triangle>;
extern template class SweepFilterOf<SolidTriangle>;

}  // namespace clearway
