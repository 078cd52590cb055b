#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "clearway/query.hpp"
#include "core/cloud/packed_cloud.hpp"
#include "core/geometry/model_tree.hpp"
#include "core/page/pose_reach.hpp"
#include "core/sweep/field/model_field.hpp"
#include "core/sweep/sweep_ref.hpp"
#include "core/trajectory/motion_chords.hpp"
#include "core/trajectory/motion_tree.hpp"

namespace clearway {

/// The inverse query, answered for ranges of poses and boxes of environment points at once by
/// going down the motion tree with the tests of SweepRef.
class SweepFilter final : public PoseReach {
 public:
  /// All arguments outlive it. cloud: for the largest coordinates, which the rounding bound needs.
  /// threads: to build with.
  SweepFilter(const Query& query, const MotionTree& motion, const ModelTree& model,
              const ModelField& field, const PackedCloud& cloud, int threads = 1);

  const Query& query() const { return query_; }
  const SweepRef& ref() const { return ref_; }
  const MotionTree& motion() const override { return motion_; }
  const ModelTree& model() const { return model_; }
  std::uint64_t allocated_bytes() const { return chords_.allocated_bytes(); }

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

 private:
  struct Limits {
    double distance;  ///< nothing beyond matters
    bool accept;      ///< boxes as a whole
  };

  static bool narrow(const SweepRef& ref, const Box& box, std::span<const std::uint32_t> nodes,
                     Limits limits, std::vector<std::uint32_t>& out, SweepStatistics& statistics);
  static bool narrow_node(const SweepRef& ref, const PointBox& points, const Limits& limits,
                          std::uint32_t node, std::vector<std::uint32_t>& out,
                          SweepStatistics& statistics);
  SweepRef::Verdict test(const Vec3& e, const MotionNode& node, SweepStatistics& statistics,
                         double& squared_lower) const;
  bool touches_below(const Vec3& e, std::uint32_t node, SweepStatistics& statistics) const;
  void first_pose_below(const Vec3& e, std::uint32_t node, std::uint32_t& best,
                        SweepStatistics& statistics) const;

  const Query& query_;
  const MotionTree& motion_;
  const ModelTree& model_;
  SweepRef ref_;
  MotionChords chords_;  ///< with a clearance
  SweepRef for_plan_;    ///< makes no bricks: cells are too large to need them
};

}  // namespace clearway
