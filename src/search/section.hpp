#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "clearway/body.hpp"
#include "clearway/query.hpp"
#include "clearway/section.hpp"
#include "core/section/section_lattice.hpp"

namespace clearway {

/// The load of a section: its poses, and the poses of the path that they belong to, ascending.
/// doubts: takes what is to be said of pivots that leave the path, unless it is null.
Body load_of_section(const std::vector<Pose>& path, const SectionParameters& parameters,
                     std::vector<Message>* doubts);

/// The points that a section leaves out, as a query has them.
QueryParameters ignored_by(const SectionParameters& asked);

/// Throws InputError where this is not the path of the section.
void check_path_of(const SectionData& section, std::span<const Pose> path);

/// Adds the blocked cells of a bin, ascending by k and j. without: the firsts of another map, whose
/// cells with the same first pose are left out; empty for none.
void add_cells_of_bin(const SectionLattice& lattice, std::span<const std::uint32_t> firsts,
                      std::uint32_t number, SectionCells& cells,
                      std::span<const std::uint32_t> without = {});

}  // namespace clearway
