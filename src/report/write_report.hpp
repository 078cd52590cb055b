#pragma once

#include "clearway/report.hpp"
#include "findings/found_conflicts.hpp"

namespace clearway {

/// As the public write_report(). found: conflicts that are known already, which are taken where
/// they are those of the result and the options; or null.
ReportSummary write_report(const Result& result, const Store& store, const Model& model,
                           const std::vector<Pose>& poses, const std::filesystem::path& output,
                           const ReportOptions& options, const FoundConflicts* found);

}  // namespace clearway
