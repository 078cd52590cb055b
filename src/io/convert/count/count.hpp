#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "core/util/progress.hpp"
#include "io/convert/checks/file_boxes.hpp"
#include "io/convert/checks/same_place.hpp"
#include "io/convert/inputs/environment_source.hpp"
#include "io/convert/split_tree.hpp"
#include "io/convert/stage_clocks.hpp"

namespace clearway {

/// Reads the environment once from its start, in order, and hands every batch to `work`, several
/// threads at a time; `in_order` sees the batches first, one by one. Throws Interrupted when the
/// progress asks to stop.
void for_each_batch(EnvironmentSource& environment, int threads, StageClocks& clocks,
                    const Progress& progress,
                    const std::function<void(const QuantaBatch&)>& in_order,
                    const std::function<void(const QuantaBatch&)>& work);

/// environment.read(), measured.
bool read_measured(EnvironmentSource& environment, QuantaBatch& batch, StageClocks& clocks);

/// What the counting pass notices besides, for warnings.
struct InputSurvey {
  PlaceSample places;
  FileBoxes boxes;
};

struct CountedEnvironment {
  std::uint64_t points = 0;        ///< finite ones
  std::uint64_t input_points = 0;  ///< all
  std::uint64_t points_hash = 0;
  std::vector<Bin> bins;  ///< none with more than kBucketPoints points
};

/// The counting pass, and further ones while a bin is too full (docs/design/conversion.md).
CountedEnvironment count_environment(EnvironmentSource& environment, const Lattice& lattice,
                                     InputSurvey& survey, int threads, StageClocks& clocks,
                                     Progress& progress);

}  // namespace clearway
