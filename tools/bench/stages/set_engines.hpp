#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>

#include "search/kinds/page_engine_kind.hpp"

namespace clearway::bench {

/// A search with engines that are set as no search of Clearway sets them. Within a tolerance or in
/// single precision its result is not exact, which the file does not say.
struct SetEngines {
  std::filesystem::path environment, model, trajectory, output;
  double radius = 0.1;
  SearchOptions search;  ///< engine kSweep or kGrid, device kCpu or kCuda
  EngineSettings settings;
};

/// Searches as `clearway run` does, but without its checks and its journal, and writes the result,
/// which replaces an earlier one. Returns what a run reports, as far as experiments use it, and
/// what the engine chose. Throws UsageError where the engine does not have a setting.
nlohmann::ordered_json search_with_set_engines(const SetEngines& asked);

}  // namespace clearway::bench
