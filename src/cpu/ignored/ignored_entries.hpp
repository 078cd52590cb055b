#pragma once

#include <cstdint>
#include <functional>

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
  std::uint64_t mark(HitSet& hits) const;
  void take_back(HitSet& hits) const;

 private:
  template <typename Visit>
  std::uint64_t for_each_word(const Visit& visit) const;

  const PackedCloud& cloud_;
  IgnoredPoints ignored_;
  const std::function<bool(std::uint32_t)>& only_;
  int threads_;
};

}  // namespace clearway
