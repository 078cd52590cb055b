#include "clearway/devices.hpp"

#include "core/error.hpp"

namespace clearway::tool {

std::string choose_device(const EngineOptions& options) {
  const bool cuda = options.device == "cuda" || !options.gpus.empty();
  if (cuda && options.engine == "kdtree") {
    throw UsageError("--device cuda: engine kdtree runs on the CPU alone; take --engine sweep");
  }
  if (cuda) {
    throw ResourceError(
        "--device cuda: this build has no CUDA engine; take --device cpu, or build "
        "Clearway where nvcc is found and run it where nvidia-smi lists a GPU");
  }
  return "cpu";
}

}  // namespace clearway::tool
