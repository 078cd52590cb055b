#include "search/device_estimate.hpp"

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
    for (std::uint32_t block = 0; block < blocks; ++block) {
      const Vec3 middle = cloud_.block_box(index, block).centre();
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
  std::vector<Workload> out;
  for (const MovingBody& body : moving_bodies(query)) {
    out.push_back(workload_of_model(cloud, query, body.model, body.poses));
  }
  return out;
}

Workload workload_of(const PackedCloud& cloud, const QueryParameters& query, const Box& model,
                     std::uint64_t model_points, std::span<const Pose> poses) {
  Workload work;
  work.model_points = static_cast<double>(model_points);
  work.poses = static_cast<double>(poses.size());
  const double radius = std::max({query.radius, query.clearance, query.profile});
  if (query.seen) work.beams = static_cast<double>(cloud.point_count());
  if (model_points == 0 || poses.empty()) return work;
  double length = 2 * radius;
  for (int k = 0; k < 3; ++k) {
    length = std::max(length, model.hi[k] - model.lo[k] + 2 * radius);
  }
  const Box reach = model.grown(radius);
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

namespace {

/// Seconds of the whole command on the CPU with engine sweep, a least-squares fit to large scenes.
/// In small scenes it gives 1.8 times too much as a median.
double sweep_seconds(const Workload& work, int threads) {
  if (work.model_points == 0 || work.poses == 0) return 0;
  const double alone = 0.064 + 7.02e-7 * work.model_points + 3.0e-6 * work.poses;
  const double search = 1.80e-5 * std::pow(work.reached_points, 0.3) *
                        std::pow(std::log(work.poses + 2), 3.91) *
                        std::pow(work.model_points, -0.135) * std::pow(work.poses, 0.0525);
  return alone + search / threads;
}

// Measured with scenes of tools/experiments.py at full size, on 16 cores and an H200. Seconds are
// those of `run --json`.

/// Seconds that a GPU adds to a run: the part of its start and end during which nothing else runs.
/// Hall: `total` was 0.506 s on the GPU, of which the search took 0.009 s.
constexpr double kStart = 0.5;
/// Seconds for making the slots of a GPU that was started before.
constexpr double kSlots = 0.15;
/// How many cores of a CPU search as fast as a GPU does. Hall: `search` was 0.26 s on 16 cores and
/// 11.7 ms on the GPU.
constexpr double kCores = 350;
/// By what factor a search on the CPU takes longer where it has distances beyond the radius. Hall:
/// `total` was 2.69 s with --clearance 0.5 and 0.453 s without.
constexpr double kDistances = 6;
/// How many beams a core follows in a second; a GPU follows as many as kCores cores or more.
/// `beams` was 1.0 s for the 55.9 M beams of the hall, and 21.7 s for the 806 M of the mine.
constexpr double kBeamsPerCore = 2.5e6;
/// How many environment points a core searches in a second. Hall: the store's points over `search`
/// and 16 cores.
constexpr double kPointsPerCore = 13e6;
/// How many pairs of a point and a bin in reach a core searches for a section in a second, and how
/// many a GPU.
constexpr double kSectionPairsPerCore = 25e6, kSectionPairsPerGpu = 1.5e9;

}  // namespace

DeviceEstimate estimate_devices(std::span<const Workload> work, const QueryParameters& query,
                                int threads, bool started) {
  const bool distances = query.clearance > 0 || query.profile > 0;
  double set = 0;
  for (const Workload& one : work) set += sweep_seconds(one, threads);
  const double beams = work.empty() ? 0 : work.front().beams / (kBeamsPerCore * threads);
  const double cpu = (distances ? kDistances : 1) * set + beams;
  return {cpu, (started ? kSlots : kStart) + cpu * threads / kCores};
}

DeviceEstimate estimate_section(double pairs, int threads) {
  return {pairs / (kSectionPairsPerCore * threads), kStart + pairs / kSectionPairsPerGpu};
}

std::uint64_t surely_many_points(int threads) {
  return static_cast<std::uint64_t>(kStart * kPointsPerCore * std::max(threads, 1));
}

}  // namespace clearway
