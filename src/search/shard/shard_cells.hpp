#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "clearway/query.hpp"
#include "clearway/shard.hpp"
#include "io/result/result.hpp"
#include "io/store/store_reader.hpp"

namespace clearway {

/// The cells of one part of a query. Every cell of the store is in exactly one part, including
/// cells that no pose reaches, so it does not matter which cells an engine would plan.
class ShardCells {
 public:
  /// threads: at least 1. Throws ResourceError where the memory is too little.
  ShardCells(const StoreReader& store, const Query& query, const Shard& shard, int threads,
             std::uint64_t memory_bytes);

  /// A set of any cells, which are those of no part.
  explicit ShardCells(std::vector<bool> cells) : own_(std::move(cells)) {}

  bool contains(std::uint32_t cell) const { return own_[cell]; }
  const ResultPart& part() const { return part_; }
  /// The estimated work of the part divided by the mean of all parts.
  double share() const { return share_; }

 private:
  std::vector<bool> own_;
  ResultPart part_;
  double share_ = 0;
};

}  // namespace clearway
