#pragma once

#include "search/devices.hpp"
#include "search/page_run.hpp"

namespace clearway {

/// The CUDA engines, one on each of the devices chosen. Only in a build with CUDA.
PageEngineKind cuda_sweep(const StoreReader& store, const EngineOptions& options,
                          const DeviceChoice& device);
PageEngineKind cuda_grid(const StoreReader& store, const Query& query, const EngineOptions& options,
                         const DeviceChoice& device);

}  // namespace clearway
