#pragma once

#include "clearway/engines.hpp"

namespace clearway::tool {

/// "cpu" or "cuda": where the engine that `options` name runs. Throws UsageError where the engine
/// has no such form, ResourceError, saying what to do, where CUDA is asked for, by itself or by
/// naming GPUs, and not there.
std::string choose_device(const EngineOptions& options);

}  // namespace clearway::tool
