#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>

namespace clearway {

/// Calls visit(i) for every set bit i, in ascending order.
template <typename Visit>
void for_each_bit(std::uint64_t bits, Visit visit) {
  for (; bits != 0; bits &= bits - 1) visit(static_cast<std::size_t>(std::countr_zero(bits)));
}

}  // namespace clearway
