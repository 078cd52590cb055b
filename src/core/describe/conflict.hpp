#pragma once

#include <tuple>

#include "clearway/conflicts.hpp"
#include "core/describe/finding.hpp"

namespace clearway {

/// The stations of a stretch of the path, which rows have where the labels of the poses do.
template <typename Row>
inline constexpr std::tuple kStationsOfStretch{
    FindingColumn{
        .member = &Row::station_from,
        .key = "station_from",
        .doc = "Station along the alignment of the pose of chainage_from, metres; None unless "
               "the labels have stations.",
        .is_left_out = true},
    FindingColumn{.member = &Row::station_to,
                  .key = "station_to",
                  .doc = "Station along the alignment of the pose of chainage_to, metres, or None.",
                  .is_left_out = true}};

/// The columns of a conflict, in the order of its files. `certain` and `body` are written by hand
/// there, because what they mean depends on the result.
inline constexpr std::tuple kConflictColumns = std::tuple_cat(
    std::tuple{
        FindingColumn{.member = &Conflict::id,
                      .key = "id",
                      .doc = "The number of the conflict, from 1, in the order of the path."},
        FindingColumn{.member = &Conflict::points,
                      .key = "points",
                      .doc = "How many colliding points the conflict has."},
        FindingColumn{.member = &Conflict::source,
                      .key = "source",
                      .doc = "The smallest source index of the conflict's points."},
        FindingColumn{.member = &Conflict::box,
                      .key = "box",
                      .doc = "The box around the conflict's points, in metres."},
        FindingColumn{.member = &Conflict::centroid,
                      .key = "centroid",
                      .doc = "The mean of the conflict's points: 3 float64, metres."},
        FindingColumn{.member = &Conflict::first_pose,
                      .key = "first_pose",
                      .doc = "The least index of a pose that touches one of its points."},
        FindingColumn{
            .member = &Conflict::last_pose,
            .key = "last_pose",
            .doc = "The greatest index of a pose that touches one of its points; between poses, "
                   "the start of the last way that does."}},
    kChainagesOfStretch<Conflict>, kStationsOfStretch<Conflict>,
    std::tuple{
        FindingColumn{
            .member = &Conflict::least_distance,
            .key = "least_distance",
            .doc = "The least distance between the conflict and the model, metres. None where "
                   "the result has no clearances."},
        FindingColumn{.member = &Conflict::nearest_pose,
                      .key = "nearest_pose",
                      .doc =
                          "The pose at which the conflict has its least distance, or None without "
                          "clearances."},
        FindingColumn{.member = &Conflict::nearest_source,
                      .key = "nearest_source",
                      .doc =
                          "The source index of the point with the least distance, or None without "
                          "clearances."},
        FindingColumn{.member = &Conflict::nearest_point,
                      .key = "nearest_point",
                      .doc =
                          "The point with the least distance: 3 float64, metres, or None without "
                          "clearances.",
                      .is_in_files = false},
        FindingColumn{
            .member = &Conflict::encroachment,
            .key = "encroachment",
            .doc = "By how much the conflict is closer than allowed: radius - least_distance, "
                   "metres, or None without clearances."},
        FindingColumn{.member = &Conflict::side,
                      .key = "side",
                      .doc =
                          "On which side of the model the conflict is: 'left', 'right', 'above', "
                          "'below', 'front', 'behind' or 'unknown'."},
        FindingColumn{
            .member = &Conflict::lateral,
            .key = "lateral",
            .doc = "How far the conflict is to the left of the model's pose, or of its body's "
                   "with bodies=; metres, negative to the right, or None."},
        FindingColumn{.member = &Conflict::height,
                      .key = "height",
                      .doc =
                          "How far the conflict is above the model's pose, or of its body's with "
                          "bodies=; metres, or None."},
        FindingColumn{.member = &Conflict::group,
                      .key = "group",
                      .doc =
                          "The smallest source index of the group that the conflict was cut from; "
                          "conflicts of one group have the same."},
        FindingColumn{
            .member = &Conflict::depth,
            .key = "depth",
            .doc = "How deep the conflict's deepest point is inside the model, metres; 0 where "
                   "none is. None where the model has no solids, or the result no clearances."},
        FindingColumn{
            .member = &Conflict::points_inside,
            .key = "points_inside",
            .doc = "How many of the conflict's points are inside the model at any pose, or None "
                   "as for depth."},
        FindingColumn{
            .member = &Conflict::obstacle_chainage,
            .key = "obstacle_chainage",
            .doc = "Station of the obstacle itself: the chainage of the pose that it is seen "
                   "from, plus how far ahead of it the nearest point lies, metres, or None."},
        FindingColumn{
            .member = &Conflict::shift_left,
            .key = "shift_left",
            .doc = "How far the vehicle has to be shifted to the left so that the conflict's "
                   "own points are free, metres. None: 2 m are too little, or no model was "
                   "given."},
        FindingColumn{
            .member = &Conflict::shift_right,
            .key = "shift_right",
            .doc = "How far the vehicle has to be shifted to the right so that the conflict's "
                   "own points are free, metres, or None as for shift_left."},
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
    kChainagesOfStretch<SmallGroup>, kStationsOfStretch<SmallGroup>);

}  // namespace clearway
