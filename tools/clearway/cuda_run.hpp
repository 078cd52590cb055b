#pragma once

#include "clearway/devices.hpp"
#include "clearway/page_run.hpp"

namespace clearway::tool {

/// The CUDA engines, one on each of the devices chosen. Only in a build with CUDA.
PageEngineKind cuda_sweep(const Store& store, const EngineOptions& options,
                          const DeviceChoice& device);
PageEngineKind cuda_grid(const Store& store, const Question& question, const EngineOptions& options,
                         const DeviceChoice& device);

}  // namespace clearway::tool
