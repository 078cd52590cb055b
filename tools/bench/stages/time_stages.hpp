#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>

namespace clearway::bench {

struct StageOptions {
  std::filesystem::path environment, model, trajectory;
  double radius = 0.1;
  int threads = 0;                       ///< 0: all cores
  std::uint32_t slots = 64, cells = 16;  ///< number of pages in flight, and of cells in a page
  bool cold = false;                     ///< whether the store is read from the disk
};

/// Times each stage of a run on a GPU by itself: reading its pages and doing nothing with them,
/// and, where there is a GPU, sending and searching pages that lie in memory.
nlohmann::ordered_json time_stages(const StageOptions& options);

}  // namespace clearway::bench
