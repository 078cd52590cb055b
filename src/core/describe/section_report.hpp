#pragma once

#include <tuple>

#include "clearway/section.hpp"
#include "core/describe/answer.hpp"
#include "core/describe/fact.hpp"

namespace clearway {

/// What is not known of a section.
template <>
inline constexpr std::tuple kFactsOf<SectionSeenCounts>{
    fact<&SectionSeenCounts::cube>("The side of the cubes of space, metres."),
    fact<&SectionSeenCounts::unknown>(
        "How many cells are not known somewhere on the path, and not blocked before."),
    fact<&SectionSeenCounts::unknown_in_bins>(
        "How many cells are not known in each stretch, added up.")};

/// What ignored points would block.
template <>
inline constexpr std::tuple kFactsOf<SectionIgnoredCells>{
    fact<&SectionIgnoredCells::blocked>("How many such cells there are."),
    fact<&SectionIgnoredCells::high>(
        "How many of them begin more than 0.5 m above z = 0, where the wheels stand.")};

/// How a section was found.
template <>
inline constexpr std::tuple kFactsOf<SectionReport>{
    fact<&SectionReport::blocked>(
        "How many cells of the cross-section are blocked somewhere on the path."),
    fact<&SectionReport::blocked_in_bins>("How many cells are blocked in each stretch, added up."),
    fact<&SectionReport::bins>("How many stretches there are in which the load has a pose."),
    fact<&SectionReport::rounding>(
        "Upper bound on the rounding of a place in the frame of the load, metres."),
    fact<&SectionReport::motion>("How far the load moves along x, and across, from a pose to the "
                                 "next, metres; None unless between_poses was given."),
    fact<&SectionReport::ignored_points>("How many points of the environment were left out."),
    fact<&SectionReport::ignored_cells>(
        "The cells that are free only because points were left out: SectionIgnoredCells, or None "
        "where nothing was to be left out."),
    fact<&SectionReport::seen>(
        "How many cells are not known: SectionSeenCounts, or None unless seen was given."),
    fact<&SectionReport::warnings>("What the section may have misread: a list of Message."),
    fact<&SectionReport::device>("The device that searched: 'cpu' or 'cuda'."),
    fact<&SectionReport::device_name>(
        "The name of the device for people, such as that of the GPU."),
    fact<&SectionReport::estimate>(
        "The DeviceEstimate by which device 'auto' chose. None where it had no choice."),
    fact<&SectionReport::peak_device_bytes>("How many bytes were taken on the GPU."),
    fact<&SectionReport::needed_host_bytes>("How many bytes of working memory the search took."),
    fact<&SectionReport::seconds>("Seconds of the whole call."),
    fact<&SectionReport::search_seconds>("Seconds of searching the points, without the two below."),
    fact<&SectionReport::engine_seconds>("Seconds of making the engine with its memory."),
    fact<&SectionReport::context_wait_seconds>(
        "Seconds that the search waited for the GPUs to start.")};

/// The ranges that a section was asked for.
template <>
inline constexpr std::tuple kFactsOf<SectionParameters>{
    fact<&SectionParameters::rear>("Where the load begins along x in its own frame."),
    fact<&SectionParameters::front>("Where the load ends along x in its own frame."),
    fact<&SectionParameters::pivots>("The two places of the load that lie on the path, front and "
                                     "rear; None where the load has the poses of the path.")};

/// A place that stops a load.
template <>
inline constexpr std::tuple kFactsOf<SectionStop>{
    fact<&SectionStop::bin>("The number of the stretch of the path."),
    fact<&SectionStop::first_pose>("The first pose of the stretch that stops the load."),
    fact<&SectionStop::chainage>("How far along the path that pose is, metres."),
    fact<&SectionStop::cell>("The cell (j, k) that stops the load at that pose: the lowest one, "
                             "and of several the one farthest to the right.")};

/// Whether a load passes.
template <>
inline constexpr std::tuple kFactsOf<SectionCheck>{
    fact<&SectionCheck::verdict>("'passes', 'stopped' or 'unknown'."),
    fact<&SectionCheck::stop>("The first place where the load is stopped: a SectionStop, or None."),
    fact<&SectionCheck::stops>("The first place of each stretch that stops the load: a list of "
                               "SectionStop along the path."),
    fact<&SectionCheck::unknowns>(
        "The first place of each stretch where the load needs a cell that no beam of the scanner "
        "crossed: a list of SectionStop, empty without seen space.")};

/// The answer to a row of a table of outlines.
template <>
inline constexpr std::tuple kFactsOf<OutlineRowCheck>{
    fact<&OutlineRowCheck::line>("The line of the table that has the row."),
    fact<&OutlineRowCheck::chainage_from>("Where the row begins, metres."),
    fact<&OutlineRowCheck::chainage_to>("Where the row ends, metres."),
    fact<&OutlineRowCheck::margin>("The distance that was kept, metres."),
    fact<&OutlineRowCheck::bins>("The first and the last stretch that were judged, or None where "
                                 "the load has no pose there."),
    fact<&OutlineRowCheck::check>("The answer: a SectionCheck.")};

/// A part of the path without an outline.
template <>
inline constexpr std::tuple kFactsOf<OutlineGap>{
    fact<&OutlineGap::chainage_from>("Where the gap begins, metres."),
    fact<&OutlineGap::chainage_to>("Where the gap ends, metres."),
    fact<&OutlineGap::bins>("The first and the last stretch that it touches, which are unknown.")};

/// The answer to a table of outlines beside that of a section.
template <>
inline constexpr std::tuple kFactsOf<OutlineTableCheck>{
    fact<&OutlineTableCheck::rows>(
        "The answer to each row, along the path: a list of OutlineRowCheck."),
    fact<&OutlineTableCheck::gaps>("Parts of the path without an outline: a list of OutlineGap.")};

/// The cells of a window.
template <>
inline constexpr std::tuple kFactsOf<SectionGrid>{
    fact<&SectionGrid::j_from>("The first column of the window."),
    fact<&SectionGrid::j_to>("One more than the last column of the window."),
    fact<&SectionGrid::k_from>("The first row of the window."),
    fact<&SectionGrid::k_to>("One more than the last row of the window.")};

}  // namespace clearway
