#pragma once

#include <cstdint>
#include <vector>

#include "clearway/store.hpp"
#include "core/util/progress.hpp"
#include "report/page.hpp"
#include "report/path_places.hpp"

namespace clearway {

/// The environment points that the page shows.
struct EnvironmentSample {
  /// The points in their order along the curve. A point's tag is its height above the top of the
  /// model at the nearest place of the path, in tenths of a metre plus 128, from 0 to 255.
  std::vector<PagePoint> points;
  /// How many points near the path they were taken from.
  std::uint64_t near_points = 0;
  /// Side of the square of surface that each point stands for near the path; 0 where all points are
  /// there.
  double spacing = 0;
};

/// Picks at most `most` of the points near the path, evenly over the surfaces that they lie on, and
/// fewer far away. Goes by the store's blocks and their boxes, so that a cell of which nothing is
/// picked is not decoded. The result is the same for any number of threads.
EnvironmentSample sample_environment(const Store& store, const PathPlaces& path,
                                     const PageLattice& lattice, std::uint64_t most,
                                     Progress& progress);

}  // namespace clearway
