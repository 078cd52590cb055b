#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "core/cloud/kd_order.hpp"
#include "core/cloud/packed_cloud.hpp"
#include "core/query/hit_set.hpp"
#include "core/query/ignored_points.hpp"

namespace clearway {

/// The ignored points of a search without pages: while it goes on they count as hit at the first
/// pose, so that nothing looks for them; then they are taken out of the answer.
class IgnoredEntries {
 public:
  /// only: the cells that are searched; null: all. All outlive it.
  IgnoredEntries(const PackedCloud& cloud, const QueryParameters& query,
                 const std::function<bool(std::uint32_t)>& only, int threads)
      : cloud_(cloud), ignored_(cloud, query), only_(only), threads_(threads) {}

  /// Returns how many there are. Throws InputError for a damaged cell.
  std::uint64_t mark(HitSet& hits);
  void take_back(HitSet& hits) const;

  static std::uint64_t most_bytes(const PackedCloud& cloud, const QueryParameters& query) {
    return query.ignores_points() ? cloud.entry_count() / kBlockPoints * sizeof(std::uint64_t) : 0;
  }

 private:
  std::uint64_t mark(std::uint32_t cell, HitSet& hits);

  const PackedCloud& cloud_;
  IgnoredPoints ignored_;
  const std::function<bool(std::uint32_t)>& only_;
  int threads_;
  std::vector<std::uint64_t> words_;  ///< of 64 entries each, those ignored, once marked
};

}  // namespace clearway
