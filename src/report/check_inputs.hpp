#pragma once

#include <vector>

#include "clearway/report.hpp"

namespace clearway {

/// Throws InputError where store, model or bodies, or poses are not those of the result.
void check_report_inputs(const Result& result, const Store& store, const Model& model,
                         const std::vector<Pose>& poses, const ReportOptions& options);

}  // namespace clearway
