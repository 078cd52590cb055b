#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "core/cloud/kd_order.hpp"
#include "core/cloud/packed_cloud.hpp"
#include "core/query/hit_set.hpp"
#include "core/query/ignored_points.hpp"

namespace clearway {

/// The ignored points of a search without pages. During the search they count as hit at the first
/// pose, so that nothing looks for them; afterwards they are removed from the answer.
class IgnoredEntries {
 public:
  /// only: tells the cells that are searched; null for all. All arguments must outlive this object.
  IgnoredEntries(const PackedCloud& cloud, const QueryParameters& query,
                 const std::function<bool(std::uint32_t)>& only, int threads)
      : cloud_(cloud), ignored_(cloud, query), only_(only), threads_(threads) {}

  /// Marks the ignored points and returns their number. Throws InputError for a damaged cell.
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
  /// For each 64 entries a word with a bit for each ignored one, once marked
  std::vector<std::uint64_t> words_;
};

}  // namespace clearway
