#pragma once

#include <future>
#include <vector>

#include "clearway/search.hpp"

namespace clearway {

/// Starts GPUs on threads of its own: their contexts and the engine's kernels. What goes wrong is
/// told where the GPU is then used, which tries it once more.
class DeviceStart {
 public:
  /// Begins, where options may take GPUs: those they name, or the first; all at once.
  explicit DeviceStart(const SearchOptions& options);

  /// Until all have started.
  void wait() const;

  /// Wall clock of the slowest one's start. Waits.
  double seconds() const;

 private:
  std::vector<std::shared_future<double>> starts_;
};

}  // namespace clearway
