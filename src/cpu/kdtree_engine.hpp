#pragma once

#include <cstdint>
#include <functional>

#include "clearway/query.hpp"
#include "core/cloud/packed_cloud.hpp"
#include "core/query/hit_set.hpp"
#include "core/query/pose_journal.hpp"
#include "core/util/progress.hpp"

namespace clearway {

struct KdTreeOptions {
  int threads = 0;  ///< 0: as many as OpenMP offers
  /// Keeps what is found; poses that it holds already are not searched
  PoseJournal* journal = nullptr;
  std::function<bool(std::uint32_t)> only = nullptr;  ///< tells the cells to search; null: all
};

struct KdTreeStatistics {
  std::uint64_t searches = 0;         ///< all pairs of a pose and a model point
  std::uint64_t tested_searches = 0;  ///< pairs that no filter dismissed
  std::uint64_t allocated_bytes = 0;  ///< without per-thread caches and the cloud's own memory
  std::uint64_t cache_bytes = 0;      ///< memory of the per-thread caches
  std::uint64_t ignored_points = 0;   ///< number of ignored points in the cells to search
};

/// Upper bound of the memory that run_kdtree() takes in addition to the cloud's own, bytes.
std::uint64_t kdtree_memory_bytes(const PackedCloud& cloud, const Query& query, int threads);

/// Finds every point of `cloud` that the query's model touches: for every pose and model point by a
/// fixed-range search in the cloud's k-d tree, over the packed points. Poses are searched in
/// parallel. Progress counts poses; when it asks to stop, the poses begun are finished and
/// Interrupted is thrown. Throws InputError for a damaged cell. Source: Schauer et al. (the paper),
/// section 3.1 (kd-CD-simple).
HitSet run_kdtree(const PackedCloud& cloud, const Query& query, const KdTreeOptions& options,
                  Progress& progress, KdTreeStatistics* statistics = nullptr);

}  // namespace clearway
