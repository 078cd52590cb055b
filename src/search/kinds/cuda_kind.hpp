#pragma once

#include <functional>
#include <memory>

#include "search/devices.hpp"
#include "search/kinds/page_engine_kind.hpp"

namespace clearway {

class PackedCloud;

/// Waits for GPUs to start, and chooses as many as the options name, or one.
using OpenGpus = std::function<DeviceChoice()>;

/// The CUDA form of the engine that options choose, with one engine on each of the GPUs that `open`
/// gives once there is a plan. Only in a build with CUDA. options.threads is not 0; all references
/// outlive it.
std::unique_ptr<PageEngineKind> cuda_kind(const PackedCloud& cloud, const Query& query,
                                          const SearchOptions& options, OpenGpus open);

}  // namespace clearway
