#pragma once

#include <cstddef>
#include <cstdint>

#include "io/merge/part_set.hpp"

namespace clearway {

/// How many rows of each part merging holds at once, so that it takes at most `memory_bytes`:
/// a power of two. Throws ResourceError where even few are too many.
std::size_t batch_rows_of(const PartSet& set, std::uint64_t memory_bytes);

}  // namespace clearway
