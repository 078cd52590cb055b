#include "search/shard/shard_cells.hpp"

#include <span>

#include "io/system/xxh64.hpp"
#include "search/memory_budget.hpp"
#include "search/query_trees.hpp"
#include "search/shard/cell_work.hpp"
#include "search/shard/divide_cells.hpp"

namespace clearway {
namespace {

std::uint64_t division_of(const StoreReader& store, std::span<const std::uint32_t> parts) {
  const std::uint64_t fingerprint = store.fingerprint();
  Xxh64Stream hash;
  hash.update(std::as_bytes(std::span(&fingerprint, 1)));
  hash.update(std::as_bytes(parts));
  return hash.digest();
}

std::vector<std::uint64_t> work_of_cells(const StoreReader& store, const Query& query, int threads,
                                         std::uint64_t memory_bytes) {
  check_memory(program_bytes(threads) + input_bytes(store, query) + tree_building_bytes(query) +
                   cell_work_bytes(store, query),
               memory_bytes);
  if (query.model.empty() || query.poses.empty()) {
    return std::vector<std::uint64_t>(store.cells().size());
  }
  return cell_work(store, query, QueryTrees(query, threads), threads);
}

}  // namespace

ShardCells::ShardCells(const StoreReader& store, const Query& query, const Shard& shard,
                       int threads, std::uint64_t memory_bytes)
    : own_(store.cells().size()) {
  const std::vector<std::uint64_t> work = work_of_cells(store, query, threads, memory_bytes);
  const std::vector<std::uint32_t> parts = divide_cells(work, shard.count);
  double all = 0, own = 0;
  for (std::size_t cell = 0; cell < parts.size(); ++cell) {
    own_[cell] = parts[cell] == shard.number - 1;
    all += static_cast<double>(work[cell]);
    if (own_[cell]) own += static_cast<double>(work[cell]);
  }
  if (all > 0) share_ = own * shard.count / all;
  part_ = {shard, division_of(store, parts), store.fingerprint(), to_string(store.metadata().unit)};
}

}  // namespace clearway
