#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/model_field.hpp"
#include "core/model_tree.hpp"
#include "core/motion_tree.hpp"
#include "core/packed_cloud.hpp"
#include "core/question.hpp"

namespace clearway {

/// How often the steps of a descent were taken.
struct SweepStatistics {
  std::uint64_t node_tests = 0;     ///< field look-ups for cells, runs of blocks and blocks
  std::uint64_t point_tests = 0;    ///< field look-ups for points
  std::uint64_t exact_tests = 0;    ///< ball searches in the model
  std::uint64_t points_tested = 0;  ///< points that no block dismissed
  void add(const SweepStatistics& other);
};

/// Whether the least d2 below the clearance alone says which points collide.
inline bool hits_follow_from_clearance(const Question& question) {
  return question.clearance >= question.radius && !question.first_pose;
}

/// The inverse question: e collides with pose i exactly when the model is closer than the radius to
/// e pulled back by pose i. Answers it for ranges of poses and boxes of environment points at once,
/// with the bounds of docs/numerics.md ("Sweep"); what they leave open goes to the predicate.
class SweepFilter {
 public:
  /// All arguments outlive it. cloud: for the largest coordinates, which the rounding bound needs.
  SweepFilter(const Question& question, const MotionTree& motion, const ModelTree& model,
              const ModelField& field, const PackedCloud& cloud);

  const Question& question() const { return question_; }
  const MotionTree& motion() const { return motion_; }
  const ModelTree& model() const { return model_; }
  const ModelField& field() const { return field_; }
  double rounding() const { return rounding_; }  ///< metres, of a test of one point at one pose

  /// The first pose equal to `pose` without another in between. Only with a clearance.
  std::uint32_t first_equal_pose(std::uint32_t pose) const { return first_equal_pose_[pose]; }

  /// Of `nodes` and the nodes below them those that may touch a point of the box, or with a
  /// clearance be the nearest to one, as fine as the box is small; replaces `out`. In the order of
  /// the poses when `nodes` are.
  void narrow(const Box& box, std::span<const std::uint32_t> nodes, std::vector<std::uint32_t>& out,
              SweepStatistics& statistics) const;

  /// Whether the model touches e at a pose of `nodes`, or between poses on the way from one to the
  /// next.
  bool touches(const Vec3& e, std::span<const std::uint32_t> nodes,
               SweepStatistics& statistics) const;

  /// The smallest pose of `nodes` at or after which the model touches e, or HitSet::kNever. `nodes`
  /// in the order of their poses.
  std::uint32_t first_pose(const Vec3& e, std::span<const std::uint32_t> nodes,
                           SweepStatistics& statistics) const;

 private:
  enum class Verdict { kDismissed, kHitAtMid, kOpen };

  bool moves_on(const MotionNode& node) const;
  double clearance_limit(const Vec3& centre, double rho, std::span<const std::uint32_t> nodes,
                         SweepStatistics& statistics) const;
  void narrow_node(const Vec3& centre, double rho, double limit, std::uint32_t node,
                   std::vector<std::uint32_t>& out, SweepStatistics& statistics) const;
  Verdict test(const Vec3& e, const MotionNode& node, SweepStatistics& statistics,
               double& squared_lower) const;
  bool touches_below(const Vec3& e, std::uint32_t node, SweepStatistics& statistics) const;
  void first_pose_below(const Vec3& e, std::uint32_t node, std::uint32_t& best,
                        SweepStatistics& statistics) const;

  const Question& question_;
  const MotionTree& motion_;
  const ModelTree& model_;
  const ModelField& field_;
  double rounding_;
  std::vector<std::uint32_t> first_equal_pose_;
};

}  // namespace clearway
