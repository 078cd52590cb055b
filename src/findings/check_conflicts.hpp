#pragma once

#include <vector>

#include "clearway/conflicts.hpp"
#include "io/result/result.hpp"

namespace clearway {

/// Throws UsageError for options that make no sense and for a result without first poses,
/// InputError for poses of another search.
void check_conflicts(const ResultReader& result, const std::vector<Pose>& poses,
                     const ConflictOptions& options);

}  // namespace clearway
