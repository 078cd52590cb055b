#pragma once

#include <future>
#include <vector>

#include "clearway/search.hpp"

namespace clearway {

/// Starts GPUs on threads of their own: makes their contexts and loads the engine's kernels. A
/// failure is not reported here but where the GPU is used, which tries once more.
class DeviceStart {
 public:
  /// Starts the GPUs that options name, or the first one, all at once. Starts none where options
  /// rule out GPUs.
  explicit DeviceStart(const SearchOptions& options);

  /// Waits until all GPUs have started or failed.
  void wait() const;

  /// Wall clock of the slowest start in seconds. Waits until all GPUs have started, and throws what
  /// a start has thrown.
  double seconds() const;

 private:
  std::vector<std::shared_future<double>> starts_;
};

}  // namespace clearway
