#pragma once

#include <string>

#include "clearway/section.hpp"

/// What the command line and pages say of a section.
namespace clearway {

/// The symbol of the unit of a section's lengths.
std::string section_unit(const SectionFacts& section);

/// Whether a load passes, and where it is stopped first, such as "passes: the load passes
/// everywhere on the path".
std::string verdict_sentence(const SectionCheck& check, const SectionData& section, double margin);

/// Whether the loads of a table pass, each on its stretch, in one sentence.
std::string table_sentence(const OutlineTableCheck& check, const SectionData& section);

/// Which outline was judged where, and whether it passes there, such as "line 2, chainage 0 to 10
/// m, load.csv with a margin of 0.1 m: passes".
std::string row_words(const OutlineRowCheck& check, const SectionData& section);

/// The largest loads that are as wide to the left as to the right and stand on the base.
std::string widths_sentence(const Section& section, const SectionHeights& heights);

}  // namespace clearway
