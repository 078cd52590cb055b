#include "core/seen/beams.hpp"

#include <cstring>

namespace clearway {

std::uint64_t stage_origins(const PageRef& page, const OriginsOfCell& origins, std::byte* to) {
  std::uint64_t at = PageShape::aligned(page.shape.cells * sizeof(PageChunk));
  for (std::uint32_t i = 0; i < page.shape.cells; ++i) {
    const PackedChunk<std::uint32_t> of = origins(page.cell(i).cell);
    const PageChunk chunk{at, static_cast<std::int32_t>(of.minimum()), of.minbits()};
    std::memcpy(to + i * sizeof(PageChunk), &chunk, sizeof(chunk));
    const std::uint64_t bytes =
        packed_bytes<std::uint32_t>(of.size(), of.minbits()) - kPackedHeaderBytes;
    std::memcpy(to + at, of.payload(), bytes);
    at += bytes;
  }
  std::memset(to + at, 0, kPagePadding);
  return PageShape::aligned(at + kPagePadding);
}

std::uint64_t origin_bytes(std::uint32_t cells, std::uint32_t cell_points, unsigned most_minbits) {
  const std::uint64_t payload =
      packed_bytes<std::uint32_t>(cell_points, most_minbits) - kPackedHeaderBytes;
  return PageShape::aligned(cells * sizeof(PageChunk)) +
         PageShape::aligned(cells * payload + kPagePadding);
}

}  // namespace clearway
