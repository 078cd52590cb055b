#pragma once

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
#include "core/sweep/sweep_ref.hpp"
#include "core/trajectory/motion_curves.hpp"
#include "core/trajectory/motion_tree.hpp"

namespace clearway {

/// The inverse query, answered for ranges of poses and boxes of environment points at once by
/// going down the motion tree with the tests of SweepRef.
template <typename Element>
class SweepFilterOf final : public PoseReach {
 public:
  /// All arguments outlive it. cloud: for the largest coordinates, which the rounding bound needs.
  /// threads: to build with.
  SweepFilterOf(const Query& query, const MotionTree& motion,
                const ModelTreeOf<StoredElement<Element>>& model, const ModelField& field,
                const PackedCloud& cloud, int threads = 1);

  const Query& query() const { return query_; }
  const SweepRefOf<Element>& ref() const { return ref_; }
  const MotionTree& motion() const override { return motion_; }
  const ModelTreeOf<StoredElement<Element>>& model() const { return model_; }
  std::uint64_t allocated_bytes() const {
    return curves_.allocated_bytes() + wide_.allocated_bytes() + runs_.most_bytes();
  }

  /// Of `nodes` and the nodes below them those that may touch a point of the box, or with a
  /// clearance be the nearest to one, as fine as the box is small; replaces `out`. In the order of
  /// the poses when `nodes` are. True, and only some of them, where every point of the box
  /// collides and nothing else is asked.
  bool narrow(const Box& box, std::span<const std::uint32_t> nodes, std::vector<std::uint32_t>& out,
              SweepStatistics& statistics) const;

  /// The same for the plan: with a profile also those that may be within its distance.
  void narrow(const Box& box, std::span<const std::uint32_t> nodes,
              std::vector<std::uint32_t>& out) const override;

  /// Whether the model touches e at a pose of `nodes`, or between poses on the way from one to the
  /// next.
  bool touches(const Vec3& e, std::span<const std::uint32_t> nodes,
               SweepStatistics& statistics) const;

  /// The first pose of e (clearway/query.hpp), or HitSet::kNever. `nodes` in the order of their
  /// poses: what narrow() left of all for a box around e.
  std::uint32_t first_pose(const Vec3& e, std::span<const std::uint32_t> nodes,
                           SweepStatistics& statistics) const;

  /// Joins nodes that narrow() left for a block into runs of poses, where one of the block's points
  /// took so many tests that its neighbours are better searched in runs. of_point: those tests.
  /// False, and no runs, where they are few, or where runs cannot be searched, or not yet.
  bool join_runs(const SweepStatistics& of_point, std::span<const std::uint32_t> nodes,
                 std::vector<std::uint32_t>& runs) const;

  /// As touches() and first_pose(), for nodes that join_runs() joined.
  bool touches_runs(const Vec3& e, std::span<const std::uint32_t> nodes,
                    SweepStatistics& statistics) const;
  std::uint32_t first_pose_of_runs(const Vec3& e, std::span<const std::uint32_t> nodes,
                                   SweepStatistics& statistics) const;

 private:
  struct Limits {
    double distance;  ///< nothing beyond matters
    bool accept;      ///< boxes as a whole
  };

  static bool narrow(const SweepRefOf<Element>& ref, const Box& box,
                     std::span<const std::uint32_t> nodes, Limits limits,
                     std::vector<std::uint32_t>& out, SweepStatistics& statistics);
  static bool narrow_node(const SweepRefOf<Element>& ref, const PointBox& points,
                          const Limits& limits, std::uint32_t node, std::vector<std::uint32_t>& out,
                          SweepStatistics& statistics);
  SweepVerdict test(const Vec3& e, const MotionNode& node, SweepStatistics& statistics,
                    double& squared_lower) const;
  bool touches_below(const Vec3& e, std::uint32_t node, SweepStatistics& statistics) const;
  void first_pose_below(const Vec3& e, std::uint32_t node, std::uint32_t& best,
                        SweepStatistics& statistics) const;

  const Query& query_;
  const MotionTree& motion_;
  const ModelTreeOf<StoredElement<Element>>& model_;
  SweepRefOf<Element> ref_;
  MotionCurves curves_;                      ///< with a clearance
  WideTreeOf<StoredElement<Element>> wide_;  ///< likewise
  HitRuns<Element> runs_;
  SweepRefOf<Element> for_plan_;  ///< makes no bricks: cells are too large to need them
};

using SweepFilter = SweepFilterOf<Vec3>;

extern template class SweepFilterOf<Vec3>;
extern template class SweepFilterOf<Triangle>;
extern template class SweepFilterOf<SolidTriangle>;

}  // namespace clearway
