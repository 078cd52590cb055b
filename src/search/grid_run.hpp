#pragma once

#include <memory>
#include <optional>

#include "core/grid/grid_scene.hpp"
#include "search/page_run.hpp"

namespace clearway {

/// A run's grid scene, made when it is first asked for. Copies share it.
class LazyGridScene {
 public:
  LazyGridScene(const StoreReader& store, const Query& query, const EngineOptions& options)
      : store_(store),
        query_(query),
        options_{options.grid_cell,
                 options.float_precision ? GridPrecision::kFloat : GridPrecision::kExact} {}

  /// Of any plan of the query: the scene depends on its motion tree alone.
  const GridScene& of(const SearchPlan& plan) const;

 private:
  const StoreReader& store_;
  const Query& query_;
  GridOptions options_;
  std::shared_ptr<std::optional<GridScene>> scene_ = std::make_shared<std::optional<GridScene>>();
};

void log_statistics(const GridScene& scene, const GridStatistics& statistics);

/// The grid engine on the CPU; options.threads is not 0.
PageEngineKind cpu_grid(const StoreReader& store, const Query& query, const EngineOptions& options);

}  // namespace clearway
