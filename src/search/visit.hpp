#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "core/query/ignored_points.hpp"
#include "core/util/progress.hpp"
#include "search/kinds/page_engine_kind.hpp"
#include "search/shard_cells.hpp"
#include "stream/run_pages.hpp"

namespace clearway {

/// Questions that are asked of cells, page by page, and where the answers go. All references
/// outlive it.
struct Visit {
  const Query& query;  ///< the first question; `kind` knows the others
  std::uint64_t memory_bytes;
  PageEngineKind& kind;
  /// The cells to visit; null for all
  const ShardCells* only = nullptr;
  /// Takes the result of each page.
  CollectPage collect;
  /// Whether a cell was visited before; null where none was
  std::function<bool(std::uint32_t)> answered = nullptr;
  const char* stage = "search";  ///< the name for those who watch the progress
  IgnoredPoints::Search search = IgnoredPoints::Search::kOthers;
  /// The least memory with which the answer can be written, where it is kept until then
  std::optional<std::uint64_t> least_write_bytes = {};
  /// Called, if not null, with the bytes that the visit takes, on the host and on each device, once
  /// it is planned.
  std::function<void(std::uint64_t host, std::uint64_t device)> planned = nullptr;
  /// Called, if not null, once the engines are made.
  std::function<void()> made = nullptr;
};

/// What a visit leaves when it is done.
struct VisitEnd {
  /// The bytes of memory that are left to write with while engines are still being taken down
  std::uint64_t write_bytes = 0;
  EngineEnd engine_end = {};
};

/// Plans a visit, makes the engines, and searches. Throws ResourceError naming the smallest budget
/// that works, before the engines are made.
VisitEnd run_visit(const PackedCloud& cloud, const Visit& visit, Progress& progress,
                   SearchReport& report, const MessageLog& log);

/// Does the same for a caller that keeps nothing of the answer by cells. Returns what it took.
SearchReport run_visit(const PackedCloud& cloud, const Visit& visit, Progress& progress);

}  // namespace clearway
