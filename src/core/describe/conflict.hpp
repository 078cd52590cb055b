#pragma once

#include <tuple>

#include "clearway/conflicts.hpp"
#include "core/describe/finding.hpp"

namespace clearway {

/// The columns of a conflict, in the order of its files. `certain` and the bodies are written by
/// hand there, because what they mean depends on the result.
inline constexpr std::tuple kConflictColumns = std::tuple_cat(
    std::tuple{
        column(&Conflict::id, "id",
               "The number of the conflict, from 1, in the order of the path."),
        column(&Conflict::rank, "rank", "1 for the worst conflict, 2 for the next, and so on."),
        column(&Conflict::points, "points", "How many points the conflict has."),
        column(&Conflict::colliding, "colliding",
               "How many of its points collide; with an error budget the others are near.",
               {.is_in_files = false}),
        column(&Conflict::source, "source", "The smallest source index of the conflict's points."),
        column(&Conflict::box, "box", "The box around the conflict's points, in metres."),
        column(&Conflict::centroid, "centroid", "The mean of the conflict's points, in metres."),
        column(&Conflict::first_pose, "first_pose",
               "The least index of a pose that touches one of its points."),
        column(&Conflict::last_pose, "last_pose",
               "The greatest index of a pose that touches one of its points; between poses, the "
               "start of the last way that does.")},
    kChainagesOfStretch<Conflict>, kStationsOfStretch<Conflict, true>,
    std::tuple{
        column(&Conflict::least_distance, "least_distance",
               "The least distance between the conflict and the model, in metres, below 0 inside a "
               "solid; only where the result has clearances."),
        column(&Conflict::nearest_pose, "nearest_pose",
               "The pose at which the conflict has its least distance; only where the result has "
               "clearances."),
        column(&Conflict::nearest_source, "nearest_source",
               "The source index of the point with the least distance; only where the result has "
               "clearances."),
        column(&Conflict::nearest_point, "nearest_point",
               "The point with the least distance: 3 float64, metres, or None without clearances.",
               {.is_in_files = false}),
        column(&Conflict::encroachment, "encroachment",
               "By how much the conflict is closer than allowed: the radius less least_distance, "
               "in metres; only where the result has clearances."),
        column(&Conflict::encroachment_is, "encroachment_is",
               "'exact' if exactly so much is missing, or 'at-least', because a surface and points "
               "have no inside; only where there is an encroachment."),
        column(&Conflict::side, "side",
               "The side from which the least trim is taken: 'left', 'right', 'above' or 'below'. "
               "Where there is no trim, 'around' for what stands on both sides, or otherwise "
               "first_touch; 'unknown' without the model's box."),
        column(&Conflict::first_touch, "first_touch",
               "The side of the model on which the points lie that are touched first: 'left', "
               "'right', 'above', 'below', 'front', 'behind' or 'unknown'."),
        column(&Conflict::trim_left, "trim_left",
               "How much taken off the left side of the body that is touched first is enough to "
               "free it from the conflict, in metres; less may do. It has no value where it would "
               "be more than half of the body.",
               {.rounds_up = true}),
        column(&Conflict::trim_right, "trim_right",
               "How much taken off its right side is enough, as for trim_left.",
               {.rounds_up = true}),
        column(&Conflict::trim_above, "trim_above",
               "How much taken off it from above is enough, as for trim_left.",
               {.rounds_up = true}),
        column(&Conflict::trim_below, "trim_below",
               "How much taken off it from below is enough, as for trim_left; it is measured from "
               "the lowest part of the body on, also where a floor is above it.",
               {.rounds_up = true}),
        column(&Conflict::lateral, "lateral",
               "How far the nearest point, or without clearances the first one that is touched, is "
               "to the left of the pose's position, in metres; below 0 to the right. Of a vehicle, "
               "the pose is that of the body."),
        column(&Conflict::height, "height",
               "How far the same point is above the pose's position, in metres; below 0 under it."),
        column(&Conflict::group, "group",
               "The smallest source index of the group that the conflict was cut from; conflicts "
               "of one group have the same."),
        column(&Conflict::depth, "depth",
               "How deep the conflict's deepest point is inside the model at any pose, in metres; "
               "0 where none is. It is exact where the model has solids and the result clearances, "
               "and otherwise the greatest depth of a run with --depth, an estimate."),
        column(&Conflict::points_inside, "points_inside",
               "How many of the conflict's points are inside the model at any pose; only where "
               "there is an exact depth."),
        column(&Conflict::depth_source, "depth_source",
               "The source index of the free point that depth is measured to; only where it is an "
               "estimate."),
        column(&Conflict::obstacle_chainage, "obstacle_chainage",
               "How far along the path the nearest point of the obstacle itself stands, in metres, "
               "whichever part of the vehicle meets it and whichever way it faces."),
        column(&Conflict::own_shift_left, "own_shift_left",
               "How far the vehicle has to be shifted to the left at least, so that the conflict's "
               "own points are free, in metres. It has no value where 2 m are not enough, or where "
               "no model was given."),
        column(&Conflict::own_shift_right, "own_shift_right",
               "How far the vehicle has to be shifted to the right at least, or no value as for "
               "own_shift_left."),
        column(&Conflict::main_class, "main_class",
               "The class that most points of the conflict have, as the scans have it, such as 18 "
               "for high noise; only where they have classes."),
        column(&Conflict::main_class_points, "main_class_points",
               "How many of the conflict's points have that class."),
        column(&Conflict::certain, "certain",
               "Whether the conflict is certain by the error budget, because ten or more of its "
               "points hang together and are certainly too close; False where it is possible, None "
               "without a budget.",
               {.is_in_files = false}),
        column(&Conflict::body, "body",
               "The body of the vehicle that comes closest, or without clearances touches first, "
               "as an index of Result.bodies(). None where there is one model.",
               {.is_in_files = false}),
        column(&Conflict::first_body, "first_body",
               "The body that is touched first, which the trims are taken from, as an index of "
               "Result.bodies(). None where there is one model.",
               {.is_in_files = false})});

/// The columns of a group that is too small to be a conflict.
inline constexpr std::tuple kSmallGroupColumns = std::tuple_cat(
    std::tuple{
        column(&SmallGroup::points, "points", "How many colliding points the group has."),
        column(&SmallGroup::source, "source", "The smallest source index of the group's points."),
        column(&SmallGroup::box, "box", "The box around the group's points, metres."),
        column(&SmallGroup::first_pose, "first_pose",
               "The least index of a pose that touches one of its points."),
        column(&SmallGroup::last_pose, "last_pose",
               "The greatest index of a pose that touches one of its points.")},
    kChainagesOfStretch<SmallGroup>, kStationsOfStretch<SmallGroup, true>);

}  // namespace clearway
