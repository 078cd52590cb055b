#pragma once

#include <cstdint>

#include "clearway/section.hpp"
#include "core/section/section_lattice.hpp"

namespace clearway {

/// Adds the blocked cells of a bin, ascending by k and j.
void add_cells_of_bin(const SectionLattice& lattice, const std::uint32_t* firsts,
                      std::uint32_t number, SectionCells& cells);

}  // namespace clearway
