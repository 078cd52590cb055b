#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/query/clearance_set.hpp"
#include "core/sweep/sweep_filter.hpp"

namespace clearway {

/// The exact clearance of one environment point after the other: branch and bound over the motion
/// tree. A node is given up only when its bound proves every computed d2 of its poses to be above
/// the best so far, so that ties reach the lowest pose (docs/design/numerics.md, "Clearance").
/// Points that are neighbours should follow each other: the answer for one is tried first for the
/// next.
class ClearanceSearch {
 public:
  /// The filter, whose query asks for clearances, outlives it.
  explicit ClearanceSearch(const SweepFilter& filter);

  /// Over the poses of `nodes`; not found where there is no d2 below the squared clearance asked
  /// for.
  Clearance nearest(const Vec3& e, std::span<const std::uint32_t> nodes,
                    SweepStatistics& statistics);

 private:
  /// A node with the field's bounds of the point pulled back by its mid.
  struct Look {
    std::uint32_t node;
    std::uint32_t near;
    double squared_lower;
  };

  Look look(std::uint32_t node);
  bool is_given_up(const Look& look) const;
  void visit(const Look& look);
  void visit_halves(std::uint32_t node);
  bool search_poses(const MotionNode& node);
  void search_pose(std::uint32_t pose, std::uint32_t near);
  void offer(std::uint32_t pose, const Vec3& m);
  void set_best(double squared, std::uint32_t pose);

  const SweepFilter& filter_;
  const MotionTree& motion_;
  const double limit_;  ///< the square of the clearance asked for
  SweepStatistics* statistics_ = nullptr;
  Vec3 e_{};
  Clearance best_;
  double reach_ = 0;  ///< a pose at which no model point is nearer than this has only larger d2
  std::uint32_t guess_pose_ = 0;
  Vec3 guess_{};  ///< the model point of the last answer
  std::vector<Look> looks_;
  std::vector<Vec3> pulled_back_;
  std::vector<Vec3> near_points_;
};

}  // namespace clearway
