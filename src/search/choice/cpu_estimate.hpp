#pragma once

#include "search/choice/workload.hpp"

namespace clearway {

/// Wall clock of answering on the CPU, seconds: from the query to what was found, without reading
/// and writing files. An estimate for choosing, never for answers. docs/design/choice.md says how
/// good it is, and how its constants were measured.
struct CpuEstimate {
  double sweep = 0;
  double kdtree = 0;
};

/// threads: at least 1.
CpuEstimate estimate_on_cpu(const Workload& work, int threads);

}  // namespace clearway
