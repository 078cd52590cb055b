#include "core/page/model_reach.hpp"

#include "core/geometry/sweep_bounds.hpp"

namespace clearway {
namespace {

/// Motion of a node in half diagonals of a box up to which the node is not split for the box.
constexpr double kMotionPerBox = 1.0;

}  // namespace

ModelReach::ModelReach(const Query& query, const MotionTree& motion, const ModelTree& model,
                       const PackedCloud& cloud)
    : motion_(motion),
      model_(model),
      radius_(query.radius),
      rounding_(motion.rounding(largest_coordinate(cloud) + query.radius) + 1e-150) {}

void ModelReach::narrow(const Box& box, std::span<const std::uint32_t> nodes,
                        std::vector<std::uint32_t>& out) const {
  out.clear();
  const Vec3 centre = box.centre();
  const double rho = half_diagonal(box);
  for (const std::uint32_t node : nodes) narrow_node(centre, rho, node, out);
}

/// Whether a point within rho of `centre` may be in reach at a pose of the node. Bounds:
/// docs/design/numerics.md ("Sweep"), with the model's points in place of the field.
bool ModelReach::may_reach(const MotionNode& node, const Vec3& centre, double rho) const {
  const InversePose& back = motion_.inverse_pose(node.mid);
  const double reach = radius_ + node.delta + rho + rounding_;
  const double ball = reach / back.least * kRoundedUp;
  return model_.ref().any_within(back.apply(centre), ball * ball * kRoundedUp,
                                 [](const Vec3&) { return true; });
}

void ModelReach::narrow_node(const Vec3& centre, double rho, std::uint32_t index,
                             std::vector<std::uint32_t>& out) const {
  const MotionNode& node = motion_.nodes()[index];
  if (!may_reach(node, centre, rho)) return;
  if (node.count == 1 || node.delta <= kMotionPerBox * rho) {
    out.push_back(index);
    return;
  }
  narrow_node(centre, rho, index + 1, out);
  narrow_node(centre, rho, node.later, out);
}

}  // namespace clearway
