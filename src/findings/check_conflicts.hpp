#pragma once

#include <span>
#include <string>
#include <vector>

#include "clearway/conflicts.hpp"
#include "clearway/progress.hpp"
#include "io/result/result.hpp"

namespace clearway {

/// Throws UsageError for options that make no sense and for a result without first poses, and
/// InputError for poses or bodies that are not those of the search.
void check_conflicts(const ResultReader& result, const std::vector<Pose>& poses,
                     const ConflictOptions& options);

/// Throws UsageError for axes other than x ahead and z up where the search turned the model,
/// because then the turned model has these.
void check_axes(const ResultReader& result, const ConflictOptions& options);

/// Throws InputError where a result is not that of the vehicle with these bodies.
void check_bodies_of(const ResultReader& result, std::span<const Body> bodies);

/// Warns of conflicts that are of little use: "one-long-conflict" for a group that spans most of
/// the path. unit: the symbol of the unit of length.
std::vector<Message> conflict_warnings(const Conflicts& conflicts, const std::string& unit);

}  // namespace clearway
