#include "clearway/search.hpp"

namespace clearway {

const char* name_of(Engine engine) {
  switch (engine) {
    case Engine::kSweep:
      return "sweep";
    case Engine::kGrid:
      return "grid";
    case Engine::kKdtree:
      return "kdtree";
  }
  return "unknown";
}

const char* name_of(Device device) {
  switch (device) {
    case Device::kCpu:
      return "cpu";
    case Device::kCuda:
      return "cuda";
    case Device::kAuto:
      break;
  }
  return "auto";
}

}  // namespace clearway
