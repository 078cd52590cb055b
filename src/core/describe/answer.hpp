#pragma once

#include <tuple>

#include "clearway/merge.hpp"
#include "clearway/search.hpp"
#include "core/describe/fact.hpp"

namespace clearway {

/// A point that was found.
template <>
inline constexpr std::tuple kFactsOf<FoundPlace>{
    fact<&FoundPlace::source>("The index of the point in the order of the scans."),
    fact<&FoundPlace::pose>("The index of the pose, from 0."),
    fact<&FoundPlace::xyz>("The coordinates of the point: 3 float64, metres."),
    fact<&FoundPlace::distance>("The distance between the point and the model at this pose, "
                                "metres; 0 where distances were not asked for."),
    fact<&FoundPlace::point_class>(
        "The class of the point, as the scans have it. None unless they have classes.")};

/// What a query left out.
template <>
inline constexpr std::tuple kFactsOf<IgnoredPointCounts>{
    fact<&IgnoredPointCounts::points>("How many points are left out in all; a point of an ignored "
                                      "class in an ignored box counts once."),
    fact<&IgnoredPointCounts::of_classes>("How many points each ignored class has: a list in the "
                                          "order of the query's ignore_classes, sorted."),
    fact<&IgnoredPointCounts::in_boxes>("How many points each ignored box has: a list in the order "
                                        "of the query's ignore_boxes, sorted.")};

/// How much of a path was searched.
template <>
inline constexpr std::tuple kFactsOf<SearchedLength>{
    fact<&SearchedLength::path>("Metres of the whole path."),
    fact<&SearchedLength::whole>(
        "Metres on which all bodies have poses, so that all of them were searched."),
    fact<&SearchedLength::part>(
        "Metres on which some bodies were searched, and others have no pose.")};

/// The answer to a query, but for what the error budget says of it.
template <>
inline constexpr std::tuple kFactsOf<Answer>{
    fact<&Answer::verdict>("The verdict: 'clear', 'conflict' or 'undecided'; 'unknown' of one part "
                           "alone that has no colliding point."),
    fact<&Answer::reasons>(
        "Why the verdict is undecided: a list of 'near', 'few', 'errors-exceed-margin', "
        "'not-scanned' and 'question-in-doubt'; otherwise empty."),
    fact<&Answer::near_points>(
        "How many further points are closer than the radius and the error budget."),
    fact<&Answer::seen>("What is known of the space that the model sweeps: a SeenSummary. None "
                        "unless the query asked for it."),
    fact<&Answer::warnings>("What may be wrong with the question and its inputs: a list of "
                            "Message. Read it before you trust an answer."),
    fact<&Answer::doubts>("The codes of the warnings that put the question, or a stretch of its "
                          "path, in doubt: a list of str."),
    fact<&Answer::warned_of>("The codes of the other warnings: a list of str."),
    fact<&Answer::parameters>("What was asked: QueryParameters."),
    fact<&Answer::environment_points>("How many points the environment has."),
    fact<&Answer::model_points>("How many points the model has, or corners where it is a surface."),
    fact<&Answer::poses>("How many poses the path has."),
    fact<&Answer::model_spacing>(
        "Metres. The model's points are samples of a mesh, and no place of its surface is farther "
        "than this from one of them. 0: the model is no sampled mesh."),
    fact<&Answer::model_solids>("How many parts of the model have an inside."),
    fact<&Answer::colliding_points>(
        "How many environment points are closer to the moving model than the radius."),
    fact<&Answer::classes>("How many of the colliding and near points have each class: a dict of "
                           "numbers by class, which is empty unless the scans have classes."),
    fact<&Answer::inside_points>("How many colliding points are inside a solid of the model at any "
                                 "pose. Counted where clearances were asked for."),
    fact<&Answer::clearance_points>(
        "How many points are closer than the clearance that was asked for."),
    fact<&Answer::profile_poses>(
        "At how many poses something is closer than the profile's distance that was asked for."),
    fact<&Answer::ignored>(
        "How many points of the environment the query left out: IgnoredPointCounts."),
    fact<&Answer::body_floors>(
        "The floor of each body in metres of its frame, its own or that of the query, None for a "
        "body without one; empty where no body has a floor."),
    fact<&Answer::floor_colliding>("How many points would collide without the floor and are not "
                                   "judged because of it. None without a floor."),
    fact<&Answer::ignored_colliding>(
        "How many ignored points would collide if they were searched."),
    fact<&Answer::ignored_colliding_high>("How many ignored points the model would first touch "
                                          "more than half a metre above its lowest point."),
    fact<&Answer::first_place>("The colliding point with the smallest first pose: a FoundPlace. "
                               "None where nothing collides or first poses were not asked for."),
    fact<&Answer::least_clearance>("The point with the least clearance: a FoundPlace. None where "
                                   "there is none or clearances were not asked for."),
    fact<&Answer::least_profile>("The point with the least distance of the profile: a FoundPlace. "
                                 "None where there is none or no profile was asked for."),
    fact<&Answer::first_place>(
        "The colliding point with the smallest first pose, as first_place has it.", "first"),
    fact<&Answer::nearest>(
        "The place of the least distance that is known, of profile and clearances: a FoundPlace. "
        "None where nothing is that close or neither was asked for.",
        "least"),
    fact<&Answer::searched>("How much of the path was searched: a SearchedLength. None for one "
                            "model, which is searched on the whole path."),
    fact<&Answer::shard>("(i, n) where only the i-th of n parts was searched; otherwise None.")};

/// The seconds of a search.
template <>
inline constexpr std::tuple kFactsOf<SearchSeconds>{
    fact<&SearchSeconds::total>("Seconds from the call until the result was written."),
    fact<&SearchSeconds::context>(
        "Seconds that starting the GPUs took, beside all that comes before the engine."),
    fact<&SearchSeconds::context_wait>("Seconds that the search waited for the GPUs to start."),
    fact<&SearchSeconds::check>("Seconds of looking at the question before it was searched."),
    fact<&SearchSeconds::field>(
        "Seconds of making what the engine looks up, such as the field around the model."),
    fact<&SearchSeconds::plan>("Seconds of planning which cells are searched at which poses."),
    fact<&SearchSeconds::engine>("Seconds of making the engine with its memory."),
    fact<&SearchSeconds::search>(
        "Seconds from the first cell that was read to the last one that was searched."),
    fact<&SearchSeconds::read>("Seconds in which cells of the store were read."),
    fact<&SearchSeconds::upload>("Seconds in which cells were copied to a GPU."),
    fact<&SearchSeconds::compute>("Seconds in which distances were computed."),
    fact<&SearchSeconds::collect>("Seconds in which what was found was gathered."),
    fact<&SearchSeconds::depth>("Seconds of finding the free point nearest to each colliding one."),
    fact<&SearchSeconds::swept>("Seconds of finding the cubes that the model sweeps."),
    fact<&SearchSeconds::beams>("Seconds of following the scanner's beams through these cubes."),
    fact<&SearchSeconds::write>("Seconds of writing the result."),
    fact<&SearchSeconds::end_wait>(
        "Seconds that the call waited, once the result was written, for the GPUs to end.")};

/// The seconds of a search by which a device was chosen.
template <>
inline constexpr std::tuple kFactsOf<DeviceEstimate>{
    fact<&DeviceEstimate::cpu>("Estimated seconds on the CPU."),
    fact<&DeviceEstimate::cuda>("Estimated seconds on a GPU, its start included.")};

/// What was read of a store.
template <>
inline constexpr std::tuple kFactsOf<BytesRead>{
    fact<&BytesRead::coordinates>("Bytes of coordinates."),
    fact<&BytesRead::sources>("Bytes of source indices."),
    fact<&BytesRead::classes>("Bytes of classes."),
    fact<&BytesRead::origins>("Bytes of the origins of beams.")};

/// What a search found beside its answer, and how it searched.
template <>
inline constexpr std::tuple kFactsOf<SearchReport>{
    fact<&SearchReport::was_finished>(
        "Whether the result was there already, so that nothing was searched."),
    fact<&SearchReport::model_triangles>("How many triangles the model has; 0 where it is points."),
    fact<&SearchReport::engine>("The engine that searched: 'sweep', 'grid' or 'kdtree'."),
    fact<&SearchReport::device>("The device that searched: 'cpu' or 'cuda'."),
    fact<&SearchReport::device_name>("The name of the device for people, such as that of the GPU."),
    fact<&SearchReport::estimate>(
        "The DeviceEstimate by which device 'auto' chose. None where it had no choice."),
    fact<&SearchReport::shard_share>("The estimated work of this part over the mean of all parts; "
                                     "None where everything was searched."),
    fact<&SearchReport::searches>(
        "How many pairs of a pose and a model point or triangle were asked about."),
    fact<&SearchReport::cells_total>("How many cells the store has."),
    fact<&SearchReport::cells_read>("How many cells were read; the model comes near no other."),
    fact<&SearchReport::bytes_read>("How many bytes of the store's points were read: a BytesRead."),
    fact<&SearchReport::resumed_cells>("How many cells an interrupted search had finished before."),
    fact<&SearchReport::pages>("In how many pieces the environment was searched."),
    fact<&SearchReport::page_bytes>("How many bytes such a piece had at the most."),
    fact<&SearchReport::slots>("How many pieces were in work at the same time."),
    fact<&SearchReport::needed_host_bytes>(
        "How much memory the search took at the most, in bytes."),
    fact<&SearchReport::pinned_bytes>(
        "How much memory of the host was reserved for the GPUs, in bytes."),
    fact<&SearchReport::peak_device_bytes>(
        "How much memory was taken on a GPU at the most, in bytes."),
    fact<&SearchReport::seconds>("How long each part of the search took: a SearchSeconds.")};

/// What a merge found beside its answer.
template <>
inline constexpr std::tuple kFactsOf<MergeReport>{
    fact<&MergeReport::was_finished>("The result was there already."),
    fact<&MergeReport::length_unit>(
        "The unit of the environment: 'metre', 'foot', 'us-survey-foot', 'degree' or 'unknown'."),
    fact<&MergeReport::parts>("How many parts were merged."),
    fact<&MergeReport::part_warnings>("The warnings of the parts, each once, and of the merge: a "
                                      "list of PartWarning. The result keeps them too.",
                                      "warnings")};

}  // namespace clearway
