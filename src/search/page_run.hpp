#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/page/page_engine.hpp"
#include "core/page/page_pool.hpp"
#include "search/engines.hpp"
#include "search/search_plan.hpp"

namespace clearway {

/// One for each device.
using PageEngines = std::vector<std::unique_ptr<PageEngine>>;

/// How an engine that works on pages is made and what it needs.
struct PageEngineKind {
  std::uint32_t most_slots = 1;  ///< with less memory, fewer
  std::uint32_t page_cells = 1;  ///< the most cells of a page
  std::uint64_t page_bytes = 0;  ///< wanted; more where a cell needs it, less with little memory
  int threads = 1;               ///< that run the pipeline, those that wait for a device included
  double field_fineness = 1;     ///< of the model field (core/sweep/model_field.hpp)

  /// Memory on the host with this layout, bytes: what `make` allocates and what the searches do.
  std::function<std::uint64_t(const SearchPlan&, const SlotLayout&)> host_bytes;
  /// Memory on a device likewise; none for an engine on the CPU.
  std::function<std::uint64_t(const SearchPlan&, const SlotLayout&)> device_bytes = {};
  std::uint64_t most_device_bytes = 0;
  std::string short_device = {};  ///< as refuse_device_memory takes it
  std::uint32_t devices = 1;      ///< engines that `make` makes
  /// Slots of the layout are those of each device.
  std::function<PageEngines(const SearchPlan&, const SlotLayout&)> make;
  /// Called once after the last page: for the log, and for what only the engine can report.
  std::function<void(const SearchPlan&, const PageEngines&, EngineReport&)> finished;
};

/// Plans the query within options.memory_bytes, makes the engine and, with the journal that is
/// then asked for, runs it. Where memory is short, first the model field gets coarser (not with a
/// tolerance: the answer depends on it), then slots fewer, then pages smaller; with device_bytes,
/// slots get fewer and pages smaller, down to one cell, before the field gets coarser.
/// Throws ResourceError, before the journal is asked for, naming the smallest budget that works.
SearchResult run_page_engine(const StoreReader& store, const Query& query,
                             const EngineOptions& options, const PageEngineKind& kind,
                             const std::function<SearchJournal&()>& open, Progress& progress,
                             EngineReport& report);

}  // namespace clearway
