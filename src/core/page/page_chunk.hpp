#pragma once

#include "core/cloud/packed_chunk.hpp"
#include "core/page/page.hpp"

namespace clearway {

/// A chunk of a page on the host, for decoding many values at once. count: the cloud's cell_points.
inline PackedChunk<std::int32_t> packed_chunk(const PageRef& page, const PageChunk& chunk,
                                              std::uint32_t count) {
  return PackedChunk<std::int32_t>::of_payload(page.begin + chunk.payload, count, chunk.minbits,
                                               chunk.minimum);
}

}  // namespace clearway
