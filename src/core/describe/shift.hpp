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
    kChainagesOfStretch<StretchShift>,
    std::tuple{
        FindingColumn{
            .member = &StretchShift::station_from,
            .key = "station_from",
            .doc = "Station along the alignment of the pose of chainage_from, metres; None unless "
                   "the labels have stations."},
        FindingColumn{
            .member = &StretchShift::station_to,
            .key = "station_to",
            .doc = "Station along the alignment of the pose of chainage_to, metres, or None."},
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
            .doc = "The shift with the least length that frees the stretch, metres, above 0 to the "
                   "left. None where no shift that was tried does."},
        FindingColumn{
            .member = &StretchShift::least_distance,
            .key = "least_distance",
            .doc =
                "The least distance on the shifted stretch, metres. None where nothing is within "
                "the clearance that the result was asked for, or without a shift."},
        FindingColumn{.member = &StretchShift::searches,
                      .key = "searches",
                      .doc = "How many searches it took."},
        FindingColumn{
            .member = &StretchShift::warned_of,
            .key = "warned_of",
            .doc = "The codes of the warnings that a run along the shifted stretch causes and one "
                   "along the stretch as it is does not, such as 'leaves-scan': a list of str.",
            .is_in_files = false}});

}  // namespace clearway
