#pragma once

#include <tuple>

#include "clearway/shift.hpp"
#include "core/describe/finding.hpp"

namespace clearway {

/// The columns of a shift, in the order of its files, which have the side beside `shift`.
inline constexpr std::tuple kShiftColumns = std::tuple_cat(
    std::tuple{
        FindingColumn{.member = &StretchShift::conflict,
                      .key = "conflict",
                      .doc = "The id of the conflict whose stretch it is; 0 for the whole path."}},
    kChainagesOfStretch<StretchShift>, kStationsOfStretch<StretchShift>,
    std::tuple{
        FindingColumn{.member = &StretchShift::first_pose,
                      .key = "first_pose",
                      .doc = "The first pose of the stretch."},
        FindingColumn{
            .member = &StretchShift::last_pose,
            .key = "last_pose",
            .doc =
                "The last pose of the stretch; between poses, the way to the next one belongs to "
                "the stretch too."},
        FindingColumn{
            .member = &StretchShift::shift,
            .key = "shift",
            .doc =
                "The shortest shift that frees the stretch, in metres, above 0 to the left; 0 "
                "where it is free as it is, and no value where no shift that was tried frees it."},
        FindingColumn{.member = &StretchShift::least_distance,
                      .key = "least_distance",
                      .doc = "The least distance on the shifted stretch, in metres; no value where "
                             "nothing is within the clearance of the result, or without a shift."},
        FindingColumn{.member = &StretchShift::searches,
                      .key = "searches",
                      .doc = "How many searches it took."},
        FindingColumn{
            .member = &StretchShift::warned_of,
            .key = "warned_of",
            .doc = "The codes of the warnings that a run along the shifted stretch causes and one "
                   "along the stretch as it is does not, such as 'nothing-below'; without a shift, "
                   "those that put in doubt every shift at which nothing collides: a list of str.",
            .is_in_files = false}});

}  // namespace clearway
