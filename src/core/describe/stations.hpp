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
        column(&StationRow::least, "least",
               "The point that is nearest to the vehicle on the stretch, by the profile of its "
               "poses and the clearances of the points whose nearest pose is on it."),
        column(&StationRow::least_below, "least_below",
               "The radius, where the stretch has a conflict whose least distance is not known: it "
               "is below this."),
        column(&StationRow::least_above, "least_above",
               "The distance that the profile was asked for, where the stretch is clear and no "
               "pose of it found anything closer.",
               {.is_in_files = false}),
        column(&StationRow::left, "left",
               "The nearest of the points whose nearest pose is on the stretch and that lie to the "
               "left of their body's box."),
        column(&StationRow::right, "right",
               "The nearest of those to the right of their body's box."),
        column(&StationRow::above, "above", "The nearest of those above their body's box."),
        column(&StationRow::verdict, "verdict", "'clear', 'conflict' or 'undecided'."),
        column(&StationRow::reasons, "reasons",
               "Why the verdict is undecided: a list such as ['near'].", {.is_in_files = false}),
        column(&StationRow::doubts, "doubts",
               "The codes of the warnings for which 'question-in-doubt' is among the reasons: a "
               "list such as ['leaves-scan'].",
               {.is_in_files = false}),
        column(&StationRow::is_searched, "searched",
               "Whether the whole vehicle was searched on all of the stretch.",
               {.is_in_files = false}),
        column(&StationRow::overthrow, "overthrow",
               "A list of Overthrow, one for each body of StationTable.bodies.",
               {.is_in_files = false})});

}  // namespace clearway
