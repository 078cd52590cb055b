#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

namespace clearway::bench {

struct ShareOptions {
  std::filesystem::path environment, model, trajectory;
  double radius = 0.1;
  int threads = 0;  ///< 0: all cores
  int repetitions = 3;
};

/// What the sweep touches on the CPU, and takes, as it is and where it is made to touch more: all
/// cells, the whole field, or each pose by itself. Of several repetitions, that of the median time.
nlohmann::ordered_json measure_shares(const ShareOptions& options);

}  // namespace clearway::bench
