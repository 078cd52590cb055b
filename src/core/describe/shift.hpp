#pragma once

#include <tuple>

#include "clearway/shift.hpp"
#include "core/describe/finding.hpp"

namespace clearway {

/// The columns of a shift, in the order of its files, which have the side beside `shift`.
inline constexpr std::tuple kShiftColumns = std::tuple_cat(
    std::tuple{column(&StretchShift::conflict, "conflict",
                      "The id of the conflict whose stretch it is; 0 for the whole path.")},
    kChainagesOfStretch<StretchShift>, kStationsOfStretch<StretchShift>,
    std::tuple{
        column(&StretchShift::first_pose, "first_pose", "The first pose of the stretch."),
        column(&StretchShift::last_pose, "last_pose",
               "The last pose of the stretch; between poses, the way to the next one belongs to "
               "the stretch too."),
        column(&StretchShift::shift, "shift",
               "The shortest shift that frees the stretch, in metres, above 0 to the left; 0 where "
               "it is free as it is, and no value where no shift that was tried frees it."),
        column(&StretchShift::least_distance, "least_distance",
               "The least distance on the shifted stretch, in metres; no value where nothing is "
               "within the clearance of the result, or without a shift."),
        column(&StretchShift::searches, "searches", "How many searches it took."),
        column(&StretchShift::warned_of, "warned_of",
               "The codes of the warnings that a run along the shifted stretch causes and one "
               "along the stretch as it is does not, such as 'nothing-below'; without a shift, "
               "those that put in doubt every shift at which nothing collides: a list of str.",
               {.is_in_files = false})});

}  // namespace clearway
