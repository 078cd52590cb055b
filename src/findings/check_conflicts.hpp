#pragma once

#include <span>
#include <string>
#include <vector>

#include "clearway/conflicts.hpp"
#include "clearway/model.hpp"
#include "clearway/pose.hpp"
#include "clearway/progress.hpp"
#include "io/result/result.hpp"
#include "io/scans/length_unit.hpp"

namespace clearway {

class StoreReader;

/// Throws UsageError for options that make no sense and for a result without first poses, and
/// InputError for poses or bodies that are not those of the search.
void check_conflicts(const ResultReader& result, const std::vector<Pose>& poses,
                     const ConflictOptions& options);

/// Throws UsageError for axes other than x ahead and z up where the search turned the model,
/// because then the turned model has these.
void check_axes(const ResultReader& result, const ConflictOptions& options);

/// Throws InputError where a result is not that of the vehicle with these bodies.
void check_bodies_of(const ResultReader& result, std::span<const Body> bodies);

/// What a result is said to be of; the references must outlive it.
struct Searched {
  const Model& model;  ///< empty for a vehicle of several bodies
  std::span<const Body> bodies;
  const std::vector<Pose>& poses;
};

/// Throws InputError where store, model or bodies, or poses are not those of the search.
void check_searched(const ResultReader& result, const StoreReader& store, const Searched& given);

/// The height above the lowest point of what moves up to which ground and rails reach, on which it
/// stands, in the environment's unit; where that is unknown or no length, metres are assumed.
double ground_height(LengthUnit unit);

/// Whether one group spans half of the path or more.
bool spans_most_of_the_path(const Conflicts& conflicts);

/// Warns of conflicts that are of little use: "one-long-conflict" for a group that spans most of
/// the path, with what its height says of it. unit: the environment's.
std::vector<Message> conflict_warnings(const Conflicts& conflicts, LengthUnit unit);

}  // namespace clearway
