#pragma once

#include <tuple>

#include "clearway/section.hpp"
#include "core/describe/machine.hpp"
#include "core/describe/selection.hpp"

namespace clearway {

/// What a section is asked, but for the ranges, which are several numbers.
inline constexpr std::tuple kSectionValues{
    Field{.member = &SectionParameters::cell,
          .key = "cell",
          .option = "--cell",
          .help = "Side of a cell",
          .usual = "0.02 m",
          .doc = "Side of a cell; 0: 0.02 m."},
    Field{.member = &SectionParameters::bin,
          .key = "bin",
          .option = "--bin",
          .help = "Length of the stretches into which the path is divided",
          .usual = "5 m",
          .doc = "Length of the stretches into which the path is divided; 0: 5 m."},
    Field{.member = &SectionParameters::margin,
          .key = "margin",
          .option = "--margin",
          .help = "The greatest margin that clearway section check may ask for, and the one that "
                  "it asks for by default",
          .usual = "0",
          .doc = "The greatest margin that Section.check() may be asked for, and its default.",
          .range = FieldRange::kFromZero},
    Field{
        .member = &SectionParameters::seen,
        .key = "seen",
        .option = "--seen",
        .group = OptionGroup::kCertainty,
        .help = "Distinguish cells that no beam of the scanner crossed from free ones; the store "
                "has to "
                "know where its scanner stood",
        .doc =
            "Distinguishes cells that no beam of the scanner crossed from free ones; needs a store "
            "with origins."},
    kSeenCube<SectionParameters>,
    Field{.member = &SectionParameters::between_poses,
          .key = "between_poses",
          .option = "--between-poses",
          .help = "Count the way from each pose to the next, too: the load grows by its motion",
          .doc = "Counts the way from each pose to the next, too, because the load grows by its "
                 "motion."}};

/// All that a section is asked but for the ranges.
inline constexpr std::tuple kSectionFields =
    std::tuple_cat(kSectionValues, kIgnoredFields<SectionParameters>);

}  // namespace clearway
