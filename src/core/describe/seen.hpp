#pragma once

#include <tuple>

#include "clearway/seen.hpp"
#include "core/describe/finding.hpp"

namespace clearway {

/// What is known of the space that the model sweeps, in the order of JSON.
inline constexpr std::tuple kSeenColumns{
    FindingColumn{
        .member = &SeenSummary::cube, .key = "cube", .doc = "The side of a cube along x, metres."},
    FindingColumn{
        .member = &SeenSummary::swept, .key = "swept", .doc = "How many cubes the model sweeps."},
    FindingColumn{.member = &SeenSummary::seen,
                  .key = "seen",
                  .doc = "How many of them a beam passed through."},
    FindingColumn{.member = &SeenSummary::unseen,
                  .key = "unseen",
                  .doc = "How many of them no beam passed through."},
    FindingColumn{.member = &SeenSummary::groups,
                  .key = "groups",
                  .doc = "How many groups of unseen cubes there are that touch each other."},
    FindingColumn{.member = &SeenSummary::listed_groups,
                  .key = "listed_groups",
                  .doc = "How many of the groups have at least seen_min cubes, which makes the "
                         "verdict undecided."},
    FindingColumn{.member = &SeenSummary::listed_cubes,
                  .key = "listed_cubes",
                  .doc = "How many cubes these groups have.",
                  .is_in_files = false},
    FindingColumn{.member = &SeenSummary::not_scanned_length,
                  .key = "not_scanned_length",
                  .doc = "Metres of the path on which the model first reaches a cube of a listed "
                         "group."}};

}  // namespace clearway
