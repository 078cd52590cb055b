#pragma once

#include <tuple>

#include "clearway/stations.hpp"
#include "core/describe/finding.hpp"

namespace clearway {

/// The columns of a stretch of the path, in the order of its files, which end with the overthrow of
/// each body and the doubts.
inline constexpr std::tuple kStationColumns = std::tuple_cat(
    kChainagesOfStretch<StationRow>, kStationsOfStretch<StationRow>,
    std::tuple{
        FindingColumn{.member = &StationRow::least,
                      .key = "least",
                      .doc = "The point that is nearest to the vehicle on the stretch, by the "
                             "profile of its poses and the clearances of the points whose nearest "
                             "pose is on it."},
        FindingColumn{.member = &StationRow::least_below,
                      .key = "least_below",
                      .doc = "The radius, where the stretch has a conflict whose least distance is "
                             "not known: it is below this."},
        FindingColumn{.member = &StationRow::least_above,
                      .key = "least_above",
                      .doc = "The distance that the profile was asked for, where the stretch is "
                             "clear and no pose of it found anything closer.",
                      .is_in_files = false},
        FindingColumn{.member = &StationRow::left,
                      .key = "left",
                      .doc = "The nearest of the points whose nearest pose is on the stretch and "
                             "that lie to the left of their body's box."},
        FindingColumn{.member = &StationRow::right,
                      .key = "right",
                      .doc = "The nearest of those to the right of their body's box."},
        FindingColumn{.member = &StationRow::above,
                      .key = "above",
                      .doc = "The nearest of those above their body's box."},
        FindingColumn{.member = &StationRow::verdict,
                      .key = "verdict",
                      .doc = "'clear', 'conflict' or 'undecided'."},
        FindingColumn{.member = &StationRow::reasons,
                      .key = "reasons",
                      .doc = "Why the verdict is undecided: a list such as ['near'].",
                      .is_in_files = false},
        FindingColumn{
            .member = &StationRow::doubts,
            .key = "doubts",
            .doc =
                "The codes of the warnings for which 'question-in-doubt' is among the reasons: a "
                "list such as ['leaves-scan'].",
            .is_in_files = false},
        FindingColumn{.member = &StationRow::is_searched,
                      .key = "searched",
                      .doc = "Whether the whole vehicle was searched on all of the stretch.",
                      .is_in_files = false},
        FindingColumn{.member = &StationRow::overthrow,
                      .key = "overthrow",
                      .doc = "A list of Overthrow, one for each body of StationTable.bodies.",
                      .is_in_files = false}});

}  // namespace clearway
