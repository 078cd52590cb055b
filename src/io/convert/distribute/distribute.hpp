#pragma once

#include "core/util/progress.hpp"
#include "io/convert/checks/same_place.hpp"
#include "io/convert/count/count.hpp"
#include "io/convert/distribute/distribution.hpp"
#include "io/convert/inputs/environment_source.hpp"
#include "io/convert/split_tree.hpp"
#include "io/convert/stage_clocks.hpp"

namespace clearway {

/// Performs the distribution pass, which puts every point to those of its unit, in source order.
/// Throws InputError when the input is not what was counted, ResourceError when the disk is full.
/// places: counts the points at its places.
void distribute(EnvironmentSource& environment, const CountedHashes& counted,
                const Lattice& lattice, const SplitTree& tree, PlaceCounter& places,
                Distribution& distribution, int threads, StageClocks& clocks, Progress& progress);

}  // namespace clearway
