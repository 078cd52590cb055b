#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>

namespace clearway::bench {

struct StageOptions {
  std::filesystem::path environment, model, trajectory;
  double radius = 0.1;
  int threads = 0;                       ///< 0: all
  std::uint32_t slots = 64, cells = 16;  ///< pages in flight, and cells of a page
  bool cold = false;                     ///< read the store from the disk
};

/// Times the stages of a run on a GPU alone: reading its pages and doing nothing with them, and,
/// where there is a GPU, sending and searching pages that lie in memory.
nlohmann::ordered_json time_stages(const StageOptions& options);

}  // namespace clearway::bench
