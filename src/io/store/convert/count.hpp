#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/util/progress.hpp"
#include "io/store/convert/environment_source.hpp"
#include "io/store/convert/file_boxes.hpp"
#include "io/store/convert/input_files.hpp"
#include "io/store/convert/same_scans.hpp"
#include "io/store/convert/split_tree.hpp"
#include "io/store/convert/stage_clocks.hpp"
#include "io/store/store_metadata.hpp"

namespace clearway {

class PathOrigins;

/// Observations of the counting pass that serve warnings.
struct InputSurvey {
  PlaceSample places;
  FileBoxes boxes;
};

/// Hashes that show whether a later pass reads the same points.
struct CountedHashes {
  std::uint64_t points;
  std::optional<std::uint64_t> classes;  ///< nullopt where all points have class 0
};

struct CountedEnvironment {
  std::uint64_t points = 0;        ///< number of finite points
  std::uint64_t input_points = 0;  ///< number of all points
  std::uint64_t points_hash = 0;
  std::optional<StoreClasses> classes = {};  ///< only where some class is above 0
  std::vector<Bin> bins;                     ///< bins, each with at most kBucketPoints points

  template <typename Values>
  void keep(Values& values) {
    values.add(points, input_points, points_hash, classes, bins);
  }

  CountedHashes hashes() const {
    return {points_hash, classes ? std::optional(classes->hash) : std::nullopt};
  }
};

/// Performs the counting pass, which also hashes the files, and further passes while a bin is too
/// full (docs/design/conversion.md). path: finds the origins of the points, or is null.
CountedEnvironment count_environment(EnvironmentSource& environment, const Lattice& lattice,
                                     InputSurvey& survey, FileHashes& files, int threads,
                                     StageClocks& clocks, Progress& progress,
                                     PathOrigins* path = nullptr);

}  // namespace clearway
