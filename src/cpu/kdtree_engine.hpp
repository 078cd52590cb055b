#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "clearway/pose.hpp"
#include "clearway/query.hpp"
#include "core/cloud/packed_cloud.hpp"
#include "core/geometry/box.hpp"
#include "core/query/pose_journal.hpp"
#include "core/query/search_result.hpp"
#include "core/util/progress.hpp"

namespace clearway {

/// A range of consecutive poses around a reference pose. At any pose of the range (between poses:
/// also on the way to the next pose) a model point within distance d of a model point c lies within
/// stretch * d + spread of transform(reference pose, c), rounding included
/// (docs/design/numerics.md, "Motion").
struct PoseNode {
  std::uint32_t first;
  std::uint32_t count;
  std::uint32_t reference;
  std::uint32_t earlier, later;  ///< indices of the two halves; only if count > 1
  double spread;                 ///< metres
  double stretch;
};

/// A binary tree over one run of poses.
class PoseTree {
 public:
  static constexpr std::uint32_t kMostPoses = 32;

  /// Builds the tree over poses first .. first + count - 1 of `poses`, 0 < count <= kMostPoses.
  /// model: holds every model point. between_poses: a pose's range includes the motion on to the
  /// next pose.
  PoseTree(std::span<const Pose> poses, std::uint32_t first, std::uint32_t count, const Box& model,
           bool between_poses = false);

  /// Node `index`; node 0 is the root.
  const PoseNode& node(std::uint32_t index) const { return nodes_[index]; }

 private:
  std::uint32_t add(std::span<const Pose> poses, std::uint32_t first, std::uint32_t count,
                    const Box& model, bool between_poses);

  std::vector<PoseNode> nodes_;
};

struct KdTreeOptions {
  int threads = 0;  ///< 0: as many as OpenMP offers
  /// Keeps what is found; poses that it holds already are not searched
  PoseJournal* journal = nullptr;
  std::function<bool(std::uint32_t)> only = nullptr;  ///< whether to search a cell; null: all
};

struct KdTreeStatistics {
  std::uint64_t searches = 0;         ///< all pairs of a pose and a model point
  std::uint64_t tested_searches = 0;  ///< pairs that no filter dismissed
  std::uint64_t allocated_bytes = 0;  ///< without per-thread caches and the cloud's own memory
  std::uint64_t cache_bytes = 0;      ///< memory of the per-thread caches
  std::uint64_t ignored_points = 0;   ///< number of ignored points in the cells to search
};

/// Upper bound on the memory that run_kdtree() takes in addition to the cloud's own, bytes.
std::uint64_t kdtree_memory_bytes(const PackedCloud& cloud, const Query& query, int threads);

/// Finds every point of `cloud` that the query's model touches: for every pose and model point by a
/// fixed-range search in the cloud's k-d tree, over the packed points. Poses are searched in
/// parallel. Progress counts poses; when it asks to stop, the poses begun are finished and
/// Interrupted is thrown. Throws InputError for a damaged cell. Source: Schauer et al. (the paper),
/// section 3.1 (kd-CD-simple).
HitSet run_kdtree(const PackedCloud& cloud, const Query& query, const KdTreeOptions& options,
                  Progress& progress, KdTreeStatistics* statistics = nullptr);

}  // namespace clearway
