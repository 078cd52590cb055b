#pragma once

#include <memory>

#include "search/devices.hpp"
#include "search/kinds/page_engine_kind.hpp"

namespace clearway {

class StoreReader;

/// The CUDA form of the engine that options choose, one on each of the devices. Only in a build
/// with CUDA. options.threads is not 0; all references outlive it.
std::unique_ptr<PageEngineKind> cuda_kind(const StoreReader& store, const Query& query,
                                          const SearchOptions& options, const DeviceChoice& device);

}  // namespace clearway
