#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "clearway/engines.hpp"

namespace clearway::tool {

/// Where a run's engine works.
struct DeviceChoice {
  std::vector<int> gpus;           ///< CUDA's numbers; none: the CPU
  std::string name = "the CPU";    ///< for people
  std::uint64_t memory_bytes = 0;  ///< that may be taken on each GPU
  double context_seconds = 0;      ///< wall clock of making the GPUs' contexts

  bool is_cuda() const { return !gpus.empty(); }
};

/// Chooses by options.device and options.gpus: "auto" takes the GPU with the most free memory where
/// there is one with room, and the CPU otherwise; "cuda" all that are named, or that one. Throws
/// UsageError where the engine has no such form, ResourceError, saying what to do, where CUDA is
/// asked for and not there.
DeviceChoice choose_device(const EngineOptions& options);

}  // namespace clearway::tool
