#pragma once

#include "clearway/page_run.hpp"

namespace clearway::tool {

/// Logs them, and reports what a tolerance spared.
void report_statistics(const SweepStatistics& statistics, EngineReport& report);

/// The sweep engine on the CPU; options.threads is not 0.
PageEngineKind cpu_sweep(const Store& store, const Question& question,
                         const EngineOptions& options);

}  // namespace clearway::tool
