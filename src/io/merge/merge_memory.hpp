#pragma once

#include <cstddef>
#include <cstdint>

#include "io/merge/part_set.hpp"

namespace clearway {

/// Number of rows of each part that merging holds at once, a power of two, chosen so that it takes
/// at most `memory_bytes`. Throws ResourceError where even the fewest rows are too many.
std::size_t batch_rows_of(const PartSet& set, std::uint64_t memory_bytes);

}  // namespace clearway
