#pragma once

#include "search/page_run.hpp"

namespace clearway {

/// Logs them, and reports what a tolerance spared.
void report_statistics(const SweepStatistics& statistics, EngineReport& report);

/// The sweep engine on the CPU; options.threads is not 0.
PageEngineKind cpu_sweep(const StoreReader& store, const Query& query,
                         const EngineOptions& options);

}  // namespace clearway
