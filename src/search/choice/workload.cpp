#include "search/choice/workload.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/geometry/point_box.hpp"
#include "core/trajectory/chainage.hpp"

namespace clearway {
namespace {

constexpr std::size_t kSampledPoses = 16;

/// Counts the points of the blocks whose centre is in the model's box at a pose.
class NearPoints {
 public:
  NearPoints(const PackedCloud& cloud, const Box& model, const Pose& pose)
      : cloud_(cloud), model_(model), reach_(moved(model, pose)), pose_(pose) {
    if (!cloud.tree().empty()) descend(0);
  }

  double count() const { return count_; }

 private:
  void descend(std::uint32_t index) {
    const TreeNode& node = cloud_.tree()[index];
    if (!reach_.meets(position_box(cloud_.quantisation(), node.box))) return;
    if (node.right == 0) {
      look_at(node.first_cell);
      return;
    }
    descend(index + 1);
    descend(node.right);
  }

  void look_at(std::uint32_t index) {
    const Cell& cell = cloud_.cells()[index];
    const auto blocks = static_cast<std::uint32_t>(divide_up(cell.count, kBlockPoints));
    const std::size_t first = std::size_t{index} * cloud_.blocks_per_cell();
    for (std::uint32_t block = 0; block < blocks; ++block) {
      const QuantumBox box = decode_block_box(cell.box, cloud_.blocks()[first + block]);
      const Vec3 middle = position_box(cloud_.quantisation(), box).centre();
      if (!reach_.contains(middle) ||
          !model_.contains(pose_.rotated_back(middle - pose_.position())))
        continue;
      count_ += std::min(kBlockPoints, cell.count - block * kBlockPoints);
    }
  }

  const PackedCloud& cloud_;
  const Box& model_;
  const Box reach_;
  const Pose& pose_;
  double count_ = 0;
};

Workload workload_of_model(const PackedCloud& cloud, const QueryParameters& query,
                           const Model& model, std::span<const Pose> poses) {
  return workload_of(cloud, query, model.empty() ? Box{} : box_of(model.vertices),
                     points_to_search(model.vertices.size(), model.triangles.size()), poses);
}

}  // namespace

Workload workload_of(const PackedCloud& cloud, const Query& query) {
  return workload_of_model(cloud, query, query.model, query.poses);
}

std::vector<Workload> workloads_of(const PackedCloud& cloud, const Query& query) {
  if (query.bodies.empty()) return {workload_of(cloud, query)};
  std::vector<Workload> out;
  for (const Body& body : query.bodies) {
    out.push_back(workload_of_model(cloud, query, body.model, body.poses));
  }
  return out;
}

Workload workload_of(const PackedCloud& cloud, const QueryParameters& query, const Box& model,
                     std::uint64_t model_points, std::span<const Pose> poses) {
  Workload work;
  work.model_points = static_cast<double>(model_points);
  work.poses = static_cast<double>(poses.size());
  work.radius = std::max({query.radius, query.clearance, query.profile});
  if (model_points == 0 || poses.empty()) return work;
  double length = 2 * work.radius;
  for (int k = 0; k < 3; ++k) {
    length = std::max(length, model.hi[k] - model.lo[k] + 2 * work.radius);
  }
  const Box reach = model.grown(work.radius);
  const std::size_t samples = std::min(kSampledPoses, poses.size());
  double near_points = 0;  // at one pose, on average
  for (std::size_t i = 0; i < samples; ++i) {
    const std::size_t pose = (2 * i + 1) * poses.size() / (2 * samples);
    near_points += NearPoints(cloud, reach, poses[pose]).count() / static_cast<double>(samples);
  }
  // A model that moves on by its length meets as many points again.
  const double places = std::min(work.poses, 1 + path_length(poses) / length);
  work.reached_points = std::min(static_cast<double>(cloud.point_count()), near_points * places);
  return work;
}

}  // namespace clearway
