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
void find_intrusions(const Section& section, std::span<const OutlinePoint> outline, double reach,
                     const std::vector<bool>& stops_load, std::vector<SectionStop>& stops);

}  // namespace clearway
