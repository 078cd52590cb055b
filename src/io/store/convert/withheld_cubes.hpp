#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "clearway/error.hpp"
#include "core/util/format.hpp"
#include "io/store/convert/quanta_batch.hpp"

namespace clearway {

/// Sorts the cubes, and keeps each once.
inline void keep_once(std::vector<MetreCube>& cubes) {
  std::ranges::sort(cubes);
  const auto rest = std::ranges::unique(cubes);
  cubes.erase(rest.begin(), rest.end());
}

/// Collects the cubes of 1 m in which points lie that are left out because they are withheld. For
/// one thread. The result does not depend on the order of the batches.
class WithheldCubes {
 public:
  /// most_bytes: memory that may be taken.
  explicit WithheldCubes(std::uint64_t most_bytes) : most_(most_bytes / sizeof(MetreCube)) {}

  /// Throws ResourceError where the cubes take too much memory.
  void add(const std::vector<MetreCube>& cubes) {
    cubes_.insert(cubes_.end(), cubes.begin(), cubes.end());
    if (cubes_.size() < wait_) return;
    keep_once(cubes_);
    if (cubes_.size() > most_ / 2) {
      throw ResourceError("the points with the flag `withheld` lie in more than " +
                              format_count(most_ / 2) +
                              " cubes of 1 m, whose list takes more than an eighth of the memory",
                          Remedy::kMoreMemory);
    }
    wait_ = std::max(kLeastWait, 2 * cubes_.size());
  }

  /// The cubes, ascending and each once. Called after the last batch.
  std::vector<MetreCube> take() {
    keep_once(cubes_);
    cubes_.shrink_to_fit();
    return std::move(cubes_);
  }

 private:
  static constexpr std::size_t kLeastWait = std::size_t{1} << 17;

  std::uint64_t most_;
  std::size_t wait_ = kLeastWait;  ///< number of cubes at which they are sorted again
  std::vector<MetreCube> cubes_;
};

}  // namespace clearway
