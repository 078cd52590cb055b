#include "search/shard/cell_work.hpp"

#include <algorithm>
#include <span>

#include "core/geometry/sweep_bounds.hpp"

namespace clearway {
namespace {

/// A node is split for a box while it moves more than this many times the box's half diagonal.
constexpr double kMotionPerBox = 1.0;

/// One walk down the store's tree.
class CellWork {
 public:
  CellWork(const PackedCloud& cloud, const Query& query, const QueryTrees& trees)
      : cloud_(cloud),
        motion_(trees.motion),
        model_(trees.model.ref()),
        distance_(std::max({query.radius, query.clearance, query.profile})),
        work_(cloud.cells().size()) {}

  std::vector<std::uint64_t> find() {
    if (cloud_.tree().empty() || motion_.nodes().empty() || model_.size == 0) return work_;
    const std::vector<std::uint32_t> root{0};
    descend(0, root);
    return std::move(work_);
  }

 private:
  void descend(std::uint32_t index, std::span<const std::uint32_t> nodes) {
    const TreeNode& node = cloud_.tree()[index];
    const Box box = position_box(cloud_.quantisation(), node.box);
    std::vector<std::uint32_t> near;
    for (const std::uint32_t pose_node : nodes) {
      narrow(centre_of(box), half_diagonal(box), pose_node, near);
    }
    if (near.empty()) return;
    if (node.right == 0) {
      work_[node.first_cell] = std::uint64_t{cloud_.cells()[node.first_cell].count} * near.size();
      return;
    }
    descend(index + 1, near);
    descend(node.right, near);
  }

  void narrow(const Vec3& centre, double rho, std::uint32_t index,
              std::vector<std::uint32_t>& near) const {
    const MotionNode& node = motion_.nodes()[index];
    const InversePose& back = motion_.inverse_pose(node.mid);
    const double ball = (distance_ + node.delta + rho) / back.least;
    if (!model_.any_within(back.apply(centre), ball * ball, [](const Vec3&) { return true; })) {
      return;
    }
    if (node.count == 1 || node.delta <= kMotionPerBox * rho) {
      near.push_back(index);
      return;
    }
    narrow(centre, rho, index + 1, near);
    narrow(centre, rho, node.later, near);
  }

  const PackedCloud& cloud_;
  const MotionTree& motion_;
  const ModelTreeRef model_;
  const double distance_;
  std::vector<std::uint64_t> work_;
};

}  // namespace

std::vector<std::uint64_t> cell_work(const PackedCloud& cloud, const Query& query,
                                     const QueryTrees& trees) {
  return CellWork(cloud, query, trees).find();
}

}  // namespace clearway
