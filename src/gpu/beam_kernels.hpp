#pragma once

#include <cuda_runtime_api.h>

#include <cstdint>

#include "core/seen/beams.hpp"

namespace clearway {

/// Follows the beams of a page. counts: as in a BeamCounts, added to. Enqueued on `stream`, not
/// synchronised. Throws ResourceError.
void follow_beams(const BeamsRef& beams, const BeamPage& page, unsigned long long* counts,
                  cudaStream_t stream);

}  // namespace clearway
