#pragma once

#include <cstdint>
#include <vector>

#include "clearway/store.hpp"
#include "core/util/progress.hpp"
#include "report/packed_points.hpp"
#include "report/path_places.hpp"

namespace clearway {

/// Environment points for the page.
struct EnvironmentSample {
  /// Along the curve. Their tag is the height above the model's top at the nearest place of the
  /// path, in tenths of a metre, plus 128, from 0 to 255.
  std::vector<PagePoint> points;
  std::uint64_t near_points = 0;  ///< from which they were taken
  /// Side of the square of surface that one point stands for near the path; 0: all are there.
  double spacing = 0;
};

/// Picks at most `most` points of those near the path, evenly over the surfaces they lie on and
/// fewer far away. By blocks of the store and their boxes: points that are not picked are not
/// decoded. The same for any number of threads.
EnvironmentSample sample_environment(const Store& store, const PathPlaces& path,
                                     const PageLattice& lattice, std::uint64_t most,
                                     Progress& progress);

}  // namespace clearway
