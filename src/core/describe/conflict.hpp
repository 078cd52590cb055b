#pragma once

#include <tuple>

#include "clearway/conflicts.hpp"
#include "core/describe/finding.hpp"

namespace clearway {

/// The columns of a conflict, in the order of its files. `certain` and the bodies are written by
/// hand there, because what they mean depends on the result.
inline constexpr std::tuple kConflictColumns = std::tuple_cat(
    std::tuple{
        FindingColumn{.member = &Conflict::id,
                      .key = "id",
                      .doc = "The number of the conflict, from 1, in the order of the path."},
        FindingColumn{.member = &Conflict::rank,
                      .key = "rank",
                      .doc = "1 for the worst conflict, 2 for the next, and so on."},
        FindingColumn{.member = &Conflict::points,
                      .key = "points",
                      .doc = "How many points the conflict has."},
        FindingColumn{.member = &Conflict::colliding,
                      .key = "colliding",
                      .doc = "How many of its points collide; with an error budget the others are "
                             "near.",
                      .is_in_files = false},
        FindingColumn{.member = &Conflict::source,
                      .key = "source",
                      .doc = "The smallest source index of the conflict's points."},
        FindingColumn{.member = &Conflict::box,
                      .key = "box",
                      .doc = "The box around the conflict's points, in metres."},
        FindingColumn{.member = &Conflict::centroid,
                      .key = "centroid",
                      .doc = "The mean of the conflict's points, in metres."},
        FindingColumn{.member = &Conflict::first_pose,
                      .key = "first_pose",
                      .doc = "The least index of a pose that touches one of its points."},
        FindingColumn{
            .member = &Conflict::last_pose,
            .key = "last_pose",
            .doc = "The greatest index of a pose that touches one of its points; between poses, "
                   "the start of the last way that does."}},
    kChainagesOfStretch<Conflict>, kStationsOfStretch<Conflict, true>,
    std::tuple{
        FindingColumn{.member = &Conflict::least_distance,
                      .key = "least_distance",
                      .doc = "The least distance between the conflict and the model, in metres, "
                             "below 0 inside a solid; only where the result has clearances."},
        FindingColumn{.member = &Conflict::nearest_pose,
                      .key = "nearest_pose",
                      .doc = "The pose at which the conflict has its least distance; only where "
                             "the result has clearances."},
        FindingColumn{.member = &Conflict::nearest_source,
                      .key = "nearest_source",
                      .doc = "The source index of the point with the least distance; only where "
                             "the result has clearances."},
        FindingColumn{.member = &Conflict::nearest_point,
                      .key = "nearest_point",
                      .doc =
                          "The point with the least distance: 3 float64, metres, or None without "
                          "clearances.",
                      .is_in_files = false},
        FindingColumn{.member = &Conflict::encroachment,
                      .key = "encroachment",
                      .doc = "By how much the conflict is closer than allowed: the radius less "
                             "least_distance, in metres; only where the result has clearances."},
        FindingColumn{.member = &Conflict::encroachment_is,
                      .key = "encroachment_is",
                      .doc = "'exact' if exactly so much is missing, or 'at-least', because a "
                             "surface and points have no inside; only where there is an "
                             "encroachment."},
        FindingColumn{.member = &Conflict::side,
                      .key = "side",
                      .doc = "The side from which the least trim is taken: 'left', 'right', "
                             "'above' or 'below'. Where there is no trim, 'around' for what stands "
                             "on both sides, or otherwise first_touch; 'unknown' without the "
                             "model's box."},
        FindingColumn{.member = &Conflict::first_touch,
                      .key = "first_touch",
                      .doc = "The side of the model on which the points lie that are touched "
                             "first: 'left', 'right', 'above', 'below', 'front', 'behind' or "
                             "'unknown'."},
        FindingColumn{.member = &Conflict::trim_left,
                      .key = "trim_left",
                      .doc = "How much taken off the left side of the body that is touched first "
                             "is enough to free it from the conflict, in metres; less may do. It "
                             "has no value where it would be more than half of the body.",
                      .rounds_up = true},
        FindingColumn{.member = &Conflict::trim_right,
                      .key = "trim_right",
                      .doc = "How much taken off its right side is enough, as for trim_left.",
                      .rounds_up = true},
        FindingColumn{.member = &Conflict::trim_above,
                      .key = "trim_above",
                      .doc = "How much taken off it from above is enough, as for trim_left.",
                      .rounds_up = true},
        FindingColumn{
            .member = &Conflict::trim_below,
            .key = "trim_below",
            .doc = "How much taken off it from below is enough, as for trim_left; it is measured "
                   "from the lowest part of the body on, also where a floor is above it.",
            .rounds_up = true},
        FindingColumn{.member = &Conflict::lateral,
                      .key = "lateral",
                      .doc = "How far the nearest point, or without clearances the first one that "
                             "is touched, is to the left of the pose's position, in metres; below "
                             "0 to the right. Of a vehicle, the pose is that of the body."},
        FindingColumn{.member = &Conflict::height,
                      .key = "height",
                      .doc = "How far the same point is above the pose's position, in metres; "
                             "below 0 under it."},
        FindingColumn{.member = &Conflict::group,
                      .key = "group",
                      .doc = "The smallest source index of the group that the conflict was cut "
                             "from; conflicts of one group have the same."},
        FindingColumn{
            .member = &Conflict::depth,
            .key = "depth",
            .doc =
                "How deep the conflict's deepest point is inside the model at any pose, in metres; "
                "0 where none is. It is exact where the model has solids and the result "
                "clearances, and otherwise the greatest depth of a run with --depth, an "
                "estimate."},
        FindingColumn{.member = &Conflict::points_inside,
                      .key = "points_inside",
                      .doc = "How many of the conflict's points are inside the model at any pose; "
                             "only where there is an exact depth."},
        FindingColumn{.member = &Conflict::depth_source,
                      .key = "depth_source",
                      .doc = "The source index of the free point that depth is measured to; only "
                             "where it is an estimate."},
        FindingColumn{
            .member = &Conflict::obstacle_chainage,
            .key = "obstacle_chainage",
            .doc = "How far along the path the nearest point of the obstacle itself stands, in "
                   "metres, whichever part of the vehicle meets it and whichever way it faces."},
        FindingColumn{.member = &Conflict::own_shift_left,
                      .key = "own_shift_left",
                      .doc = "How far the vehicle has to be shifted to the left at least, so that "
                             "the conflict's own points are free, in metres. It has no value where "
                             "2 m are not enough, or where no model was given."},
        FindingColumn{
            .member = &Conflict::own_shift_right,
            .key = "own_shift_right",
            .doc =
                "How far the vehicle has to be shifted to the right at least, or no value as for "
                "own_shift_left."},
        FindingColumn{.member = &Conflict::main_class,
                      .key = "main_class",
                      .doc = "The class that most points of the conflict have, as the scans have "
                             "it, such as 18 for high noise; only where they have classes."},
        FindingColumn{.member = &Conflict::main_class_points,
                      .key = "main_class_points",
                      .doc = "How many of the conflict's points have that class."},
        FindingColumn{
            .member = &Conflict::certain,
            .key = "certain",
            .doc = "Whether the conflict is certain by the error budget, because ten or more of "
                   "its points hang together and are certainly too close; False where it is "
                   "possible, None without a budget.",
            .is_in_files = false},
        FindingColumn{
            .member = &Conflict::body,
            .key = "body",
            .doc = "The body of the vehicle that comes closest, or without clearances touches "
                   "first, as an index of Result.bodies(). None where there is one model.",
            .is_in_files = false},
        FindingColumn{
            .member = &Conflict::first_body,
            .key = "first_body",
            .doc = "The body that is touched first, which the trims are taken from, as an index of "
                   "Result.bodies(). None where there is one model.",
            .is_in_files = false}});

/// The columns of a group that is too small to be a conflict.
inline constexpr std::tuple kSmallGroupColumns = std::tuple_cat(
    std::tuple{
        FindingColumn{.member = &SmallGroup::points,
                      .key = "points",
                      .doc = "How many colliding points the group has."},
        FindingColumn{.member = &SmallGroup::source,
                      .key = "source",
                      .doc = "The smallest source index of the group's points."},
        FindingColumn{.member = &SmallGroup::box,
                      .key = "box",
                      .doc = "The box around the group's points, metres."},
        FindingColumn{.member = &SmallGroup::first_pose,
                      .key = "first_pose",
                      .doc = "The least index of a pose that touches one of its points."},
        FindingColumn{.member = &SmallGroup::last_pose,
                      .key = "last_pose",
                      .doc = "The greatest index of a pose that touches one of its points."}},
    kChainagesOfStretch<SmallGroup>, kStationsOfStretch<SmallGroup, true>);

}  // namespace clearway
