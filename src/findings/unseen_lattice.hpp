#pragma once

#include <array>
#include <cstdint>

#include "clearway/seen.hpp"
#include "clearway/vec3.hpp"
#include "core/geometry/quantisation.hpp"
#include "core/seen/cubes.hpp"
#include "io/result/result.hpp"

namespace clearway {

/// The cubes of a result with seen space. Its file keeps the side along x alone; the other sides
/// follow from the side that was asked for, which by default is 0.2 m in the unit of the store.
CubeLattice lattice_of_unseen(const ResultHeader& header, const SeenSummary& seen);

/// The middle of a cube, as the search computes it.
Vec3 middle_of_cube(const CubeLattice& lattice, const Quantisation& quantisation,
                    const std::array<std::int32_t, 3>& cube);

}  // namespace clearway
