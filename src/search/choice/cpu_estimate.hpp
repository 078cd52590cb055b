#pragma once

#include "clearway/search.hpp"
#include "search/choice/workload.hpp"

namespace clearway {

/// Wall clock of the whole command on the CPU, seconds: with reading model and poses and writing a
/// small result. An estimate for choosing, never for answers. docs/design/choice.md says how good
/// it is, and how its constants were measured. threads: at least 1.
EngineEstimate estimate_on_cpu(const Workload& work, int threads);

}  // namespace clearway
