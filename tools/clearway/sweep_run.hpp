#pragma once

#include "clearway/page_run.hpp"

namespace clearway::tool {

void log_statistics(const SweepStatistics& statistics);

/// The sweep engine on the CPU; options.threads is not 0.
PageEngineKind cpu_sweep(const Store& store, const Question& question,
                         const EngineOptions& options);

}  // namespace clearway::tool
