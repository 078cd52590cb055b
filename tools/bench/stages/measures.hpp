#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>

#include "clearway/model.hpp"
#include "clearway/trajectory.hpp"
#include "search/kinds/page_engine_kind.hpp"

namespace clearway::bench {

using Json = nlohmann::ordered_json;

/// What every measurement is asked about.
struct Asked {
  std::filesystem::path environment, model, trajectory;
  double radius = 0.1;
  int threads = 0;  ///< 0: all cores
};

/// Model and path of what is asked, without further options.
inline Query read_query(const Asked& asked) {
  return {read_model(asked.model, {.radius = asked.radius}),
          read_trajectory(asked.trajectory, {}),
          {.radius = asked.radius}};
}

struct ShareOptions : Asked {
  int repetitions = 3;
};

/// What the sweep touches on the CPU, and takes, as it is and where it is made to touch more: all
/// cells, the whole field, or each pose by itself. Of several repetitions, that of the median time.
Json measure_shares(const ShareOptions& options);

struct StageOptions : Asked {
  std::uint32_t slots = 64, cells = 16;  ///< number of pages in flight, and of cells in a page
  bool cold = false;                     ///< whether the store is read from the disk
};

/// Times each stage of a run on a GPU by itself: reading its pages and doing nothing with them,
/// and, where there is a GPU, sending and searching pages that lie in memory.
Json time_stages(const StageOptions& options);

/// A search with engines that are set as no search of Clearway sets them. In single
/// precision its result is not exact, which the file does not say.
struct SetEngines : Asked {
  std::filesystem::path output;
  SearchOptions search;  ///< engine kSweep or kGrid, device kCpu or kCuda; threads are as asked
  EngineSettings settings;
};

/// Searches as `clearway run` does, but without its checks and its journal, and writes the result,
/// which replaces an earlier one. Returns what a run reports, as far as experiments use it, and
/// what the engine chose. Throws UsageError where the engine does not have a setting.
Json search_with_set_engines(const SetEngines& asked);

}  // namespace clearway::bench
