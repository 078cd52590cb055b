#pragma once

namespace clearway {

enum class Device { kAuto, kCpu, kCuda };  ///< kAuto: a GPU that has room, or else the CPU

const char* name_of(Device device);  ///< "auto", "cpu" or "cuda"

/// Estimated seconds of a search on each device, including a GPU's start.
struct DeviceEstimate {
  double cpu = 0, cuda = 0;
};

}  // namespace clearway
