#include "search/shard/divide_cells.hpp"

#include <algorithm>
#include <functional>
#include <numeric>
#include <queue>
#include <utility>

namespace clearway {

std::vector<std::uint32_t> divide_cells(std::span<const std::uint64_t> work, std::uint32_t shards) {
  std::vector<std::uint32_t> order(work.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, std::greater(), [&](std::uint32_t cell) { return work[cell]; });
  using Load = std::pair<std::uint64_t, std::uint32_t>;  // the part's work, and its number
  std::priority_queue<Load, std::vector<Load>, std::greater<>> loads;
  for (std::uint32_t shard = 0; shard < shards; ++shard) loads.emplace(0, shard);
  std::vector<std::uint32_t> parts(work.size());
  for (const std::uint32_t cell : order) {
    if (work[cell] == 0) {
      parts[cell] = cell % shards;
      continue;
    }
    const auto [load, shard] = loads.top();
    loads.pop();
    parts[cell] = shard;
    loads.emplace(load + work[cell], shard);
  }
  return parts;
}

}  // namespace clearway
