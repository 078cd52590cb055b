#pragma once

#include <string>

#include "clearway/section.hpp"

/// What the command line and pages say of a section.
namespace clearway {

/// The symbol of the unit of a section's lengths.
std::string section_unit(const SectionFacts& section);

/// Where a cell is, such as "1.24 m to the left at a height of 3.1 m".
std::string cell_words(const std::array<std::int32_t, 2>& cell, const SectionFacts& section);

/// Whether a load passes, and where it is stopped first, such as "passes: the load passes
/// everywhere on the path".
std::string verdict_sentence(const SectionCheck& check, const SectionData& section, double margin);

/// The largest loads that are as wide to the left as to the right and stand on the base.
std::string widths_sentence(const Section& section, const SectionHeights& heights);

}  // namespace clearway
