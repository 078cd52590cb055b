#pragma once

#include <tbb/global_control.h>

#include <optional>

namespace clearway {

/// Lets oneTBB start more threads than the machine has cores, where that many are asked for, as
/// long as it lives; never fewer. A limit that the caller has set stays.
class ThreadLimit {
 public:
  explicit ThreadLimit(int threads) {
    constexpr auto kLimit = tbb::global_control::max_allowed_parallelism;
    const auto wanted = static_cast<std::size_t>(threads);
    if (wanted > tbb::global_control::active_value(kLimit)) raised_.emplace(kLimit, wanted);
  }

 private:
  std::optional<tbb::global_control> raised_;
};

}  // namespace clearway
