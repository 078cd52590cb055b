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
};

/// Performs the counting pass, which also hashes the files, and further passes while a bin is too
/// full (docs/design/conversion.md). places, boxes: take what serves warnings. path: finds the
/// origins of the points, or is null.
CountedEnvironment count_environment(EnvironmentSource& environment, const Lattice& lattice,
                                     PlaceSample& places, FileBoxes& boxes, FileHashes& files,
                                     int threads, StageClocks& clocks, Progress& progress,
                                     PathOrigins* path = nullptr);

}  // namespace clearway
