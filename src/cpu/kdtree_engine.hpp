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
  int threads = 0;                 ///< 0: all that OpenMP offers
  PoseJournal* journal = nullptr;  ///< keeps what is found; what it held before is not searched
  std::function<bool(std::uint32_t)> only = nullptr;  ///< the cells to search; null: all
};

struct KdTreeStatistics {
  std::uint64_t searches = 0;         ///< pairs of pose and model point
  std::uint64_t tested_searches = 0;  ///< of these, those that no filter dismissed
  std::uint64_t allocated_bytes = 0;  ///< per-thread caches and the cloud's own memory not counted
  std::uint64_t cache_bytes = 0;      ///< per-thread caches
  std::uint64_t ignored_points = 0;   ///< of the cells to search
};

/// An upper bound of the memory that run_kdtree takes beside the cloud's own, bytes.
std::uint64_t kdtree_memory_bytes(const PackedCloud& cloud, const Query& query, int threads);

/// Every point of `cloud` that the query's model touches: for every pose and model point a
/// fixed-range search in the cloud's k-d tree, over the packed points. Poses are searched in
/// parallel. Progress counts poses; where it asks to stop, the poses begun are finished and
/// Interrupted is thrown. Throws InputError for a damaged cell.
/// Source: Schauer et al. (the paper), section 3.1 (kd-CD-simple).
HitSet run_kdtree(const PackedCloud& cloud, const Query& query, const KdTreeOptions& options,
                  Progress& progress, KdTreeStatistics* statistics = nullptr);

}  // namespace clearway
