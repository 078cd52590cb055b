#pragma once

#include <tuple>

#include "clearway/convert.hpp"
#include "clearway/report.hpp"
#include "clearway/smooth.hpp"
#include "clearway/stations.hpp"
#include "clearway/unsearched.hpp"
#include "core/describe/fact.hpp"

namespace clearway {

/// How points found their places on the path of a scanner.
template <>
inline constexpr std::tuple kFactsOf<OriginsPathReport>{
    fact<&OriginsPathReport::point_clock>(
        "What the GPS times of the points are: 'week-seconds', 'adjusted' (adjusted standard GPS "
        "time), or 'mixed' where files differ."),
    fact<&OriginsPathReport::path_clock>(
        "What the times of the path are taken for: 'week-seconds', 'adjusted', or 'standard', "
        "which is any other epoch."),
    fact<&OriginsPathReport::first_point>("The least GPS time of a point, seconds as in the file."),
    fact<&OriginsPathReport::last_point>(
        "The greatest GPS time of a point, seconds as in the file."),
    fact<&OriginsPathReport::first_pose>("The time of the first pose, seconds."),
    fact<&OriginsPathReport::last_pose>("The time of the last pose, seconds."),
    fact<&OriginsPathReport::shifts>("What was added to times of points to compare them with the "
                                     "path: a list of seconds, ascending."),
    fact<&OriginsPathReport::before>("How many points are from before the first pose."),
    fact<&OriginsPathReport::after>("How many points are from after the last pose."),
    fact<&OriginsPathReport::in_gaps>(
        "How many points are from between poses more than 1 s apart."),
    fact<&OriginsPathReport::without_time>("How many points have no finite GPS time.")};

/// What a conversion did.
template <>
inline constexpr std::tuple kFactsOf<ConvertReport>{
    fact<&ConvertReport::was_finished>(
        "Whether the store was there already, so that nothing was converted. Then only what the "
        "store keeps is known, and records without a point count as points that are not finite."),
    fact<&ConvertReport::points>("How many points were stored."),
    fact<&ConvertReport::cells>("Into how many cells the points were divided."),
    fact<&ConvertReport::non_finite_points>(
        "How many points were left out because a coordinate was not a finite number."),
    fact<&ConvertReport::absent_points>(
        "How many records of the scans have no point, such as beams that hit nothing."),
    fact<&ConvertReport::withheld_points>(
        "How many points were left out because they have the flag withheld."),
    fact<&ConvertReport::kept_withheld_points>(
        "How many points were stored although they have the flag withheld."),
    fact<&ConvertReport::far_points>(
        "How many points were left out because they are too far from the path of near."),
    fact<&ConvertReport::unread_points>("How many of these were not even read."),
    fact<&ConvertReport::passed_over_files>(
        "How many files were not read because of trust_bounds."),
    fact<&ConvertReport::origins>(
        "From how many distinct places the points were seen; 0 where no input says so."),
    fact<&ConvertReport::points_without_origin>(
        "For how many points it is not known from where they were seen."),
    fact<&ConvertReport::origins_path>("How the points found their places on origins_path: an "
                                       "OriginsPathReport; None without it."),
    fact<&ConvertReport::scale>(
        "The step of the stored coordinates on each axis: 3 float64, metres."),
    fact<&ConvertReport::offset>(
        "The place that the stored coordinates count from: 3 float64, metres."),
    fact<&ConvertReport::box>("The Box around the points of the scans, those too far from a path "
                              "included; None where there are no points."),
    fact<&ConvertReport::largest_change>(
        "By how much rounding to the scale changed any coordinate at the most, metres."),
    fact<&ConvertReport::temporary_bytes>("How many bytes temporary files took."),
    fact<&ConvertReport::output_bytes>("How many bytes the store has."),
    fact<&ConvertReport::resumed_from>(
        "What an interrupted call had come to, which resume=True took over: 'the inputs were "
        "inspected', 'all points were counted' or 'all points were distributed'. Empty where "
        "nothing was taken over."),
    fact<&ConvertReport::count_seconds>("Seconds of counting the points of the inputs."),
    fact<&ConvertReport::distribute_seconds>(
        "Seconds of distributing the points to places of the store."),
    fact<&ConvertReport::partition_seconds>(
        "Seconds of dividing the points into cells and writing them."),
    fact<&ConvertReport::confirm_seconds>(
        "Seconds of confirming that the inputs did not change meanwhile."),
    fact<&ConvertReport::warnings>("What may be wrong with the scans: a list of Message.")};

/// The conflicts of a result.
template <>
inline constexpr std::tuple kFactsOf<Conflicts>{
    fact<&Conflicts::listed>("The conflicts: a list of Conflict in the order of the path."),
    fact<&Conflicts::small>("A list of SmallGroup along the path: the groups that are not listed."),
    fact<&Conflicts::gap>(
        "How far apart points of one conflict are at most: the gap that was used."),
    fact<&Conflicts::min_points>(
        "How many points a conflict has at least: the number that was used."),
    fact<&Conflicts::spacing>(
        "How far apart colliding points are, as the lower median of the distances to the nearest "
        "one at another place; None with fewer than 10 places."),
    fact<&Conflicts::colliding_points>("How many colliding points the result has, listed or not."),
    fact<&Conflicts::classes>("How many colliding and near points have each class: a dict of "
                              "numbers by class, which is empty unless the scans have classes."),
    fact<&Conflicts::groups>(
        "How many groups there are before long ones are cut, small ones included."),
    fact<&Conflicts::small_groups>("How many groups have too few points to be listed."),
    fact<&Conflicts::small_points>("How many points the groups have that are not listed."),
    fact<&Conflicts::path_length>("How long the path is, metres."),
    fact<&Conflicts::longest_group>(
        "The longest stretch of the path that one group covers, metres."),
    fact<&Conflicts::longest_group_points>("How many points that longest group has."),
    fact<&Conflicts::longest_group_height_from>(
        "How far the lowest point of that group lies above the lowest point of the model, metres. "
        "None unless the group spans half of the path or more."),
    fact<&Conflicts::longest_group_height_to>(
        "How far its highest point lies above the lowest point of the model, metres."),
    fact<&Conflicts::longest_group_is>(
        "What that group probably is: 'ground' where most of it lies in the lowest 0.5 m, 'inside' "
        "where all of it lies within the model's width and height, as the vehicle does that "
        "carried the scanner, otherwise 'other'.")};

/// How far a body leaves the path in a curve.
template <>
inline constexpr std::tuple kFactsOf<Overthrow>{
    fact<&Overthrow::end>(
        "The greatest overthrow of the body's two ends, outwards: metres, or None."),
    fact<&Overthrow::middle>(
        "The greatest overthrow of the body's middle, inwards: metres, or None.")};

/// The path of a result, stretch by stretch.
template <>
inline constexpr std::tuple kFactsOf<StationTable>{
    fact<&StationTable::bodies>("The names of the bodies; for one model a single empty name."),
    fact<&StationTable::rows>("A list of StationRow in the order of the path."),
    fact<&StationTable::warnings>("A list of Message: what the table lacks, and why.")};

/// The shifts of a path.
template <>
inline constexpr std::tuple kFactsOf<ShiftTable>{
    fact<&ShiftTable::path>("The StretchShift of the whole path."),
    fact<&ShiftTable::conflicts>("A list of StretchShift, one for each conflict, in their order."),
    fact<&ShiftTable::lateral_from>(
        "The shift farthest to the right that was tried, metres, 0 or below it."),
    fact<&ShiftTable::lateral_to>("The shift farthest to the left that was tried, metres."),
    fact<&ShiftTable::step>("The shifts were multiples of it, metres."),
    fact<&ShiftTable::searches>("How many searches it took for all."),
    fact<&ShiftTable::seconds>("How many seconds it took.")};

/// What is left of an answer without the accepted conflicts.
template <>
inline constexpr std::tuple kFactsOf<OutsideOfAccepted>{
    fact<&OutsideOfAccepted::verdict>(
        "'conflict' where a colliding point is left, of a small group too; otherwise what the "
        "verdict would be if the points of accepted conflicts were not there."),
    fact<&OutsideOfAccepted::colliding>("How many colliding points are in no accepted conflict.",
                                        "colliding_points"),
    fact<&OutsideOfAccepted::near>("How many near points are in no accepted conflict.",
                                   "near_points")};

/// A ledger that was compared with a result.
template <>
inline constexpr std::tuple kFactsOf<Ledger>{
    fact<&Ledger::rows>("The rows: a list of LedgerRow in the order of the table; those that an "
                        "update adds come last."),
    fact<&Ledger::conflicts>(
        "A list of LedgerEntry, one for each listed conflict, in their order."),
    fact<&Ledger::date>("The day of the run, such as '2026-06-30'."),
    fact<&Ledger::is_updated>("Whether the files were updated."),
    fact<&Ledger::outside>("What is left without the accepted conflicts: an OutsideOfAccepted."),
    fact<&Ledger::accepted_conflicts>("How many conflicts are accepted.")};

/// A stretch on which bodies have no pose.
template <>
inline constexpr std::tuple kFactsOf<UnsearchedStretch>{
    fact<&UnsearchedStretch::first_pose>("The path's pose at its start."),
    fact<&UnsearchedStretch::last_pose>("The path's pose at its end."),
    fact<&UnsearchedStretch::chainage_from>("Metres along the path."),
    fact<&UnsearchedStretch::chainage_to>("Metres along the path."),
    fact<&UnsearchedStretch::bodies>("Indices of the bodies without a pose there, ascending."),
    fact<&UnsearchedStretch::has_answer>("Whether other bodies were searched there.")};

/// A path on a smooth curve.
template <>
inline constexpr std::tuple kFactsOf<SmoothPath>{
    fact<&SmoothPath::poses>("The new poses: n x 4 x 4 float64."),
    fact<&SmoothPath::control_points>("How many control points the curve has."),
    fact<&SmoothPath::largest_deviation>(
        "The farthest that a model point is from where the given path has it."),
    fact<&SmoothPath::mean_deviation>(
        "The mean of the greatest deviation at each of the given poses."),
    fact<&SmoothPath::largest_step>(
        "The most that a model point moves from one new pose to the next."),
    fact<&SmoothPath::error_between_poses>(
        "The error_model of a query with between_poses that covers the given path."),
    fact<&SmoothPath::error_at_poses>(
        "The error_model of a query without between_poses that covers the given path.")};

/// What the page of a report says.
template <>
inline constexpr std::tuple kFactsOf<ReportSummary>{
    fact<&ReportSummary::clear>("Whether the verdict is 'clear'."),
    fact<&ReportSummary::verdict>("The verdict: 'clear', 'conflict' or 'undecided'."),
    fact<&ReportSummary::bytes>("How many bytes the page has."),
    fact<&ReportSummary::facts>("What the page says, without its points: a text of JSON.")};

}  // namespace clearway
