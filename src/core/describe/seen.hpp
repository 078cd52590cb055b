#pragma once

#include <tuple>

#include "clearway/seen.hpp"
#include "core/describe/finding.hpp"

namespace clearway {

/// What is known of the space that the model sweeps, in the order of JSON.
inline constexpr std::tuple kSeenColumns{
    column(&SeenSummary::cube, "cube", "The side of a cube along x, metres."),
    column(&SeenSummary::swept, "swept", "How many cubes the model sweeps."),
    column(&SeenSummary::seen, "seen", "How many of them a beam passed through."),
    column(&SeenSummary::unseen, "unseen", "How many of them no beam passed through."),
    column(&SeenSummary::groups, "groups",
           "How many groups of unseen cubes there are that touch each other."),
    column(
        &SeenSummary::listed_groups, "listed_groups",
        "How many of the groups have at least seen_min cubes, which makes the verdict undecided."),
    column(&SeenSummary::listed_cubes, "listed_cubes", "How many cubes these groups have.",
           {.is_in_files = false}),
    column(&SeenSummary::not_scanned_length, "not_scanned_length",
           "Metres of the path on which the model first reaches a cube of a listed group.")};

}  // namespace clearway
