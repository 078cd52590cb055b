#pragma once

#include <memory>
#include <optional>

#include "clearway/page_run.hpp"
#include "grid/grid_scene.hpp"

namespace clearway::tool {

/// A run's grid scene, made when it is first asked for. Copies share it.
class LazyGridScene {
 public:
  LazyGridScene(const Store& store, const Question& question, const EngineOptions& options)
      : store_(store),
        question_(question),
        options_{options.grid_cell,
                 options.float_precision ? GridPrecision::kFloat : GridPrecision::kExact} {}

  /// Of any plan of the question: the scene depends on its motion tree alone.
  const GridScene& of(const SearchPlan& plan) const;

 private:
  const Store& store_;
  const Question& question_;
  GridOptions options_;
  std::shared_ptr<std::optional<GridScene>> scene_ = std::make_shared<std::optional<GridScene>>();
};

void log_statistics(const GridScene& scene, const GridStatistics& statistics);

/// The grid engine on the CPU; options.threads is not 0.
PageEngineKind cpu_grid(const Store& store, const Question& question, const EngineOptions& options);

}  // namespace clearway::tool
