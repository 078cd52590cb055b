#pragma once

#include "clearway/query.hpp"
#include "core/cloud/packed_cloud.hpp"
#include "core/geometry/model_tree.hpp"
#include "core/page/pose_reach.hpp"

namespace clearway {

/// Finds the poses that bring a model point within the radius of a box, by a ball search in the
/// model's tree at the middle pose of each node. Needs no field. Only for queries at poses.
class ModelReach final : public PoseReach {
 public:
  /// All arguments but the cloud must outlive this object; of the cloud no points are read.
  ModelReach(const Query& query, const MotionTree& motion, const ModelTree& model,
             const PackedCloud& cloud);

  const MotionTree& motion() const override { return motion_; }
  void narrow(const Box& box, std::span<const std::uint32_t> nodes,
              std::vector<std::uint32_t>& out) const override;

 private:
  bool may_reach(const MotionNode& node, const Vec3& centre, double rho) const;
  void narrow_node(const Vec3& centre, double rho, std::uint32_t index,
                   std::vector<std::uint32_t>& out) const;

  const MotionTree& motion_;
  const ModelTree& model_;
  double radius_;
  double rounding_;  ///< rounding of a test at one pose, metres
};

}  // namespace clearway
