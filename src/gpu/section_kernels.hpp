#pragma once

#include <cuda_runtime_api.h>

#include "core/section/section_block.hpp"

namespace clearway {

/// Blocks the cells of a section by the points of a page. Enqueued on `stream`, not synchronised.
/// Throws ResourceError.
void block_cells(const SectionPage& page, cudaStream_t stream);

/// Loads the kernel on the current device, so that the first page does not wait for that. A failure
/// is ignored.
void load_section_kernel() noexcept;

}  // namespace clearway
