#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "clearway/outline.hpp"
#include "clearway/section.hpp"

/// Which cells of a section stop a load, and how far they reach into it.
namespace clearway {

/// Why the section says nothing of any load, as the end of a sentence; empty where it does.
std::string doubt_about(const SectionData& section);

/// Cells closer to an outline than this stop it: the margin, rounding, and between poses half of
/// the motion across.
double reach_of(const SectionFacts& section, double margin);

/// Whether each cell of the whole path, in its order, stops the load. Throws as Section::check().
std::vector<bool> stopping_cells(const Section& section, std::span<const OutlinePoint> outline,
                                 double margin);

/// Index of a cell among those of the whole path, which have all cells of the bins.
std::size_t index_of_cell(const SectionCells& cells, std::int32_t j, std::int32_t k);

/// Fills the intrusions of the stops, which are ascending by bin. stops_load: stopping_cells().
///
/// A cell j, k of the side g takes from the left the greatest y of the outline in the strip of z
/// from k g - reach to (k + 1) g + reach, less (j g - reach), and from the other sides likewise. It
/// counts on the side where it takes least, and a side takes the greatest of its cells. The set of
/// sides that is reported has the least sum among those that leave something of the outline's box
/// both across and up, and of equal sums the fewest sides; without any it is left and right. A
/// rectangle that is cut back by these depths is nowhere closer than reach to a cell of the bin.
void find_intrusions(const Section& section, std::span<const OutlinePoint> outline, double reach,
                     const std::vector<bool>& stops_load, std::vector<SectionStop>& stops);

}  // namespace clearway
