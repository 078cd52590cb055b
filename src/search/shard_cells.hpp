#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "clearway/query.hpp"
#include "clearway/shard.hpp"
#include "core/cloud/packed_cloud.hpp"
#include "io/result/result.hpp"
#include "io/store/store_reader.hpp"
#include "search/query_trees.hpp"

namespace clearway {

/// An estimate, for each cell, of the work that a search has with it, in an arbitrary unit; 0 where
/// the model comes nowhere near. It follows from the store's index and the query alone, by
/// operations that give the same numbers on every machine. Reads no points. threads: at least 1.
std::vector<std::uint64_t> cell_work(const PackedCloud& cloud, const Query& query,
                                     const QueryTrees& trees, int threads);

/// Bytes of memory that cell_work() takes besides the trees.
std::uint64_t cell_work_bytes(const PackedCloud& cloud, const Query& query);

/// The part of each cell, from 0 to shards - 1. Cells are taken in the order of decreasing work,
/// and each goes to the part that has the least work so far, so that no part has more than the mean
/// and the work of the largest cell. Cells without work are spread by their index. Among equal
/// cells or parts the first is taken.
/// Source: Graham 1969, "longest processing time".
std::vector<std::uint32_t> divide_cells(std::span<const std::uint64_t> work, std::uint32_t shards);

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
  bool empty() const { return std::ranges::find(own_, true) == own_.end(); }
  const ResultPart& part() const { return part_; }
  /// The estimated work of the part divided by the mean of all parts.
  double share() const { return share_; }

 private:
  std::vector<bool> own_;
  ResultPart part_;
  double share_ = 0;
};

}  // namespace clearway
