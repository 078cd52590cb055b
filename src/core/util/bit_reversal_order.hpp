#pragma once

#include <cstdint>

#include "core/util/macros.hpp"

namespace clearway {

/// The numbers 0 .. n - 1, n at most 64, in an order in which the first ones lie far apart: that of
/// their bits read backwards (van der Corput).
class BitReversalOrder {
 public:
  static constexpr std::uint32_t kMost = 64;

  CLEARWAY_HD explicit BitReversalOrder(std::uint32_t n) : n_(n) {
    while (n_ > 1U << bits_) ++bits_;
  }

  /// Calls visit(number) for each number until it returns false.
  template <typename Visit>
  CLEARWAY_HD void for_each(Visit visit) const {
    for (std::uint32_t i = 0; i < 1U << bits_; ++i) {
      std::uint32_t number = 0;
      for (std::uint32_t bit = 0; bit < bits_; ++bit) number |= (i >> bit & 1) << (bits_ - 1 - bit);
      if (number < n_ && !visit(number)) return;
    }
  }

 private:
  std::uint32_t n_;
  std::uint32_t bits_ = 0;
};

}  // namespace clearway
