#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/util/progress.hpp"
#include "io/convert/checks/file_boxes.hpp"
#include "io/convert/checks/same_place.hpp"
#include "io/convert/inputs/environment_source.hpp"
#include "io/convert/inputs/file_hashes.hpp"
#include "io/convert/split_tree.hpp"
#include "io/convert/stage_clocks.hpp"
#include "io/store/store_metadata.hpp"

namespace clearway {

/// What the counting pass notices besides, for warnings.
struct InputSurvey {
  PlaceSample places;
  FileBoxes boxes;
};

/// What tells whether a later pass reads the same points.
struct CountedHashes {
  std::uint64_t points;
  std::optional<std::uint64_t> classes;  ///< none where all have class 0
};

struct CountedEnvironment {
  std::uint64_t points = 0;        ///< finite ones
  std::uint64_t input_points = 0;  ///< all
  std::uint64_t points_hash = 0;
  std::optional<StoreClasses> classes = {};  ///< where any is above 0
  std::vector<Bin> bins;                     ///< none with more than kBucketPoints points

  CountedHashes hashes() const {
    return {points_hash, classes ? std::optional(classes->hash) : std::nullopt};
  }
};

/// The counting pass, which also hashes the files, and further ones while a bin is too full
/// (docs/design/conversion.md).
CountedEnvironment count_environment(EnvironmentSource& environment, const Lattice& lattice,
                                     InputSurvey& survey, FileHashes& files, int threads,
                                     StageClocks& clocks, Progress& progress);

}  // namespace clearway
