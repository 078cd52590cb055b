#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "clearway/found_place.hpp"
#include "clearway/ignored.hpp"
#include "clearway/progress.hpp"
#include "clearway/query.hpp"
#include "clearway/shard.hpp"
#include "clearway/unsearched.hpp"

namespace clearway {

/// Whether the model passes. kUnknown is the verdict of one part of a divided query alone, where
/// this part has no colliding point: merge() tells the verdict of all parts.
enum class Verdict { kClear, kConflict, kUndecided, kUnknown };

/// Why a verdict is kUndecided.
enum class Reason {
  kQuestionInDoubt  ///< a warning says that the search could not find anything: see is_doubt()
};

const char* name_of(Verdict verdict);  ///< "clear", "conflict", "undecided" or "unknown"
const char* name_of(Reason reason);    ///< "question-in-doubt"

/// Whether a warning of this code says that nothing could be found, whatever stands in the way, so
/// that finding nothing is no answer: "out-of-reach", "no-points", "no-poses" and "all-ignored".
bool is_doubt(std::string_view code);

/// The codes among these warnings that are doubts, each once, in the order of the alphabet.
std::vector<std::string> doubts_among(const std::vector<Message>& warnings);

/// The answer to a query in short. All that words or counts an answer takes it from here: search()
/// and merge() report it, and Result::answer() reads it from a file.
struct Answer {
  QueryParameters parameters;  ///< lists of what is ignored ascending, each once
  std::uint64_t environment_points = 0, model_points = 0, poses = 0;
  std::uint64_t model_solids = 0;  ///< parts of the model that have an inside
  /// Metres. No place of the surface of a mesh that was searched as points is farther than this
  /// from one of them; the greatest of all bodies. 0: the model is no sampled mesh.
  double model_spacing = 0;
  std::uint64_t colliding_points = 0;
  std::uint64_t clearance_points = 0;  ///< points closer than the clearance asked for
  std::uint64_t inside_points = 0;     ///< those of them inside a solid of the model
  std::uint64_t profile_poses = 0;     ///< poses closer than the profile's distance asked for
  /// How many points of the whole environment the search left out, in the order of the lists of
  /// the parameters.
  IgnoredPointCounts ignored;
  /// How many of the ignored points would collide if they were searched, and how many of these the
  /// model first touches more than half a metre above its lowest point. 0 where none is ignored,
  /// nullopt where it is not known, as in results of earlier releases.
  std::optional<std::uint64_t> ignored_colliding = 0, ignored_colliding_high = 0;
  /// Where the query asks for it: the point with the smallest first pose, the one with the least
  /// clearance, and the least distance of the profile at its first pose. Of several points the one
  /// with the smallest source. Coordinates are NaN where a file before version 3 lacks them.
  std::optional<FoundPlace> first_place, least_clearance, least_profile;
  std::vector<std::string> bodies;  ///< names, where the query has several bodies
  std::optional<Shard> shard;       ///< where it is the answer of one part alone
  bool float_precision = false;     ///< single precision alone decided: not exact
  std::vector<std::string> doubts;  ///< see doubts_among()
  /// How much of the path the answer is about: bodies on pivots have no pose at its ends. nullopt
  /// where it is not known, as for files of one model, whose path was searched to its whole length,
  /// and for files of several bodies that an earlier release wrote.
  std::optional<SearchedLength> searched;

  /// One colliding point is a conflict, however doubtful the question is.
  Verdict verdict() const;
  std::vector<Reason> reasons() const;  ///< why it is undecided, otherwise none
  /// The least distance that is known.
  const std::optional<FoundPlace>& nearest() const;
  /// How many points are inside the model; nullopt without solids or clearances.
  std::optional<std::uint64_t> points_inside() const;
  /// The greatest depth of a point inside the model in metres, 0 where none is inside; nullopt
  /// without solids, or without distances.
  std::optional<double> greatest_depth() const;
};

}  // namespace clearway
