#pragma once

#include "clearway/search.hpp"
#include "search/choice/workload.hpp"

namespace clearway {

/// Estimates the wall clock of the whole command on the CPU with each engine, in seconds, including
/// the time to read model and poses and to write a small result. Used for choosing, never for
/// answers. docs/design/choice.md says how good the estimate is, and how its constants were
/// measured. threads: at least 1.
EngineEstimate estimate_on_cpu(const Workload& work, int threads);

}  // namespace clearway
